/** Where the camera stands for given points to fill the view. */
import { Matrix4, type PerspectiveCamera, Vector3 } from 'three';

/** Room for labels at the edges, CSS pixels. */
const MARGIN = { x: 34, y: 26 };
const LEAST = 0.5;

export interface Standpoint {
  readonly position: Vector3;
  /** The point in the middle of the view that the camera turns about. */
  readonly target: Vector3;
  readonly distance: number;
}

/**
 * Return the nearest standpoint from which all points are seen, looking along a given direction.
 *
 * @param from Unit vector from the points to the camera; not along the camera's up.
 * @param width Of the view, CSS pixels, like its height.
 */
export function standpoint(
  points: readonly Vector3[],
  from: Vector3,
  camera: PerspectiveCamera,
  width: number,
  height: number,
): Standpoint {
  const turn = new Matrix4().lookAt(from, new Vector3(), camera.up);
  const back = turn.clone().transpose();
  const seen = points.map((one) => one.clone().applyMatrix4(back));
  const tangent = Math.tan((camera.fov * Math.PI) / 360);
  // |x - cx| <= k (D - z) for every point: two lines of D for each side, and cx between them.
  const across = (axis: 'x' | 'y', k: number): { centre: number; distance: number } => {
    const high = Math.max(...seen.map((one) => one[axis] + k * one.z));
    const low = Math.min(...seen.map((one) => one[axis] - k * one.z));
    return { centre: (high + low) / 2, distance: (high - low) / (2 * k) };
  };
  const part = (length: number, margin: number): number =>
    Math.max(LEAST, 1 - (2 * margin) / length);
  const x = across('x', tangent * (width / height) * part(width, MARGIN.x));
  const y = across('y', tangent * part(height, MARGIN.y));
  const near = Math.max(...seen.map((one) => one.z));
  const far = Math.min(...seen.map((one) => one.z));
  const depth = (near + far) / 2;
  const distance = Math.max(x.distance, y.distance, near) - depth;
  const at = (z: number): Vector3 => new Vector3(x.centre, y.centre, z).applyMatrix4(turn);
  return { position: at(depth + distance), target: at(depth), distance };
}
