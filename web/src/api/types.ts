/** What the service takes and answers. */

export type Convention = 'standard' | 'modified' | 'khalil';
export type AngleUnit = 'rad' | 'deg';
export type LengthUnit = 'm' | 'mm';
export type JointType = 'revolute' | 'prismatic' | 'continuous' | 'fixed';
export type Matrix = readonly (readonly number[])[];
export type ReferenceFrame = 'local_world_aligned' | 'world' | 'local';

export interface RobotLine {
  readonly id: string;
  readonly kind: 'dh' | 'urdf';
  readonly title: string;
  readonly dof: number;
  readonly shipped: boolean;
}

export interface JointView {
  readonly name: string;
  readonly type: Exclude<JointType, 'fixed'>;
  readonly lower: number | null;
  readonly upper: number | null;
}

export interface RobotView {
  readonly id: string;
  readonly kind: 'dh' | 'urdf';
  readonly title: string;
  readonly source: string | null;
  readonly shipped: boolean;
  readonly revision: string;
  readonly dof: number;
  readonly convention: Convention | null;
  readonly joints: readonly JointView[];
  readonly base_frame: string;
  readonly tip_frame: string;
  readonly frames: readonly string[];
  readonly warnings: readonly string[];
}

/** A mesh of a stored robot. */
export interface MeshLine {
  /** As the URDF names it. */
  readonly filename: string;
  /** Where the service has it. */
  readonly href: string;
}

/** A number, or a text such as `pi/2`, `90°`, `0,4`, `q2-pi/2`. */
export type Cell = number | string;

export interface TableRow {
  name?: string;
  type?: string;
  alpha?: Cell;
  a?: Cell;
  d?: Cell;
  theta?: Cell;
  r?: Cell;
  b?: Cell;
  gamma?: Cell;
  ant?: number;
  offset?: Cell;
  sign?: number;
  limits?: { lower?: Cell; upper?: Cell; velocity?: Cell; effort?: Cell };
  inertial?: unknown;
  visual?: boolean;
}

export interface Placement {
  xyz?: readonly Cell[];
  rpy?: readonly Cell[];
  quaternion_xyzw?: readonly number[];
  matrix?: Matrix;
}

/** A table as the API takes and gives it. */
export interface TableDocument {
  name?: string;
  title?: string;
  description?: string;
  source?: string;
  convention: Convention;
  units?: { angle?: AngleUnit; length?: LengthUnit };
  base?: Placement;
  tool?: Placement;
  values?: Record<string, Cell>;
  joints: TableRow[];
  residual?: unknown;
  warnings?: readonly string[];
  explanation?: unknown;
}

/** What the calculations work on: a robot of the service by id, or one in the body. */
export type RobotRef =
  | { readonly id: string }
  | { readonly table: TableDocument }
  | { readonly urdf: string; readonly base?: string; readonly tip?: string };

export interface Pose {
  readonly matrix: Matrix;
  readonly position: readonly number[];
  readonly quaternion_xyzw: readonly number[];
  readonly rpy: readonly number[];
  readonly euler?: {
    readonly sequence: string;
    readonly solutions: Matrix;
    readonly degenerate: boolean;
  };
}

export interface FKAnswer {
  readonly poses: Readonly<Record<string, Pose>>;
}

/** Poses at many configurations; each quantity has one more axis, the configurations, in front. */
export interface FKBatchAnswer {
  readonly poses: Readonly<Record<string, { readonly position: Matrix }>>;
}

export interface MatricesAnswer {
  readonly convention: Convention;
  readonly joints: readonly string[];
  readonly A: readonly Matrix[];
  readonly T0: readonly Matrix[];
  readonly base: Matrix;
  readonly tool: Matrix;
  readonly T: Matrix;
}

export interface JacobianAnswer {
  readonly jacobian: Matrix;
  readonly rows: readonly string[];
  readonly columns: readonly string[];
  readonly frame: string;
  readonly reference_frame: ReferenceFrame;
}

export interface EllipsoidView {
  readonly axes: Matrix;
  readonly velocity_semi_axes: readonly number[];
  readonly force_semi_axes: readonly (number | null)[];
}

