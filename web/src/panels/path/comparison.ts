/** What the methods did on a path, side by side. */
import type { PathComparison, PathComparisonRow } from '../../api';
import { button, h } from '../../dom';
import { brief } from '../../format';
import { t } from '../../i18n';

const FIGURES = ['max_position_error', 'min_clearance', 'sum_dq', 'ms_per_point'] as const;

/** @param play Plays what a method did. */
export function comparisonTable(
  { rows, messages }: PathComparison,
  play: (method: string) => void,
): HTMLElement[] {
  const failed = new Set(rows.filter((row) => !row.success).map((row) => row.method));
  const table = h(
    'table',
    { class: 'factors compared' },
    h('caption', { class: 'hidden' }, t.comparison),
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        h('th', { scope: 'col' }, t.method),
        ...(['success', ...FIGURES] as const).map((one) =>
          h('th', { scope: 'col' }, t.pathColumns[one]),
        ),
        h('td'),
      ),
    ),
    h('tbody', {}, ...rows.map((row) => line(row, play))),
  );
  const reasons = Object.entries(messages)
    .filter(([method]) => failed.has(method))
    .map(([method, words]) => h('li', {}, `${method}: ${words}`));
  return [table, h('ul', { class: 'note' }, ...reasons)];
}

function line(row: PathComparisonRow, play: (method: string) => void): HTMLElement {
  const { method, success, reason } = row;
  return h(
    'tr',
    { class: success ? '' : 'bad' },
    h('th', { scope: 'row' }, method),
    h('td', {}, success ? t.yes : `${t.no}: ${reason ?? ''}`),
    ...FIGURES.map((one) => {
      const value = row[one];
      return h('td', { class: 'mono' }, value === null ? '—' : brief(value, 2));
    }),
    h(
      'td',
      {},
      button('▶', () => play(method), { 'aria-label': `${t.play}: ${method}` }),
    ),
  );
}
