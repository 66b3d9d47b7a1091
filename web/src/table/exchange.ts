/** Conversions between the form of a table in the API and the form that is edited. */
import type { Placement, TableDocument, TableRow } from '../api';
import { ownColumn } from './convention';
import { variableCell } from './document';

/**
 * Change a document of the API to the form that is edited: the variable is in its own column, with
 * `offset` and `sign` in its cell, as in a textbook.
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

/** A placement without rotation is shown as a point. */
function placed(name: 'base' | 'tool', given: Placement | undefined): Partial<TableDocument> {
  const matrix = given?.matrix;
  if (!matrix) return given ? { [name]: given } : {};
  const turned = matrix.some((row, i) => row.some((x, k) => k < 3 && x !== (i === k ? 1 : 0)));
  if (turned) return { [name]: given };
  return { [name]: { xyz: matrix.slice(0, 3).map((row) => row[3] ?? 0), rpy: [0, 0, 0] } };
}

/** Change an edited document to the form of the API: without empty cells, which it then names. */
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