export interface Factor {
  readonly name: string;
  readonly value: number;
  readonly normalised: number;
  readonly unit: string;
  readonly vanishes: boolean;
  readonly joints: readonly string[];
  readonly vanishes_where: string;
}

export interface SingularityAnswer {
  readonly task: string;
  readonly rows: readonly string[];
  readonly columns: readonly string[];
  readonly frame: string;
  readonly rank: number;
  readonly singular_values: readonly number[];
  readonly condition_number: number | null;
  readonly manipulability: number;
  readonly lost_directions: Matrix;
  readonly null_motions: Matrix;
  readonly singular: boolean;
  readonly tolerance: number;
  readonly explanation: readonly string[];
  readonly factorization: {
    readonly structure: string | null;
    readonly reason: string | null;
    readonly of: string | null;
    readonly constant: number | null;
    readonly product: number | null;
    readonly exact: boolean | null;
    readonly factors: readonly Factor[];
  };
  readonly ellipsoids: {
    readonly translation: EllipsoidView | null;
    readonly rotation: EllipsoidView | null;
  };
  readonly warnings: readonly string[];
}

export interface Target {
  readonly matrix?: Matrix;
  readonly position?: readonly number[];
  readonly rpy?: readonly number[];
  readonly quaternion_xyzw?: readonly number[];
  readonly euler?: { readonly sequence: string; readonly angles: readonly number[] };
  readonly phi?: number;
  readonly direction?: readonly number[];
}

export interface IKAnswer {
  readonly status: 'converged' | 'not_converged' | 'timeout' | 'unreachable';
  readonly q: readonly number[];
  readonly position_error: number;
  readonly orientation_error: number;
  readonly iterations: number;
  readonly restarts: number;
  readonly elapsed_ms: number;
}

export interface IKSolution {
  readonly q: readonly number[];
  readonly posture: readonly string[];
  readonly within_limits: boolean;
  readonly position_error: number;
  readonly orientation_error: number;
  readonly free: readonly string[];
  readonly swivel: number | null;
}

export interface IKSolutionsAnswer {
  readonly method: string;
  readonly complete: boolean;
  readonly description: string;
  readonly solutions: readonly IKSolution[];
}

export type Obstacle =
  | {
      readonly type: 'sphere' | 'circle';
      readonly center: readonly number[];
      readonly radius: number;
    }
  | {
      readonly type: 'capsule';
      readonly start: readonly number[];
      readonly end: readonly number[];
      readonly radius: number;
    }
  | { readonly type: 'half_space'; readonly normal: readonly number[]; readonly offset: number }
  | {
      readonly type: 'box';
      readonly center: readonly number[];
      readonly size: readonly number[];
      readonly rpy?: readonly number[];
    };

export interface PathFields {
  readonly q: readonly number[];
  readonly task: string;
  readonly target?: Target;
  readonly circle?: {
    readonly center: readonly number[];
    readonly plane: string;
    readonly turns: number;
  };
  readonly time_law: string;
  readonly tf: number;
  readonly samples: number;
  readonly obstacles: readonly Obstacle[];
  readonly link_radius: number;
  readonly d_safe: number;
}

export interface PathAnswer {
  readonly method: string;
  readonly success: boolean;
  readonly reason: string | null;
  readonly message: string;
  readonly samples: number;
  readonly samples_done: number;
  readonly summary: Readonly<Record<string, number | null>>;
  readonly t: readonly number[];
  readonly q: Matrix;
  readonly position_error: readonly number[];
  readonly clearance: readonly number[] | null;
}

/** What one method did on a path, in figures. */
export interface PathComparisonRow {
  readonly method: string;
  readonly success: boolean;
  readonly reason: string | null;
  readonly max_position_error: number;
  readonly min_clearance: number | null;
  readonly sum_dq: number;
  readonly ms_per_point: number;
}

export interface PathComparison {
  readonly rows: readonly PathComparisonRow[];
  readonly messages: Readonly<Record<string, string>>;
}
