/**
 * Client of the public REST API, one function an endpoint.
 *
 * There is no kinematics in the page: every number on it comes from here. A call is first made as
 * a `Call`, a plain description of the HTTP request, which `send` carries out and which the panel
 * "Reproduce" writes as curl, Python or PowerShell: what is copied is what was sent.
 */

export type Convention = 'standard' | 'modified' | 'khalil';
export type AngleUnit = 'rad' | 'deg';
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
  units?: { angle?: AngleUnit; length?: 'm' | 'mm' };
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

/** One line of `errors` in a problem document. */
export interface FieldError {
  readonly pointer: string;
  readonly message: string;
}

/** The service refused: its problem document (RFC 9457). */
export class Refusal extends Error {
  constructor(
    readonly status: number,
    readonly detail: string,
    readonly errors: readonly FieldError[],
  ) {
    super(detail);
  }
}

/** There was no answer at all. */
export class Unreachable extends Error {}

/** Whether asking again later may help: no answer, or a service that is busy or starting. */
export function willPass(error: unknown): boolean {
  return (
    error instanceof Unreachable ||
    (error instanceof Refusal && [429, 502, 503, 504].includes(error.status))
  );
}

/** One HTTP request in plain words. */
export interface Call {
  readonly method: 'GET' | 'POST' | 'PUT' | 'DELETE';
  /** Below the service's root, without query: `v1/robots/puma560/fk`. */
  readonly path: string;
  readonly query: Readonly<Record<string, string>>;
  /** An object is sent as JSON. */
  readonly body?: unknown;
  /** Content-Type of a text body. */
  readonly type?: string;
  readonly accept?: string;
}

/** The service's root, from where the page itself lies: it may be behind a path prefix. */
export const ROOT = new URL('.', document.baseURI);

export function urlOf(call: Call): string {
  const query = Object.entries(call.query).map(([key, value]) => `${key}=${escaped(value)}`);
  return new URL(call.path, ROOT).href + (query.length ? `?${query.join('&')}` : '');
}

/** Commas, colons and slashes may stand in a query as they are, and read better so. */
function escaped(text: string): string {
  return encodeURIComponent(text).replaceAll(/%2C|%3A|%2F/gi, decodeURIComponent);
}

/**
 * Carries out a call.
 *
 * @throws Refusal for any status but 2xx; Unreachable without an answer; DOMException AbortError.
 */
export async function send(call: Call, signal?: AbortSignal): Promise<Response> {
  const headers: Record<string, string> = { Accept: call.accept ?? 'application/json' };
  const init: RequestInit = { method: call.method, headers };
  if (signal) init.signal = signal;
  if (call.body !== undefined) {
    headers['Content-Type'] = call.type ?? 'application/json';
    init.body = call.type ? (call.body as string) : JSON.stringify(call.body);
  }
  let response: Response;
  try {
    response = await fetch(urlOf(call), init);
  } catch (error) {
    if (error instanceof DOMException) throw error;
    throw new Unreachable(String(error));
  }
  if (!response.ok) throw await refusal(response);
  return response;
}

async function refusal(response: Response): Promise<Refusal> {
  try {
    const problem = (await response.json()) as { detail?: string; errors?: FieldError[] };
    return new Refusal(
      response.status,
      problem.detail ?? response.statusText,
      problem.errors ?? [],
    );
  } catch {
    return new Refusal(response.status, response.statusText, []);
  }
}

export async function json<T>(call: Call, signal?: AbortSignal): Promise<T> {
  return (await (await send(call, signal)).json()) as T;
}

export async function text(call: Call, signal?: AbortSignal): Promise<string> {
  return (await send(call, signal)).text();
}

/** Computations whose fields a student types into a URL. */
const BY_GET = new Set([
  'fk',
  'dh-matrices',
  'jacobian',
  'singularity',
  'picture.svg',
  'workspace',
]);

type Fields = Readonly<Record<string, unknown>>;

/**
 * A computation on a robot: by GET where the robot has an id and the fields fit into a query, as a
 * student would type it; else by POST, with the robot in the body where it has no id.
 */
export function computation(
  name: string,
  robot: RobotRef,
  fields: Fields,
  angle: AngleUnit = 'rad',
  accept?: string,
): Call {
  const given = Object.entries(fields).filter(([, value]) => value !== undefined && value !== null);
  const query: Record<string, string> = {};
  const more = accept === undefined ? {} : { accept };
  if ('id' in robot && BY_GET.has(name) && given.every(([, value]) => isFlat(value))) {
    for (const [key, value] of given) query[key] = String(value);
    if (angle === 'deg') query.angle = angle;
    return {
      method: 'GET',
      path: `v1/robots/${encodeURIComponent(robot.id)}/${name}`,
      query,
      ...more,
    };
  }
  if (angle === 'deg') query.angle = angle;
  const body = Object.fromEntries(given);
  if ('id' in robot) {
    const path = `v1/robots/${encodeURIComponent(robot.id)}/${name}`;
    return { method: 'POST', path, query, body, ...more };
  }
  const inline = 'table' in robot ? robot.table : robot;
  return { method: 'POST', path: `v1/${name}`, query, body: { ...body, robot: inline }, ...more };
}

