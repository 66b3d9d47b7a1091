/** Computations that the first screen asks for, one function an endpoint. */
import { type Call, robotPath } from './call';
import type {
  AngleUnit,
  FKAnswer,
  JacobianAnswer,
  MatricesAnswer,
  ReferenceFrame,
  RobotRef,
  SingularityAnswer,
} from './types';

/** Computations whose fields a student types into a URL. */
const BY_GET = new Set([
  'fk',
  'dh-matrices',
  'jacobian',
  'singularity',
  'picture.svg',
  'workspace',
]);

type Q = readonly number[];
export type Fields = Readonly<Record<string, unknown>>;

/**
 * A computation on a robot: by GET where the robot has an id and the fields fit into a query, as a
 * student would type it; else by POST, with the robot in the body where it has no id.
 */
export function computation<Answer>(
  name: string,
  robot: RobotRef,
  fields: Fields,
  angle: AngleUnit = 'rad',
  accept?: string,
): Call<Answer> {
  const given = Object.entries(fields).filter(([, value]) => value !== undefined && value !== null);
  const query: Record<string, string> = {};
  const more = accept === undefined ? {} : { accept };
  if ('id' in robot && BY_GET.has(name) && given.every(([, value]) => isFlat(value))) {
    for (const [key, value] of given) query[key] = String(value);
    if (angle === 'deg') query.angle = angle;
    return { method: 'GET', path: robotPath(robot.id, name), query, ...more };
  }
  if (angle === 'deg') query.angle = angle;
  const body = Object.fromEntries(given);
  if ('id' in robot) {
    return { method: 'POST', path: robotPath(robot.id, name), query, body, ...more };
  }
  const inline = 'table' in robot ? robot.table : robot;
  return { method: 'POST', path: `v1/${name}`, query, body: { ...body, robot: inline }, ...more };
}

function isFlat(value: unknown): boolean {
  if (Array.isArray(value)) {
    return value.every((one) => typeof one === 'number' || typeof one === 'string');
  }
  return typeof value !== 'object';
}

/** The tip's pose at one configuration, with Euler angles in a sequence such as ZXZ. */
export const fk = (robot: RobotRef, q: Q, euler: string, angle: AngleUnit): Call<FKAnswer> =>
  computation('fk', robot, { q, euler }, angle);

export const dhMatrices = (robot: RobotRef, q: Q, angle: AngleUnit): Call<MatricesAnswer> =>
  computation('dh-matrices', robot, { q }, angle);

export const jacobian = (
  robot: RobotRef,
  q: Q,
  angle: AngleUnit,
  reference_frame: ReferenceFrame,
): Call<JacobianAnswer> => computation('jacobian', robot, { q, reference_frame }, angle);

export const singularity = (
  robot: RobotRef,
  q: Q,
  angle: AngleUnit,
  task: string,
): Call<SingularityAnswer> => computation('singularity', robot, { q, task }, angle);

/** Points that the tip reaches, as an npy file of shape (samples, 3). */
export const workspace = (robot: RobotRef, samples: number): Call =>
  computation('workspace', robot, { samples }, 'rad', 'application/x-npy');
