/** A robot without meshes: a rod from joint to joint, a drum for each joint that moves. */
import { type Object3D, Vector3 } from 'three';
import type { URDFRobot } from 'urdf-loader';
import { rod } from './parts';
import { release } from './space';

/** @param size Diagonal of the box around the robot, m. */
export function drawBones(urdf: URDFRobot, size: number): void {
  for (const joint of Object.values(urdf.joints)) {
    const { parent } = joint;
    if (!parent) continue;
    parent.add(marked(rod(new Vector3(), joint.position, 0.008 * size, 0x7a8794)));
    if (joint.jointType === 'fixed') continue;
    const axis = joint.axis.clone().multiplyScalar(0.03 * size);
    joint.add(marked(rod(axis.clone().negate(), axis, 0.014 * size, 0x2f3b47)));
  }
}

export function removeBones(urdf: URDFRobot): void {
  const found: Object3D[] = [];
  urdf.traverse((one) => {
    if (one.userData.bone) found.push(one);
  });
  for (const one of found) {
    one.removeFromParent();
    release(one);
  }
}

function marked(bone: Object3D): Object3D {
  bone.userData.bone = true;
  return bone;
}
