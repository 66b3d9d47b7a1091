/** A target in numbers, how near the arm comes to it, and all its solutions. */
import type * as api from '../api';
import { button, h, replace } from '../dom';
import { brief, fixed, readNumber, typed } from '../format';
import { t } from '../i18n';
import type { Page } from '../page';
import { findAll, follow } from '../solve';
import { type Solved, tipPose } from '../state';
import { positionOf } from '../target';

/** The arm follows a typed number once typing has rested for this time, ms. */
const PAUSE = 350;
/** Most solutions that are listed. */
const MOST = 32;
const NAMES = ['x', 'y', 'z', 'roll', 'pitch', 'yaw'];

export function ikPanel(page: Page): HTMLElement {
  const { store, history } = page;
  const fields = NAMES.map((name, k) => {
    const field = h('input', {
      type: 'text',
      inputmode: 'decimal',
      autocomplete: 'off',
      'aria-label': `${t.target}, ${name}`,
      oninput: () => put(k, field),
      onkeydown: (event) => {
        if ((event as KeyboardEvent).key !== 'Enter') return;
        clearTimeout(typing);
        follow(page, true);
      },
    });
    return field;
  });
  const verdict = h('p', { class: 'verdict', role: 'status' });
  const why = h('ul', { class: 'note' });
  const list = h('ul', { class: 'solutions' });
  const units = h('span', { class: 'note' });
  let typing: ReturnType<typeof setTimeout>;

  /** Position and roll-pitch-yaw of the target; the angles of a dragged one are the tool's. */
  function values(): (number | null)[] {
    const { target } = store.state;
    const position = positionOf(target) ?? [];
    const rpy = target?.rpy ?? (target?.matrix ? (tipPose(store.state)?.rpy ?? []) : []);
    return NAMES.map((_, k) => (k < 3 ? position[k] : rpy[k - 3]) ?? null);
  }

  function put(k: number, field: HTMLInputElement): void {
    const value = readNumber(field.value);
    field.setAttribute('aria-invalid', String(value === null));
    if (value === null) return;
    const now = values()
      .with(k, value)
      .map((one) => one ?? 0);
    history.change({ target: { position: now.slice(0, 3), rpy: now.slice(3) } }, `target${k}`);
    // A number is typed digit by digit, "0" before "0.5": the arm does not go to each.
    clearTimeout(typing);
    typing = setTimeout(() => follow(page, true), PAUSE);
  }

  function takePose(): void {
    const pose = tipPose(store.state);
    if (pose) history.change({ target: { position: pose.position, rpy: pose.rpy } }, 'target');
  }

  function render(): void {
    const { target, angle } = store.state;
    const now = values();
    fields.forEach((field, k) => {
      const value = now[k];
      const text = value === null || value === undefined ? '' : typed(Number(value.toFixed(9)));
      if (field !== document.activeElement && field.value !== text) field.value = text;
    });
    units.textContent = `m, ${angle === 'deg' ? '°' : 'rad'}`;
    for (const one of [clear, solve, all]) one.disabled = !target;
    renderChosen();
  }

  function renderChosen(): void {
    const { q } = store.state;
    for (const item of list.querySelectorAll<HTMLButtonElement>('button')) {
      const one = item.dataset.q?.split(',').map(Number) ?? [];
      const isChosen = one.every((x, k) => Math.abs(x - (q[k] ?? 0)) < 1e-9);
      item.setAttribute('aria-pressed', String(isChosen));
    }
  }

  function renderSolved(solved: Solved | null): void {
    const answer = solved?.answer;
    const hasFailed = answer
      ? 'status' in answer && answer.status !== 'converged'
      : solved !== null;
    verdict.classList.toggle('bad', hasFailed);
    verdict.textContent = answer ? wordsOf(answer) : (solved?.error ?? '');
    // The solutions found before stay beside an error.
    if (solved?.error) return;
    replace(why, ...(answer?.explanation ?? []).map((one) => h('li', {}, one)));
    const solutions = answer && 'solutions' in answer ? answer.solutions : [];
    replace(list, ...solutions.slice(0, MOST).map(solutionLine));
    renderChosen();
  }

  function solutionLine(solution: api.IKSolution, k: number): HTMLElement {
    const { q, posture, within_limits, beyond_limits } = solution;
    const beyond = within_limits ? '' : `${t.beyondLimits}: ${beyond_limits?.join(', ') ?? ''}`;
    const digits = store.state.angle === 'deg' ? 1 : 3;
    const words = posture.map((one) => t.postures[one as keyof typeof t.postures] ?? one);
    return h(
      'li',
      {},
      h(
        'button',
        { type: 'button', 'data-q': q.join(','), onclick: () => history.change({ q }, 'solution') },
        h('b', {}, `${k + 1}`),
        h('span', { class: 'mono' }, q.map((x) => fixed(x, digits)).join('  ')),
        h('span', { class: 'note' }, [words.join(', '), beyond].filter(Boolean).join(' · ')),
      ),
    );
  }

  const solve = button(t.solve, () => follow(page, true));
  const all = button(t.allSolutions, () => findAll(page));
  const clear = button(t.clear, () => {
    store.set({ solved: null, solutions: [] });
    history.change({ target: null }, 'target');
  });
  store.subscribe(({ target, angle, q, answers }) => [target, angle, q, answers], render);
  store.subscribe(({ solved }) => solved, renderSolved);
  render();
  return h(
    'div',
    {},
    h('p', { class: 'note' }, t.ikHelp),
    h('div', { class: 'line' }, button(t.takePose, takePose), solve, all, clear, units),
    h(
      'div',
      { class: 'six' },
      h('span', {}, 'x y z'),
      ...fields.slice(0, 3),
      h('span', {}, 'r p y'),
      ...fields.slice(3),
    ),
    verdict,
    why,
    list,
  );
}

function wordsOf(answer: api.IKAnswer | api.IKSolutionsAnswer): string {
  if ('status' in answer) {
    const errors = [answer.position_error, answer.orientation_error] as const;
    return `${t.ikStatus[answer.status]} ${t.ikErrors(brief(errors[0], 2), brief(errors[1], 2))}`;
  }
  const { solutions, method, complete } = answer;
  return t.solutionsFound(solutions.length, method === 'closed_form', complete);
}
