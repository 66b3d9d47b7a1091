/** Runs one task at a time, and of those that wait only the last. */
import { pace } from './api/pace';

/** A task that runs for longer than this is aborted for a newer one, ms. */
const PATIENCE = 150;

type Task = (signal: AbortSignal) => Promise<void>;

export class Latest {
  private next: Task | null = null;
  private isTurning = false;
  private timer: ReturnType<typeof setTimeout> | undefined;
  /** Called when another task comes while one runs for too long. */
  private giveUp: (() => void) | null = null;

  /**
   * @param requests How many requests a task of a drag sends at first: they wait for their turn
   *   before the task is run, so that it is the newest one. None: its requests wait by themselves.
   * @param patience Time for which others are let pass, ms.
   */
  constructor(
    private readonly requests?: () => number,
    private readonly patience = 0,
  ) {}

  /** Run a task now, or after the one that runs; a task that still waits is dropped. */
  run(task: Task): void {
    this.next = task;
    this.giveUp?.();
    if (!this.isTurning) void this.turn();
  }

  private async turn(): Promise<void> {
    this.isTurning = true;
    let before: AbortController | null = null;
    while (this.next) {
      if (this.requests) await pace.admit(this.requests(), this.patience);
      before?.abort();
      const task: Task = this.next;
      this.next = null;
      const running = new AbortController();
      before = running;
      const ended = task(running.signal).catch((error: unknown) => {
        // Nobody waits for a task: its error is the page's.
        if (!isAbort(error))
          queueMicrotask(() => {
            throw error;
          });
      });
      await Promise.race([ended, this.outlived()]);
      clearTimeout(this.timer);
    }
    this.isTurning = false;
  }

  /** Wait until a task has run for too long, and another has come. */
  private outlived(): Promise<void> {
    return new Promise((done) => {
      this.giveUp = null;
      this.timer = setTimeout(() => {
        if (this.next) done();
        else this.giveUp = done;
      }, PATIENCE);
    });
  }
}

export function isAbort(error: unknown): boolean {
  return error instanceof DOMException && error.name === 'AbortError';
}
