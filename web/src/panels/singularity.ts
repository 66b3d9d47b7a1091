/** How near the arm is to a singularity: rank, singular values, w, κ, lost directions, factors of det J. */
import * as api from '../api';
import { h, replace, select } from '../dom';
import { brief, fixed } from '../format';
import { t } from '../i18n';
import type { Page } from '../page';
import type { Panel } from './panel';
import { taskOptions } from './tasks';

export function singularityPanel({ store, history }: Page): Panel<'singularity'> {
  const task = select(t.taskSpace, taskOptions(), store.state.task, (value) =>
    history.change({ task: value }, 'task'),
  );
  store.subscribe(
    (state) => state.task,
    (value) => {
      task.value = value;
    },
  );
  const verdict = h('p', { class: 'verdict' });
  const bars = h('div', { class: 'bars', role: 'list', 'aria-label': t.singularValues });
  const facts = h('dl', { class: 'facts' });
  const factors = h('div');
  const words = h('div');
  return {
    id: 'singularity',
    title: t.singularity,
    body: h(
      'div',
      {},
      h('div', { class: 'line' }, h('label', {}, `${t.taskSpace} `, task)),
      verdict,
      bars,
      facts,
      words,
      factors,
    ),
    call: (model, state) => api.singularity(model.ref, state.q, state.angle, state.task),
    show(found, _model, state) {
      const full = Math.min(found.rows.length, found.columns.length);
      const redundant = found.columns.length - found.rank;
      verdict.classList.toggle('bad', found.singular);
      replace(
        verdict,
        found.singular ? t.rankLost(found.rank, full) : t.rankFull(found.rank, found.rows.length),
        redundant > 0 && ` ${t.nullMotions(redundant)}`,
      );
      const largest = found.singular_values[0] || 1;
      replace(
        bars,
        ...found.singular_values.map((value, k) => {
          const fill = h('span', { class: 'fill' });
          fill.style.width = `${(100 * value) / largest}%`;
          return h(
            'div',
            { role: 'listitem' },
            h('span', {}, 'σ', h('sub', {}, k + 1)),
            h('span', { class: 'bar' }, fill),
            h('span', { class: 'mono' }, value < 1e-10 ? '0' : brief(value)),
          );
        }),
      );
      replace(
        facts,
        h('dt', {}, `w (${t.manipulability})`),
        h('dd', {}, brief(found.singular ? 0 : found.manipulability)),
        h('dt', {}, `κ (${t.conditionNumber})`),
        h('dd', {}, brief(found.condition_number)),
      );
      replace(
        words,
        found.explanation.length > 0 &&
          h(
            'ul',
            { class: 'note' },
            ...found.explanation.slice(0, 4).map((one) => h('li', {}, one)),
          ),
      );
      replace(factors, factorTable(found, state.digits));
    },
  };
}

function factorTable(found: api.SingularityAnswer, digits: number): HTMLElement | null {
  const { factorization } = found;
  if (!factorization.factors.length) return null;
  return h(
    'div',
    {},
    h(
      'p',
      { class: 'lead' },
      factorization.of === 'determinant' ? t.determinant : t.manipulabilityProduct,
      ` = ${brief(factorization.product ?? 0)}`,
    ),
    h(
      'table',
      { class: 'factors' },
      h('caption', { class: 'hidden' }, t.factors),
      h(
        'thead',
        {},
        h(
          'tr',
          {},
          ...[t.factor, t.value, t.vanishesWhere].map((one) => h('th', { scope: 'col' }, one)),
        ),
      ),
      h(
        'tbody',
        {},
        ...factorization.factors.map((one) =>
          h(
            'tr',
            { class: one.vanishes ? 'bad' : '' },
            h(
              'th',
              { scope: 'row' },
              t.factorNames[one.name as keyof typeof t.factorNames] ?? one.name,
            ),
            h('td', { class: 'mono' }, fixed(one.value, digits)),
            h('td', {}, one.vanishes_where),
          ),
        ),
      ),
    ),
  );
}
