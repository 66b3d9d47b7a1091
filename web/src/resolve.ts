/** Asks the service for the joints, the table and the URDF of a robot. */
import * as api from './api';
import { type Follower, followersOfRows, narrowed } from './followers';
import type { Model, Source } from './model';
import type { SceneJoint } from './scene/types';
import { typeOf } from './table/convention';
import { editable, sendable } from './table/exchange';

/**
 * Resolve a source.
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
    api.json(api.readRobot(id), signal),
    api.text(api.readURDF(id), signal),
  ]);
  const convention = wanted ?? view.convention ?? 'standard';
  const call = api.readTable(id, convention, angle);
  const table = await (view.kind === 'urdf' ? tableIfAny(call, signal) : api.json(call, signal));
  return {
    key: view.revision,
    ref: { id },
    title: view.title || id,
    kind: view.kind,
    joints: view.joints,
    followers: view.followers.map((one) => ({ ...one, lower: null, upper: null })),
    urdf,
    table: table && editable(table),
    rows: table && inRadians(table),
    baseFrame: view.base_frame,
    tipFrame: view.tip_frame,
    warnings: view.warnings,
  };
}

/** A table; null for a robot that has none, such as a tree with a floating base. */
async function tableIfAny(
  call: api.Call<api.TableDocument>,
  signal: AbortSignal,
): Promise<api.TableDocument | null> {
  try {
    return await api.json(call, signal);
  } catch (error) {
    if (error instanceof api.Refusal) return null;
    throw error;
  }
}

async function fromTable(document: api.TableDocument, signal: AbortSignal): Promise<Model> {
  const table = sendable({ name: 'table', ...document });
  const [rows, urdf] = await Promise.all([
    api.json(api.convertTable(table, table.convention, 'rad'), signal),
    api.text(api.tableToURDF(table), signal),
  ]);
  const followers = followersOfRows(rows.joints);
  const free = rows.joints.filter((row) => typeOf(row) !== 'fixed' && !row.mimic).map(jointOf);
  return {
    key: urdf,
    ref: { table },
    title: document.title ?? document.name ?? '',
    kind: 'dh',
    joints: narrowed(free, followers),
    followers,
    urdf,
    table: document,
    rows,
    baseFrame: 'base_link',
    tipFrame: 'tool',
    warnings: [],
  };
}

async function fromURDF(
  name: string,
  urdf: string,
  angle: api.AngleUnit,
  signal: AbortSignal,
): Promise<Model> {
  const ref = { urdf };
  // The service checks the file first: the browser's parser would log an error for invalid XML.
  await api.send(api.workspace(ref, 1), signal);
  const { joints, followers } = jointsOfURDF(urdf);
  const zero = joints.map(() => 0);
  const answer = await api.json(api.computation<api.FKAnswer>('fk', ref, { q: zero }), signal);
  const table = await tableIfAny(api.urdfToTable(urdf, 'standard', angle), signal);
  return {
    key: urdf,
    ref,
    title: name,
    kind: 'urdf',
    joints,
    followers,
    urdf,
    table: table && editable(table),
    rows: table && inRadians(table),
    baseFrame: '',
    tipFrame: Object.keys(answer.poses)[0] ?? '',
    warnings: answer.warnings,
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

/** Joints in the order of the file, which is that of q; the service has checked the file. */
function jointsOfURDF(urdf: string): { joints: SceneJoint[]; followers: Follower[] } {
  const parsed = new DOMParser().parseFromString(urdf, 'application/xml');
  const joints: SceneJoint[] = [];
  const followers: Follower[] = [];
  for (const joint of parsed.querySelectorAll('robot > joint')) {
    const type = joint.getAttribute('type');
    if (type !== 'revolute' && type !== 'prismatic' && type !== 'continuous') continue;
    const limit = joint.querySelector('limit');
    const bound = (name: string): number | null =>
      type === 'continuous' || !limit ? null : Number(limit.getAttribute(name) ?? 0);
    const name = joint.getAttribute('name') ?? '';
    const found = { name, type, lower: bound('lower'), upper: bound('upper') } as const;
    const mimic = joint.querySelector('mimic');
    if (mimic) {
      followers.push({
        ...found,
        joint: mimic.getAttribute('joint') ?? '',
        multiplier: Number(mimic.getAttribute('multiplier') ?? 1),
        offset: Number(mimic.getAttribute('offset') ?? 0),
      });
    } else joints.push(found);
  }
  return { joints: narrowed(joints, followers), followers };
}

/** A table of the service with angles in rad, for the scene; the service computes with its own. */
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
