/** Obstacles in numbers: one line each. */
import type { Obstacle } from '../../api';
import { button, h, replace, select } from '../../dom';
import { readNumber, typed } from '../../format';
import { t } from '../../i18n';
import type { Page } from '../../page';

type Kind = Obstacle['type'];
type Values = Record<string, number | readonly number[]>;

const NEW: Record<Kind, Obstacle> = {
  sphere: { type: 'sphere', center: [0.5, 0, 0.5], radius: 0.1 },
  circle: { type: 'circle', center: [0.5, 0.3], radius: 0.1 },
  box: { type: 'box', center: [0.5, 0, 0.3], size: [0.2, 0.2, 0.2] },
  capsule: { type: 'capsule', start: [0.5, 0, 0], end: [0.5, 0, 0.5], radius: 0.05 },
  half_space: { type: 'half_space', normal: [0, 0, 1], offset: 0 },
};

export function obstacleEditor({ store, history }: Page): HTMLElement {
  const list = h('div');
  const kind = select(
    t.obstacle,
    (Object.keys(NEW) as Kind[]).map((one) => [one, t.obstacleKinds[one]]),
    'sphere',
    () => {},
  );
  let built = '';

  const current = (): readonly Obstacle[] => store.state.path.obstacles;
  const put = (obstacles: readonly Obstacle[], how: string): void =>
    history.change({ path: { ...store.state.path, obstacles } }, `obstacles ${how}`);

  /** Change a number of an obstacle, or the component `k` where it is a vector. */
  function setNumber(index: number, name: string, k: number, value: number): void {
    const { type, ...values } = current()[index] as Obstacle & Values;
    const before = values[name];
    const after = typeof before === 'object' ? before.with(k, value) : value;
    // The field shows the change already; the list is built anew once it is left.
    built = '';
    const changed = { type, ...values, [name]: after } as Obstacle;
    put(current().with(index, changed), `${index} ${name}`);
  }

  function numberField(index: number, name: string, k: number, value: number): HTMLElement {
    const field = h('input', {
      type: 'text',
      inputmode: 'decimal',
      class: 'value',
      value: typed(value),
      'aria-label': `${t.obstacle} ${index + 1}, ${name} ${k + 1}`,
      oninput: () => {
        const read = readNumber(field.value);
        field.setAttribute('aria-invalid', String(read === null));
        if (read !== null) setNumber(index, name, k, read);
      },
    });
    return field;
  }

  function line({ type, ...values }: Obstacle, index: number): HTMLElement {
    return h(
      'div',
      { class: 'line obstacle', role: 'group', 'aria-label': `${t.obstacle} ${index + 1}` },
      h('b', {}, t.obstacleKinds[type]),
      ...Object.entries(values as Values).flatMap(([name, value]) => [
        h(
          'span',
          { class: 'note' },
          t.obstacleFields[name as keyof typeof t.obstacleFields] ?? name,
        ),
        ...[value].flat().map((x, k) => numberField(index, name, k, x)),
      ]),
      button('×', () => put(current().toSpliced(index, 1), 'remove'), {
        'aria-label': `${t.removeObstacle} ${index + 1}`,
      }),
    );
  }

  function render(): void {
    const obstacles = current();
    const shape = JSON.stringify(obstacles);
    const isTyping =
      list.contains(document.activeElement) && list.childElementCount === obstacles.length;
    if (shape === built || isTyping) return;
    built = shape;
    replace(list, ...obstacles.map(line));
  }

  store.subscribe(({ path }) => path.obstacles, render);
  render();
  return h(
    'fieldset',
    {},
    h('legend', {}, t.obstacles),
    list,
    h(
      'div',
      { class: 'line' },
      kind,
      button(t.add, () => put([...current(), NEW[kind.value as Kind]], 'add')),
    ),
  );
}
