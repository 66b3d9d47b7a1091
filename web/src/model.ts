/** A robot on the page: where it comes from, and as the service has resolved it. */
import type { Convention, RobotRef, TableDocument } from './api';
import type { Follower } from './followers';
import type { SceneJoint } from './scene/types';
import { typeOf } from './table/convention';

/** Where a robot comes from: stored on the service, or only in this page. */
export type Source =
  | { readonly kind: 'stored'; readonly id: string; readonly convention: Convention | null }
  | { readonly kind: 'table'; readonly table: TableDocument }
  | { readonly kind: 'urdf'; readonly name: string; readonly urdf: string };

export interface Model {
  readonly key: string;
  /** How computations name it. */
  readonly ref: RobotRef;
  readonly title: string;
  readonly kind: 'dh' | 'urdf';
  /** The entries of q; limits are rad and m. */
  readonly joints: readonly SceneJoint[];
  /** Joints that follow those of q. */
  readonly followers: readonly Follower[];
  readonly urdf: string;
  /** The table as it is shown and edited. */
  readonly table: TableDocument | null;
  /** The same in numbers, rad and m, with offsets in a column of their own. */
  readonly rows: TableDocument | null;
  readonly baseFrame: string;
  readonly tipFrame: string;
  /** What the service found doubtful when it was stored. */
  readonly warnings: readonly string[];
}

/** The task that an arm is asked for first: with fewer than six joints it cannot reach any pose. */
export function defaultTask({ joints, rows }: Model): string {
  if (joints.length >= 6) return 'pose';
  const isPlanar = rows?.joints.every(
    (row) => Number(row.alpha ?? 0) === 0 && typeOf(row) !== 'prismatic',
  );
  return isPlanar && joints.length > 1 ? 'xy' : 'position';
}
