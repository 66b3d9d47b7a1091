/** The link matrix as a product of four elementary motions, which show the chosen row. */
import type { TableDocument } from '../api';
import { button, h, replace } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import { MOTIONS, SYMBOLS } from './convention';
import { chooseRow } from './editing';

export function formula(page: Page): {
  readonly element: HTMLElement;
  render(document: TableDocument): void;
} {
  const { store } = page;
  const line = h('span', { class: 'formula', role: 'group', 'aria-label': t.linkMatrix });
  const words = h('p', { class: 'note' });
  let shown = '';
  return {
    element: h('div', {}, line, words),
    render({ convention }) {
      const { row, step } = store.state;
      const key = [convention, row, step].join();
      if (key === shown) return;
      shown = key;
      const k = row === null ? 'k' : String(row + 1);
      const motions = MOTIONS[convention];
      replace(
        line,
        h(
          'span',
          { class: 'sum' },
          h('sup', {}, row === null ? 'k−1' : String(row)),
          'A',
          h('sub', {}, k),
          ' =',
        ),
        ...motions.map((motion, i) =>
          h(
            'button',
            {
              type: 'button',
              class: `axis-${motion.axis}`,
              'aria-pressed': String(row !== null && i < step),
              title: t.motions[motion.name as keyof typeof t.motions],
              onclick: () => chooseRow(page, { row: row ?? 0, step: i + 1 }),
            },
            `${motion.name}(`,
            h('i', {}, SYMBOLS[motion.column]),
            ')',
          ),
        ),
        row !== null &&
          button('⟲', () => chooseRow(page, { row, step: 0 }), {
            'aria-label': t.stepStart,
            title: t.stepStart,
          }),
      );
      const last = step > 0 ? motions[step - 1] : undefined;
      words.textContent =
        row === null
          ? t.formulaHint
          : last
            ? t.stepDone(step, t.columns[convention][last.column])
            : t.stepNone;
    },
  };
}
