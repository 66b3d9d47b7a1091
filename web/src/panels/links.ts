/** The link matrices: A_k of one row, and the product up to it. */
import * as api from '../api';
import { h, replace } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import { matrixView } from './matrix';
import type { Panel } from './panel';

export function linksPanel({ history }: Page): Panel<'links'> {
  const one = matrixView('A', [], []);
  const product = matrixView('0A', [], []);
  const titleOne = h('b');
  const titleProduct = h('b');
  const rows = h('div', { class: 'chips', role: 'group', 'aria-label': t.rowOfTable });
  const body = h(
    'div',
    {},
    rows,
    h('p', { class: 'lead' }, titleOne, ` — ${t.linkLead}`),
    one.element,
    h('p', { class: 'lead' }, titleProduct, ` — ${t.productLead}`),
    product.element,
  );
  return {
    id: 'links',
    title: t.links,
    body,
    call: (model, state) =>
      model.kind === 'dh' ? api.dhMatrices(model.ref, state.q, state.angle) : null,
    show(found, model, state) {
      const count = found.A.length;
      const k = Math.min(state.row ?? count - 1, count - 1);
      replace(
        rows,
        ...found.A.map((_, i) =>
          h(
            'button',
            {
              type: 'button',
              'aria-pressed': String(i === k),
              'aria-label': `${t.row} ${i + 1}`,
              onclick: () => history.change({ row: i }, 'row'),
            },
            String(i + 1),
          ),
        ),
      );
      const from = model.rows?.joints[k]?.ant ?? k;
      replace(titleOne, h('sup', {}, String(from)), 'A', h('sub', {}, String(k + 1)));
      replace(titleProduct, h('sup', {}, '0'), 'A', h('sub', {}, String(k + 1)));
      one.show(found.A[k] ?? [], state.digits);
      product.show(found.T0[k] ?? [], state.digits);
    },
  };
}
