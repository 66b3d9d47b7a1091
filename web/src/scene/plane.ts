/** Whether an arm moves in a plane. */
import type { Vector3 } from 'three';
import type { RobotModel } from './robot';

/** The normal of the plane that the arm moves in, base axes; null where it leaves every plane. */
export function planeNormal(model: RobotModel): Vector3 | null {
  let normal: Vector3 | null = null;
  for (const { name, type } of model.robot.joints) {
    const joint = model.urdf.joints[name];
    if (!joint) return null;
    const axis = joint.axis.clone().transformDirection(joint.matrixWorld);
    if (type === 'prismatic') {
      if (normal && Math.abs(axis.dot(normal)) > 1e-6) return null;
    } else if (!normal) {
      normal = axis;
    } else if (Math.abs(Math.abs(axis.dot(normal)) - 1) > 1e-9) {
      return null;
    }
  }
  return normal && normal.z < -0.5 ? normal.negate() : normal;
}
