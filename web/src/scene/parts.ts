/** Lines, arrows, axes and labels of which the scene is made. */
import {
  BufferGeometry,
  CanvasTexture,
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
  Object3D,
  SphereGeometry,
  SRGBColorSpace,
  Sprite,
  SpriteMaterial,
  Vector3,
} from 'three';
import { along } from './space';

export const AXES = [0xd62728, 0x2ca02c, 0x1f6fd0] as const;
export const COLORS = { a: 0xc2570c, d: 0x155a9c, target: 0xb01e8f, path: 0x222222, ghost: 0x8a94a0 } as const;
const UP = new Vector3(0, 1, 0);
const RESOLUTION = 3;
const HEIGHT = 22;

/** How large things are drawn: a length of the scene and pixels a metre are told once a robot. */
export interface Scale {
  /** Length of a frame's axes, m. */
  readonly axis: number;
  /** Height of a label on the screen as a part of the height of the view. */
  readonly label: number;
}

export function polyline(points: readonly Vector3[], color: number, dashed = false): Line {
  const geometry = new BufferGeometry().setFromPoints([...points]);
  if (!dashed) return new Line(geometry, new LineBasicMaterial({ color }));
  const line = new Line(geometry, new LineDashedMaterial({ color, dashSize: 0.02, gapSize: 0.014 }));
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

/** Axes of a frame, x red, y green, z blue. */
export function axes(length: number, opacity = 1): Group {
  const group = new Group();
  AXES.forEach((color, k) => {
    const end = new Vector3().setComponent(k, length);
    const arrow = rod(new Vector3(), end, 0.034 * length, color, 0.24 * length);
    arrow.traverse((one) => {
      if (one instanceof Mesh && opacity < 1) Object.assign(one.material, { transparent: true, opacity });
    });
    group.add(arrow);
  });
  return group;
}

/** A word that always faces the viewer and keeps its size on the screen. */
export function label(text: string, at: Vector3, color: number, scale: Scale, dark: boolean): Sprite {
  const canvas = document.createElement('canvas');
  const font = `600 ${16 * RESOLUTION}px system-ui, "DejaVu Sans", sans-serif`;
  const measure = canvas.getContext('2d');
  if (!measure) return new Sprite();
  measure.font = font;
  const width = measure.measureText(text).width / RESOLUTION + 8;
  canvas.width = width * RESOLUTION;
  canvas.height = HEIGHT * RESOLUTION;
  const pen = canvas.getContext('2d');
  if (!pen) return new Sprite();
  pen.font = font;
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.lineJoin = 'round';
  pen.lineWidth = 4 * RESOLUTION;
  pen.strokeStyle = dark ? '#14171b' : '#ffffff';
  pen.fillStyle = `#${color.toString(16).padStart(6, '0')}`;
  pen.strokeText(text, canvas.width / 2, canvas.height / 2);
  pen.fillText(text, canvas.width / 2, canvas.height / 2);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  const material = new SpriteMaterial({ map: texture, depthTest: false, sizeAttenuation: false, transparent: true });
  const sprite = new Sprite(material);
  sprite.position.copy(at);
  sprite.scale.set((scale.label * width) / HEIGHT, scale.label, 1);
  sprite.renderOrder = 10;
  return sprite;
}

/** A flat ring sector about z from one angle to another: how far a turn goes. */
export function sector(radius: number, from: number, to: number, color: number): Mesh {
  const steps = Math.max(2, Math.ceil(Math.abs(to - from) / 0.1));
  const points: number[] = [];
  for (let k = 0; k < steps; k += 1) {
    const [p, q] = [from + ((to - from) * k) / steps, from + ((to - from) * (k + 1)) / steps];
    points.push(0, 0, 0, radius * Math.cos(p), radius * Math.sin(p), 0, radius * Math.cos(q), radius * Math.sin(q), 0);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(points, 3));
  const material = new MeshBasicMaterial({ color, transparent: true, opacity: 0.35, side: DoubleSide, depthWrite: false });
  return new Mesh(geometry, material);
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
