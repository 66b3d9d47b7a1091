/** The pointer in the scene: drags the target and joints, picks frames and ghosts. */
import { Matrix4, type Object3D, type PerspectiveCamera, Plane, Quaternion, Vector3 } from 'three';
import type { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { planeNormal } from './plane';
import type { RobotModel } from './robot';
import { onScreen, pointerOf, rayAt, rowsOf } from './space';
import type { SceneCallbacks } from './types';

const NEAR = 16;
/** A finger is broader than a pointer. */
const NEAR_FINGER = 32;
const STILL = 4;

/** What the hand acts on, as it is now. */
export interface Surroundings {
  model(): RobotModel | null;
  /** The ball that is grabbed. */
  readonly handle: Object3D;
  /** The pose that it stands for: of the target, else of the tool; base axes. */
  target(): Matrix4 | null;
  ghosts(): readonly RobotModel[];
}

interface Drag {
  move(event: PointerEvent): void;
  end(event: PointerEvent): void;
}

export class Hand {
  private drag: Drag | null = null;
  private pressed: { x: number; y: number } | null = null;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly camera: PerspectiveCamera,
    private readonly controls: OrbitControls,
    private readonly around: Surroundings,
    private readonly callbacks: SceneCallbacks,
  ) {
    // Before the controls hear of it, which would turn the camera.
    canvas.addEventListener('pointerdown', this.down, { capture: true });
    canvas.addEventListener('pointermove', this.move);
    canvas.addEventListener('pointerup', this.up);
    canvas.addEventListener('pointercancel', this.up);
  }

  dispose(): void {
    this.canvas.removeEventListener('pointerdown', this.down, { capture: true });
    this.canvas.removeEventListener('pointermove', this.move);
    this.canvas.removeEventListener('pointerup', this.up);
    this.canvas.removeEventListener('pointercancel', this.up);
  }

  private readonly down = (event: PointerEvent): void => {
    if (event.button !== 0 || !event.isPrimary) return;
    this.pressed = { x: event.clientX, y: event.clientY };
    this.drag = this.grabTarget(event) ?? this.grabJoint(event);
    if (!this.drag) return;
    event.stopImmediatePropagation();
    this.controls.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
  };

  private readonly move = (event: PointerEvent): void => {
    if (this.drag) this.drag.move(event);
    else if (!event.buttons) this.canvas.style.cursor = this.over(event) ? 'grab' : '';
  };

  private readonly up = (event: PointerEvent): void => {
    const still =
      this.pressed &&
      Math.hypot(event.clientX - this.pressed.x, event.clientY - this.pressed.y) < STILL;
    if (this.drag) {
      this.drag.end(event);
      this.drag = null;
      this.controls.enabled = true;
    } else if (still && event.type === 'pointerup') {
      this.pick(event);
    }
    this.pressed = null;
  };

  private over(event: PointerEvent): boolean {
    return this.near(event, this.around.handle) || this.jointAt(event) !== null;
  }

  private near(event: PointerEvent, object: Object3D): boolean {
    if (!object.visible) return false;
    const at = onScreen(object.getWorldPosition(new Vector3()), this.camera, this.canvas);
    return Math.hypot(at.x - event.clientX, at.y - event.clientY) < reachOf(event);
  }

  /** In the plane of the screen, or of a planar arm; with Shift it turns instead. */
  private grabTarget(event: PointerEvent): Drag | null {
    const { around, callbacks, camera } = this;
    const start = around.target();
    if (!start || !this.near(event, around.handle)) return null;
    const centre = new Vector3().setFromMatrixPosition(start);
    const towards = camera.getWorldDirection(new Vector3());
    const model = around.model();
    const own = model && planeNormal(model);
    const normal = own && Math.abs(own.dot(towards)) > 0.15 ? own : towards;
    const plane = new Plane().setFromNormalAndCoplanarPoint(normal, centre);
    const grabbed = this.hit(event, plane);
    if (!grabbed) return null;
    let pose = start;
    const change = (now: PointerEvent, done: boolean): void => {
      if (now.shiftKey && !own) pose = this.turned(start, now, event);
      else {
        const at = this.hit(now, plane);
        if (at) pose = start.clone().setPosition(centre.clone().add(at).sub(grabbed));
      }
      callbacks.onTargetDrag(rowsOf(pose), done);
    };
    return { move: (now) => change(now, false), end: (now) => change(now, true) };
  }

  private turned(start: Matrix4, now: PointerEvent, before: PointerEvent): Matrix4 {
    const [right, up] = [new Vector3(), new Vector3()];
    this.camera.matrixWorld.extractBasis(right, up, new Vector3());
    const [dx, dy] = [(now.clientX - before.clientX) * 0.01, (now.clientY - before.clientY) * 0.01];
    const turn = new Quaternion()
      .setFromAxisAngle(up, dx)
      .multiply(new Quaternion().setFromAxisAngle(right, dy));
    const at = new Vector3().setFromMatrixPosition(start);
    const rotation = new Matrix4()
      .makeRotationFromQuaternion(turn)
      .multiply(new Matrix4().extractRotation(start));
    return rotation.setPosition(at);
  }

  private grabJoint(event: PointerEvent): Drag | null {
    const index = this.jointAt(event);
    const model = this.around.model();
    if (index === null || !model) return null;
    const name = model.robot.joints[index]?.name ?? '';
    const joint = model.urdf.joints[name];
    if (!joint) return null;
    const origin = joint.getWorldPosition(new Vector3());
    const axis = joint.axis
      .clone()
      .applyQuaternion(joint.getWorldQuaternion(new Quaternion()))
      .normalize();
    const from = joint.jointValue[0] ?? 0;
    const value =
      joint.jointType === 'prismatic'
        ? this.slide(event, origin, axis)
        : this.turn(event, origin, axis);
    const change = (now: PointerEvent): void =>
      this.callbacks.onJointChange(index, from + value(now));
    return { move: change, end: change };
  }

  /** How far the pointer turned about an axis since an event. */
  private turn(event: PointerEvent, origin: Vector3, axis: Vector3): (now: PointerEvent) => number {
    const facing = axis.dot(this.camera.getWorldDirection(new Vector3()));
    if (Math.abs(facing) < 0.2) {
      // Seen from the side there is no angle to read: across the axis on the screen, 1 rad in 120 px.
      const [a, b] = [origin, origin.clone().add(axis)].map((p) =>
        onScreen(p, this.camera, this.canvas),
      ) as [Pixel, Pixel];
      const length = Math.hypot(b.x - a.x, b.y - a.y) || 1;
      const normal = { x: (b.y - a.y) / length, y: -(b.x - a.x) / length };
      return (now) =>
        -((now.clientX - event.clientX) * normal.x + (now.clientY - event.clientY) * normal.y) /
        120;
    }
    const middle = onScreen(origin, this.camera, this.canvas);
    const angle = (one: PointerEvent): number =>
      Math.atan2(one.clientY - middle.y, one.clientX - middle.x);
    let [last, sum] = [angle(event), 0];
    return (now) => {
      const next = angle(now);
      sum += Math.atan2(Math.sin(next - last), Math.cos(next - last)) * Math.sign(facing);
      last = next;
      return sum;
    };
  }

  private slide(
    event: PointerEvent,
    origin: Vector3,
    axis: Vector3,
  ): (now: PointerEvent) => number {
    const [a, b] = [origin, origin.clone().addScaledVector(axis, 0.1)].map((p) =>
      onScreen(p, this.camera, this.canvas),
    ) as [Pixel, Pixel];
    const square = (b.x - a.x) ** 2 + (b.y - a.y) ** 2 || 1;
    return (now) =>
      (0.1 *
        ((now.clientX - event.clientX) * (b.x - a.x) +
          (now.clientY - event.clientY) * (b.y - a.y))) /
      square;
  }

  /** The joint whose moving part is under the pointer; no deeper than the first thing hit. */
  private jointAt(event: PointerEvent): number | null {
    const model = this.around.model();
    if (!model) return null;
    const ray = rayAt(pointerOf(event, this.canvas), this.camera);
    const hit = ray
      .intersectObject(model.urdf, true)
      .find((one) => 'isMesh' in one.object && !('isSprite' in one.object));
    for (let object: Object3D | null = hit?.object ?? null; object; object = object.parent) {
      const name = (object as Object3D & { urdfName?: string }).urdfName;
      const index =
        'isURDFJoint' in object ? model.robot.joints.findIndex((one) => one.name === name) : -1;
      if (index >= 0) return index;
    }
    return null;
  }

  private pick(event: PointerEvent): void {
    const model = this.around.model();
    const ray = rayAt(pointerOf(event, this.canvas), this.camera);
    const ghost = this.around
      .ghosts()
      .findIndex((one) => ray.intersectObject(one.object, true).length > 0);
    if (ghost >= 0) {
      this.callbacks.onGhostPick(ghost);
      return;
    }
    let [best, nearest]: [string | null, number] = [null, reachOf(event)];
    for (const name of model?.frames ?? []) {
      const frame = model?.frame(name);
      if (!frame) continue;
      const at = onScreen(frame.getWorldPosition(new Vector3()), this.camera, this.canvas);
      const distance = Math.hypot(at.x - event.clientX, at.y - event.clientY);
      // Of frames at one place the later one: it belongs to the row that ends there.
      if (distance <= nearest) [best, nearest] = [name, distance];
    }
    this.callbacks.onFramePick(best);
  }

  private hit(event: PointerEvent, plane: Plane): Vector3 | null {
    return rayAt(pointerOf(event, this.canvas), this.camera).ray.intersectPlane(
      plane,
      new Vector3(),
    );
  }
}

function reachOf(event: PointerEvent): number {
  return event.pointerType === 'touch' ? NEAR_FINGER : NEAR;
}

interface Pixel {
  x: number;
  y: number;
}
