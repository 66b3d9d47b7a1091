/** The state of the page. Everything on it follows from here. */
import type {
  AngleUnit,
  Call,
  FieldError,
  FKAnswer,
  IKAnswer,
  IKSolutionsAnswer,
  JacobianAnswer,
  MatricesAnswer,
  Obstacle,
  PathFields,
  Pose,
  ReferenceFrame,
  SingularityAnswer,
  Target,
} from './api';
import type { Model, Source } from './model';
import type { FramesShown, ScenePath } from './scene/types';

export type Section = 'pose' | 'links' | 'jacobian' | 'singularity' | 'ik' | 'path' | 'reproduce';

export interface View {
  readonly frames: FramesShown;
  readonly dimensions: boolean;
  readonly ellipsoid: 'none' | 'velocity' | 'force' | 'both';
  readonly lost: boolean;
  readonly cloud: boolean;
  /** Id of a second robot to compare; '' for none. */
  readonly other: string;
}

export interface PathForm {
  readonly kind: 'line' | 'circle';
  /** End of the line, or centre of the circle. */
  readonly point: readonly number[];
  readonly plane: 'xy' | 'xz' | 'yz';
  readonly turns: number;
  /** '' for that of the page, and for the position where that is the whole pose. */
  readonly task: string;
  readonly methods: readonly string[];
  readonly timeLaw: NonNullable<PathFields['time_law']>;
  readonly tf: number;
  readonly samples: number;
  readonly linkRadius: number;
  readonly dSafe: number;
  readonly obstacles: readonly Obstacle[];
}

/** What the link holds, and undo restores. */
export interface Linked {
  readonly source: Source;
  readonly angle: AngleUnit;
  /** In the shown unit: degrees or rad for revolute joints, m for prismatic ones. */
  readonly q: readonly number[];
  readonly euler: string;
  readonly reference: ReferenceFrame;
  readonly task: string;
  readonly digits: number;
  readonly open: readonly Section[];
  readonly view: View;
  /** Row of the table whose elementary motions are shown. */
  readonly row: number | null;
  /** How many of its four motions are done. */
  readonly step: number;
  readonly target: Target | null;
  /** Configurations kept to compare, in the shown unit. */
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

/** What a link without parameters shows. */
export const START: Linked = {
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

/** The last answers of the service, by the section that shows them. */
export interface Answers {
  readonly pose: FKAnswer;
  readonly links: MatricesAnswer;
  readonly jacobian: JacobianAnswer;
  readonly singularity: SingularityAnswer;
}

/** What became of the last inverse kinematics. */
export interface Solved {
  readonly answer: IKAnswer | IKSolutionsAnswer | null;
  /** Why there is no answer; '' where there is one. */
  readonly error: string;
}

/** A configuration shown beside the arm, in the shown unit. */
export interface Ghost {
  readonly q: readonly number[];
  readonly label: string;
}

/** What belongs to this visit only. */
export interface Session {
  /** The last robot that could be used; null before the first. */
  readonly model: Model | null;
  /** What the service refused of the robot being edited. */
  readonly errors: readonly FieldError[];
  /** The last request of each section. */
  readonly calls: Readonly<Partial<Record<Section, Call>>>;
  /** Replaced each time that all sections have their answers. */
  readonly answers: Readonly<Partial<Answers>>;
  /** The section whose request "Reproduce" shows. */
  readonly reproduced: Section;
  readonly solved: Solved | null;
  /** All solutions of the inverse kinematics, to choose from. */
  readonly solutions: readonly Ghost[];
  /** The path that was followed last. */
  readonly followed: ScenePath | null;
  readonly dark: boolean;
  /** How often the reader was asked for a key or gave one; what was refused is then asked anew. */
  readonly keys: number;
}

export interface State extends Linked, Session {}

/** A visit as it begins. */
export function newSession(dark: boolean): Session {
  return {
    model: null,
    errors: [],
    calls: {},
    answers: {},
    reproduced: 'pose',
    solved: null,
    solutions: [],
    followed: null,
    dark,
    keys: 0,
  };
}

const LINKED = Object.keys(START) as (keyof Linked)[];

/** The part of the state that the link holds. */
export function linkedOf(state: Linked): Linked {
  return Object.fromEntries(LINKED.map((name) => [name, state[name]])) as unknown as Linked;
}

/** Its values in a fixed order, to be compared. */
export function linkedValues(state: Linked): readonly unknown[] {
  return LINKED.map((name) => state[name]);
}

/** The tip's pose as the service last answered it. */
export function tipPose({ answers }: State): Pose | undefined {
  return Object.values(answers.pose?.poses ?? {})[0];
}
