/** The robot of the state, resolved by the service: joints, table, URDF. */
import * as api from './api';
import type { SceneJoint, SceneRobot, SceneRow } from './scene/types';
import type { Source } from './state';
import { editable, ownColumn, sendable, typeOf } from './table/document';

export interface Model {
  readonly key: string;
  /** How computations name it. */
  readonly ref: api.RobotRef;
  readonly title: string;
  readonly note: string | null;
  readonly kind: 'dh' | 'urdf';
  /** Limits are rad and m. */
  readonly joints: readonly SceneJoint[];
  readonly urdf: string;
  /** The table as it is shown and edited. */
  readonly table: api.TableDocument | null;
  /** The same in numbers, rad and m, with offsets apart. */
  readonly rows: api.TableDocument | null;
  readonly baseFrame: string;
  readonly tipFrame: string;
  readonly warnings: readonly string[];
}

/**
 * Resolves a source.
 *
 * @throws Refusal with pointers into the table where it cannot be used.
 */
export async function resolve(
  source: Source,
  angle: api.AngleUnit,
  signal: AbortSignal,
): Promise<Model> {
  if (source.kind === 'stored') return stored(source.id, source.convention, angle, signal);
  if (source.kind === 'urdf') return fromURDF(source.name, source.urdf, angle, signal);
  return fromTable(source.table, signal);
}

async function stored(
  id: string,
  wanted: api.Convention | null,
  angle: api.AngleUnit,
  signal: AbortSignal,
): Promise<Model> {
  const [view, urdf] = await Promise.all([
    api.json<api.RobotView>(api.readRobot(id), signal),
    api.text(api.readURDF(id), signal),
  ]);
  const convention = wanted ?? view.convention ?? 'standard';
  const table = await tableOf(api.readTable(id, convention, angle), view.kind === 'urdf', signal);
  return {
    key: view.revision,
    ref: { id },
    title: view.title || id,
    note: view.source,
    kind: view.kind,
    joints: view.joints,
    urdf,
    table: table && editable(table),
    rows: table && inRadians(table),
    baseFrame: view.base_frame,
    tipFrame: view.tip_frame,
    warnings: view.warnings,
  };
}

/** A table; null for a robot of which none can be made, such as a tree with a floating base. */
async function tableOf(
  call: api.Call,
  may: boolean,
  signal: AbortSignal,
): Promise<api.TableDocument | null> {
  try {
    return await api.json<api.TableDocument>(call, signal);
  } catch (error) {
    if (may && error instanceof api.Refusal) return null;
    throw error;
  }
}

async function fromTable(document: api.TableDocument, signal: AbortSignal): Promise<Model> {
  const table = sendable({ name: 'table', ...document });
  const [rows, urdf] = await Promise.all([
    api.json<api.TableDocument>(api.convertTable(table, table.convention, 'rad'), signal),
    api.text(api.tableToURDF(table), signal),
  ]);
  return {
    key: urdf,
    ref: { table },
    title: document.title ?? document.name ?? '',
    note: null,
    kind: 'dh',
    joints: rows.joints.filter((row) => typeOf(row) !== 'fixed').map(jointOf),
    urdf,
    table: document,
    rows,
    baseFrame: 'base_link',
    tipFrame: 'tool',
    warnings: rows.warnings ?? [],
  };
}

async function fromURDF(
  name: string,
  urdf: string,
  angle: api.AngleUnit,
  signal: AbortSignal,
): Promise<Model> {
  const ref = { urdf };
  // The service reads it first: what is no XML would make the browser's parser complain.
  await api.send(api.workspace(ref, 1), signal);
  const joints = jointsOfURDF(urdf);
  const answer = await api.json<api.FKAnswer>(
    api.computation('fk', ref, { q: joints.map(() => 0) }),
    signal,
  );
  const table = await tableOf(api.urdfToTable(urdf, 'standard', angle), true, signal);
  return {
    key: urdf,
    ref,
    title: name,
    note: null,
    kind: 'urdf',
    joints,
    urdf,
    table: table && editable(table),
    rows: table && inRadians(table),
    baseFrame: '',
    tipFrame: Object.keys(answer.poses)[0] ?? '',
    warnings: [],
  };
}

function jointOf(row: api.TableRow): SceneJoint {
  const type = typeOf(row);
  const bound = (value: api.Cell | undefined): number | null =>
    value === undefined ? null : Number(value);
  return {
    name: row.name ?? '',
    type: type === 'fixed' ? 'revolute' : type,
    lower: bound(row.limits?.lower),
    upper: bound(row.limits?.upper),
  };
}

