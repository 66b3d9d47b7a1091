/** Computations that are asked for later: inverse kinematics, paths, pictures. */
import type { Call } from './call';
import { computation, type Fields } from './computations';
import type {
  AngleUnit,
  FKBatchAnswer,
  IKAnswer,
  IKSolutionsAnswer,
  Matrix,
  PathAnswer,
  PathComparison,
  PathFields,
  RobotRef,
} from './types';

/** The tip's pose at each of many configurations. */
export const fkBatch = (robot: RobotRef, q: Matrix, angle: AngleUnit): Call<FKBatchAnswer> =>
  computation('fk', robot, { q }, angle);

export const ik = (robot: RobotRef, fields: Fields, angle: AngleUnit): Call<IKAnswer> =>
  computation('ik', robot, fields, angle);

export const ikSolutions = (
  robot: RobotRef,
  fields: Fields,
  angle: AngleUnit,
): Call<IKSolutionsAnswer> => computation('ik/solutions', robot, fields, angle);

export const path = (
  robot: RobotRef,
  fields: PathFields,
  method: string,
  angle: AngleUnit,
): Call<PathAnswer> => computation('path', robot, { ...fields, method }, angle);

export const comparePaths = (
  robot: RobotRef,
  fields: PathFields,
  methods: readonly string[],
  angle: AngleUnit,
): Call<PathComparison> => computation('path/compare', robot, { ...fields, methods }, angle);

/** The arm as a picture, for browsers without WebGL. */
export const picture = (
  robot: RobotRef,
  q: readonly number[],
  angle: AngleUnit,
  width: number,
  height: number,
): Call => computation('picture.svg', robot, { q, width, height }, angle, 'image/svg+xml');
