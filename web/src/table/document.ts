/** Changes of a table as it was typed: pure functions on the document that the API takes. */
import type {
  AngleUnit,
  Cell,
  Convention,
  JointType,
  Placement,
  TableDocument,
  TableRow,
} from '../api';

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

/** The column that a joint's variable is in; null for a fixed row. */
export function ownColumn(row: TableRow, convention: Convention): Column | null {
  const type = typeOf(row);
  if (type === 'fixed') return null;
  if (type === 'prismatic') return convention === 'khalil' ? 'r' : 'd';
  return 'theta';
}

/** `q3`, `-q3 + 90`: a variable with its constant, as it stands in a cell. */
export function variableCell(index: number, sign: number, constant: Cell): string {
  const variable = `${sign < 0 ? '-' : ''}q${index + 1}`;
  const text = String(constant).trim();
  if (text === '' || Number(text) === 0) return variable;
  if (/^-/.test(text)) return `${variable} - ${text.slice(1).trim()}`;
  return `${variable} + ${text}`;
}

/**
 * A document as the API gives it -> as it is edited: the variable stands in its own column, with
 * what were `offset` and `sign`, as in a textbook.
 */
export function editable(document: TableDocument): TableDocument {
  const { residual: _residual, warnings: _warnings, explanation: _explanation, ...kept } = document;
  return {
    ...kept,
    ...placed('base', document.base),
    ...placed('tool', document.tool),
    joints: document.joints.map((row, k) => {
      const own = ownColumn(row, document.convention);
      const { offset, sign, ...rest } = row;
      if (own === null) return rest;
      return { ...rest, [own]: variableCell(k, sign ?? 1, offset ?? 0) };
    }),
  };
}

/** A placement without turning is shown as a point. */
function placed(name: 'base' | 'tool', given: Placement | undefined): Partial<TableDocument> {
  const matrix = given?.matrix;
  if (!matrix) return given ? { [name]: given } : {};
  const turned = matrix.some((row, i) => row.some((x, k) => k < 3 && x !== (i === k ? 1 : 0)));
  if (turned) return { [name]: given };
  return { [name]: { xyz: matrix.slice(0, 3).map((row) => row[3] ?? 0), rpy: [0, 0, 0] } };
}

/** The document as it is sent: without what is empty, for which the API then asks by name. */
export function sendable(document: TableDocument): TableDocument {
  const { name, ...rest } = document;
  return {
    ...(name ? { name } : {}),
    ...rest,
    joints: document.joints.map((row) => {
      const { limits, ...cells } = row;
      const filled = Object.fromEntries(
        Object.entries(cells).filter(([, value]) => value !== '' && value !== undefined),
      ) as TableRow;
      const bounds = Object.entries(limits ?? {}).filter(([, v]) => v !== '' && v !== undefined);
      return bounds.length ? { ...filled, limits: Object.fromEntries(bounds) } : filled;
    }),
  };
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

/** Another type of joint: the variable moves to its column and leaves its constant behind. */
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

/** What is left of a cell without its variable: `q2 - pi/2` -> `-pi/2`. */
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

/** Variables are numbered by rows: q3 in row 3. */
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

/** A joint as far as its value goes: what it is called, and whether it slides. */
interface Named {
  readonly name?: string;
  readonly type?: string;
}

/**
 * The values of the joints after a change of the table: each keeps its own, wherever its row went;
 * what is new, or slides now and turned before, is at zero.
 */
export function carried(
  before: readonly Named[],
  after: TableDocument,
  q: readonly number[],
): number[] {
  const key = (one: Named): string => `${one.name} ${typeOf(one) === 'prismatic'}`;
  const values = new Map(before.map((one, k) => [key(one), q[k] ?? 0]));
  return moving(after).map((row) => values.get(key(row)) ?? 0);
}

/** The rows that have a variable. */
export function moving(document: TableDocument): TableRow[] {
  return document.joints.filter((row) => typeOf(row) !== 'fixed');
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

/** The same numbers in another convention: another arm, which is what one may want to see. */
export function readAs(document: TableDocument, convention: Convention): TableDocument {
  const khalil = document.convention === 'khalil';
  if (khalil === (convention === 'khalil')) return { ...document, convention };
  const joints = document.joints.map((row): TableRow => {
    const { a, d, r, ...rest } = row;
    return khalil ? { ...rest, a: d ?? 0, d: r ?? 0 } : { ...rest, d: a ?? 0, r: d ?? 0 };
  });
  return { ...document, convention, joints };
}

/** A table to begin with: one joint. */
export function newTable(convention: Convention, angle: AngleUnit): TableDocument {
  const empty: TableDocument = { convention, units: { angle, length: 'm' }, joints: [] };
  return addRow(addRow(empty, -1), 0);
}
