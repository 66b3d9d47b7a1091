/** The pose of the tool: T, position, roll-pitch-yaw, quaternion, both Euler triples. */
import * as api from '../api';
import { h, replace, select } from '../dom';
import { fixed } from '../format';
import { t } from '../i18n';
import type { Page } from '../page';
import { matrixView } from './matrix';
import type { Panel } from './panel';

const SEQUENCES = ['ZXZ', 'ZYZ', 'ZYX', 'XYZ', 'YXZ', 'XYX', 'xyz', 'zyx', 'zxz'];

export function posePanel({ store, history }: Page): Panel<'pose'> {
  const matrix = matrixView('T', [], []);
  const facts = h('dl', { class: 'facts' });
  const euler = h('output', { class: 'mono' });
  const note = h('p', { class: 'note', hidden: true }, t.eulerDegenerate);
  const sequence = select(
    t.eulerSequence,
    SEQUENCES.map((one) => [one, one]),
    store.state.euler,
    (value) => history.change({ euler: value }, 'euler'),
  );
  store.subscribe(
    (state) => state.euler,
    (value) => {
      sequence.value = value;
    },
  );
  return {
    id: 'pose',
    title: t.pose,
    body: h(
      'div',
      {},
      h('p', { class: 'lead' }, h('b', {}, 'T'), ` — ${t.poseLead}`),
      matrix.element,
      facts,
      h('div', { class: 'line' }, h('label', {}, `${t.eulerSequence} `, sequence), euler),
      note,
    ),
    call: (model, state) => api.fk(model.ref, state.q, state.euler, state.angle),
    show({ poses }, model, state) {
      const pose = poses[model.tipFrame] ?? Object.values(poses)[0];
      if (!pose) return;
      const { digits } = state;
      const angles = (values: readonly number[]): string =>
        values
          .map((x) => fixed(x, state.angle === 'deg' ? Math.max(2, digits - 2) : digits))
          .join('  ');
      const plain = (values: readonly number[]): string =>
        values.map((x) => fixed(x, digits)).join('  ');
      matrix.show(pose.matrix, digits);
      replace(
        facts,
        h('dt', {}, `${t.position} (m)`),
        h('dd', {}, plain(pose.position)),
        h('dt', {}, `${t.rpy} (${state.angle === 'deg' ? '°' : 'rad'})`),
        h('dd', {}, angles(pose.rpy)),
        h('dt', {}, t.quaternion),
        h('dd', {}, plain(pose.quaternion_xyzw)),
      );
      const found = pose.euler;
      replace(
        euler,
        ...(found?.solutions ?? []).map((one, k) =>
          h('span', { class: 'triple' }, `${k + 1}: ${angles(one)}`),
        ),
      );
      note.hidden = !found?.degenerate && !pose.rpy_degenerate;
    },
  };
}
