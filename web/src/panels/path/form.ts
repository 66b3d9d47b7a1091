/** The path that is asked for: its geometry, its times, its methods. */
import type { PathFields, Target } from '../../api';
import { button, h, select } from '../../dom';
import { readNumber, typed } from '../../format';
import { t } from '../../i18n';
import type { Page } from '../../page';
import { type PathForm, tipPose } from '../../state';
import { positionOf } from '../../target';
import { taskOptions } from '../tasks';

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
const PLANES = ['xy', 'xz', 'yz'] as const;

export interface PathFormView {
  readonly elements: readonly HTMLElement[];
  /** The path as the service takes it. */
  fields(): PathFields;
  /** Change the form. */
  put(change: Partial<PathForm>): void;
}

export function pathForm({ store, history }: Page): PathFormView {
  const put = (change: Partial<PathForm>): void =>
    history.change(
      { path: { ...store.state.path, ...change } },
      `path ${Object.keys(change).join()}`,
    );
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
    PLANES.map((one) => [one, one]),
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
    (value) => put({ timeLaw: value as PathForm['timeLaw'] }),
  );
  const pointLabel = h('span');
  const point = ['x', 'y', 'z'].map((axis, k) =>
    numberField(axis, (value) => put({ point: pointOf().with(k, value) })),
  );
  const turns = numberField(t.turns, (value) => put({ turns: value }));
  const tf = numberField(`${t.duration} (s)`, (value) => put({ tf: value }));
  const samples = numberField(t.samples, (value) => put({ samples: Math.round(value) }));
  const linkRadius = numberField(`${t.linkRadius} (m)`, (value) => put({ linkRadius: value }));
  const dSafe = numberField(`${t.dSafe} (m)`, (value) => put({ dSafe: value }));
  const boxes = METHODS.map((name) => {
    const box = h('input', { type: 'checkbox', onchange: () => put({ methods: checked() }) });
    return { name, box };
  });
  const checked = (): string[] => boxes.filter(({ box }) => box.checked).map(({ name }) => name);

  /** The form's point; where it has none yet, the tool's position. */
  function pointOf(): number[] {
    const pose = tipPose(store.state);
    const { point: given } = store.state.path;
    return [0, 1, 2].map((k) => given[k] ?? pose?.position[k] ?? 0);
  }

  function taskName(): string {
    const { path, task: shown } = store.state;
    return path.task || (shown === 'pose' ? 'position' : shown);
  }

  /** The line's end; the orientation is that of the start where the task asks for one. */
  function lineEnd(): Target {
    const pose = tipPose(store.state);
    const needsOrientation = /pose|orientation|phi|direction/.test(taskName());
    return {
      position: pointOf(),
      ...(needsOrientation && pose && { quaternion_xyzw: pose.quaternion_xyzw }),
    };
  }

  function fields(): PathFields {
    const { path, q } = store.state;
    return {
      q,
      task: taskName(),
      time_law: path.timeLaw,
      tf: path.tf,
      samples: path.samples,
      obstacles: path.obstacles,
      link_radius: path.linkRadius,
      d_safe: path.dSafe,
      ...(path.kind === 'line'
        ? { target: lineEnd() }
        : { circle: { center: pointOf(), plane: path.plane, turns: path.turns } }),
    };
  }

  function takeTarget(): void {
    const position = positionOf(store.state.target);
    if (position) put({ point: position });
  }

  function render(): void {
    const { path } = store.state;
    const isLine = path.kind === 'line';
    kind.value = path.kind;
    plane.value = path.plane;
    task.value = path.task;
    law.value = path.timeLaw;
    plane.parentElement?.toggleAttribute('hidden', isLine);
    turns.element.hidden = isLine;
    pointLabel.textContent = isLine ? t.endPoint : t.centre;
    const now = pointOf();
    point.forEach((one, k) => {
      one.show(now[k] ?? 0);
    });
    turns.show(path.turns);
    tf.show(path.tf);
    samples.show(path.samples);
    linkRadius.show(path.linkRadius);
    dSafe.show(path.dSafe);
    for (const { name, box } of boxes) box.checked = path.methods.includes(name);
  }

  const elements = [
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
      button(t.takeTarget, takeTarget),
    ),
    h(
      'div',
      { class: 'line' },
      h('label', {}, `${t.timeLaw} `, law),
      ...[turns, tf, samples, linkRadius, dSafe].map((one) => one.element),
    ),
    h(
      'fieldset',
      { class: 'line' },
      h('legend', {}, t.methods),
      ...boxes.map(({ name, box }) => h('label', {}, box, ` ${name}`)),
    ),
  ];
  store.subscribe(({ path, answers }) => [path, answers], render);
  render();
  return { elements, fields, put };
}

interface NumberField {
  readonly element: HTMLElement;
  show(value: number): void;
}

function numberField(label: string, changed: (value: number) => void): NumberField {
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
    show(value) {
      if (field !== document.activeElement) field.value = typed(Number(value.toFixed(6)));
    },
  };
}
