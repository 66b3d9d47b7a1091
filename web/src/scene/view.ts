/** The scene: the robot, and what is shown with it, in layers. */
import {
  AmbientLight,
  DirectionalLight,
  Group,
  HemisphereLight,
  Scene as ThreeScene,
  Vector3,
} from 'three';
import { Annotations } from './annotations';
import { Canvas } from './canvas';
import { Ghosts } from './ghosts';
import { drawGround } from './ground';
import { Interaction } from './interaction';
import type { Placed } from './labels';
import { drawCloud, drawEllipsoids, drawLost, drawObstacles, drawPath } from './overlays';
import type { Scale } from './parts';
import { planeNormal } from './plane';
import { probeOf } from './probe';
import { RobotModel } from './robot';
import { pointsToSee } from './seen';
import { matrix4 } from './space';
import type { FramesShown, Scene, SceneCallbacks, SceneGhost, SceneRobot, SceneRow } from './types';
import { newCamera, Viewpoint } from './viewpoint';

const OTHER = { color: 0xd0762b, opacity: 0.35 };

export class View implements Scene {
  private readonly world = new ThreeScene();
  private readonly layers = {
    ground: new Group(),
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
  private readonly annotations = new Annotations(this.layers);
  private readonly canvas: Canvas;
  private readonly viewpoint: Viewpoint;
  private readonly ghosts: Ghosts;
  private readonly interaction: Interaction;
  private model: RobotModel | null = null;
  private other: RobotModel | null = null;
  private obstaclesKey = '';
  private path: Parameters<Scene['setPath']>[0] = null;
  private scale: Scale = { axis: 0.1 };
  private dark = false;
  /** Whether the robot is new: its first configuration is brought into view. */
  private isNew = false;

  constructor(host: HTMLElement, callbacks: SceneCallbacks) {
    const { world, layers } = this;
    const { handle } = this.annotations;
    world.add(...lights(), ...Object.values(layers), handle);
    const camera = newCamera();
    this.canvas = new Canvas(host, world, camera, handle, () => {
      this.fitUnlessChosen();
      this.draw();
    });
    const { element, draw } = this.canvas;
    this.viewpoint = new Viewpoint(host, element, camera, draw);
    this.ghosts = new Ghosts(layers.ghosts, draw);
    const around = {
      handle,
      model: () => this.model,
      target: () => this.annotations.target ?? this.model?.tipPose() ?? null,
      ghosts: () => this.ghosts.models,
    };
    const { controls } = this.viewpoint;
    this.interaction = new Interaction(element, camera, controls, around, callbacks);
    const labels = (): readonly Placed[] => this.canvas.labels;
    Object.assign(host, { probe: probeOf({ ...around, canvas: element, camera, layers, labels }) });
  }

  setRobot(robot: SceneRobot): void {
    const before = this.model;
    if (before?.robot.key === robot.key && before.robot.id === robot.id) return;
    this.model = new RobotModel(robot, () => this.redraw());
    before?.dispose();
    this.layers.robot.add(this.model.object);
    this.annotations.target = null;
    this.annotations.rows = [];
    this.ghosts.clear();
    // While a table is edited the reader's standpoint stays; for another robot it does not.
    const axis = this.model.axisLength();
    const isOther = robot.id !== null && robot.id !== before?.robot.id;
    if (isOther || axis > 2 * this.scale.axis || axis < this.scale.axis / 2) {
      this.viewpoint.isChosen = false;
    }
    this.rescale(axis);
    this.refresh();
    this.isNew = true;
  }

  setQ(q: readonly number[]): void {
    this.model?.setQ(q);
    // Prismatic joints make an arm longer than it was at first.
    const axis = this.model?.axisLength() ?? 0;
    const hasGrown = axis > 2 * this.scale.axis;
    if (this.isNew || hasGrown) this.rescale(axis);
    this.refresh();
    if (this.isNew || hasGrown || this.isTipOutside()) this.fitUnlessChosen();
    this.isNew = false;
  }

  setFramesShown(shown: FramesShown): void {
    this.annotations.framesShown = shown;
    this.refresh();
  }

  setDimensions(convention: SceneRobot['convention'], rows: readonly SceneRow[]): void {
    this.annotations.convention = convention;
    this.annotations.rows = rows;
    this.refresh();
  }

  setMotionStep(row: number | null, step: number): void {
    this.annotations.motion = { row, step };
    this.refresh();
  }

  setEllipsoids(ellipsoids: Parameters<Scene['setEllipsoids']>[0]): void {
    drawEllipsoids(this.layers.ellipsoids, ellipsoids, this.scale);
    this.draw();
  }

  setGhosts(ghosts: readonly SceneGhost[]): void {
    if (!this.model) return;
    if (this.ghosts.show(this.model.robot, ghosts, this.dark)) this.fitUnlessChosen();
    this.draw();
  }

  setOther(robot: SceneRobot | null, q: readonly number[]): void {
    if (this.other && this.other.robot.key !== robot?.key) {
      this.other.dispose();
      this.other = null;
    }
    if (robot && !this.other) {
      const other = new RobotModel(robot, () => {
        other.tint(OTHER.color, OTHER.opacity);
        this.draw();
      });
      other.tint(OTHER.color, OTHER.opacity);
      this.layers.other.add(other.object);
      this.other = other;
    }
    this.other?.setQ(q);
    this.draw();
  }

  setObstacles(obstacles: Parameters<Scene['setObstacles']>[0]): void {
    const key = JSON.stringify([this.model?.robot.key, obstacles]);
    if (key === this.obstaclesKey) return;
    this.obstaclesKey = key;
    drawObstacles(this.layers.obstacles, obstacles, this.model?.extent() ?? 1);
    this.draw();
  }

  setPath(path: Parameters<Scene['setPath']>[0]): void {
    if (path === this.path) return;
    this.path = path;
    drawPath(this.layers.path, path, this.scale, this.dark);
    if (path) this.fitUnlessChosen();
    this.draw();
  }

  setTarget(target: Parameters<Scene['setTarget']>[0]): void {
    this.annotations.target = target && matrix4(target);
    this.refresh();
  }

  setLostDirections(directions: Parameters<Scene['setLostDirections']>[0]): void {
    drawLost(this.layers.lost, directions, this.scale, this.dark);
    this.draw();
  }

  setCloud(points: Float32Array | null): void {
    drawCloud(this.layers.cloud, points, this.scale);
    if (points) this.fitUnlessChosen();
    this.draw();
  }

  fit(): void {
    if (!this.model) return;
    const points = pointsToSee(this.model, this.layers, this.scale);
    this.viewpoint.fit(points, planeNormal(this.model));
  }

  setTheme(dark: boolean): void {
    if (dark === this.dark && this.layers.ground.children.length) return;
    this.dark = dark;
    this.rescale(this.scale.axis);
    drawPath(this.layers.path, this.path, this.scale, dark);
    this.refresh();
  }

  dispose(): void {
    this.interaction.dispose();
    this.viewpoint.dispose();
    this.canvas.dispose();
  }

  private draw(): void {
    this.canvas.draw();
  }

  private fitUnlessChosen(): void {
    if (!this.viewpoint.isChosen) this.fit();
  }

  /** Draw what depends on the size of the robot: frames at the next refresh, the ground now. */
  private rescale(axis: number): void {
    this.scale = { axis };
    this.annotations.reset();
    drawGround(this.layers.ground, this.model?.extent() ?? 1, this.dark);
  }

  /** Draw the frames anew, too. */
  private redraw(): void {
    this.annotations.reset();
    this.refresh();
  }

  /** Draw what depends on the configuration. */
  private refresh(): void {
    if (!this.model) return;
    this.annotations.draw(this.model, this.scale, this.dark);
    this.draw();
  }

  private isTipOutside(): boolean {
    const tip = this.model?.tipPose() ?? null;
    return tip !== null && this.viewpoint.isOutside(new Vector3().setFromMatrixPosition(tip));
  }
}

function lights(): (AmbientLight | HemisphereLight | DirectionalLight)[] {
  const sun = new DirectionalLight(0xffffff, 1.6);
  sun.position.set(2, -3, 5);
  return [new AmbientLight(0xffffff, 0.7), new HemisphereLight(0xffffff, 0xb0b8c0, 0.9), sun];
}
