/** Undo and redo of what the link holds. */
import { type Linked, linkedOf, type State } from './state';
import type { Store } from './store';

/** Most steps that can be undone. */
const LENGTH = 200;
/** Changes of one kind within this time are one step, ms. */
const TOGETHER = 800;

export class History {
  private past: Linked[] = [];
  private future: Linked[] = [];
  private last = { kind: '', at: 0 };

  constructor(private readonly store: Store<State>) {}

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /**
   * Change the state in a step that can be undone.
   *
   * @param kind What is changed: quick changes of the same kind are one step.
   */
  change(change: Partial<Linked>, kind: string): void {
    const at = performance.now();
    if (kind !== this.last.kind || at - this.last.at > TOGETHER) {
      this.past.push(linkedOf(this.store.state));
      if (this.past.length > LENGTH) this.past.shift();
    }
    this.last = { kind, at };
    this.future = [];
    this.store.set(change);
  }

  undo(): void {
    this.move(this.past, this.future);
  }

  redo(): void {
    this.move(this.future, this.past);
  }

  private move(from: Linked[], to: Linked[]): void {
    const next = from.pop();
    if (!next) return;
    to.push(linkedOf(this.store.state));
    this.last = { kind: '', at: 0 };
    this.store.set(next);
  }
}
