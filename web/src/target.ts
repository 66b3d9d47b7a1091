/** A target as a matrix, for the picture of it; what is sent to the service is what was typed. */
import type { Matrix, Target } from './api';

/** Roll-pitch-yaw in rad: R = Rz(yaw) Ry(pitch) Rx(roll). */
export function matrixOf(target: Target, angle: 'rad' | 'deg' = 'rad'): Matrix | null {
  if (target.matrix) return target.matrix;
  const { position, rpy = [0, 0, 0] } = target;
  if (!position) return null;
  const factor = angle === 'deg' ? Math.PI / 180 : 1;
  const [r = 0, p = 0, y = 0] = rpy.map((one) => one * factor);
  const [sr, cr, sp, cp, sy, cy] = [
    Math.sin(r),
    Math.cos(r),
    Math.sin(p),
    Math.cos(p),
    Math.sin(y),
    Math.cos(y),
  ];
  const [px = 0, py = 0, pz = 0] = position;
  return [
    [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, px],
    [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, py],
    [-sp, cp * sr, cp * cr, pz],
    [0, 0, 0, 1],
  ];
}
