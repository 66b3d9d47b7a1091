/** Obstacles in numbers: one line each. */
import type { Obstacle } from '../api';
import { button, h, replace, select } from '../dom';
import { readNumber, typed } from '../format';
import { t } from '../i18n';
import type { Store } from '../state';

const NEW: Record<Obstacle['type'], Obstacle> = {
  sphere: { type: 'sphere', center: [0.5, 0, 0.5], radius: 0.1 },
  circle: { type: 'circle', center: [0.5, 0.3], radius: 0.1 },
  box: { type: 'box', center: [0.5, 0, 0.3], size: [0.2, 0.2, 0.2] },
  capsule: { type: 'capsule', start: [0.5, 0, 0], end: [0.5, 0, 0.5], radius: 0.05 },
  half_space: { type: 'half_space', normal: [0, 0, 1], offset: 0 },
};

export function obstacleEditor(store: Store): { element: HTMLElement; render(): void } {
  const list = h('div');
  const kind = select(
    t.obstacle,
    (Object.keys(NEW) as Obstacle['type'][]).map((one) => [one, t.obstacleKinds[one]]),
    'sphere',
    () => {},
  );
  let built = '';
  const put = (obstacles: readonly Obstacle[], how: string): void =>
    store.set({ path: { ...store.state.path, obstacles } }, `obstacles ${how}`);

  function line(one: Obstacle, index: number): HTMLElement {
    const fields = Object.entries(one).filter(([name]) => name !== 'type') as [
      string,
      number | readonly number[],
    ][];
    return h(
      'div',
      { class: 'line obstacle', role: 'group', 'aria-label': `${t.obstacle} ${index + 1}` },
      h('b', {}, t.obstacleKinds[one.type]),
      ...fields.flatMap(([name, value]) => {
        const values = typeof value === 'number' ? [value] : value;
        return [
          h(
            'span',
            { class: 'note' },
            t.obstacleFields[name as keyof typeof t.obstacleFields] ?? name,
          ),
          ...values.map((x, k) => {
            const field = h('input', {
              type: 'text',
              inputmode: 'decimal',
              class: 'value',
              value: typed(x),
              'aria-label': `${t.obstacle} ${index + 1}, ${name} ${k + 1}`,
              oninput: () => {
                const read = readNumber(field.value);
                field.setAttribute('aria-invalid', String(read === null));
                if (read === null) return;
                const now = store.state.path.obstacles[index] as unknown as Record<
                  string,
                  number | readonly number[]
                >;
                const before = now[name];
                const after = Array.isArray(before)
                  ? (before as readonly number[]).with(k, read)
                  : read;
                built = '';
                put(
                  store.state.path.obstacles.with(index, {
                    ...now,
                    [name]: after,
                  } as unknown as Obstacle),
                  `${index} ${name}`,
                );
              },
            });
            return field;
          }),
        ];
      }),
      button('×', () => put(store.state.path.obstacles.toSpliced(index, 1), 'remove'), {
        'aria-label': `${t.removeObstacle} ${index + 1}`,
      }),
    );
  }

  return {
    element: h(
      'fieldset',
      {},
      h('legend', {}, t.obstacles),
      list,
      h(
        'div',
        { class: 'line' },
        kind,
        button(t.add, () =>
          put([...store.state.path.obstacles, NEW[kind.value as Obstacle['type']]], 'add'),
        ),
      ),
    ),
    render() {
      const { obstacles } = store.state.path;
      const shape = JSON.stringify(obstacles);
      if (
        shape === built ||
        (list.contains(document.activeElement) && list.childElementCount === obstacles.length)
      )
        return;
      built = shape;
      replace(list, ...obstacles.map(line));
    },
  };
}
