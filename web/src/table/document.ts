/** Changes of a table as it was typed: pure functions on the document that the service takes. */
import type { AngleUnit, Cell, Convention, JointType, TableDocument, TableRow } from '../api';
import { COLUMNS, ownColumn, typeOf } from './convention';

/** `q3`, `-q3 + 90`: a variable with its constant, as it stands in a cell. */
export function variableCell(index: number, sign: number, constant: Cell): string {
  const variable = `${sign < 0 ? '-' : ''}q${index + 1}`;
  const text = String(constant).trim();
  if (text === '' || Number(text) === 0) return variable;
  if (/^-/.test(text)) return `${variable} - ${text.slice(1).trim()}`;
  return `${variable} + ${text}`;
}

export function setCell(
  document: TableDocument,
  index: number,
  field: keyof TableRow,
  value: Cell,
): TableDocument {
  return withRow(document, index, (row) => ({ ...row, [field]: value }));
}

export function setLimit(
  document: TableDocument,
  index: number,
  bound: 'lower' | 'upper',
  value: Cell,
): TableDocument {
  return withRow(document, index, (row) => ({ ...row, limits: { ...row.limits, [bound]: value } }));
}

/** Change a joint's type: the variable moves to its column, its constant stays. */
export function setType(document: TableDocument, index: number, type: JointType): TableDocument {
  return withRow(document, index, (row) => {
    const { convention } = document;
    const before = ownColumn(row, convention);
    const next: TableRow = { ...row, type };
    const after = ownColumn(next, convention);
    if (before === after) return next;
    delete next.limits;
    if (before) next[before] = constantOf(row[before]);
    if (after) next[after] = variableCell(index, 1, next[after] ?? 0);
    return next;
  });
}

/** A cell without its variable: `q2 - pi/2` -> `-pi/2`. */
export function constantOf(cell: Cell | undefined): string {
  const text = String(cell ?? '')
    .replace(/[+-]?\s*(?:q|θ|theta)_?\d*/i, '')
    .trim();
  return text.replace(/^\+\s*/, '').replace(/^-\s+/, '-') || '0';
}

export function addRow(document: TableDocument, after: number): TableDocument {
  const { convention, joints } = document;
  const row: TableRow = { name: freeName(joints), type: 'revolute' };
  for (const column of COLUMNS[convention]) row[column] = column === 'theta' ? 'q1' : 0;
  return renumbered({ ...document, joints: joints.toSpliced(after + 1, 0, row) });
}

export function removeRow(document: TableDocument, index: number): TableDocument {
  return renumbered({ ...document, joints: document.joints.toSpliced(index, 1) });
}

export function moveRow(document: TableDocument, from: number, to: number): TableDocument {
  const row = document.joints[from];
  if (!row || to < 0 || to >= document.joints.length) return document;
  return renumbered({
    ...document,
    joints: document.joints.toSpliced(from, 1).toSpliced(to, 0, row),
  });
}

/** Number the variables by rows: q3 in row 3. */
function renumbered(document: TableDocument): TableDocument {
  return {
    ...document,
    joints: document.joints.map((row, k) => {
      const own = ownColumn(row, document.convention);
      if (!own) return row;
      const cell = row[own];
      if (typeof cell !== 'string') return row;
      return { ...row, [own]: cell.replace(/(?<![\p{L}\d_])(q|θ|theta)(_?)\d+/iu, `$1$2${k + 1}`) };
    }),
  };
}

/** What identifies a joint's value: its name, and whether it is prismatic. */
interface Named {
  readonly name?: string;
  readonly type?: string;
}

/**
 * The values of the joints after a change of the table: a joint keeps its own, wherever its row is;
 * one that is new, or has become prismatic or revolute, is at zero.
 */
export function carried(
  before: readonly Named[],
  after: TableDocument,
  q: readonly number[],
): number[] {
  const key = (one: Named): string => `${one.name} ${typeOf(one) === 'prismatic'}`;
  const values = new Map(before.map((one, k) => [key(one), q[k] ?? 0]));
  return movingRows(after).map((row) => values.get(key(row)) ?? 0);
}

/** The rows that are entries of q. */
export function movingRows(document: TableDocument): TableRow[] {
  return document.joints.filter((row) => typeOf(row) !== 'fixed' && !row.mimic);
}

function freeName(rows: readonly TableRow[]): string {
  const taken = new Set(rows.map((row) => row.name));
  let k = rows.length + 1;
  while (taken.has(`j${k}`)) k += 1;
  return `j${k}`;
}

function withRow(
  document: TableDocument,
  index: number,
  change: (row: TableRow) => TableRow,
): TableDocument {
  const joints = document.joints.map((row, k) => (k === index ? change(row) : row));
  return { ...document, joints };
}

/** Keep the numbers and read them in another convention: that is another arm. */
export function readAs(document: TableDocument, convention: Convention): TableDocument {
  const khalil = document.convention === 'khalil';
  if (khalil === (convention === 'khalil')) return { ...document, convention };
  const joints = document.joints.map((row): TableRow => {
    const { a, d, r, ...rest } = row;
    return khalil ? { ...rest, a: d ?? 0, d: r ?? 0 } : { ...rest, d: a ?? 0, r: d ?? 0 };
  });
  return { ...document, convention, joints };
}

/** A new table, with two joints. */
export function newTable(convention: Convention, angle: AngleUnit): TableDocument {
  const empty: TableDocument = { convention, units: { angle, length: 'm' }, joints: [] };
  return addRow(addRow(empty, -1), 0);
}
