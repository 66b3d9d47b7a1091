/** The 3D part: a lazy chunk with three.js and urdf-loader. */
import {
  AmbientLight,
  Color,
  DirectionalLight,
  GridHelper,
  Group,
  HemisphereLight,
  type Matrix4,
  Mesh,
  MeshBasicMaterial,
  Object3D,
  PerspectiveCamera,
  Points,
  Quaternion,
  SphereGeometry,
  Spherical,
  Scene as ThreeScene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { standpoint } from './fit';
import { Frames } from './frames';
import { Hand } from './hand';
import { layOut, type Placed } from './labels';
import { drawCloud, drawEllipsoids, drawLost, drawObstacles, drawPath } from './overlays';
import { axes, COLORS, label, type Scale } from './parts';
import { probeOf } from './probe';
import { RobotModel } from './robot';
import { drawDimensions, drawMotion } from './rows';
import { clear, cornersOf, matrix4, pose } from './space';
import {
  type FramesShown,
  NoWebGL,
  type Scene,
  type SceneCallbacks,
  type SceneGhost,
  type SceneRobot,
  type SceneRow,
} from './types';

const FIELD = 40;
const TURN = Math.PI / 24;
const NEARER = 0.87;
/** What a key does: turns to the left and upwards, rad, and how many times farther it goes. */
const KEYS: Readonly<Record<string, readonly [number, number, number]>> = {
  ArrowLeft: [-TURN, 0, 1],
  ArrowRight: [TURN, 0, 1],
  ArrowUp: [0, TURN, 1],
  ArrowDown: [0, -TURN, 1],
  '+': [0, 0, NEARER],
  '=': [0, 0, NEARER],
  '-': [0, 0, 1 / NEARER],
};

/**
 * Creates the scene in a host element, which it fills.
 *
 * @throws NoWebGL where the browser gives no WebGL context.
 */
export function createScene(host: HTMLElement, callbacks: SceneCallbacks): Scene {
  Object3D.DEFAULT_UP.set(0, 0, 1);
  return new View(host, callbacks);
}

class View implements Scene {
  private readonly renderer = newRenderer();
  private readonly world = new ThreeScene();
  private readonly camera = new PerspectiveCamera(FIELD, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly hand: Hand;
  private readonly observer: ResizeObserver;
  private readonly layers = {
    grid: new Group(),
    robot: new Group(),
    other: new Group(),
    ghosts: new Group(),
    dimensions: new Group(),
    motion: new Group(),
    ellipsoids: new Group(),
    lost: new Group(),
    obstacles: new Group(),
    path: new Group(),
    cloud: new Group(),
    target: new Group(),
  };
  private readonly handle = new Mesh(
    new SphereGeometry(1, 20, 14),
    new MeshBasicMaterial({
      color: COLORS.target,
      transparent: true,
      opacity: 0.85,
      depthTest: false,
    }),
  );
  private readonly frames = new Frames();
  private model: RobotModel | null = null;
  private other: RobotModel | null = null;
  private ghosts: { key: string; models: RobotModel[] } = { key: '', models: [] };
  private framesShown: FramesShown = 'all';
  private rows: readonly SceneRow[] = [];
  private convention: SceneRobot['convention'] = null;
  private motion: { row: number | null; step: number } = { row: null, step: 0 };
  private target: Matrix4 | null = null;
  private scale: Scale = { axis: 0.1 };
  private dark = false;
  private drawn = '';
  private labels: readonly Placed[] = [];
  private obstacles = '';
  private path: Parameters<Scene['setPath']>[0] = null;
  private requested = 0;
  /** Whether the reader has chosen another standpoint than that of `fit`. */
  private turned = false;
  /** Whether the robot is new: its first posture is brought into view. */
  private unseen = false;

  constructor(
    private readonly host: HTMLElement,
    callbacks: SceneCallbacks,
  ) {
    host.append(this.renderer.domElement);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    const light = new DirectionalLight(0xffffff, 1.6);
    light.position.set(2, -3, 5);
    this.world.add(
      new AmbientLight(0xffffff, 0.7),
      new HemisphereLight(0xffffff, 0xb0b8c0, 0.9),
      light,
    );
    this.world.add(...Object.values(this.layers));
    this.handle.renderOrder = 9;
    this.handle.visible = false;
    this.world.add(this.handle);
    const view = this;
    this.hand = new Hand(
      this.renderer.domElement,
      this.camera,
      this.controls,
      {
        get model() {
          return view.model;
        },
        handle: this.handle,
        targetPose: () => this.target ?? this.tipPose(),
        planeNormal: () => this.planeNormal(),
        get ghosts() {
          return view.ghosts.models.map((one) => one.object);
        },
      },
      callbacks,
    );
    this.controls.addEventListener('change', this.draw);
    this.controls.addEventListener('start', () => (this.turned = true));
    host.tabIndex = 0;
    host.addEventListener('keydown', this.keyed);
    this.observer = new ResizeObserver(this.resize);
    this.observer.observe(host);
    const probe = probeOf({
      canvas: this.renderer.domElement,
      camera: this.camera,
      layers: this.layers,
      handle: this.handle,
      model: () => this.model,
      ghosts: () => this.ghosts.models,
      target: () => this.target ?? this.tipPose(),
      labels: () => this.labels,
    });
    Object.assign(host, { probe });
  }

  setRobot(robot: SceneRobot): void {
    if (this.model?.robot.key === robot.key && this.model.robot.id === robot.id) return;
    const before = this.model;
    this.model = new RobotModel(robot, () => this.robotChanged());
    before?.dispose();
    this.layers.robot.add(this.model.object);
    this.target = null;
    this.rows = [];
    this.ghosts.models.forEach((one) => one.dispose());
    this.ghosts = { key: '', models: [] };
    const axis = this.model.axisLength();
    // While a table is being typed the reader's standpoint stays; for another robot it does not.
    const isOther = robot.id !== null && robot.id !== before?.robot.id;
    if (isOther || axis > 2 * this.scale.axis || axis < this.scale.axis / 2) this.turned = false;
    this.scale = { axis };
    this.drawn = '';
    this.drawGrid();
    this.robotChanged();
    this.unseen = true;
  }

  setQ(q: readonly number[]): void {
    this.model?.setQ(q);
    const axis = this.model?.axisLength() ?? 0;
    // Slides make an arm longer than it was at first.
    const grown = axis > 2 * this.scale.axis;
    if (this.unseen || grown) {
      this.scale = { axis };
      this.drawn = '';
      this.drawGrid();
    }
    this.refresh();
    if ((this.unseen || grown || this.isTipOutside()) && !this.turned) this.fit();
    this.unseen = false;
  }

  setFramesShown(shown: FramesShown): void {
    this.framesShown = shown;
    this.refresh();
  }

  setDimensions(convention: SceneRobot['convention'], rows: readonly SceneRow[]): void {
    this.convention = convention;
    this.rows = rows;
    this.refresh();
  }

  setMotionStep(row: number | null, step: number): void {
    this.motion = { row, step };
    this.refresh();
  }

  setEllipsoids(ellipsoids: Parameters<Scene['setEllipsoids']>[0]): void {
    drawEllipsoids(this.layers.ellipsoids, ellipsoids, this.scale);
    this.draw();
  }

  setGhosts(ghosts: readonly SceneGhost[]): void {
    const key = JSON.stringify([this.model?.robot.key, ghosts]);
    if (key === this.ghosts.key || !this.model) return;
    const { robot } = this.model;
    this.ghosts.models.forEach((one) => one.dispose());
    clear(this.layers.ghosts);
    const models = ghosts.map((ghost) => {
      const model = new RobotModel({ ...robot, id: null }, this.draw);
      model.setQ(ghost.q);
      model.tint(ghost.chosen ? 0x2b7fd0 : COLORS.ghost, ghost.chosen ? 0.12 : 0.28);
      this.layers.ghosts.add(model.object);
      const tip = model.poseOf(robot.tipFrame);
      if (tip && !ghost.chosen) {
        const elbow = middleOf(model);
        this.layers.ghosts.add(label(ghost.label, elbow, 0x566070, this.dark));
      }
      return model;
    });
    const more = models.length > this.ghosts.models.length;
    this.ghosts = { key, models };
    if (more && !this.turned) this.fit();
    this.draw();
  }

  setOther(robot: SceneRobot | null, q: readonly number[]): void {
    if (!robot) {
      this.other?.dispose();
      this.other = null;
    } else {
      if (this.other?.robot.key !== robot.key) {
        this.other?.dispose();
        const other = new RobotModel(robot, () => {
          other.tint(0xd0762b, 0.35);
          this.draw();
        });
        this.other = other;
        this.layers.other.add(other.object);
      }
      this.other.setQ(q);
      this.other.tint(0xd0762b, 0.35);
    }
    this.draw();
  }

  setObstacles(obstacles: Parameters<Scene['setObstacles']>[0]): void {
    const key = JSON.stringify([this.model?.robot.key, obstacles]);
    if (key === this.obstacles) return;
    this.obstacles = key;
    drawObstacles(this.layers.obstacles, obstacles, this.model?.extent() ?? 1);
    this.draw();
  }

  setPath(path: Parameters<Scene['setPath']>[0]): void {
    if (path?.reached === this.path?.reached && path?.wanted === this.path?.wanted) return;
    this.path = path;
    drawPath(this.layers.path, path, this.scale, this.dark);
    if (path && !this.turned) this.fit();
    this.draw();
  }

  setTarget(target: Parameters<Scene['setTarget']>[0]): void {
    this.target = target && matrix4(target);
    this.refresh();
  }

  setLostDirections(directions: Parameters<Scene['setLostDirections']>[0]): void {
    drawLost(this.layers.lost, directions, this.scale, this.dark);
    this.draw();
  }

  setCloud(points: Float32Array | null): void {
    drawCloud(this.layers.cloud, points, this.scale);
    if (points && !this.turned) this.fit();
    this.draw();
  }

  fit(): void {
    if (!this.model) return;
    this.turned = false;
    const normal = this.planeNormal();
    const from = normal ?? new Vector3(0.75, -0.85, 0.5).normalize();
    // Straight from above there is no "up" for the camera's turning: a very little from the side.
    if (normal && Math.abs(normal.z) > 0.99)
      from.set(0, -0.01, Math.sign(normal.z) || 1).normalize();
    const { clientWidth: width, clientHeight: height } = this.host;
    const { position, target, distance } = standpoint(
      this.seen(),
      from,
      this.camera,
      width || 1,
      height || 1,
    );
    this.controls.target.copy(target);
    this.camera.position.copy(position);
    this.camera.near = distance / 100;
    this.camera.far = distance * 30;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  setTheme(dark: boolean): void {
    if (dark === this.dark && this.layers.grid.children.length) return;
    this.dark = dark;
    this.drawn = '';
    this.drawGrid();
    drawPath(this.layers.path, this.path, this.scale, dark);
    this.refresh();
  }

  dispose(): void {
    this.host.removeEventListener('keydown', this.keyed);
    this.hand.dispose();
    this.observer.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.domElement.remove();
  }

  private robotChanged(): void {
    this.drawn = '';
    this.refresh();
  }

  /** Draws what depends on the posture. */
  private refresh(): void {
    const { model, scale, dark } = this;
    if (!model) return;
    const start = (name: string): Matrix4 | null => model.poseOf(name);
    const { row, step } = this.motion;
    const one = row === null ? undefined : this.rows[row];
    // A row that is shown in its motions has the view to itself: its two frames and no others.
    const frames = one && this.framesShown !== 'none' ? [one.from, one.to] : this.framesShown;
    const wanted = `${model.robot.key} ${String(frames)} ${dark}`;
    if (wanted !== this.drawn) {
      this.frames.show(model, frames, scale, dark);
      this.drawn = wanted;
    }
    if (this.convention) {
      drawDimensions(
        this.layers.dimensions,
        this.convention,
        one ? [] : this.rows,
        start,
        scale,
        dark,
      );
      const from = one && start(one.from);
      if (one && from)
        drawMotion(this.layers.motion, this.convention, one, step, from, scale, dark);
      else clear(this.layers.motion);
    } else {
      clear(this.layers.dimensions);
      clear(this.layers.motion);
    }
    this.drawTarget();
    this.draw();
  }

  private drawTarget(): void {
    clear(this.layers.target);
    const at = this.target ?? this.tipPose();
    this.handle.visible = at !== null;
    if (!at) return;
    this.handle.position.setFromMatrixPosition(at);
    this.handle.scale.setScalar(0.13 * this.scale.axis);
    if (this.target) {
      const triad = axes(1.1 * this.scale.axis, 0.55);
      pose(triad, this.target);
      this.layers.target.add(triad);
    }
  }

  private tipPose(): Matrix4 | null {
    return this.model?.poseOf(this.model.robot.tipFrame) ?? null;
  }

  /** Whether the tool has left the view; never while a hand holds it. */
  private isTipOutside(): boolean {
    const tip = this.tipPose();
    if (!tip || !this.controls.enabled) return false;
    const { x, y } = new Vector3().setFromMatrixPosition(tip).project(this.camera);
    return Math.max(Math.abs(x), Math.abs(y)) > 1;
  }

  /** The direction that all turning axes have, where no slide goes along it. */
  private planeNormal(): Vector3 | null {
    const { model } = this;
    if (!model) return null;
    let normal: Vector3 | null = null;
    for (const { name, type } of model.robot.joints) {
      const joint = model.urdf.joints[name];
      if (!joint) return null;
      const axis = joint.axis.clone().transformDirection(joint.matrixWorld);
      if (type === 'prismatic') {
        if (normal && Math.abs(axis.dot(normal)) > 1e-6) return null;
      } else if (!normal) normal = axis;
      else if (Math.abs(Math.abs(axis.dot(normal)) - 1) > 1e-9) return null;
    }
    return normal && normal.z < -0.5 ? normal.negate() : normal;
  }

  /** Points that are to be in view: the robot with its axes, and what is shown around it. */
  private seen(): Vector3[] {
    const { model, layers, scale } = this;
    const points = [new Vector3()];
    const shown = [
      layers.ghosts,
      layers.other,
      layers.ellipsoids,
      layers.lost,
      layers.path,
      layers.target,
    ];
    points.push(...[...(model ? [model.object] : []), ...shown].flatMap(cornersOf));
    layers.cloud.traverse((one) => {
      if (one instanceof Points) points.push(...sampled(one));
    });
    for (const name of model?.frames ?? []) {
      const at = model?.poseOf(name);
      if (!at) continue;
      const origin = new Vector3().setFromMatrixPosition(at);
      for (const k of [0, 1, 2]) {
        points.push(
          origin
            .clone()
            .addScaledVector(new Vector3().setFromMatrixColumn(at, k), 1.2 * scale.axis),
        );
        points.push(
          origin
            .clone()
            .addScaledVector(new Vector3().setFromMatrixColumn(at, k), -0.4 * scale.axis),
        );
      }
    }
    return points;
  }

  /** Squares of a round size on the ground. */
  private drawGrid(): void {
    clear(this.layers.grid);
    const extent = this.model?.extent() ?? 1;
    const cell = 10 ** Math.floor(Math.log10(extent / 2));
    const count = 2 * Math.ceil((1.4 * extent) / cell);
    const [major, minor] = this.dark ? [0x59636f, 0x2b323b] : [0xa4adb8, 0xe1e5ea];
    const grid = new GridHelper(count * cell, count, new Color(major), new Color(minor));
    grid.rotation.x = Math.PI / 2;
    grid.position.z = -1e-4 * extent;
    this.layers.grid.add(grid);
  }

  private readonly draw = (): void => {
    if (this.requested) return;
    this.requested = requestAnimationFrame(() => {
      this.requested = 0;
      this.world.updateMatrixWorld();
      this.camera.updateMatrixWorld();
      this.labels = layOut(
        this.world,
        this.camera,
        this.host.clientWidth,
        this.host.clientHeight,
        this.handle,
      );
      this.renderer.render(this.world, this.camera);
    });
  };

  /** Arrow keys turn the view, + and - bring it nearer and farther. */
  private readonly keyed = (event: KeyboardEvent): void => {
    const { camera, controls } = this;
    const [left, up, farther] = KEYS[event.key] ?? [];
    if (left === undefined || up === undefined || farther === undefined) return;
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const upright = new Quaternion().setFromUnitVectors(camera.up, new Vector3(0, 1, 0));
    const away = camera.position.clone().sub(controls.target).applyQuaternion(upright);
    const at = new Spherical().setFromVector3(away);
    at.set(at.radius * farther, at.phi - up, at.theta + left).makeSafe();
    camera.position.setFromSpherical(at).applyQuaternion(upright.invert()).add(controls.target);
    this.turned = true;
    controls.update();
    this.draw();
  };

  private readonly resize = (): void => {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.turned) this.fit();
    this.draw();
  };
}

/** Some points of a cloud, enough to see how far it goes. */
function sampled(cloud: Points): Vector3[] {
  const places = cloud.geometry.getAttribute('position');
  const step = Math.max(1, Math.floor(places.count / 2000));
  return Array.from({ length: Math.floor(places.count / step) }, (_, k) =>
    new Vector3().fromBufferAttribute(places, k * step),
  );
}

/** A point of the posture halfway along its joints, where postures differ most. */
function middleOf(model: RobotModel): Vector3 {
  const { joints } = model.robot;
  const joint = model.urdf.joints[joints[Math.floor(joints.length / 2)]?.name ?? ''];
  return joint?.getWorldPosition(new Vector3()) ?? new Vector3();
}

function newRenderer(): WebGLRenderer {
  try {
    return new WebGLRenderer({ antialias: true, alpha: true });
  } catch (error) {
    throw new NoWebGL(String(error));
  }
}
