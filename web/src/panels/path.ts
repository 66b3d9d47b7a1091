/** A redundant arm on a path: methods compared, obstacles, playback. */
import * as api from '../api';
import { button, h, replace, select } from '../dom';
import { brief, readNumber, typed } from '../format';
import { t } from '../i18n';
import { Latest } from '../latest';
import type { Page } from '../page';
import { playback } from '../stage';
import { NO_PATH, type PathForm } from '../state';
import { obstacleEditor } from './obstacles';
import { taskOptions } from './singularity';

const METHODS = [
  'pseudo_inverse',
  'damped',
  'null_space',
  'task_priority',
  'sqp',
  'qp',
  'whole_path',
] as const;
const LAWS = ['cubic', 'linear', 'quintic', 'trapezoidal'] as const;
const COLUMNS = [
  'success',
  'max_position_error',
  'min_clearance',
  'sum_dq',
  'ms_per_point',
] as const;

interface Row {
  readonly method: string;
  readonly success: boolean;
  readonly reason: string | null;
  readonly max_position_error: number;
  readonly min_clearance: number | null;
  readonly sum_dq: number;
  readonly ms_per_point: number;
}

interface Comparison {
  readonly rows: readonly Row[];
  readonly messages: Readonly<Record<string, string>>;
}

export function pathPanel(page: Page): HTMLElement {
  const { store } = page;
  const latest = new Latest();
  const table = h('div', {
    class: 'scroll',
    tabindex: 0,
    role: 'region',
    'aria-label': t.comparison,
  });
  const verdict = h('p', { class: 'verdict', role: 'status' });
  const put = (change: Partial<PathForm>): void =>
    store.set({ path: { ...store.state.path, ...change } }, `path ${Object.keys(change).join()}`);

  const kind = select(
    t.pathKind,
    [
      ['line', t.line],
      ['circle', t.circle],
    ],
    'line',
    (value) => put({ kind: value as PathForm['kind'] }),
  );
  const plane = select(
    t.plane,
    [
      ['xy', 'xy'],
      ['xz', 'xz'],
      ['yz', 'yz'],
    ],
    'xy',
    (value) => put({ plane: value as PathForm['plane'] }),
  );
  const task = select(t.taskSpace, [['', t.sameTask], ...taskOptions()], '', (value) =>
    put({ task: value }),
  );
  const law = select(
    t.timeLaw,
    LAWS.map((one) => [one, t.timeLaws[one]]),
    'cubic',
    (value) => put({ timeLaw: value }),
  );
  const point = ['x', 'y', 'z'].map((axis, k) =>
    numberField(
      axis,
      () => store.state.path.point[k] ?? 0,
      (value) => put({ point: pointOf().with(k, value) }),
    ),
  );
  const numbers = [
    numberField(
      t.turns,
      () => store.state.path.turns,
      (turns) => put({ turns }),
    ),
    numberField(
      `${t.duration} (s)`,
      () => store.state.path.tf,
      (tf) => put({ tf }),
    ),
    numberField(
      t.samples,
      () => store.state.path.samples,
      (samples) => put({ samples: Math.round(samples) }),
    ),
    numberField(
      `${t.linkRadius} (m)`,
      () => store.state.path.linkRadius,
      (linkRadius) => put({ linkRadius }),
    ),
    numberField(
      `${t.dSafe} (m)`,
      () => store.state.path.dSafe,
      (dSafe) => put({ dSafe }),
    ),
  ] as const;
  const methods = METHODS.map((one) => {
    const box = h('input', {
      type: 'checkbox',
      onchange: () => {
        const chosen = METHODS.filter((name) => boxes.get(name)?.checked);
        put({ methods: chosen });
      },
    });
    boxes.set(one, box);
    return h('label', {}, box, ` ${one}`);
  });
  const obstacles = obstacleEditor(store);

  function pointOf(): number[] {
    const pose = Object.values(page.answers.fk?.poses ?? {})[0];
    const {
      path: { point: given },
    } = store.state;
    return [0, 1, 2].map((k) => given[k] ?? pose?.position[k] ?? 0);
  }

  function fields(): api.PathFields {
    const { path: form, q } = store.state;
    const plane_ = form.plane;
    return {
      q,
      task: taskOf(form),
      time_law: form.timeLaw,
      tf: form.tf,
      samples: form.samples,
      obstacles: form.obstacles,
      link_radius: form.linkRadius,
      d_safe: form.dSafe,
      ...(form.kind === 'line'
        ? { target: targetOf(form) }
        : { circle: { center: pointOf(), plane: plane_, turns: form.turns } }),
    };
  }

  function taskOf(form: PathForm): string {
    const { task: chosen } = store.state;
    return form.task || (chosen === 'pose' ? 'position' : chosen);
  }

  /** The line's end; the orientation is that of the start where the task asks for one. */
  function targetOf(form: PathForm): api.Target {
    const pose = Object.values(page.answers.fk?.poses ?? {})[0];
    const turns = /pose|orientation|phi|direction/.test(taskOf(form));
    return {
      position: pointOf(),
      ...(turns && pose ? { quaternion_xyzw: pose.quaternion_xyzw } : {}),
    };
  }

  function guarded(
    work: (model: NonNullable<Page['model']>, signal: AbortSignal) => Promise<void>,
  ): void {
    const { model } = page;
    if (!model) return;
    verdict.classList.remove('bad');
    verdict.textContent = t.computing;
    latest.run(async (signal) => {
      try {
        await work(model, signal);
      } catch (error) {
        if (!(error instanceof api.Refusal || error instanceof api.Unreachable)) throw error;
        verdict.classList.add('bad');
        verdict.textContent = error instanceof api.Refusal ? error.detail : t.unreachable;
      }
    });
  }

  function compare(): void {
    stop();
    guarded(async (model, signal) => {
      const asked = fields();
      const call = api.comparePaths(model.ref, asked, store.state.path.methods, store.state.angle);
      page.calls.set('path', call);
      const found = await api.json<Comparison>(call, signal);
      verdict.textContent = t.choosePlay;
      replace(
        table,
        h(
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
              ...COLUMNS.map((one) => h('th', { scope: 'col' }, t.pathColumns[one])),
              h('td'),
            ),
          ),
          h(
            'tbody',
            {},
            ...found.rows.map((row) =>
              h(
                'tr',
                { class: row.success ? '' : 'bad' },
                h('th', { scope: 'row' }, row.method),
                h('td', {}, row.success ? t.yes : `${t.no}: ${row.reason ?? ''}`),
                ...COLUMNS.slice(1).map((one) =>
                  h(
                    'td',
                    { class: 'mono' },
                    row[one] === null ? '—' : brief(row[one] as number, 2),
                  ),
                ),
                h(
                  'td',
                  {},
                  button('▶', () => play(row.method, asked), {
                    'aria-label': `${t.play}: ${row.method}`,
                  }),
                ),
              ),
            ),
          ),
        ),
        h(
          'ul',
          { class: 'note', lang: 'en' },
          ...Object.entries(found.messages)
            .filter(([name]) => found.rows.some((row) => row.method === name && !row.success))
            .map(([name, words]) => h('li', {}, `${name}: ${words}`)),
        ),
      );
    });
  }

  let answer: api.PathAnswer | null = null;
  let timer = 0;
  const seek = h('input', {
    type: 'range',
    min: 0,
    max: 0,
    step: 1,
    'aria-label': t.sample,
    oninput: () => {
      stop();
      go(seek.valueAsNumber);
    },
  });
  const toggle = button(t.play, () => (timer ? stop() : start()));
  const player = h('div', { class: 'line player', hidden: true }, toggle, seek);

  function go(k: number): void {
    const q = answer?.q[k];
    if (!q) return;
    seek.value = String(k);
    store.set({ q }, 'play');
  }

  function start(): void {
    if (!answer) return;
    toggle.textContent = t.pause;
    const { t: times, q } = answer;
    const begun =
      performance.now() -
      1000 * (seek.valueAsNumber < q.length - 1 ? (times[seek.valueAsNumber] ?? 0) : 0);
    const tick = (): void => {
      const seconds = (performance.now() - begun) / 1000;
      const k = times.findIndex((one) => one > seconds);
      go(k < 0 ? q.length - 1 : k);
      if (k < 0) stop();
      else timer = requestAnimationFrame(tick);
    };
    timer = requestAnimationFrame(tick);
  }

  function stop(): void {
    cancelAnimationFrame(timer);
    timer = 0;
    toggle.textContent = t.play;
  }

  function play(method: string, asked: api.PathFields): void {
    stop();
    guarded(async (model, signal) => {
      const call = api.path(model.ref, asked, method, store.state.angle);
      page.calls.set('path', call);
      answer = await api.json<api.PathAnswer>(call, signal);
      verdict.classList.toggle('bad', !answer.success);
      verdict.textContent = `${method}: ${answer.success ? t.followed : answer.message}`;
      player.hidden = false;
      seek.max = String(answer.q.length - 1);
      seek.value = '0';
      const reached = await api.json<api.FKAnswer>(
        {
          method: 'POST',
          path: batchPath(model.ref),
          query: store.state.angle === 'deg' ? { angle: 'deg' } : {},
          body: batchBody(model.ref, answer.q),
        },
        signal,
      );
      const points = Object.values(reached.poses)[0]?.position as unknown as api.Matrix;
      playback.path = points;
      playback.wanted =
        asked.target?.position && points[0] ? [points[0], asked.target.position] : points;
      for (const tell of [...page.onExtras, ...page.onNumbers]) tell();
      start();
    });
  }

  function render(): void {
    const { path: form } = store.state;
    kind.value = form.kind;
    plane.value = form.plane;
    task.value = form.task;
    law.value = form.timeLaw;
    plane.parentElement?.toggleAttribute('hidden', form.kind === 'line');
    numbers[0].element.hidden = form.kind === 'line';
    pointLabel.textContent = form.kind === 'line' ? t.endPoint : t.centre;
    const now = pointOf();
    point.forEach((one, k) => one.show(now[k] ?? 0));
    for (const one of numbers) one.show();
    for (const [name, box] of boxes) box.checked = form.methods.includes(name);
    obstacles.render();
  }

  const pointLabel = h('span', {}, t.endPoint);
  store.listen(render);
  page.onNumbers.push(render);
  page.onModel.push(() => {
    stop();
    playback.path = null;
    replace(table);
    verdict.textContent = '';
    player.hidden = true;
  });
  const element = h(
    'div',
    { class: 'form' },
    h('p', { class: 'note' }, t.pathHelp),
    h(
      'div',
      { class: 'line' },
      h('label', {}, `${t.pathKind} `, kind),
      h('label', {}, `${t.plane} `, plane),
      h('label', {}, `${t.taskSpace} `, task),
    ),
    h(
      'div',
      { class: 'line' },
      pointLabel,
      ...point.map((one) => one.element),
      button(t.takeTarget, () => {
        const { target } = store.state;
        const position = target?.position ?? target?.matrix?.slice(0, 3).map((row) => row[3] ?? 0);
        if (position) put({ point: position });
      }),
    ),
    h(
      'div',
      { class: 'line' },
      h('label', {}, `${t.timeLaw} `, law),
      ...numbers.map((one) => one.element),
    ),
    h('fieldset', { class: 'line' }, h('legend', {}, t.methods), ...methods),
    obstacles.element,
    h(
      'div',
      { class: 'line' },
      button(t.compare, compare, { class: 'main' }),
      button(t.reset, () => put(NO_PATH)),
    ),
    verdict,
    table,
    player,
  );
  render();
  return element;
}

const boxes = new Map<string, HTMLInputElement>();

interface Field {
  readonly element: HTMLElement;
  show(value?: number): void;
}

function numberField(label: string, read: () => number, changed: (value: number) => void): Field {
  const field = h('input', {
    type: 'text',
    inputmode: 'decimal',
    class: 'value',
    autocomplete: 'off',
    oninput: () => {
      const value = readNumber(field.value);
      field.setAttribute('aria-invalid', String(value === null));
      if (value !== null) changed(value);
    },
  });
  return {
    element: h('label', {}, `${label} `, field),
    show(value = read()) {
      if (field !== document.activeElement) field.value = typed(Number(value.toFixed(6)));
    },
  };
}

function batchPath(ref: api.RobotRef): string {
  return 'id' in ref ? `v1/robots/${encodeURIComponent(ref.id)}/fk` : 'v1/fk';
}

function batchBody(ref: api.RobotRef, q: api.Matrix): unknown {
  if ('id' in ref) return { q };
  return { q, robot: 'table' in ref ? ref.table : ref };
}
