/** How near the arm is to a singularity: rank, singular values, w, κ, lost directions, factors of det J. */
import * as api from '../api';
import { h, replace, select } from '../dom';
import { brief, fixed } from '../format';
import { t } from '../i18n';
import type { Page } from '../page';
import type { Panel } from './panel';
import { rowName, taskOptions } from './tasks';

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
      const lost = found.lost_directions.map((one) =>
        h(
          'li',
          {},
          found.rows.map((row, k) => `${rowName(row)} ${fixed(one[k] ?? 0, 3)}`).join('  '),
        ),
      );
      const moving = found.null_motions.map((one) => h('li', {}, ratios(one)));
      const english = document.documentElement.lang === 'en';
      replace(
        words,
        // The service explains in English only: in other languages the numbers are shown instead.
        !english && lost.length > 0 && h('p', { class: 'lead' }, t.lostDirections),
        !english && lost.length > 0 && h('ul', { class: 'mono' }, ...lost),
        !english && moving.length > 0 && h('p', { class: 'lead' }, t.nullLead),
        !english && moving.length > 0 && h('ul', { class: 'mono' }, ...moving),
        english &&
          found.explanation.length > 0 &&
          h(
            'ul',
            { lang: 'en', class: 'note' },
            ...found.explanation.slice(0, 4).map((one) => h('li', {}, one)),
          ),
      );
      replace(factors, factorTable(found, state.digits));
    },
  };
}

/** The joints that a motion moves, and their ratios to the first of them. */
function ratios(motion: readonly number[]): string {
  const largest = Math.max(...motion.map(Math.abs));
  const moving = motion.flatMap((x, k) => (Math.abs(x) > 1e-6 * largest ? [k] : []));
  const first = motion[moving[0] ?? 0] ?? 1;
  const names = moving.map((k) => `q${k + 1}`).join(' : ');
  if (moving.length === 1) return names;
  return `${names} = ${moving.map((k) => brief((motion[k] ?? 0) / first)).join(' : ')}`;
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
            h('td', { lang: 'en' }, one.vanishes_where),
          ),
        ),
      ),
    ),
  );
}
