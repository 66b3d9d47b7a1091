/** How far a drag of the pointer moves a joint. */
import { type PerspectiveCamera, Quaternion, Vector3 } from 'three';
import type { URDFJoint } from 'urdf-loader';
import { onScreen } from './space';

/** Below this cosine of the angle to the view direction an axis is seen from the side. */
const SIDEWAYS = 0.2;
/** Pixels that turn a joint by 1 rad where its axis is seen from the side. */
const PIXELS_PER_RADIAN = 120;

interface Pixel {
  readonly x: number;
  readonly y: number;
}

/**
 * Follow the pointer with a joint.
 *
 * @param start Where the drag began.
 * @returns A function of the pointer now: how far the joint has moved since, rad or m.
 */
export function jointMotion(
  joint: URDFJoint,
  start: PointerEvent,
  camera: PerspectiveCamera,
  canvas: HTMLElement,
): (now: PointerEvent) => number {
  const origin = joint.getWorldPosition(new Vector3());
  const axis = joint.axis
    .clone()
    .applyQuaternion(joint.getWorldQuaternion(new Quaternion()))
    .normalize();
  const pixel = (along: number): Pixel =>
    onScreen(origin.clone().addScaledVector(axis, along), camera, canvas);
  if (joint.jointType === 'prismatic') return slide(start, pixel(0), pixel(0.1), 0.1);
  const facing = axis.dot(camera.getWorldDirection(new Vector3()));
  if (Math.abs(facing) < SIDEWAYS) return roll(start, pixel(0), pixel(1));
  return turn(start, pixel(0), Math.sign(facing));
}

/** Along an axis that is seen from `a` to `b`, which are `length` apart. */
function slide(
  start: PointerEvent,
  a: Pixel,
  b: Pixel,
  length: number,
): (now: PointerEvent) => number {
  const [x, y] = [b.x - a.x, b.y - a.y];
  const square = x ** 2 + y ** 2 || 1;
  return (now) =>
    (length * ((now.clientX - start.clientX) * x + (now.clientY - start.clientY) * y)) / square;
}

/** About an axis that is seen from the side, from `a` to `b`: by motion across it. */
function roll(start: PointerEvent, a: Pixel, b: Pixel): (now: PointerEvent) => number {
  const length = Math.hypot(b.x - a.x, b.y - a.y) || 1;
  const [x, y] = [(b.y - a.y) / length, -(b.x - a.x) / length];
  return (now) =>
    -((now.clientX - start.clientX) * x + (now.clientY - start.clientY) * y) / PIXELS_PER_RADIAN;
}

/** About an axis that is seen from its end: by the angle around it, any number of turns. */
function turn(start: PointerEvent, centre: Pixel, sign: number): (now: PointerEvent) => number {
  const angle = (one: PointerEvent): number =>
    Math.atan2(one.clientY - centre.y, one.clientX - centre.x);
  let last = angle(start);
  let sum = 0;
  return (now) => {
    const next = angle(now);
    sum += Math.atan2(Math.sin(next - last), Math.cos(next - last)) * sign;
    last = next;
    return sum;
  };
}