/** Joints in the order of the file, which is that of q; the service has checked the rest. */
function jointsOfURDF(urdf: string): SceneJoint[] {
  const parsed = new DOMParser().parseFromString(urdf, 'application/xml');
  return [...parsed.querySelectorAll('robot > joint')].flatMap((joint): SceneJoint[] => {
    const type = joint.getAttribute('type');
    if (type !== 'revolute' && type !== 'prismatic' && type !== 'continuous') return [];
    const limit = joint.querySelector('limit');
    const bound = (name: string): number | null =>
      type === 'continuous' || !limit ? null : Number(limit.getAttribute(name) ?? 0);
    return [
      {
        name: joint.getAttribute('name') ?? '',
        type,
        lower: bound('lower'),
        upper: bound('upper'),
      },
    ];
  });
}

/** An answer's table with angles in rad; for pictures, the API computes with the one it has. */
function inRadians(table: api.TableDocument): api.TableDocument {
  if (table.units?.angle !== 'deg') return table;
  const rad = (value: api.Cell | undefined): number => (Number(value ?? 0) * Math.PI) / 180;
  return {
    ...table,
    units: { ...table.units, angle: 'rad' },
    joints: table.joints.map((row) => ({
      ...row,
      alpha: rad(row.alpha),
      theta: rad(row.theta),
      ...(row.gamma === undefined ? {} : { gamma: rad(row.gamma) }),
      ...(typeOf(row) === 'prismatic' ? {} : { offset: rad(row.offset) }),
    })),
  };
}

/** What an arm can be asked for: with fewer than six joints it cannot have every pose. */
export function taskOf({ joints, rows }: Model): string {
  if (joints.length >= 6) return 'pose';
  const flat = rows?.joints.every(
    (row) => Number(row.alpha ?? 0) === 0 && typeOf(row) !== 'prismatic',
  );
  return flat && joints.length > 1 ? 'xy' : 'position';
}

export function sceneRobot(model: Model): SceneRobot {
  return {
    key: model.key,
    urdf: model.urdf,
    joints: model.joints,
    baseFrame: model.baseFrame,
    tipFrame: model.tipFrame,
    convention: model.kind === 'dh' ? (model.rows?.convention ?? null) : null,
    id: 'id' in model.ref ? model.ref.id : null,
  };
}

/** The rows with the present values of the joints, rad and m, for the scene's dimension lines. */
export function sceneRows(model: Model, q: readonly number[]): SceneRow[] {
  const { rows } = model;
  if (model.kind !== 'dh' || !rows) return [];
  let joint = 0;
  return rows.joints.map((row, k) => {
    const own = ownColumn(row, rows.convention);
    const value = own === null ? 0 : (row.sign ?? 1) * (q[joint++] ?? 0) + Number(row.offset ?? 0);
    const khalil = rows.convention === 'khalil';
    const cell = (name: 'a' | 'd' | 'r' | 'theta' | 'alpha' | 'b' | 'gamma'): number =>
      Number(row[name] ?? 0) + (own === name ? value : 0);
    return {
      name: row.name ?? '',
      type: typeOf(row),
      from: `frame_${row.ant ?? k}`,
      to: `frame_${k + 1}`,
      a: khalil ? cell('d') : cell('a'),
      d: khalil ? cell('r') : cell('d'),
      alpha: cell('alpha'),
      theta: cell('theta'),
      b: cell('b'),
      gamma: cell('gamma'),
    };
  });
}

/** Values in the shown unit -> rad and m, for the scene. */
export function toScene(
  joints: readonly SceneJoint[],
  q: readonly number[],
  angle: api.AngleUnit,
): number[] {
  const factor = angle === 'deg' ? Math.PI / 180 : 1;
  return joints.map((joint, k) => (q[k] ?? 0) * (joint.type === 'prismatic' ? 1 : factor));
}

/** rad and m -> the shown unit; what rounding adds behind the twelfth digit is dropped. */
export function shown(joint: SceneJoint, value: number, angle: api.AngleUnit): number {
  if (joint.type === 'prismatic' || angle === 'rad') return value;
  return Number(((value * 180) / Math.PI).toPrecision(12));
}

/** A posture to begin with: zero, or the nearest within the limits; in the shown unit. */
export function atRest(joints: readonly SceneJoint[], angle: api.AngleUnit): number[] {
  return joints.map((joint) => {
    const value = Math.min(Math.max(0, joint.lower ?? 0), joint.upper ?? 0);
    return shown(joint, joint.lower !== null && joint.upper !== null ? value : 0, angle);
  });
}
