/** Base and tool of a table: a point with roll-pitch-yaw, or a matrix where it has one. */
import type { Cell, Placement, TableDocument } from '../api';
import { button, h, replace } from '../dom';
import { readNumber } from '../format';
import { t } from '../i18n';

const ENDS = ['base', 'tool'] as const;
const ZERO: readonly Cell[] = [0, 0, 0];

export interface Placements {
  readonly element: HTMLElement;
  render(document: TableDocument): void;
  /** The field that a pointer such as `/tool/xyz/0` names. */
  field(pointer: string): HTMLInputElement | undefined;
}

export function placementsView(edit: (document: TableDocument, kind: string) => void): Placements {
  const element = h('div');
  let built = '';
  let document: TableDocument;
  const fields = new Map<string, HTMLInputElement>();

  function put(end: 'base' | 'tool', part: 'xyz' | 'rpy', k: number, value: string): void {
    const before = document[end] ?? {};
    const cells = (before[part] ?? ZERO).with(k, value);
    edit(
      { ...document, [end]: { xyz: ZERO, rpy: ZERO, ...before, [part]: cells } },
      `${end}/${part}/${k}`,
    );
  }

  function row(end: 'base' | 'tool', given: Placement | undefined): HTMLElement {
    if (given?.matrix || given?.quaternion_xyzw) {
      return h(
        'fieldset',
        {},
        h('legend', {}, t[end]),
        h(
          'pre',
          { class: 'mono' },
          (given.matrix ?? [given.quaternion_xyzw ?? []])
            .map((line) => line.map((x) => String(Number(x.toPrecision(6))).padStart(9)).join(' '))
            .join('\n'),
        ),
        button(t.replaceByPoint, () =>
          edit(
            {
              ...document,
              [end]: {
                xyz: given.xyz ?? given.matrix?.slice(0, 3).map((one) => one[3] ?? 0) ?? ZERO,
                rpy: ZERO,
              },
            },
            end,
          ),
        ),
      );
    }
    const inputs = (['xyz', 'rpy'] as const).flatMap((part) =>
      ['x', 'y', 'z'].map((axis, k) => {
        const label = `${t[end]}, ${part === 'xyz' ? axis : ['roll', 'pitch', 'yaw'][k]}`;
        const field = h('input', {
          type: 'text',
          'aria-label': label,
          autocomplete: 'off',
          oninput: () => put(end, part, k, field.value),
        });
        fields.set(`${end}/${part}/${k}`, field);
        return field;
      }),
    );
    return h(
      'fieldset',
      {},
      h('legend', {}, t[end]),
      h(
        'div',
        { class: 'six' },
        h('span', {}, 'x y z'),
        ...inputs.slice(0, 3),
        h('span', {}, 'r p y'),
        ...inputs.slice(3),
      ),
    );
  }

  return {
    element,
    // The service may name a whole end, `/tool`: its first field that is not a number.
    field: (pointer) =>
      fields.get(pointer.slice(1)) ??
      [...fields].find(
        ([key, one]) => key.startsWith(`${pointer.slice(1)}/`) && readNumber(one.value) === null,
      )?.[1],
    render(next) {
      document = next;
      const shape = JSON.stringify(
        ENDS.map((end) => [
          Boolean(next[end]?.matrix),
          next[end]?.matrix,
          next[end]?.quaternion_xyzw,
        ]),
      );
      if (shape !== built) {
        built = shape;
        fields.clear();
        replace(element, ...ENDS.map((end) => row(end, next[end])));
      }
      for (const [key, field] of fields) {
        const [end, part, k] = key.split('/') as ['base' | 'tool', 'xyz' | 'rpy', string];
        const text = String(next[end]?.[part]?.[Number(k)] ?? 0);
        if (field !== window.document.activeElement && field.value !== text) field.value = text;
      }
    },
  };
}
