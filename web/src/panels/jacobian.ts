/** The Jacobian of the tool in the chosen reference frame. */
import * as api from '../api';
import { h, replace, select } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import { type MatrixView, matrixView } from './matrix';
import type { Panel } from './panel';
import { rowName } from './tasks';

export function jacobianPanel({ store, history }: Page): Panel<'jacobian'> {
  const reference = select(
    t.referenceFrame,
    [
      ['local_world_aligned', t.localWorldAligned],
      ['local', t.local],
      ['world', t.world],
    ],
    store.state.reference,
    (value) => history.change({ reference: value as api.ReferenceFrame }, 'reference'),
  );
  store.subscribe(
    (state) => state.reference,
    (value) => {
      reference.value = value;
    },
  );
  const place = h('div');
  let view: MatrixView | null = null;
  let columns = '';
  return {
    id: 'jacobian',
    title: t.jacobian,
    body: h(
      'div',
      {},
      h('div', { class: 'line' }, h('label', {}, `${t.referenceFrame} `, reference)),
      place,
      h('p', { class: 'note' }, t.jacobianUnits),
    ),
    call: (model, state) => api.jacobian(model.ref, state.q, state.angle, state.reference),
    show(found, _model, state) {
      if (!view || columns !== found.columns.join()) {
        columns = found.columns.join();
        view = matrixView('J', found.rows.map(rowName), headings(found.columns), found.columns);
        replace(place, view.element);
      }
      view.show(found.jacobian, state.digits);
    },
  };
}

/** Names of the joints; where one is long q1, q2 … */
function headings(names: readonly string[]): readonly string[] {
  return names.every((one) => one.length <= 4) ? names : names.map((_, k) => `q${k + 1}`);
}
