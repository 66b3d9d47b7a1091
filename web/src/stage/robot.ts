/** A robot as the scene takes it. */
import { rowValues } from '../followers';
import type { Model } from '../model';
import type { SceneRobot, SceneRow } from '../scene/types';
import { ownColumn, typeOf } from '../table/convention';

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

/** The rows of the table with the joints' values in them, rad and m. */
export function sceneRows(model: Model, q: readonly number[]): SceneRow[] {
  const { rows } = model;
  if (model.kind !== 'dh' || !rows) return [];
  const isKhalil = rows.convention === 'khalil';
  const values = rowValues(rows.joints, q);
  return rows.joints.map((row, k) => {
    const own = ownColumn(row, rows.convention);
    const value = own === null ? 0 : (row.sign ?? 1) * (values[k] ?? 0) + Number(row.offset ?? 0);
    const cell = (name: 'a' | 'd' | 'r' | 'theta' | 'alpha' | 'b' | 'gamma'): number =>
      Number(row[name] ?? 0) + (own === name ? value : 0);
    return {
      name: row.name ?? '',
      type: typeOf(row),
      from: `frame_${row.ant ?? k}`,
      to: `frame_${k + 1}`,
      a: cell(isKhalil ? 'd' : 'a'),
      d: cell(isKhalil ? 'r' : 'd'),
      alpha: cell('alpha'),
      theta: cell('theta'),
      b: cell('b'),
      gamma: cell('gamma'),
    };
  });
}
