/** A target in numbers, how near the arm comes to it, and all its solutions. */
import type * as api from '../api';
import { button, h, replace } from '../dom';
import { brief, fixed, readNumber, typed } from '../format';
import { t } from '../i18n';
import type { Page } from '../page';
import { findAll, follow, forget, onSolved } from '../solve';

/** Typing rests for this long before the arm moves, ms. */
const PAUSE = 350;

export function ikPanel(page: Page): HTMLElement {
  const { store } = page;
  const names = ['x', 'y', 'z', 'roll', 'pitch', 'yaw'];
  const fields = names.map((name, k) => {
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
  const list = h('ul', { class: 'solutions' });
  const units = h('span', { class: 'note' });
  let typing: ReturnType<typeof setTimeout>;

  /** Position and roll-pitch-yaw of the target; of one that was dragged those of the arm's tool. */
  function values(): (number | null)[] {
    const { target } = store.state;
    const pose = Object.values(page.answers.fk?.poses ?? {})[0];
    const position =
      target?.position ?? target?.matrix?.slice(0, 3).map((row) => row[3] ?? 0) ?? [];
    const rpy = target?.rpy ?? (target?.matrix ? (pose?.rpy ?? []) : []);
    return names.map((_, k) => (k < 3 ? position[k] : rpy[k - 3]) ?? null);
  }

  function put(k: number, field: HTMLInputElement): void {
    const value = readNumber(field.value);
    field.setAttribute('aria-invalid', String(value === null));
    if (value === null) return;
    const now = values()
      .with(k, value)
      .map((one) => one ?? 0);
    store.set({ target: { position: now.slice(0, 3), rpy: now.slice(3) } }, `target${k}`);
    // "0.5" begins with "0": the arm waits until the number is there.
    clearTimeout(typing);
    typing = setTimeout(() => follow(page, true), PAUSE);
  }

  function take(): void {
    const pose = Object.values(page.answers.fk?.poses ?? {})[0];
    if (pose) store.set({ target: { position: pose.position, rpy: pose.rpy } }, 'target');
  }

  function render(): void {
    const { target, angle, q } = store.state;
    const now = values();
    fields.forEach((field, k) => {
      const value = now[k];
      const text = value === null || value === undefined ? '' : typed(Number(value.toFixed(9)));
      if (field !== document.activeElement && field.value !== text) field.value = text;
    });
    units.textContent = `m, ${angle === 'deg' ? '°' : 'rad'}`;
    clear.disabled = !target;
    solve.disabled = !target;
    all.disabled = !target;
    for (const item of list.querySelectorAll<HTMLButtonElement>('button')) {
      const one = item.dataset.q?.split(',').map(Number) ?? [];
      const same = one.every((x, k) => Math.abs(x - (q[k] ?? 0)) < 1e-9);
      item.setAttribute('aria-pressed', String(same));
    }
  }

  function solved(answer: api.IKAnswer | api.IKSolutionsAnswer | null, error: string): void {
    verdict.classList.toggle(
      'bad',
      Boolean(error) || (answer !== null && 'status' in answer && answer.status !== 'converged'),
    );
    if (!answer) {
      verdict.textContent = error;
      return;
    }
    if ('status' in answer) {
      replace(list);
      verdict.textContent = `${t.ikStatus[answer.status]} ${t.ikErrors(brief(answer.position_error, 2), brief(answer.orientation_error, 2))}`;
      return;
    }
    verdict.textContent = t.solutionsFound(
      answer.solutions.length,
      answer.method === 'closed_form',
      answer.complete,
    );
    replace(
      list,
      ...answer.solutions.slice(0, 32).map((one, k) => {
        const text = one.q.map((x) => fixed(x, store.state.angle === 'deg' ? 1 : 3)).join('  ');
        return h(
          'li',
          {},
          h(
            'button',
            {
              type: 'button',
              'aria-pressed': 'false',
              'data-q': one.q.join(','),
              onclick: () => store.set({ q: one.q }, 'solution'),
            },
            h('b', {}, `${k + 1}`),
            h('span', { class: 'mono' }, text),
            h(
              'span',
              { class: 'note' },
              [
                one.posture
                  .map((word) => t.postures[word as keyof typeof t.postures] ?? word)
                  .join(', '),
                one.within_limits ? '' : t.beyondLimits,
              ]
                .filter(Boolean)
                .join(' · '),
            ),
          ),
        );
      }),
    );
    render();
  }

  const solve = button(t.solve, () => follow(page, true));
  const all = button(t.allSolutions, () => findAll(page));
  const clear = button(t.clear, () => {
    forget();
    replace(list);
    verdict.textContent = '';
    store.set({ target: null }, 'target');
  });
  onSolved.push(solved);
  store.listen(render);
  page.onNumbers.push(render);
  page.onModel.push(() => {
    forget();
    replace(list);
    verdict.textContent = '';
  });
  render();
  return h(
    'div',
    {},
    h('p', { class: 'note' }, t.ikHelp),
    h('div', { class: 'line' }, button(t.takePose, take), solve, all, clear, units),
    h(
      'div',
      { class: 'six' },
      h('span', {}, 'x y z'),
      ...fields.slice(0, 3),
      h('span', {}, 'r p y'),
      ...fields.slice(3),
    ),
    verdict,
    list,
  );
}
