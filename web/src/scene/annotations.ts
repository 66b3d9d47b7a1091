/** What is drawn at the frames of the robot: axes, dimensions, a row's motions, the target. */
import { type Group, type Matrix4, Mesh, MeshBasicMaterial, SphereGeometry } from 'three';
import type { Convention } from '../api';
import { Frames } from './frames';
import { axes, COLORS, type Scale } from './parts';
import type { RobotModel } from './robot';
import { drawDimensions, drawMotion } from './rows';
import { clear, pose } from './space';
import type { FramesShown, SceneRow } from './types';

interface Layers {
  readonly dimensions: Group;
  readonly motion: Group;
  readonly target: Group;
}

/** What is shown; the scene changes it and then calls `draw`. */
export class Annotations {
  framesShown: FramesShown = 'all';
  convention: Convention | null = null;
  rows: readonly SceneRow[] = [];
  /** The row that is shown by its motions, and how many of them are done. */
  motion: { readonly row: number | null; readonly step: number } = { row: null, step: 0 };
  target: Matrix4 | null = null;
  /** The ball that is dragged: at the target, else at the tool. */
  readonly handle = newHandle();
  private readonly frames = new Frames();
  /** What the frames were drawn for. */
  private framesKey = '';

  constructor(private readonly layers: Layers) {}

  /** Draw the frames anew, too, the next time. */
  reset(): void {
    this.framesKey = '';
  }

  draw(model: RobotModel, scale: Scale, dark: boolean): void {
    const { row: index, step } = this.motion;
    const row = index === null ? undefined : this.rows[index];
    this.drawFrames(model, row, scale, dark);
    this.drawRows(model, row, step, scale, dark);
    this.drawTarget(model, scale);
  }

  /** With a row shown by its motions: its two frames and no others. */
  private drawFrames(
    model: RobotModel,
    row: SceneRow | undefined,
    scale: Scale,
    dark: boolean,
  ): void {
    const frames = row && this.framesShown !== 'none' ? [row.from, row.to] : this.framesShown;
    const key = `${model.robot.key} ${String(frames)} ${dark}`;
    if (key === this.framesKey) return;
    this.framesKey = key;
    this.frames.show(model, frames, scale, dark);
  }

  private drawRows(
    model: RobotModel,
    row: SceneRow | undefined,
    step: number,
    scale: Scale,
    dark: boolean,
  ): void {
    const { layers, convention, rows } = this;
    clear(layers.dimensions);
    clear(layers.motion);
    if (!convention) return;
    const start = (name: string): Matrix4 | null => model.poseOf(name);
    drawDimensions(layers.dimensions, convention, row ? [] : rows, start, scale, dark);
    const from = row && start(row.from);
    if (row && from) drawMotion(layers.motion, convention, row, step, from, scale, dark);
  }

  private drawTarget(model: RobotModel, { axis }: Scale): void {
    clear(this.layers.target);
    const at = this.target ?? model.tipPose();
    this.handle.visible = at !== null;
    if (!at) return;
    this.handle.position.setFromMatrixPosition(at);
    this.handle.scale.setScalar(0.13 * axis);
    if (!this.target) return;
    const triad = axes(1.1 * axis, 0.55);
    pose(triad, this.target);
    this.layers.target.add(triad);
  }
}

function newHandle(): Mesh {
  const material = new MeshBasicMaterial({
    color: COLORS.target,
    transparent: true,
    opacity: 0.85,
    depthTest: false,
  });
  const handle = new Mesh(new SphereGeometry(1, 20, 14), material);
  handle.renderOrder = 9;
  handle.visible = false;
  return handle;
}
