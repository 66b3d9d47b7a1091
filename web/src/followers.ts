/** Joints that follow others: their values, and the limits that theirs put on their leaders. */
import type { TableRow } from './api';
import type { SceneJoint } from './scene/types';
import { typeOf } from './table/convention';

/** `value = multiplier * (value of joint) + offset`, rad and m. */
export interface Follower {
  readonly name: string;
  readonly type: SceneJoint['type'];
  readonly joint: string;
  readonly multiplier: number;
  readonly offset: number;
  readonly lower: number | null;
  readonly upper: number | null;
}

/** The free joint that a follower follows at last, and how. */
function rootOf(follower: Follower, followers: readonly Follower[]): Follower {
  let found = follower;
  for (let count = 0; count < followers.length; count += 1) {
    const leader = followers.find((one) => one.name === found.joint);
    if (!leader) break;
    found = {
      ...found,
      joint: leader.joint,
      multiplier: found.multiplier * leader.multiplier,
      offset: found.offset + found.multiplier * leader.offset,
    };
  }
  return found;
}

/** Value of a follower, rad or m, at a q in rad and m. */
export function followerValue(
  follower: Follower,
  followers: readonly Follower[],
  joints: readonly SceneJoint[],
  q: readonly number[],
): number {
  const { joint, multiplier, offset } = rootOf(follower, followers);
  return multiplier * (q[joints.findIndex((one) => one.name === joint)] ?? 0) + offset;
}

/** The free joints, with limits that keep their followers within theirs. */
export function narrowed(
  joints: readonly SceneJoint[],
  followers: readonly Follower[],
): SceneJoint[] {
  return joints.map((joint) => {
    let lower = joint.lower ?? Number.NEGATIVE_INFINITY;
    let upper = joint.upper ?? Number.POSITIVE_INFINITY;
    for (const one of followers) {
      const root = rootOf(one, followers);
      if (root.joint !== joint.name || root.multiplier === 0) continue;
      const ends = [one.lower, one.upper].flatMap((end) =>
        end === null ? [] : [(end - root.offset) / root.multiplier],
      );
      if (ends.length < 2) continue;
      lower = Math.max(lower, Math.min(...ends));
      upper = Math.min(upper, Math.max(...ends));
    }
    return {
      ...joint,
      lower: Number.isFinite(lower) ? lower : null,
      upper: Number.isFinite(upper) ? upper : null,
    };
  });
}

/** What each row of a table turns or slides by, before sign and offset; rad and m. */
export function rowValues(rows: readonly TableRow[], q: readonly number[]): number[] {
  const free = new Map<string, number>();
  for (const row of rows) {
    if (typeOf(row) !== 'fixed' && !row.mimic) free.set(row.name ?? '', q[free.size] ?? 0);
  }
  const coordinate = (name: string, depth: number): number => {
    const mimic = rows.find((row) => row.name === name)?.mimic;
    if (typeof mimic !== 'object' || depth > rows.length) return free.get(name) ?? 0;
    return (
      Number(mimic.multiplier ?? 1) * coordinate(mimic.joint, depth + 1) + Number(mimic.offset ?? 0)
    );
  };
  return rows.map((row) => {
    const { coupling } = row;
    const others = typeof coupling === 'object' ? Object.entries(coupling) : [];
    return others.reduce(
      (sum, [name, by]) => sum + Number(by) * coordinate(name, 0),
      coordinate(row.name ?? '', 0),
    );
  });
}

/** Followers of a table's rows, in rad and m. */
export function followersOfRows(rows: readonly TableRow[]): Follower[] {
  return rows.flatMap((row): Follower[] => {
    const type = typeOf(row);
    const { mimic } = row;
    if (type === 'fixed' || typeof mimic !== 'object') return [];
    const bound = (value: string | number | undefined): number | null =>
      value === undefined ? null : Number(value);
    return [
      {
        name: row.name ?? '',
        type,
        joint: mimic.joint,
        multiplier: Number(mimic.multiplier ?? 1),
        offset: Number(mimic.offset ?? 0),
        lower: bound(row.limits?.lower),
        upper: bound(row.limits?.upper),
      },
    ];
  });
}
