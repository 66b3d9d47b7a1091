/** What the pointer does in the scene: drag the target and joints, pick frames and ghosts. */
import { Matrix4, type Object3D, type PerspectiveCamera, Plane, Quaternion, Vector3 } from 'three';
import type { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { jointMotion } from './joint-motion';
import { planeNormal } from './plane';
import type { RobotModel } from './robot';
import { onScreen, pointerOf, rayAt, rowsOf } from './space';
import type { SceneCallbacks } from './types';

/** Within this distance of a point the pointer is on it, CSS pixels; a finger is less exact. */
const NEAR = { mouse: 16, touch: 32 };
/** A press that moves less than this is a click, CSS pixels. */
const STILL = 4;
/** Turn of the target for a CSS pixel, rad. */
const TURN = 0.01;

/** What the pointer acts on, as it is now. */
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

export class Interaction {
  private drag: Drag | null = null;
  private pressed: { x: number; y: number } | null = null;

  constructor(
    private readonly canvas: HTMLElement,
    private readonly camera: PerspectiveCamera,
    private readonly controls: OrbitControls,
    private readonly around: Surroundings,
    private readonly callbacks: SceneCallbacks,
  ) {
    // In the capture phase, before the orbit controls, which would turn the camera.
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

  /** The target moves in the plane of the screen, or of a planar arm; with Shift it turns. */
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
    const [dx, dy] = [(now.clientX - before.clientX) * TURN, (now.clientY - before.clientY) * TURN];
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
    const joint = model.urdf.joints[model.robot.joints[index]?.name ?? ''];
    if (!joint) return null;
    const from = joint.jointValue[0] ?? 0;
    const motion = jointMotion(joint, event, this.camera, this.canvas);
    const change = (now: PointerEvent): void =>
      this.callbacks.onJointChange(index, from + motion(now));
    return { move: change, end: change };
  }

  /** The joint that moves the first object under the pointer. */
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
      // Of frames at one point the last one is picked: it is that of the row which ends there.
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
  return event.pointerType === 'touch' ? NEAR.touch : NEAR.mouse;
}
