/** A row of a D-H table: dimension lines for a and d, and its elementary motions. */
import { type Group, Matrix4, Vector3 } from 'three';
import type { Convention } from '../api';
import {
  axes,
  COLORS,
  label,
  onGround,
  polyline,
  rod,
  type Scale,
  sector,
  subscript,
} from './parts';
import { clear, pose } from './space';
import type { SceneRow } from './types';

type Kind = 'Rz' | 'Tz' | 'Tx' | 'Rx';

export interface Motion {
  readonly kind: Kind;
  readonly value: number;
}

/** The four motions of A_k in their order; in Khalil's trees two more precede them. */
function motionsOf(convention: Convention, row: SceneRow): Motion[] {
  const about: Motion[] = [
    { kind: 'Rz', value: row.theta },
    { kind: 'Tz', value: row.d },
  ];
  const across: Motion[] = [
    { kind: 'Tx', value: row.a },
    { kind: 'Rx', value: row.alpha },
  ];
  if (convention === 'standard') return [...about, ...across];
  const tree: Motion[] =
    row.b || row.gamma
      ? [
          { kind: 'Rz', value: row.gamma },
          { kind: 'Tz', value: row.b },
        ]
      : [];
  return [...tree, ...across, ...about];
}

export function matrixOf({ kind, value }: Motion): Matrix4 {
  if (kind === 'Rz') return new Matrix4().makeRotationZ(value);
  if (kind === 'Rx') return new Matrix4().makeRotationX(value);
  return kind === 'Tz'
    ? new Matrix4().makeTranslation(0, 0, value)
    : new Matrix4().makeTranslation(value, 0, 0);
}

/** Draw a and d of each row, from the pose of the frame that it starts from. */
export function drawDimensions(
  group: Group,
  convention: Convention,
  rows: readonly SceneRow[],
  start: (frame: string) => Matrix4 | null,
  scale: Scale,
  dark: boolean,
): void {
  clear(group);
  rows.forEach((row, k) => {
    let at = start(row.from);
    if (!at) return;
    for (const motion of motionsOf(convention, row)) {
      const next = at.clone().multiply(matrixOf(motion));
      if (motion.kind === 'Tx' || motion.kind === 'Tz') {
        const name = nameOf(convention, motion.kind, k);
        dimension(group, at, next, name, motion, scale, dark);
      }
      at = next;
    }
  });
}

/** The name of a dimension: row k has a_{k-1} in the modified convention, d and r in Khalil's. */
function nameOf(convention: Convention, kind: Kind, k: number): string {
  if (convention === 'khalil') return `${kind === 'Tx' ? 'd' : 'r'}${subscript(k + 1)}`;
  if (kind === 'Tz') return `d${subscript(k + 1)}`;
  return `a${subscript(convention === 'modified' ? k : k + 1)}`;
}

function dimension(
  group: Group,
  from: Matrix4,
  to: Matrix4,
  name: string,
  motion: Motion,
  scale: Scale,
  dark: boolean,
): void {
  if (Math.abs(motion.value) < 1e-6) return;
  const color = motion.kind === 'Tx' ? COLORS.a : COLORS.d;
  const ink = onGround(color, dark);
  // The line is drawn beside the link, moved along y of the frame that the row starts from.
  const aside = new Vector3().setFromMatrixColumn(from, 1).multiplyScalar(0.45 * scale.axis);
  const [p, q] = [from, to].map((one) => new Vector3().setFromMatrixPosition(one)) as [
    Vector3,
    Vector3,
  ];
  const [a, b] = [p.clone().add(aside), q.clone().add(aside)];
  const head = Math.min(0.2 * scale.axis, 0.3 * a.distanceTo(b));
  const middle = a.clone().lerp(b, 0.5);
  group.add(
    polyline([p, a.clone().addScaledVector(aside, 0.2)], ink),
    polyline([q, b.clone().addScaledVector(aside, 0.2)], ink),
  );
  group.add(
    rod(middle, b, 0.014 * scale.axis, ink, head),
    rod(middle, a, 0.014 * scale.axis, ink, head),
  );
  const text = `${name} = ${Number(motion.value.toPrecision(4))} m`;
  group.add(label(text, middle.clone().addScaledVector(aside, 0.5), color, dark));
}

/** Draw the first `step` motions of a row, and the frame that has done them. */
export function drawMotion(
  group: Group,
  convention: Convention,
  row: SceneRow,
  step: number,
  start: Matrix4,
  scale: Scale,
  dark: boolean,
): void {
  clear(group);
  let at = start.clone();
  const motions = motionsOf(convention, row).slice(-4);
  motions.slice(0, step).forEach((motion, k) => {
    const next = at.clone().multiply(matrixOf(motion));
    const last = k === step - 1;
    const color = motion.kind.endsWith('x') ? COLORS.a : COLORS.d;
    const [p, q] = [at, next].map((one) => new Vector3().setFromMatrixPosition(one)) as [
      Vector3,
      Vector3,
    ];
    if (motion.kind.startsWith('T')) {
      if (p.distanceTo(q) > 1e-9)
        group.add(
          rod(p, q, (last ? 0.03 : 0.018) * scale.axis, color, last ? 0.25 * scale.axis : 0),
        );
    } else if (Math.abs(motion.value) > 1e-9) {
      const fan = sector(0.8 * scale.axis, 0, motion.value, color);
      // About x the sector lies in y-z, beginning at y.
      const turned = new Matrix4();
      if (motion.kind === 'Rx')
        turned.makeBasis(new Vector3(0, 1, 0), new Vector3(0, 0, 1), new Vector3(1, 0, 0));
      pose(fan, at.clone().multiply(turned));
      group.add(fan);
    }
    if (last) {
      const angle = motion.kind.startsWith('R');
      const value = angle
        ? `${Number(((motion.value * 180) / Math.PI).toPrecision(5))}°`
        : `${Number(motion.value.toPrecision(4))} m`;
      const up = new Vector3().setFromMatrixColumn(next, 2).multiplyScalar(-0.75 * scale.axis);
      group.add(label(`${motion.kind}(${value})`, q.clone().add(up), color, dark));
    }
    at = next;
  });
  const moving = axes(1.25 * scale.axis);
  moving.name = 'moving';
  pose(moving, at);
  group.add(moving);
}
