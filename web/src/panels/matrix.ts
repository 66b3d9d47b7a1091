/** A matrix as a table with headings; new values are written into its cells. */
import { h } from '../dom';
import { fixed } from '../format';

export interface MatrixView {
  readonly element: HTMLElement;
  show(values: readonly (readonly number[])[], digits: number): void;
}

/**
 * @param label Its name for screen readers.
 * @param rows Headings of the rows; without any a 4x4 matrix without headings.
 */
export function matrixView(
  label: string,
  rows: readonly string[],
  columns: readonly string[],
  titles: readonly string[] = columns,
): MatrixView {
  const size = [rows.length || 4, columns.length || 4] as const;
  const cells = Array.from({ length: size[0] }, () =>
    Array.from({ length: size[1] }, () => h('td')),
  );
  const head =
    columns.length > 0 &&
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        rows.length > 0 && h('td'),
        ...columns.map((one, k) => h('th', { scope: 'col', title: titles[k] }, one)),
      ),
    );
  const body = cells.map((line, i) =>
    h('tr', {}, rows.length > 0 && h('th', { scope: 'row' }, rows[i]), ...line),
  );
  const table = h(
    'table',
    { class: `matrix${columns.length > 5 ? ' wide' : ''}${columns.length > 6 ? ' wider' : ''}` },
    h('caption', { class: 'hidden' }, label),
    head,
    h('tbody', {}, ...body),
  );
  const element = h(
    'div',
    { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': label },
    table,
  );
  return {
    element,
    show(values, digits) {
      for (const [i, line] of values.entries()) {
        for (const [k, value] of line.entries()) {
          const cell = cells[i]?.[k];
          if (!cell) continue;
          const text = Math.abs(value) < 1e-12 ? '0' : fixed(value, digits);
          if (cell.textContent !== text) cell.textContent = text;
          cell.classList.toggle('zero', Number(value.toFixed(digits)) === 0);
          cell.dataset.value = String(value);
        }
      }
    },
  };
}
