/** A redundant arm on a path: methods compared among obstacles, and played back. */
import * as api from '../../api';
import { comparePaths, fkBatch, path } from '../../api/motion';
import { button, h, replace } from '../../dom';
import { reasonOf } from '../../failure';
import { t } from '../../i18n';
import { Latest } from '../../latest';
import type { Model } from '../../model';
import type { Page } from '../../page';
import { NO_PATH } from '../../state';
import { showWarnings, warningList } from '../../warnings';
import { comparisonTable } from './comparison';
import { pathForm } from './form';
import { obstacleEditor } from './obstacles';
import { pathPlayer } from './player';

export function pathPanel(page: Page): HTMLElement {
  const { store } = page;
  const latest = new Latest();
  const form = pathForm(page);
  const obstacles = obstacleEditor(page);
  const player = pathPlayer(page);
  const table = h('div', {
    class: 'scroll',
    tabindex: 0,
    role: 'region',
    'aria-label': t.comparison,
  });
  const verdict = h('p', { class: 'verdict', role: 'status' });
  const warnings = warningList();

  /** Run a request for the robot of the page; what it is refused for is the verdict. */
  function request(work: (model: Model, signal: AbortSignal) => Promise<void>): void {
    const { model } = store.state;
    if (!model) return;
    player.stop();
    verdict.classList.remove('bad');
    verdict.textContent = t.computing;
    latest.run(async (signal) => {
      try {
        await work(model, signal);
      } catch (error) {
        verdict.textContent = reasonOf(error);
        verdict.classList.add('bad');
      }
    });
  }

  function record(call: api.Call): void {
    store.set({ calls: { ...store.state.calls, path: call } });
  }

  function compare(): void {
    request(async (model, signal) => {
      const fields = form.fields();
      const { path: asked, angle } = store.state;
      const call = comparePaths(model.ref, fields, asked.methods, angle);
      record(call);
      const found = await api.json(call, signal);
      verdict.textContent = t.choosePlay;
      showWarnings(warnings, found.warnings);
      replace(table, ...comparisonTable(found, (method) => play(method, fields)));
    });
  }

  function play(method: string, fields: api.PathFields): void {
    request(async (model, signal) => {
      const { angle } = store.state;
      const call = path(model.ref, fields, method, angle);
      record(call);
      const answer = await api.json(call, signal);
      verdict.classList.toggle('bad', !answer.success);
      verdict.textContent = `${method}: ${answer.success ? t.followed : answer.message}`;
      player.load(answer);
      const { poses } = await api.json(fkBatch(model.ref, answer.q, angle), signal);
      const reached = Object.values(poses)[0]?.position ?? [];
      const end = fields.target?.position;
      const wanted = end && reached[0] ? [reached[0], end] : reached;
      store.set({ followed: { wanted, reached } });
      player.start();
    });
  }

  store.subscribe(
    ({ model }) => model,
    () => {
      player.close();
      replace(table);
      showWarnings(warnings, []);
      verdict.textContent = '';
    },
  );
  return h(
    'div',
    { class: 'form' },
    h('p', { class: 'note' }, t.pathHelp),
    ...form.elements,
    obstacles,
    h(
      'div',
      { class: 'line' },
      button(t.compare, compare, { class: 'main' }),
      button(t.reset, () => form.put(NO_PATH)),
    ),
    verdict,
    warnings,
    table,
    player.element,
  );
}
