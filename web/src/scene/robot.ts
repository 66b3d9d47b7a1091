/** A robot in the scene: links by urdf-loader, meshes where the service has them, else bones. */
import {
  Box3,
  BoxGeometry,
  Group,
  LoadingManager,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  type Object3D,
  Vector3,
} from 'three';
import URDFLoader, { type URDFJoint, type URDFRobot } from 'urdf-loader';
import { json, listMeshes, ROOT } from '../api';
import { rod } from './parts';
import { along, cornersOf, pose, release } from './space';
import type { SceneRobot } from './types';

const SLIDE = 0x4a86c5;

interface MeshLine {
  readonly filename: string;
  readonly href: string;
}

/** One robot, its base frame at the origin of `object`. */
export class RobotModel {
  /** Holds the URDF's root so that the base frame is at its origin. */
  readonly object = new Group();
  readonly urdf: URDFRobot;
  readonly robot: SceneRobot;
  /** Number of mesh files that are shown. */
  meshes = 0;
  private gone = false;
  /** A bar for each slide, from where it is at zero to where it is. */
  private readonly slides: { joint: URDFJoint; from: Vector3; bar: Mesh }[] = [];
  /** Size of the shapes that the links have of their own, m. */
  private readonly shapes: number;

  /** `changed` is called as meshes come in. */
  constructor(robot: SceneRobot, changed: () => void) {
    this.robot = robot;
    const loader = new URDFLoader();
    const wanted: { url: string; done: (mesh: Object3D) => void }[] = [];
    loader.packages = (name) => `package://${name}`;
    loader.loadMeshCb = (url, _manager, _material, done) => wanted.push({ url, done });
    this.urdf = loader.parse(robot.urdf);
    for (const joint of Object.values(this.urdf.joints)) {
      joint.ignoreLimits = true;
      // The service has a value of its own for each joint, whether it mimics another or not.
      joint.mimicJoints = [];
    }
    this.object.add(this.urdf);
    this.setQ([]);
    if (wanted.length) {
      this.drawBones();
      // Without them the bones stay.
      if (robot.id)
        void this.loadMeshes(robot.id, wanted, changed).catch((error: unknown) =>
          console.warn(error),
        );
    } else if (!this.hasShapes()) {
      this.drawBones();
    }
    this.shapes = new Box3().setFromPoints(cornersOf(this.object)).getSize(new Vector3()).length();
    this.addSlides();
  }

  /** One value a joint, rad and m; joints without one stay. */
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
    // The base frame may be carried by joints itself: everything else then moves about it.
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

  /** About how far it reaches, m; of an arm without lengths its joints are all that is seen. */
  extent(): number {
    const { x, y, z } = this.box().expandByPoint(new Vector3()).getSize(new Vector3());
    return Math.max(x, y, z, 0.3 * this.shapes, 1e-6);
  }

  /** Length of the axes of its frames: clear of the next frame where links are short, m. */
  axisLength(): number {
    const extent = this.extent();
    const lengths = Object.values(this.urdf.joints)
      .map((joint) => joint.position.length())
      .filter((one) => one > 0.02 * extent);
    const middle = lengths.sort((a, b) => a - b)[Math.floor(lengths.length / 2)] ?? extent;
    return Math.min(0.1 * extent, Math.max(0.5 * middle, 0.04 * extent));
  }

  /** Makes everything see-through and of one colour. */
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
    this.gone = true;
    release(this.object);
    this.object.removeFromParent();
  }

  private addSlides(): void {
    for (const joint of Object.values(this.urdf.joints)) {
      if (joint.jointType !== 'prismatic' || !joint.parent) continue;
      const bar = new Mesh(new BoxGeometry(1, 1, 1), new MeshLambertMaterial({ color: SLIDE }));
      bar.visible = false;
      joint.parent.add(bar);
      this.slides.push({ joint, from: joint.position.clone(), bar });
    }
  }

  private hasShapes(): boolean {
    let found = false;
    this.urdf.traverse((one) => {
      found ||= one instanceof Mesh;
    });
    return found;
  }

  /** A rod from each link's frame to those of its children. */
  private drawBones(): void {
    const size = this.box().getSize(new Vector3()).length();
    for (const joint of Object.values(this.urdf.joints)) {
      const parent = joint.parent;
      if (!parent) continue;
      const bone = rod(new Vector3(), joint.position, 0.008 * size, 0x7a8794);
      bone.userData['bone'] = true;
      parent.add(bone);
      if (joint.jointType !== 'fixed') {
        const axis = joint.axis.clone().multiplyScalar(0.03 * size);
        const drum = rod(axis.clone().negate(), axis, 0.014 * size, 0x2f3b47);
        drum.userData['bone'] = true;
        joint.add(drum);
      }
    }
  }

  private dropBones(): void {
    const found: Object3D[] = [];
    this.urdf.traverse((one) => {
      if (one.userData['bone']) found.push(one);
    });
    for (const one of found) {
      one.removeFromParent();
      release(one);
    }
  }

  private async loadMeshes(
    id: string,
    wanted: readonly { url: string; done: (mesh: Object3D) => void }[],
    changed: () => void,
  ): Promise<void> {
    const { meshes } = await json<{ meshes: MeshLine[] }>(listMeshes(id));
    const hrefs = new Map(meshes.map((one) => [named(one.filename), one.href]));
    const known = wanted.filter((one) => hrefs.has(named(one.url)));
    if (!known.length || this.gone) return;
    const loaded = await Promise.all(
      known.map(async ({ url, done }) => {
        const mesh = await meshAt(hrefs.get(named(url)) ?? '');
        return { mesh, done };
      }),
    );
    if (this.gone) return;
    this.dropBones();
    for (const { mesh, done } of loaded) done(mesh);
    this.meshes = loaded.length;
    for (const { bar } of this.slides) bar.visible = false;
    changed();
  }
}

/** A package's path without its leading parts, which loaders write differently. */
function named(url: string): string {
  return url.replace(/^package:\/+/, '').replace(/^\/+/, '');
}

async function meshAt(href: string): Promise<Object3D> {
  const url = new URL(href, ROOT).href;
  const suffix = href.toLowerCase().split('.').at(-1);
  if (suffix === 'stl') {
    const { STLLoader } = await import('three/examples/jsm/loaders/STLLoader.js');
    return new Mesh(
      await new STLLoader().loadAsync(url),
      new MeshLambertMaterial({ color: 0xb8c0c8 }),
    );
  }
  // Textures and material files are not served: nothing but the mesh itself is asked for.
  const manager = new LoadingManager();
  manager.setURLModifier((asked) => (asked === url ? asked : BLANK));
  if (suffix === 'obj') {
    const { OBJLoader } = await import('three/examples/jsm/loaders/OBJLoader.js');
    return new OBJLoader(manager).loadAsync(url);
  }
  const { ColladaLoader } = await import('three/examples/jsm/loaders/ColladaLoader.js');
  const text = await (await fetch(url)).text();
  // URDF counts in the file's own axes; the loader would turn those with z upwards.
  const found = new ColladaLoader(manager).parse(text.replace('>Z_UP<', '>Y_UP<'), '');
  const scene = (found as { scene: Object3D }).scene;
  for (const light of scene.children.filter((one) => 'isLight' in one || 'isCamera' in one))
    scene.remove(light);
  return scene;
}

const BLANK =
  'data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mP8/x8AAwMCAO+ip1sAAAAASUVORK5CYII=';
