/** What is drawn with the robot: ellipsoids, lost directions, obstacles, a path, a cloud. */
import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  DoubleSide,
  Euler,
  Float32BufferAttribute,
  type Group,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  PlaneGeometry,
  Points,
  PointsMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';
import type { Matrix, Obstacle } from '../api';
import { ball, COLORS, label, onTop, polyline, ring, rod, type Scale } from './parts';
import { along, clear, pose, vector } from './space';
import type { LostDirection, SceneEllipsoid, ScenePath } from './types';

const LARGEST = 3.2;
const FLAT = 0.012;

/** Draw ellipsoids, scaled so that the largest bounded semi-axis has a fixed length. */
export function drawEllipsoids(
  group: Group,
  ellipsoids: readonly SceneEllipsoid[],
  scale: Scale,
): void {
  clear(group);
  for (const { kind, center, axes, semiAxes } of ellipsoids) {
    const bounded = semiAxes.filter((one): one is number => one !== null && one < 1e3);
    const unit = (LARGEST * scale.axis) / Math.max(...bounded, 1e-9);
    const radii = axes.map((_, k) => {
      const semi = semiAxes[k];
      const length = semi === null || semi === undefined ? 2 * LARGEST * scale.axis : semi * unit;
      return Math.min(Math.max(length, FLAT * scale.axis), 2 * LARGEST * scale.axis);
    });
    const columns = axes.map(vector);
    // In a plane there are two axes: the third is normal to them, and short.
    while (columns.length < 3) {
      columns.push(
        columns.length === 2
          ? new Vector3().crossVectors(columns[0] as Vector3, columns[1] as Vector3)
          : across(columns[0] as Vector3),
      );
      radii.push(FLAT * scale.axis);
    }
    const [x, y, z] = columns as [Vector3, Vector3, Vector3];
    // The API's axes may be left-handed; an ellipsoid looks the same mirrored.
    if (new Vector3().crossVectors(x, y).dot(z) < 0) z.negate();
    const color = kind === 'velocity' ? 0x2b7fd0 : 0xd0762b;
    const material = new MeshLambertMaterial({
      color,
      transparent: true,
      opacity: 0.35,
      depthWrite: false,
    });
    const mesh = new Mesh(new SphereGeometry(1, 40, 28), material);
    const [a, b, c] = radii as [number, number, number];
    const matrix = new Matrix4().makeBasis(
      x.multiplyScalar(a),
      y.multiplyScalar(b),
      z.multiplyScalar(c),
    );
    pose(mesh, matrix.setPosition(vector(center)));
    group.add(mesh);
  }
}

function across(one: Vector3): Vector3 {
  const other = Math.abs(one.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  return other.cross(one).normalize();
}

const LINEAR = 0xd6186b;
const ANGULAR = 0x8e24aa;

/** Draw a double arrow for a lost translation, and a turn about its axis for a lost rotation. */
export function drawLost(
  group: Group,
  directions: readonly LostDirection[],
  scale: Scale,
  dark: boolean,
): void {
  clear(group);
  for (const { at, linear, angular } of directions) {
    const from = vector(at);
    const [v, w] = [vector(linear), vector(angular)];
    const reach = (part: Vector3): Vector3 =>
      part
        .clone()
        .normalize()
        .multiplyScalar(2.2 * scale.axis * Math.max(part.length(), 0.4));
    if (v.length() > 1e-6) {
      const end = reach(v);
      for (const sign of [1, -1]) {
        const arrow = onTop(
          rod(
            from,
            from.clone().addScaledVector(end, sign),
            0.04 * scale.axis,
            LINEAR,
            0.3 * scale.axis,
          ),
        );
        arrow.name = 'linear';
        group.add(arrow);
      }
      group.add(label('v', from.clone().addScaledVector(end, 1.1), LINEAR, dark));
    }
    if (w.length() > 1e-6) {
      const end = reach(w);
      const [low, high] = [from.clone().sub(end), from.clone().add(end)];
      group.add(onTop(rod(low, high, 0.016 * scale.axis, ANGULAR)));
      const turn = onTop(ring(0.55 * scale.axis, 0.035 * scale.axis, ANGULAR));
      turn.position.copy(from).addScaledVector(end, 0.7);
      along(turn, end);
      group.add(turn, label('ω', high.clone().addScaledVector(end, 0.1), ANGULAR, dark));
    }
  }
}

export function drawObstacles(group: Group, obstacles: readonly Obstacle[], extent: number): void {
  clear(group);
  for (const obstacle of obstacles) {
    const material = new MeshLambertMaterial({
      color: 0x9aa3ad,
      transparent: true,
      opacity: 0.75,
      side: DoubleSide,
    });
    if (obstacle.type === 'circle') {
      // A disc of the plane z = 0, as high as the links are thick.
      const mesh = new Mesh(
        new CylinderGeometry(obstacle.radius, obstacle.radius, 0.03 * extent, 48),
        material,
      );
      mesh.rotation.x = Math.PI / 2;
      mesh.position.copy(vector(obstacle.center));
      group.add(mesh);
    } else if (obstacle.type === 'sphere') {
      const mesh = new Mesh(new SphereGeometry(obstacle.radius, 32, 20), material);
      mesh.position.copy(vector(obstacle.center));
      group.add(mesh);
    } else if (obstacle.type === 'capsule') {
      const [start, end] = [vector(obstacle.start), vector(obstacle.end)];
      const mesh = new Mesh(
        new CapsuleGeometry(obstacle.radius, start.distanceTo(end), 10, 24),
        material,
      );
      mesh.position.copy(start).lerp(end, 0.5);
      if (start.distanceTo(end) > 1e-9) along(mesh, end.sub(start), new Vector3(0, 1, 0));
      group.add(mesh);
    } else if (obstacle.type === 'box') {
      const size = vector(obstacle.size);
      const mesh = new Mesh(new BoxGeometry(size.x, size.y, size.z), material);
      mesh.position.copy(vector(obstacle.center));
      const [roll, pitch, yaw] = obstacle.rpy ?? [0, 0, 0];
      mesh.quaternion.setFromEuler(new Euler(roll, pitch, yaw, 'ZYX'));
      group.add(mesh);
    } else if (obstacle.type === 'half_space') {
      const normal = vector(obstacle.normal).normalize();
      const length = vector(obstacle.normal).length() || 1;
      const mesh = new Mesh(new PlaneGeometry(2 * extent, 2 * extent), material);
      mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), normal));
      mesh.position.copy(normal).multiplyScalar((obstacle.offset ?? 0) / length);
      group.add(mesh);
    }
  }
}

export function drawPath(group: Group, path: ScenePath | null, scale: Scale, dark: boolean): void {
  clear(group);
  if (!path) return;
  const points = (rows: Matrix): Vector3[] => rows.map(vector);
  if (path.wanted.length > 1)
    group.add(polyline(points(path.wanted), dark ? 0xdfe4ea : COLORS.path, 0.2 * scale.axis));
  if (path.reached.length > 1) group.add(polyline(points(path.reached), COLORS.a));
  const last = path.reached.at(-1);
  if (last) group.add(ball(vector(last), 0.08 * scale.axis, COLORS.a));
}

export function drawCloud(group: Group, points: Float32Array | null, scale: Scale): void {
  clear(group);
  if (!points) return;
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(points, 3));
  const material = new PointsMaterial({
    color: 0x2b9f83,
    size: 0.05 * scale.axis,
    transparent: true,
    opacity: 0.5,
    depthWrite: false,
  });
  group.add(new Points(geometry, material));
}
