/** What the scene shows, as data on its host element, for tests. */
import { Matrix4, type Object3D, type PerspectiveCamera, Quaternion, Vector3 } from 'three';
import type { Placed } from './labels';
import type { RobotModel } from './robot';
import { onScreen, rowsOf } from './space';

interface Pixel {
  readonly x: number;
  readonly y: number;
}

export interface Probe {
  /** Pose of every frame in base axes. */
  poses(): Record<string, number[][]>;
  /** Client pixels of the ball that is dragged; null where there is none. */
  handle(): Pixel | null;
  /** Pose of the target, of the tool where there is none. */
  target(): number[][] | null;
  /** Client pixels of a frame's origin. */
  pixel(frame: string): Pixel | null;
  /** Client pixels of a frame's origin of a ghost. */
  ghost(index: number, frame: string): Pixel | null;
  /** Number of mesh files that are shown. */
  meshes(): number;
  /** Number of objects in each layer. */
  shown(): Record<string, number>;
  /** Pose of the frame that has done part of a row's motions. */
  motion(): number[][] | null;
  /** Directions of the arrows of lost translations, in base axes. */
  lost(): number[][];
  labels(): readonly Placed[];
}

interface Seen {
  readonly canvas: HTMLElement;
  readonly camera: PerspectiveCamera;
  readonly layers: Readonly<Record<string, Object3D>>;
  readonly handle: Object3D;
  model(): RobotModel | null;
  ghosts(): readonly RobotModel[];
  target(): Matrix4 | null;
  labels(): readonly Placed[];
}

export function probeOf(seen: Seen): Probe {
  const pixel = (point: Vector3): Pixel => {
    // The camera may have moved since the last drawing.
    seen.camera.updateMatrixWorld();
    return onScreen(point, seen.camera, seen.canvas);
  };
  const originOf = (model: RobotModel | null | undefined, frame: string): Pixel | null => {
    const at = model?.poseOf(frame);
    return at ? pixel(new Vector3().setFromMatrixPosition(at)) : null;
  };
  return {
    poses: () => {
      const model = seen.model();
      return Object.fromEntries(
        (model?.frames ?? []).map((name) => [name, rowsOf(model?.poseOf(name) ?? new Matrix4())]),
      );
    },
    handle: () => (seen.handle.visible ? pixel(seen.handle.position) : null),
    target: () => {
      const at = seen.target();
      return at && rowsOf(at);
    },
    pixel: (frame) => originOf(seen.model(), frame),
    ghost: (index, frame) => originOf(seen.ghosts()[index], frame),
    meshes: () => seen.model()?.meshes ?? 0,
    shown: () =>
      Object.fromEntries(
        Object.entries(seen.layers).map(([name, layer]) => [name, layer.children.length]),
      ),
    motion: () => {
      const moving = seen.layers.motion?.getObjectByName('moving');
      return moving ? rowsOf(moving.matrix) : null;
    },
    lost: () =>
      (seen.layers.lost?.children ?? [])
        .filter((one) => one.name === 'linear')
        .map((one) =>
          new Vector3(0, 1, 0).applyQuaternion(one.getWorldQuaternion(new Quaternion())).toArray(),
        ),
    labels: () => seen.labels(),
  };
}
