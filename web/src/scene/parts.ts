/** Lines, arrows, axes and labels. */
import {
  BufferGeometry,
  CanvasTexture,
  Color,
  ConeGeometry,
  CylinderGeometry,
  DoubleSide,
  Float32BufferAttribute,
  Group,
  Line,
  LineBasicMaterial,
  LineDashedMaterial,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  type Object3D,
  SphereGeometry,
  Sprite,
  SpriteMaterial,
  SRGBColorSpace,
  TorusGeometry,
  Vector3,
} from 'three';
import { LABEL_HEIGHT } from './labels';
import { along } from './space';

export const AXES = [0xd62728, 0x2ca02c, 0x1f6fd0] as const;
export const COLORS = {
  a: 0xc2570c,
  d: 0x155a9c,
  target: 0xb01e8f,
  path: 0x222222,
  ghost: 0x8a94a0,
} as const;
const UP = new Vector3(0, 1, 0);
const RESOLUTION = 3;
/** Part of the way to white that a colour is moved on a dark ground. */
const LIGHTER = 0.2;

/** How large things are drawn. */
export interface Scale {
  /** Length of a frame's axes, m. */
  readonly axis: number;
}

/** A colour of a light ground, on the present one. */
export function onGround(color: number, dark: boolean): number {
  return dark ? new Color(color).lerp(new Color(0xffffff), LIGHTER).getHex() : color;
}

/** @param dash Length of a dash, m; 0 for a solid line. */
export function polyline(points: readonly Vector3[], color: number, dash = 0): Line {
  const geometry = new BufferGeometry().setFromPoints([...points]);
  if (!dash) return new Line(geometry, new LineBasicMaterial({ color }));
  const line = new Line(
    geometry,
    new LineDashedMaterial({ color, dashSize: dash, gapSize: 0.7 * dash }),
  );
  line.computeLineDistances();
  return line;
}

/** A shaft from one point to another, with a head where it is an arrow. */
export function rod(from: Vector3, to: Vector3, radius: number, color: number, head = 0): Object3D {
  const group = new Group();
  const direction = to.clone().sub(from);
  const length = direction.length();
  if (length < 1e-9) return group;
  const material = new MeshBasicMaterial({ color });
  const shaft = Math.max(length - head, 1e-6);
  const tube = new Mesh(new CylinderGeometry(radius, radius, shaft, 10), material);
  tube.position.y = shaft / 2;
  group.add(tube);
  if (head) {
    const cone = new Mesh(new ConeGeometry(2.6 * radius, head, 14), material);
    cone.position.y = length - head / 2;
    group.add(cone);
  }
  group.position.copy(from);
  along(group, direction, UP);
  return group;
}

export function ball(at: Vector3, radius: number, color: number, opacity = 1): Mesh {
  const material = new MeshLambertMaterial({ color, transparent: opacity < 1, opacity });
  const mesh = new Mesh(new SphereGeometry(radius, 24, 16), material);
  mesh.position.copy(at);
  return mesh;
}

/** Axes of a frame, x red, y green, z blue; links never hide them. */
export function axes(length: number, opacity = 1): Group {
  const group = new Group();
  AXES.forEach((color, k) => {
    const end = new Vector3().setComponent(k, length);
    group.add(onTop(rod(new Vector3(), end, 0.03 * length, color, 0.24 * length), opacity));
  });
  return group;
}

/** Draw an object over all that is solid, its farther parts first. */
export function onTop<T extends Object3D>(object: T, opacity = 1): T {
  object.traverse((one) => {
    if (!(one instanceof Mesh)) return;
    // three.js sorts only transparent objects from back to front.
    Object.assign(one.material, { transparent: true, opacity, depthTest: false });
    one.renderOrder = 5;
  });
  return object;
}

/** A text that faces the viewer; `layOut` gives it its size and its place. */
export function label(text: string, at: Vector3, color: number, dark: boolean): Sprite {
  const canvas = document.createElement('canvas');
  const font = `600 ${16 * RESOLUTION}px system-ui, "DejaVu Sans", sans-serif`;
  const measure = canvas.getContext('2d');
  if (!measure) return new Sprite();
  measure.font = font;
  const width = measure.measureText(text).width / RESOLUTION + 8;
  canvas.width = width * RESOLUTION;
  canvas.height = LABEL_HEIGHT * RESOLUTION;
  const pen = canvas.getContext('2d');
  if (!pen) return new Sprite();
  pen.font = font;
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.lineJoin = 'round';
  pen.lineWidth = 4 * RESOLUTION;
  pen.strokeStyle = dark ? '#14171b' : '#ffffff';
  pen.fillStyle = `#${onGround(color, dark).toString(16).padStart(6, '0')}`;
  pen.strokeText(text, canvas.width / 2, canvas.height / 2);
  pen.fillText(text, canvas.width / 2, canvas.height / 2);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  const material = new SpriteMaterial({
    map: texture,
    depthTest: false,
    sizeAttenuation: false,
    transparent: true,
  });
  const sprite = new Sprite(material);
  sprite.position.copy(at);
  sprite.userData.labelWidth = width;
  sprite.name = text;
  sprite.renderOrder = 10;
  return sprite;
}

/** A flat sector about z from one angle to another, rad: it shows how far a turn goes. */
export function sector(radius: number, from: number, to: number, color: number): Mesh {
  const steps = Math.max(2, Math.ceil(Math.abs(to - from) / 0.1));
  const points: number[] = [];
  for (let k = 0; k < steps; k += 1) {
    const [p, q] = [from + ((to - from) * k) / steps, from + ((to - from) * (k + 1)) / steps];
    points.push(
      0,
      0,
      0,
      radius * Math.cos(p),
      radius * Math.sin(p),
      0,
      radius * Math.cos(q),
      radius * Math.sin(q),
      0,
    );
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(points, 3));
  const material = new MeshBasicMaterial({
    color,
    transparent: true,
    opacity: 0.35,
    side: DoubleSide,
    depthWrite: false,
  });
  return new Mesh(geometry, material);
}

/** An arrow that turns about z through three quarters of a circle, with a head at each end. */
export function ring(radius: number, thick: number, color: number): Group {
  const group = new Group();
  const sweep = 1.5 * Math.PI;
  const material = new MeshBasicMaterial({ color });
  group.add(new Mesh(new TorusGeometry(radius, thick, 8, 40, sweep), material));
  for (const [angle, sign] of [
    [0, -1],
    [sweep, 1],
  ] as const) {
    const head = new Mesh(new ConeGeometry(2.8 * thick, 7 * thick, 14), material);
    head.position.set(radius * Math.cos(angle), radius * Math.sin(angle), 0);
    along(head, new Vector3(-Math.sin(angle), Math.cos(angle), 0).multiplyScalar(sign), UP);
    group.add(head);
  }
  return group;
}

const DIGITS = '₀₁₂₃₄₅₆₇₈₉';

/** `frame_12` -> `₁₂`; null for other names. */
export function numberOf(frame: string): string | null {
  const found = /^frame_(\d+)$/.exec(frame)?.[1];
  return found === undefined ? null : subscript(found);
}

export function subscript(digits: string | number): string {
  return [...String(digits)].map((digit) => DIGITS[Number(digit)] ?? digit).join('');
}
