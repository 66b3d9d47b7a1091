/** What the service takes and answers: names for the types of its OpenAPI document. */

import type { components } from './schema';

type Schemas = components['schemas'];

/** A type of an answer, which nobody writes to. */
type Read<T> = T extends string | number | boolean | null | undefined
  ? T
  : { readonly [K in keyof T]: Read<T[K]> };

export type RobotView = Read<Schemas['RobotView']>;
export type RobotLine = Read<Schemas['RobotLine']>;
export type JointView = Read<Schemas['JointView']>;
export type MeshLine = Read<Schemas['MeshLine']>;
export type Pose = Read<Schemas['PoseView']>;
export type FKAnswer = Read<Schemas['FKAnswer']>;
/** Poses at many configurations; each quantity has one more axis, the configurations, in front. */
export type FKBatchAnswer = Read<Schemas['FKAnswerBatch']>;
export type MatricesAnswer = Read<Schemas['DHMatricesAnswer']>;
export type JacobianAnswer = Read<Schemas['JacobianAnswer']>;
export type EllipsoidView = Read<Schemas['EllipsoidView']>;
export type Factor = Read<Schemas['FactorView']>;
export type SingularityAnswer = Read<Schemas['SingularityAnswer']>;
export type IKAnswer = Read<Schemas['IKAnswer']>;
export type IKSolution = Read<Schemas['IKSolutionView']>;
export type IKSolutionsAnswer = Read<Schemas['IKSolutionsAnswer']>;
export type PathAnswer = Read<Schemas['PathAnswer']>;
/** What one method did on a path, in figures. */
export type PathComparisonRow = Read<Schemas['CompareRow']>;
export type PathComparison = Read<Schemas['CompareAnswer']>;
export type Target = Read<Schemas['Target']>;
export type PathFields = Read<Schemas['PathRequest']>;
export type Obstacle = NonNullable<PathFields['obstacles']>[number];

export type Convention = NonNullable<RobotView['convention']>;
export type AngleUnit = 'rad' | 'deg';
export type LengthUnit = 'm' | 'mm';
export type JointType = JointView['type'] | 'fixed';
export type Matrix = Pose['matrix'];
export type ReferenceFrame = NonNullable<Schemas['JacobianRequest']['reference_frame']>;

/** A number, or a text such as `pi/2`, `90°`, `0,4`, `q2-pi/2`. */
export type Cell = Schemas['DHCell'];
/** A row that is being written. */
export type TableRow = Partial<Schemas['DHTable']['joints'][number]>;
/** A table that is being written. */
export type TableDocument = Omit<Schemas['DHTable'], 'joints' | 'convention'> & {
  convention: Convention;
  joints: TableRow[];
};
export type Placement = NonNullable<TableDocument['tool']>;

/** What the calculations work on: a robot of the service by id, or one in the body. */
export type RobotRef =
  | { readonly id: string }
  | { readonly table: TableDocument }
  | Read<Schemas['InlineURDF']>;
