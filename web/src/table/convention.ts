/** The D-H conventions: columns, elementary motions, the column of a joint's variable. */
import type { Convention, JointType, TableRow } from '../api';

/** Columns of a convention, in the order of its link matrix. */
export const COLUMNS = {
  standard: ['theta', 'd', 'a', 'alpha'],
  modified: ['alpha', 'a', 'd', 'theta'],
  khalil: ['alpha', 'd', 'theta', 'r'],
} as const satisfies Record<Convention, readonly (keyof TableRow)[]>;

export type Column = 'theta' | 'd' | 'a' | 'alpha' | 'r';

/** The elementary motions of A_k: about or along which axis, and by which column. */
export const MOTIONS: Record<
  Convention,
  readonly { name: string; axis: 'x' | 'z'; column: Column }[]
> = {
  standard: [
    { name: 'Rz', axis: 'z', column: 'theta' },
    { name: 'Tz', axis: 'z', column: 'd' },
    { name: 'Tx', axis: 'x', column: 'a' },
    { name: 'Rx', axis: 'x', column: 'alpha' },
  ],
  modified: [
    { name: 'Tx', axis: 'x', column: 'a' },
    { name: 'Rx', axis: 'x', column: 'alpha' },
    { name: 'Rz', axis: 'z', column: 'theta' },
    { name: 'Tz', axis: 'z', column: 'd' },
  ],
  khalil: [
    { name: 'Rx', axis: 'x', column: 'alpha' },
    { name: 'Tx', axis: 'x', column: 'd' },
    { name: 'Rz', axis: 'z', column: 'theta' },
    { name: 'Tz', axis: 'z', column: 'r' },
  ],
};

export const SYMBOLS: Record<Column, string> = { theta: 'θ', d: 'd', a: 'a', alpha: 'α', r: 'r' };

const TYPES: Record<string, JointType> = {
  r: 'revolute',
  revolute: 'revolute',
  p: 'prismatic',
  prismatic: 'prismatic',
  c: 'continuous',
  continuous: 'continuous',
  f: 'fixed',
  fixed: 'fixed',
};

export function typeOf(row: TableRow): JointType {
  return TYPES[(row.type ?? '').toLowerCase()] ?? 'revolute';
}

/** The column of a joint's variable; null for a fixed row. */
export function ownColumn(row: TableRow, convention: Convention): Column | null {
  const type = typeOf(row);
  if (type === 'fixed') return null;
  if (type === 'prismatic') return convention === 'khalil' ? 'r' : 'd';
  return 'theta';
}
