/** Parts of a target for the view and for forms; the service gets the target as it was typed. */
import type { AngleUnit, Matrix, Target } from './api';

/** The position of a target, m; null where it has none. */
export function positionOf(target: Target | null): readonly number[] | null {
  return target?.position ?? target?.matrix?.slice(0, 3).map((row) => row[3] ?? 0) ?? null;
}

/** The pose of a target; its roll, pitch and yaw are fixed-axis: R = Rz(yaw) Ry(pitch) Rx(roll). */
export function matrixOf(target: Target, angle: AngleUnit): Matrix | null {
  if (target.matrix) return target.matrix;
  const { position } = target;
  const rpy = target.rpy ?? [0, 0, 0];
  if (!position) return null;
  const factor = angle === 'deg' ? Math.PI / 180 : 1;
  const [r = 0, p = 0, y = 0] = rpy.map((one) => one * factor);
  const [sr, cr, sp, cp] = [Math.sin(r), Math.cos(r), Math.sin(p), Math.cos(p)];
  const [sy, cy] = [Math.sin(y), Math.cos(y)];
  const [px = 0, py = 0, pz = 0] = position;
  return [
    [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, px],
    [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, py],
    [-sp, cp * sr, cp * cr, pz],
    [0, 0, 0, 1],
  ];
}
