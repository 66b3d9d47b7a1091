/** One store. Everything that is on the page follows from the state; all of it is in the link. */
import type { AngleUnit, Convention, Obstacle, ReferenceFrame, TableDocument, Target } from './api';
import type { FramesShown } from './scene/types';

/** Where the robot comes from: stored on the service, or only in this page. */
export type Source =
  | { readonly kind: 'stored'; readonly id: string; readonly convention: Convention | null }
  | { readonly kind: 'table'; readonly table: TableDocument }
  | { readonly kind: 'urdf'; readonly name: string; readonly urdf: string };

export type Section = 'pose' | 'links' | 'jacobian' | 'singularity' | 'ik' | 'path' | 'reproduce';

export interface View {
  readonly frames: FramesShown;
  readonly dimensions: boolean;
  readonly ellipsoid: 'none' | 'velocity' | 'force' | 'both';
  readonly lost: boolean;
  readonly cloud: boolean;
  /** A second robot to compare, by id. */
  readonly other: string;
}

export interface PathForm {
  readonly kind: 'line' | 'circle';
  /** End of the line, or centre of the circle. */
  readonly point: readonly number[];
  readonly plane: 'xy' | 'xz' | 'yz';
  readonly turns: number;
  /** '': that of the page, or of the position where that is the whole pose. */
  readonly task: string;
  readonly methods: readonly string[];
  readonly timeLaw: string;
  readonly tf: number;
  readonly samples: number;
  readonly linkRadius: number;
  readonly dSafe: number;
  readonly obstacles: readonly Obstacle[];
}

export interface State {
  readonly source: Source;
  readonly angle: AngleUnit;
  /** In the shown unit: degrees or rad for joints that turn, m for those that slide. */
  readonly q: readonly number[];
  readonly euler: string;
  readonly reference: ReferenceFrame;
  readonly task: string;
  readonly digits: number;
  readonly open: readonly Section[];
  readonly view: View;
  /** Row of the table whose motions are shown, and how many of the four are done. */
  readonly row: number | null;
  readonly step: number;
  readonly target: Target | null;
  /** Postures kept to compare, in the shown unit. */
  readonly kept: readonly (readonly number[])[];
  readonly path: PathForm;
}

export const NO_PATH: PathForm = {
  kind: 'line',
  point: [],
  plane: 'xy',
  turns: 1,
  task: '',
  methods: ['pseudo_inverse', 'qp'],
  timeLaw: 'cubic',
  tf: 2,
  samples: 101,
  linkRadius: 0.02,
  dSafe: 0.02,
  obstacles: [],
};

export const START: State = {
  source: { kind: 'stored', id: 'puma560', convention: null },
  angle: 'deg',
  q: [],
  euler: 'ZXZ',
  reference: 'local_world_aligned',
  task: 'pose',
  digits: 4,
  open: ['pose', 'jacobian', 'singularity'],
  view: {
    frames: 'all',
    dimensions: false,
    ellipsoid: 'none',
    lost: true,
    cloud: false,
    other: '',
  },
  row: null,
  step: 4,
  target: null,
  kept: [],
  path: NO_PATH,
};

type Listener = (state: State, before: State) => void;

const HISTORY = 200;
/** Changes of one kind within this time are undone together, ms. */
const TOGETHER = 800;

/** The state, who listens to it, and what undo goes back to. */
export class Store {
  private listeners: Listener[] = [];
  private past: State[] = [];
  private future: State[] = [];
  private last = { kind: '', at: 0 };

  constructor(private now: State) {}

  get state(): State {
    return this.now;
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  listen(listener: Listener): void {
    this.listeners.push(listener);
  }

  /**
   * Changes the state.
   *
   * @param kind Name of the change for undo; '' is not undone by itself (what the service answers).
   */
  set(change: Partial<State>, kind = ''): void {
    const before = this.now;
    if (kind) {
      const at = performance.now();
      if (kind !== this.last.kind || at - this.last.at > TOGETHER) {
        this.past.push(before);
        if (this.past.length > HISTORY) this.past.shift();
      }
      this.last = { kind, at };
      this.future = [];
    }
    this.go({ ...before, ...change });
  }

  undo(): void {
    const back = this.past.pop();
    if (!back) return;
    this.future.push(this.now);
    this.last = { kind: '', at: 0 };
    this.go(back);
  }

  redo(): void {
    const forth = this.future.pop();
    if (!forth) return;
    this.past.push(this.now);
    this.last = { kind: '', at: 0 };
    this.go(forth);
  }

  private go(next: State): void {
    const before = this.now;
    this.now = next;
    for (const listener of this.listeners) listener(next, before);
  }
}
