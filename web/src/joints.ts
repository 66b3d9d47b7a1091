/** A slider and a field for each joint, with its limits. */
import { h, replace } from './dom';
import { type Follower, followerValue } from './followers';
import { readNumber, typed } from './format';
import { t } from './i18n';
import type { Page } from './page';
import type { SceneJoint } from './scene/types';
import { fromRadians, toRadians } from './units';

interface Line {
  readonly slider: HTMLInputElement;
  readonly field: HTMLInputElement;
  readonly element: HTMLElement;
  readonly lower: number;
  readonly upper: number;
}

export function jointsView(page: Page): HTMLElement {
  const { store, history } = page;
  const list = h('div', { class: 'joints' });
  let lines: Line[] = [];
  let followers: ReturnType<typeof followerLine>[] = [];
  let built = '';

  function put(k: number, value: number): void {
    history.change({ q: store.state.q.with(k, value) }, `q${k}`);
  }

  function line(joint: SceneJoint, k: number): Line {
    const { angle } = store.state;
    const turns = joint.type !== 'prismatic';
    const half = turns ? (angle === 'deg' ? 180 : Math.PI) : 1;
    const limited = joint.lower !== null && joint.upper !== null && joint.type !== 'continuous';
    const lower = limited ? fromRadians(joint, joint.lower ?? 0, angle) : -half;
    const upper = limited ? fromRadians(joint, joint.upper ?? 0, angle) : half;
    const unit = turns ? (angle === 'deg' ? '°' : 'rad') : 'm';
    // So many digits that a hundredth of the range is still a step.
    const range = limited && upper > lower ? upper - lower : 1;
    const digits = Math.max(turns && angle === 'deg' ? 1 : 3, 2 - Math.floor(Math.log10(range)));
    const slider = h('input', {
      type: 'range',
      min: lower,
      max: upper,
      step: 'any',
      'aria-label': `${joint.name} (${unit})`,
      oninput: () => put(k, Number(slider.valueAsNumber.toFixed(digits))),
    });
    const field = h('input', {
      type: 'text',
      inputmode: 'decimal',
      autocomplete: 'off',
      class: 'value',
      'aria-label': `${joint.name}, ${t.valueIn(unit)}`,
      oninput: () => {
        const value = readNumber(field.value);
        field.setAttribute('aria-invalid', String(value === null));
        if (value !== null) put(k, value);
      },
      onkeydown: (event) => {
        const by = { ArrowUp: 1, ArrowDown: -1 }[(event as KeyboardEvent).key];
        if (!by) return;
        event.preventDefault();
        const step = 10 ** -digits * ((event as KeyboardEvent).shiftKey ? 100 : 10);
        put(k, Number(((store.state.q[k] ?? 0) + by * step).toFixed(digits + 1)));
        field.value = typed(store.state.q[k] ?? 0);
      },
    });
    const bounds = limited
      ? `${typed(Number(lower.toFixed(digits)))} … ${typed(Number(upper.toFixed(digits)))}`
      : t.unlimited;
    const element = h(
      'div',
      { class: 'joint' },
      h(
        'span',
        { class: 'name', title: joint.name },
        h('b', {}, 'q', h('sub', {}, k + 1)),
        ` ${joint.name}`,
      ),
      slider,
      field,
      h('span', { class: 'unit' }, unit),
      h('span', { class: 'limits' }, bounds),
    );
    return { slider, field, element, lower, upper };
  }

  /** A joint that follows another: its value, which cannot be changed. */
  function followerLine(follower: Follower): { field: HTMLElement; element: HTMLElement } {
    const turns = follower.type !== 'prismatic';
    const unit = turns ? (store.state.angle === 'deg' ? '°' : 'rad') : 'm';
    const field = h('output', { class: 'value', 'aria-label': follower.name });
    const element = h(
      'div',
      { class: 'joint follower', title: t.follows(follower.joint) },
      h('span', { class: 'name' }, follower.name),
      h('span', { class: 'note' }, t.follows(follower.joint)),
      field,
      h('span', { class: 'unit' }, unit),
    );
    return { field, element };
  }

  function render(): void {
    const joints = store.state.model?.joints ?? [];
    const all = store.state.model?.followers ?? [];
    const { q, angle } = store.state;
    const shape = JSON.stringify([joints, all, angle]);
    if (shape !== built) {
      built = shape;
      lines = joints.map(line);
      followers = all.map(followerLine);
      replace(list, ...[...lines, ...followers].map((one) => one.element));
    }
    const inRad = toRadians(joints, q, angle);
    followers.forEach(({ field }, k) => {
      const one = all[k];
      if (!one) return;
      const value = followerValue(one, all, joints, inRad);
      field.textContent = typed(Number(fromRadians(one, value, angle).toPrecision(9)));
    });
    lines.forEach((one, k) => {
      const value = q[k] ?? 0;
      one.slider.value = String(value);
      if (one.field !== document.activeElement) one.field.value = typed(value);
      const beyond = value < one.lower - 1e-9 || value > one.upper + 1e-9;
      one.element.classList.toggle('beyond', beyond && joints[k]?.lower !== null);
      one.field.title = beyond ? t.beyondLimit : '';
    });
  }

  store.subscribe(({ model, q, angle }) => [model, q, angle], render);
  render();
  return list;
}
