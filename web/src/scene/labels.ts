/** Places labels on the screen: of one size, inside the view, without overlap. */
import { type Object3D, type PerspectiveCamera, Sprite, Vector3 } from 'three';

/** Height of a label's picture, CSS pixels, in a view that is high enough. */
export const LABEL_HEIGHT = 22;
/** Views lower than this have smaller labels. */
const ENOUGH = 560;
const SMALLEST = 0.8;
const RINGS = 14;
const STEP = 7;
const BALL = 7;
/** The part of a label's picture that may overlap another: its halo, CSS pixels. */
const HALO = { x: 6, y: 7 };

/** The place of a label, CSS pixels from the lower left corner of the view. */
export interface Placed extends Box {
  readonly text: string;
}

interface Box {
  readonly x: number;
  readonly y: number;
  readonly halfWidth: number;
  readonly halfHeight: number;
}

/** Offsets from nearest to farthest, pixels; along the axes before the diagonals. */
const OFFSETS: readonly (readonly [number, number])[] = Array.from({ length: RINGS }, (_, ring) =>
  ring === 0
    ? [[0, 0] as const]
    : [0, 4, 2, 6, 1, 3, 5, 7].map((turn) => {
        const angle = (turn * Math.PI) / 4;
        return [STEP * ring * Math.cos(angle), STEP * ring * Math.sin(angle)] as const;
      }),
).flat();

/**
 * Give every visible label its size, and move it on the screen to the nearest free place.
 *
 * @param root What the labels are in; its world matrices are up to date.
 * @param width Of the view, CSS pixels, like its height.
 * @param ball What is dragged: no label hides it.
 * @returns The labels that have a place.
 */
export function layOut(
  root: Object3D,
  camera: PerspectiveCamera,
  width: number,
  height: number,
  ball: Object3D,
): Placed[] {
  const placed: Placed[] = [];
  const taken: Box[] = [];
  const factor = Math.min(1, Math.max(SMALLEST, height / ENOUGH));
  const unit = (2 * Math.tan((camera.fov * Math.PI) / 360)) / height;
  const seen = new Vector3();
  if (ball.visible) {
    seen.setFromMatrixPosition(ball.matrixWorld).project(camera);
    taken.push({
      x: ((seen.x + 1) / 2) * width,
      y: ((seen.y + 1) / 2) * height,
      halfWidth: BALL,
      halfHeight: BALL,
    });
  }
  root.traverseVisible((one) => {
    const wide: unknown = one.userData.labelWidth;
    if (!(one instanceof Sprite) || typeof wide !== 'number') return;
    const size = { x: wide * factor, y: LABEL_HEIGHT * factor };
    one.scale.set(size.x * unit, size.y * unit, 1);
    seen.setFromMatrixPosition(one.matrixWorld).project(camera);
    const half = { x: (size.x - HALO.x) / 2, y: (size.y - HALO.y) / 2 };
    const at = { x: ((seen.x + 1) / 2) * width, y: ((seen.y + 1) / 2) * height };
    const near =
      Math.abs(seen.z) <= 1 &&
      at.x > -half.x &&
      at.x < width + half.x &&
      at.y > -half.y &&
      at.y < height + half.y;
    const place = near ? free(at, half, width, height, taken) : null;
    const [dx, dy] = place ? [place.x - at.x, place.y - at.y] : [0, 0];
    one.center.set(0.5 - dx / size.x, 0.5 - dy / size.y);
    if (place) {
      taken.push(place);
      placed.push({ ...place, text: one.name });
    }
    // Without a free place it is not drawn: two that overlap could not be read.
    else one.scale.set(0, 0, 1);
  });
  return placed;
}

function free(
  at: { x: number; y: number },
  half: { x: number; y: number },
  width: number,
  height: number,
  taken: readonly Box[],
): Box | null {
  const inside = (value: number, margin: number, length: number): number =>
    length > 2 * margin ? Math.min(Math.max(value, margin), length - margin) : value;
  const start = { x: inside(at.x, half.x, width), y: inside(at.y, half.y, height) };
  const box = (x: number, y: number): Box => ({ x, y, halfWidth: half.x, halfHeight: half.y });
  for (const [dx, dy] of OFFSETS) {
    const [x, y] = [start.x + dx, start.y + dy];
    if (x !== inside(x, half.x, width) || y !== inside(y, half.y, height)) continue;
    const clear = taken.every(
      (one) =>
        Math.abs(one.x - x) >= one.halfWidth + half.x ||
        Math.abs(one.y - y) >= one.halfHeight + half.y,
    );
    if (clear) return box(x, y);
  }
  return null;
}
