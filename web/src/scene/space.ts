/** Conversions between matrices of the API, objects of three.js and points of the screen. */
import {
  Box3,
  type Camera,
  Matrix4,
  type Mesh,
  type Object3D,
  Raycaster,
  Sprite,
  Vector2,
  Vector3,
} from 'three';
import type { Matrix } from '../api';

/** A 4x4 matrix, row by row. */
export function matrix4(rows: Matrix): Matrix4 {
  return new Matrix4().fromArray(rows.flat()).transpose();
}

export function rowsOf(matrix: Matrix4): number[][] {
  const e = matrix.elements;
  return [0, 1, 2, 3].map((i) => [0, 1, 2, 3].map((j) => e[4 * j + i] ?? 0));
}

export function vector(values: readonly number[]): Vector3 {
  return new Vector3(values[0] ?? 0, values[1] ?? 0, values[2] ?? 0);
}

/** Give an object a fixed pose in its parent. */
export function pose(object: Object3D, matrix: Matrix4): void {
  object.matrixAutoUpdate = false;
  object.matrix.copy(matrix);
  object.matrixWorldNeedsUpdate = true;
}

/** Turn an object's z axis (for cylinders of three.js their y) onto a direction. */
export function along(object: Object3D, direction: Vector3, own = new Vector3(0, 0, 1)): void {
  object.quaternion.setFromUnitVectors(own, direction.clone().normalize());
}

/** The place of a pointer on an element, -1 to 1 on both axes. */
export function pointerOf(event: PointerEvent, element: HTMLElement): Vector2 {
  const box = element.getBoundingClientRect();
  return new Vector2(
    ((event.clientX - box.left) / box.width) * 2 - 1,
    1 - ((event.clientY - box.top) / box.height) * 2,
  );
}

/** The place of a point of the world on the screen, client pixels. */
export function onScreen(
  point: Vector3,
  camera: Camera,
  element: HTMLElement,
): { x: number; y: number } {
  const box = element.getBoundingClientRect();
  const seen = point.clone().project(camera);
  return {
    x: box.left + ((seen.x + 1) / 2) * box.width,
    y: box.top + ((1 - seen.y) / 2) * box.height,
  };
}

/** Corners of the boxes around all objects but labels, which have no size in the world. */
export function cornersOf(object: Object3D): Vector3[] {
  const found: Vector3[] = [];
  object.updateMatrixWorld(true);
  object.traverse((one) => {
    if (!('geometry' in one) || one instanceof Sprite) return;
    const { geometry } = one as Mesh;
    if (!geometry.boundingBox) geometry.computeBoundingBox();
    const { min, max } = geometry.boundingBox ?? new Box3();
    if (min.x > max.x) return;
    for (const x of [min.x, max.x])
      for (const y of [min.y, max.y])
        for (const z of [min.z, max.z]) {
          found.push(new Vector3(x, y, z).applyMatrix4(one.matrixWorld));
        }
  });
  return found;
}

export function rayAt(pointer: Vector2, camera: Camera): Raycaster {
  const ray = new Raycaster();
  ray.setFromCamera(pointer, camera);
  return ray;
}

/** Empty a group, and free what it held on the graphics card. */
export function clear(group: Object3D): void {
  for (const child of [...group.children]) {
    group.remove(child);
    release(child);
  }
}

export function release(object: Object3D): void {
  object.traverse((one) => {
    const held = one as Object3D & {
      geometry?: { dispose(): void };
      material?: Disposable | Disposable[];
    };
    held.geometry?.dispose();
    for (const material of [held.material ?? []].flat()) {
      material.map?.dispose();
      material.dispose();
    }
  });
}

interface Disposable {
  map?: { dispose(): void } | null;
  dispose(): void;
}
