/** Configurations in the unit shown (degrees or rad, and m) and in that of the scene (rad and m). */
import type { AngleUnit } from './api';
import type { SceneJoint } from './scene/types';

const DEGREE = Math.PI / 180;

/** A configuration in the shown unit -> in rad and m. */
export function toRadians(
  joints: readonly SceneJoint[],
  q: readonly number[],
  angle: AngleUnit,
): number[] {
  const factor = angle === 'deg' ? DEGREE : 1;
  return joints.map((joint, k) => (q[k] ?? 0) * (joint.type === 'prismatic' ? 1 : factor));
}

/** A joint's value in rad or m -> in the shown unit, rounded to twelve digits where it changes. */
export function fromRadians(joint: SceneJoint, value: number, angle: AngleUnit): number {
  if (joint.type === 'prismatic' || angle === 'rad') return value;
  return Number(((value * 180) / Math.PI).toPrecision(12));
}

/** A configuration in the other unit of angles, rounded to twelve digits. */
export function converted(
  joints: readonly SceneJoint[],
  q: readonly number[],
  to: AngleUnit,
): number[] {
  const factor = to === 'deg' ? 180 / Math.PI : DEGREE;
  return q.map((x, k) =>
    joints[k]?.type === 'prismatic' ? x : Number((x * factor).toPrecision(12)),
  );
}

/** Zero, or what is nearest to it within the limits; in the shown unit. */
export function restingConfiguration(joints: readonly SceneJoint[], angle: AngleUnit): number[] {
  return joints.map((joint) => {
    const { lower, upper } = joint;
    const value = lower === null || upper === null ? 0 : Math.min(Math.max(0, lower), upper);
    return fromRadians(joint, value, angle);
  });
}
