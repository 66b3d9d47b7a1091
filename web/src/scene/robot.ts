/** A robot in the scene: links by urdf-loader, with their meshes, or with bones where it has none. */
import {
  Box3,
  BoxGeometry,
  Group,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  type Object3D,
  Vector3,
} from 'three';
import URDFLoader, { type URDFJoint, type URDFRobot } from 'urdf-loader';
import { drawBones, removeBones } from './bones';
import { loadMeshes, type WantedMesh } from './meshes';
import { along, cornersOf, pose, release } from './space';
import type { SceneRobot } from './types';

/** Colour of a prismatic joint's bar. */
const SLIDE = 0x4a86c5;

export class RobotModel {
  /** Holds the URDF's root so that the base frame is at its origin. */
  readonly object = new Group();
  readonly urdf: URDFRobot;
  readonly robot: SceneRobot;
  /** Number of mesh files that are shown. */
  meshes = 0;
  private isDisposed = false;
  /** A bar for each prismatic joint, from where the way along its axis begins to its origin. */
  private readonly slides: { joint: URDFJoint; from: Vector3; bar: Mesh }[] = [];
  /** Size of the shapes that the links have of their own, m. */
  private readonly shapes: number;

  /** @param changed Called when the meshes have been loaded. */
  constructor(robot: SceneRobot, changed: () => void) {
    this.robot = robot;
    const loader = new URDFLoader();
    const wanted: WantedMesh[] = [];
    loader.packages = (name) => `package://${name}`;
    loader.loadMeshCb = (url, _manager, _material, done) => wanted.push({ url, done });
    this.urdf = loader.parse(robot.urdf);
    for (const joint of Object.values(this.urdf.joints)) {
      joint.ignoreLimits = true;
    }
    // Followers go with their leaders, and have offsets of their own at zero.
    for (const name of Object.keys(this.urdf.joints)) {
      if (this.urdf.joints[name]?.mimicJoints.length) this.urdf.setJointValue(name, 0);
    }
    this.object.add(this.urdf);
    this.setQ([]);
    if (wanted.length || !this.hasShapes()) {
      drawBones(this.urdf, this.box().getSize(new Vector3()).length());
    }
    if (wanted.length && robot.id) {
      // Where this fails the bones stay.
      void this.showMeshes(robot.id, wanted, changed).catch((error: unknown) =>
        console.warn(error),
      );
    }
    this.shapes = new Box3().setFromPoints(cornersOf(this.object)).getSize(new Vector3()).length();
    this.addSlides();
  }

  /** Set the joints, rad and m; those without a value in q stay as they are. */
  setQ(q: readonly number[]): void {
    this.robot.joints.forEach((joint, k) => {
      const value = q[k];
      if (value !== undefined) this.urdf.setJointValue(joint.name, value);
    });
    this.object.updateMatrixWorld(true);
    const thick = this.slides.length ? 0.16 * this.axisLength() : 0;
    for (const { joint, from, bar } of this.slides) {
      const way = joint.position.clone().sub(from);
      bar.visible = way.length() > 1e-9 && !this.meshes;
      bar.position.copy(from).addScaledVector(way, 0.5);
      if (bar.visible) along(bar, way);
      bar.scale.set(thick, thick, Math.max(way.length(), 1e-9));
    }
    this.object.updateMatrixWorld(true);
    const base = this.urdf.links[this.robot.baseFrame];
    if (!base) return;
    // Joints may move the base frame: the URDF's root is placed so that the base frame is fixed.
    const seen = new Matrix4().copy(this.urdf.matrixWorld).invert().multiply(base.matrixWorld);
    pose(this.urdf, seen.invert());
    this.object.updateMatrixWorld(true);
  }

  frame(name: string): Object3D | undefined {
    return this.urdf.links[name];
  }

  /** Pose of a frame in base axes. */
  poseOf(name: string): Matrix4 | null {
    const frame = this.frame(name);
    if (!frame) return null;
    return new Matrix4().copy(this.object.matrixWorld).invert().multiply(frame.matrixWorld);
  }

  tipPose(): Matrix4 | null {
    return this.poseOf(this.robot.tipFrame);
  }

  get frames(): string[] {
    return Object.keys(this.urdf.links).filter(
      (name) => !name.startsWith('link_') || !this.robot.convention,
    );
  }

  /** The box around all links' origins and shapes, in base axes. */
  box(): Box3 {
    const box = new Box3();
    for (const link of Object.values(this.urdf.links)) {
      box.expandByPoint(new Vector3().setFromMatrixPosition(link.matrixWorld));
    }
    return box;
  }

  /** About how far it reaches, m; an arm without lengths has the size of its joints' shapes. */
  extent(): number {
    const { x, y, z } = this.box().expandByPoint(new Vector3()).getSize(new Vector3());
    return Math.max(x, y, z, 0.3 * this.shapes, 1e-6);
  }

  /** Length of the axes of its frames, m: short enough not to reach the next frame. */
  axisLength(): number {
    const extent = this.extent();
    const lengths = Object.values(this.urdf.joints)
      .map((joint) => joint.position.length())
      .filter((one) => one > 0.02 * extent);
    const middle = lengths.sort((a, b) => a - b)[Math.floor(lengths.length / 2)] ?? extent;
    return Math.min(0.1 * extent, Math.max(0.5 * middle, 0.04 * extent));
  }

  /** Make everything see-through and of one colour. */
  tint(color: number, opacity: number): void {
    this.object.traverse((one) => {
      if (one instanceof Mesh) {
        one.material = new MeshLambertMaterial({
          color,
          transparent: true,
          opacity,
          depthWrite: false,
        });
      }
    });
  }

  dispose(): void {
    this.isDisposed = true;
    release(this.object);
    this.object.removeFromParent();
  }

  private addSlides(): void {
    for (const joint of Object.values(this.urdf.joints)) {
      if (joint.jointType !== 'prismatic' || !joint.parent) continue;
      const bar = new Mesh(new BoxGeometry(1, 1, 1), new MeshLambertMaterial({ color: SLIDE }));
      bar.visible = false;
      joint.parent.add(bar);
      this.slides.push({ joint, from: this.startOf(joint), bar });
    }
  }

  /**
   * Where the way along a sliding joint's axis begins, in the axes of its parent, with the joint at
   * zero. The joint of a modified row stands at the end of d: the way begins before it, on x.
   */
  private startOf(joint: URDFJoint): Vector3 {
    const from = joint.position.clone();
    const { convention } = this.robot;
    if (convention === null || convention === 'standard') return from;
    const axis = joint.axis.clone().applyQuaternion(joint.quaternion);
    return from.addScaledVector(axis, -axis.dot(from));
  }

  private hasShapes(): boolean {
    let found = false;
    this.urdf.traverse((one) => {
      found ||= one instanceof Mesh;
    });
    return found;
  }

  private async showMeshes(
    id: string,
    wanted: readonly WantedMesh[],
    changed: () => void,
  ): Promise<void> {
    const loaded = await loadMeshes(id, wanted, () => !this.isDisposed);
    if (!loaded.length || this.isDisposed) return;
    removeBones(this.urdf);
    for (const { mesh, done } of loaded) done(mesh);
    this.meshes = loaded.length;
    for (const { bar } of this.slides) bar.visible = false;
    changed();
  }
}
