/** The camera: the reader turns it by pointer and keys, `fit` brings everything into view. */
import { PerspectiveCamera, Quaternion, Spherical, Vector3 } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { standpoint } from './fit';

/** Vertical field of view, degrees. */
const FIELD = 40;
const TURN = Math.PI / 24;
const NEARER = 0.87;
/** What a key does: turns left and up, rad, and a factor of the distance. */
const KEYS: Readonly<Record<string, readonly [number, number, number]>> = {
  ArrowLeft: [-TURN, 0, 1],
  ArrowRight: [TURN, 0, 1],
  ArrowUp: [0, TURN, 1],
  ArrowDown: [0, -TURN, 1],
  '+': [0, 0, NEARER],
  '=': [0, 0, NEARER],
  '-': [0, 0, 1 / NEARER],
};

/** A camera whose up is z. */
export function newCamera(): PerspectiveCamera {
  const camera = new PerspectiveCamera(FIELD, 1, 0.01, 100);
  camera.up.set(0, 0, 1);
  return camera;
}

export class Viewpoint {
  readonly controls: OrbitControls;
  /** Whether the reader has left the standpoint of `fit`. */
  isChosen = false;

  /** @param changed Called when the view is to be drawn anew. */
  constructor(
    private readonly host: HTMLElement,
    canvas: HTMLElement,
    private readonly camera: PerspectiveCamera,
    private readonly changed: () => void,
  ) {
    this.controls = new OrbitControls(camera, canvas);
    this.controls.addEventListener('change', changed);
    this.controls.addEventListener('start', () => {
      this.isChosen = true;
    });
    host.tabIndex = 0;
    host.addEventListener('keydown', this.keyed);
  }

  /** Look at points, at a plane from its front. */
  fit(points: readonly Vector3[], normal: Vector3 | null): void {
    this.isChosen = false;
    const from = normal ?? new Vector3(0.75, -0.85, 0.5).normalize();
    // The orbit controls cannot look along up: the ground plane is seen slightly from the side.
    if (normal && Math.abs(normal.z) > 0.99) {
      from.set(0, -0.01, Math.sign(normal.z) || 1).normalize();
    }
    const { clientWidth: width, clientHeight: height } = this.host;
    const { camera, controls } = this;
    const { position, target, distance } = standpoint(
      points,
      from,
      camera,
      width || 1,
      height || 1,
    );
    controls.target.copy(target);
    camera.position.copy(position);
    camera.near = distance / 100;
    camera.far = distance * 30;
    camera.updateProjectionMatrix();
    controls.update();
    this.changed();
  }

  /** Whether a point is outside the view; false during a drag, when the view must not move. */
  isOutside(point: Vector3): boolean {
    if (!this.controls.enabled) return false;
    const { x, y } = point.clone().project(this.camera);
    return Math.max(Math.abs(x), Math.abs(y)) > 1;
  }

  dispose(): void {
    this.host.removeEventListener('keydown', this.keyed);
    this.controls.dispose();
  }

  /** Arrow keys turn the view, + and - bring it nearer and farther. */
  private readonly keyed = (event: KeyboardEvent): void => {
    const { camera, controls } = this;
    const motion = KEYS[event.key];
    if (!motion || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const [left, up, farther] = motion;
    const upright = new Quaternion().setFromUnitVectors(camera.up, new Vector3(0, 1, 0));
    const away = camera.position.clone().sub(controls.target).applyQuaternion(upright);
    const at = new Spherical().setFromVector3(away);
    at.set(at.radius * farther, at.phi - up, at.theta + left).makeSafe();
    camera.position.setFromSpherical(at).applyQuaternion(upright.invert()).add(controls.target);
    this.isChosen = true;
    controls.update();
    this.changed();
  };
}