function isFlat(value: unknown): boolean {
  if (Array.isArray(value))
    return value.every((one) => typeof one === 'number' || typeof one === 'string');
  return typeof value !== 'object';
}

type Q = readonly number[];

export const fk = (robot: RobotRef, q: Q, euler: string, angle: AngleUnit, frames?: string): Call =>
  computation('fk', robot, { q, frames, euler }, angle);

export const dhMatrices = (robot: RobotRef, q: Q, angle: AngleUnit): Call =>
  computation('dh-matrices', robot, { q }, angle);

export const jacobian = (
  robot: RobotRef,
  q: Q,
  angle: AngleUnit,
  reference_frame: ReferenceFrame,
  frame?: string,
): Call => computation('jacobian', robot, { q, frame, reference_frame }, angle);

export const singularity = (
  robot: RobotRef,
  q: Q,
  angle: AngleUnit,
  task: string,
  frame?: string,
): Call => computation('singularity', robot, { q, task, frame }, angle);

export const ik = (robot: RobotRef, fields: Fields, angle: AngleUnit): Call =>
  computation('ik', robot, fields, angle);

export const ikSolutions = (robot: RobotRef, fields: Fields, angle: AngleUnit): Call =>
  computation('ik/solutions', robot, fields, angle);

export const path = (robot: RobotRef, fields: PathFields, method: string, angle: AngleUnit): Call =>
  computation('path', robot, { ...fields, method }, angle);

export const comparePaths = (
  robot: RobotRef,
  fields: PathFields,
  methods: readonly string[],
  angle: AngleUnit,
): Call => computation('path/compare', robot, { ...fields, methods }, angle);

/** Points that the tip reaches, as an npy file of shape (samples, 3). */
export const workspace = (robot: RobotRef, samples: number): Call =>
  computation('workspace', robot, { samples }, 'rad', 'application/x-npy');

/** The arm as a picture, for browsers without WebGL. */
export const picture = (
  robot: RobotRef,
  q: Q,
  angle: AngleUnit,
  width: number,
  height: number,
): Call => computation('picture.svg', robot, { q, width, height }, angle, 'image/svg+xml');

export const listRobots = (): Call => ({
  method: 'GET',
  path: 'v1/robots',
  query: { page_size: '1000' },
});

export const readRobot = (id: string): Call => ({
  method: 'GET',
  path: `v1/robots/${encodeURIComponent(id)}`,
  query: {},
});

export const listMeshes = (id: string): Call => ({
  method: 'GET',
  path: `v1/robots/${encodeURIComponent(id)}/meshes`,
  query: {},
});

export const readURDF = (id: string): Call => ({
  method: 'GET',
  path: `v1/robots/${encodeURIComponent(id)}/urdf`,
  query: {},
  accept: 'application/xml',
});

export const readTable = (
  id: string,
  convention: Convention,
  angle: AngleUnit,
  format = 'json',
): Call => ({
  method: 'GET',
  path: `v1/robots/${encodeURIComponent(id)}/dh`,
  query: {
    convention,
    ...(angle === 'deg' ? { angle } : {}),
    ...(format === 'json' ? {} : { format }),
  },
  ...(format === 'json' ? {} : { accept: '*/*' }),
});

/** A table in numbers, checked; with other `to` in another convention. */
export const convertTable = (
  table: TableDocument,
  to: Convention,
  angle: AngleUnit,
  format = 'json',
): Call => ({
  method: 'POST',
  path: 'v1/convert-dh',
  query: {
    to,
    ...(angle === 'deg' ? { angle } : {}),
    ...(format === 'json' ? {} : { format }),
  },
  body: table,
  ...(format === 'json' ? {} : { accept: '*/*' }),
});

export const tableToURDF = (table: TableDocument): Call => ({
  method: 'POST',
  path: 'v1/dh-to-urdf',
  query: {},
  body: table,
  accept: 'application/xml',
});

/** A table pasted as Markdown, LaTeX, MATLAB, Python or columns. */
export const readPasted = (
  pasted: string,
  convention: Convention,
  angle: AngleUnit | '',
  length: 'm' | 'mm',
  values: string,
  columns: string,
): Call => ({
  method: 'POST',
  path: 'v1/convert-dh',
  query: {
    to: convention,
    convention,
    name: 'table',
    ...(angle ? { angle } : {}),
    ...(length === 'mm' ? { length } : {}),
    ...(values ? { values } : {}),
    ...(columns ? { columns } : {}),
  },
  body: pasted,
  type: 'text/plain',
});

export const urdfToTable = (urdf: string, convention: Convention, angle: AngleUnit): Call => ({
  method: 'POST',
  path: 'v1/urdf-to-dh',
  query: { convention, ...(angle === 'deg' ? { angle } : {}) },
  body: urdf,
  type: 'application/xml',
});

/** Stores a robot on the service; refused where the name is taken. */
export const createRobot = (name: string, document: TableDocument | string): Call => ({
  method: 'POST',
  path: 'v1/robots',
  query: typeof document === 'string' ? { name } : {},
  body: document,
  ...(typeof document === 'string' ? { type: 'application/xml' } : {}),
});
