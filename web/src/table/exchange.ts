/** A table between the form that the service takes and gives and the form that is edited. */
import type { Placement, TableDocument, TableRow } from '../api';
import { ownColumn } from './convention';
import { variableCell } from './document';

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
