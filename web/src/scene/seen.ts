/** What is to be in view. */
import { type Group, Points, Vector3 } from 'three';
import type { Scale } from './parts';
import type { RobotModel } from './robot';
import { cornersOf } from './space';

/** Points of a cloud that are looked at: enough to see how far it reaches. */
const SAMPLE = 2000;
/** How far a frame's axes reach with their labels, forwards and backwards, in axis lengths. */
const AXIS = [1.2, -0.4];

interface Layers {
  readonly ghosts: Group;
  readonly other: Group;
  readonly ellipsoids: Group;
  readonly lost: Group;
  readonly path: Group;
  readonly target: Group;
  readonly cloud: Group;
}

/** Points around the robot with its frames, and around what is shown with it. */
export function pointsToSee(model: RobotModel, layers: Layers, { axis }: Scale): Vector3[] {
  const { ghosts, other, ellipsoids, lost, path, target } = layers;
  const shown = [model.object, ghosts, other, ellipsoids, lost, path, target];
  const points = [new Vector3(), ...shown.flatMap(cornersOf)];
  layers.cloud.traverse((one) => {
    if (one instanceof Points) points.push(...sampleOf(one));
  });
  for (const name of model.frames) {
    const at = model.poseOf(name);
    if (!at) continue;
    const origin = new Vector3().setFromMatrixPosition(at);
    for (const k of [0, 1, 2]) {
      const direction = new Vector3().setFromMatrixColumn(at, k);
      for (const reach of AXIS) {
        points.push(origin.clone().addScaledVector(direction, reach * axis));
      }
    }
  }
  return points;
}

function sampleOf(cloud: Points): Vector3[] {
  const places = cloud.geometry.getAttribute('position');
  const step = Math.max(1, Math.floor(places.count / SAMPLE));
  const count = Math.floor(places.count / step);
  return Array.from({ length: count }, (_, k) =>
    new Vector3().fromBufferAttribute(places, k * step),
  );
}
