/**
 * What the page asks of the 3D part and what the 3D part tells the page.
 *
 * Types only, so that the first screen does not load three.js; the implementation is the lazy
 * chunk behind `createScene` in `./index.ts`. Lengths are m and angles rad, everywhere in here.
 * Matrices are 4x4, row by row, as the API gives them; poses and points are in the axes of the
 * robot's base frame.
 */
import type { Convention, Matrix, Obstacle } from '../api';

/** One entry of q. */
export interface SceneJoint {
  readonly name: string;
  readonly type: 'revolute' | 'prismatic' | 'continuous';
  readonly lower: number | null;
  readonly upper: number | null;
}

export interface SceneRobot {
  /** Changes if and only if the model does. */
  readonly key: string;
  readonly urdf: string;
  readonly joints: readonly SceneJoint[];
  readonly baseFrame: string;
  readonly tipFrame: string;
  /** Present where the URDF was written from a table: its frames are `frame_0` … `frame_n`. */
  readonly convention: Convention | null;
  /** Id in the library or among the uploads; null for a table that is not stored. */
  readonly id: string | null;
}

/** A row of the table in numbers, for dimension lines and elementary motions. */
export interface SceneRow {
  readonly name: string;
  readonly type: 'revolute' | 'prismatic' | 'continuous' | 'fixed';
  /** Frame that the row starts from (`frame_{k-1}`, in a tree that of `ant`) and ends in. */
  readonly from: string;
  readonly to: string;
  /** With the present value of the joint in it. Khalil's d is `a` here, his r is `d`. */
  readonly a: number;
  readonly alpha: number;
  readonly d: number;
  readonly theta: number;
  /** Khalil's trees only, else 0. */
  readonly b: number;
  readonly gamma: number;
}

export interface SceneEllipsoid {
  readonly kind: 'velocity' | 'force';
  readonly center: readonly number[];
  /** Unit vectors in base axes, one a row. */
  readonly axes: Matrix;
  /** null: without bound. */
  readonly semiAxes: readonly (number | null)[];
}

export interface SceneGhost {
  readonly q: readonly number[];
  readonly label: string;
  readonly chosen: boolean;
}

/** A direction in which the frame cannot move: linear and angular part, at a point. */
export interface LostDirection {
  readonly at: readonly number[];
  readonly linear: readonly number[];
  readonly angular: readonly number[];
}

export interface ScenePath {
  /** Wanted points of the frame, and those that were reached. */
  readonly wanted: Matrix;
  readonly reached: Matrix;
}

export type FramesShown = 'none' | 'ends' | 'all';

export interface SceneCallbacks {
  /** A joint was moved by the pointer; the page answers by `setQ`. */
  onJointChange(index: number, value: number): void;
  /** The target was dragged; `done` when the pointer is released. */
  onTargetDrag(pose: Matrix, done: boolean): void;
  /** A frame was picked, or none. */
  onFramePick(frame: string | null): void;
  /** A ghost was picked: its index in `setGhosts`. */
  onGhostPick(index: number): void;
}

/** The 3D part. A call with the values that are shown already is cheap; null removes. */
export interface Scene {
  /** Show a robot; the ghosts, rows and target of the one before are removed. */
  setRobot(robot: SceneRobot): void;
  /** One value a joint, in the robot's order; not clamped to limits. */
  setQ(q: readonly number[]): void;
  setFramesShown(shown: FramesShown): void;
  setDimensions(convention: Convention | null, rows: readonly SceneRow[]): void;
  /** Row and how many of its four elementary motions are done (0 to 4). */
  setMotionStep(row: number | null, step: number): void;
  setEllipsoids(ellipsoids: readonly SceneEllipsoid[]): void;
  setGhosts(ghosts: readonly SceneGhost[]): void;
  /** A second robot beside the first, to compare; at its own q. */
  setOther(robot: SceneRobot | null, q: readonly number[]): void;
  setObstacles(obstacles: readonly Obstacle[]): void;
  setPath(path: ScenePath | null): void;
  /** Pose of the draggable target; null hides it. */
  setTarget(pose: Matrix | null): void;
  setLostDirections(directions: readonly LostDirection[]): void;
  /** Points x, y, z, x, y, z … */
  setCloud(points: Float32Array | null): void;
  /** Move the camera so that the robot is in view. */
  fit(): void;
  setTheme(dark: boolean): void;
  dispose(): void;
}

/** Thrown by `createScene` where there is no WebGL: the page shows a picture instead. */
export class NoWebGL extends Error {}
