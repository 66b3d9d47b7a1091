/** The rows of the table as an HTML table with a field in each cell. */
import type { Convention, JointType, TableDocument, TableRow } from '../api';
import { button, h, select } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import type { Cells } from './cells';
import { COLUMNS, type Column, SYMBOLS, typeOf } from './convention';
import { addRow, moveRow, removeRow, setCell, setLimit, setType } from './document';
import { chooseRow, editTable } from './editing';

const LETTERS: Record<JointType, string> = {
  revolute: 'R',
  prismatic: 'P',
  fixed: 'F',
  continuous: 'C',
};
/** Columns that only a tree has. */
const TREE = ['ant', 'gamma', 'b'] as const;

/**
 * Build the table; its cells are empty until they are filled.
 *
 * @param cells Where its fields are registered.
 * @param explain Called with the column whose meaning is asked for.
 */
export function tableGrid(
  page: Page,
  document: TableDocument,
  cells: Cells,
  explain: (column: Column) => void,
): HTMLElement {
  const extra = isTree(document) ? TREE : [];
  return h(
    'table',
    { class: 'dh' },
    h('caption', { class: 'hidden' }, t.table),
    h(
      'thead',
      {},
      h(
        'tr',
        {},
        h('th', { scope: 'col' }, 'k'),
        h('th', { scope: 'col', title: t.jointType }, h('span', { class: 'hidden' }, t.jointType)),
        ...extra.map((one) => h('th', { scope: 'col' }, one)),
        ...COLUMNS[document.convention].map((one) => heading(document.convention, one, explain)),
        h('th', { scope: 'col', class: 'bound' }, t.lower),
        h('th', { scope: 'col', class: 'bound' }, t.upper),
        h('td'),
      ),
    ),
    h('tbody', {}, ...document.joints.map((row, k) => line(page, document, cells, row, k))),
  );
}

function isTree({ joints }: TableDocument): boolean {
  return joints.some((row) => TREE.some((column) => row[column] !== undefined));
}

function heading(
  convention: Convention,
  column: Column,
  explain: (column: Column) => void,
): HTMLElement {
  const isAlongX =
    column === 'alpha' || column === 'a' || (column === 'd' && convention === 'khalil');
  return h(
    'th',
    { scope: 'col' },
    h(
      'button',
      {
        type: 'button',
        class: `axis-${isAlongX ? 'x' : 'z'}`,
        'aria-describedby': 'column-help',
        title: t.columns[convention][column],
        onclick: () => explain(column),
        onmouseenter: () => explain(column),
      },
      SYMBOLS[column],
      h('sub', {}, subscript(convention, column)),
    ),
  );
}

/** In the modified convention a and α have the number of the row before. */
function subscript(convention: Convention, column: Column): string {
  return convention === 'modified' && (column === 'a' || column === 'alpha') ? 'k−1' : 'k';
}

function line(
  page: Page,
  document: TableDocument,
  cells: Cells,
  row: TableRow,
  k: number,
): HTMLElement {
  const label = `${t.row} ${k + 1}`;
  const pointer = `/joints/${k}`;
  const columns = [...(isTree(document) ? TREE : []), ...COLUMNS[document.convention]];
  const hasLimits = typeOf(row) === 'revolute' || typeOf(row) === 'prismatic';
  return h(
    'tr',
    {},
    h('th', { scope: 'row' }, numberButton(page, row, k)),
    h('td', {}, typeSelect(page, cells, row, k)),
    ...columns.map((column) => {
      const own = `${pointer}/${column}`;
      const put = (value: string): void =>
        editTable(page, own, (one) =>
          setCell(one, k, column, column === 'ant' ? Number(value) : value),
        );
      if (column === 'ant' || column === 'gamma' || column === 'b') {
        return cells.create(own, `${label}, ${column}`, put);
      }
      return cells.create(own, `${label}, ${SYMBOLS[column]}`, put, column);
    }),
    ...(['lower', 'upper'] as const).map((bound) => {
      const own = `${pointer}/limits/${bound}`;
      if (!hasLimits) return h('td');
      return cells.create(own, `${label}, ${t[bound]}`, (value) =>
        editTable(page, own, (one) => setLimit(one, k, bound, value)),
      );
    }),
    h('td', { class: 'tools' }, ...tools(page, document.joints.length, k)),
  );
}

/** Shows the row's elementary motions, or no longer. */
function numberButton(page: Page, { name = '' }: TableRow, k: number): HTMLElement {
  return h(
    'button',
    {
      type: 'button',
      class: 'row-number',
      'aria-label': `${t.row} ${k + 1}, ${name}`,
      title: name,
      onclick: () => chooseRow(page, { row: page.store.state.row === k ? null : k, step: 4 }),
    },
    k + 1,
  );
}

function typeSelect(page: Page, cells: Cells, row: TableRow, k: number): HTMLElement {
  const element = select(
    `${t.row} ${k + 1}, ${t.jointType}`,
    (['revolute', 'prismatic', 'fixed', 'continuous'] as const).map((one) => [one, LETTERS[one]]),
    typeOf(row),
    (value) => editTable(page, 'type', (one) => setType(one, k, value as JointType)),
  );
  element.title = t.types[typeOf(row)];
  cells.add(`/joints/${k}/type`, element);
  return element;
}

function tools(page: Page, rows: number, k: number): HTMLElement[] {
  const tool = (
    text: string,
    title: string,
    isDisabled: boolean,
    pressed: () => void,
  ): HTMLElement => button(text, pressed, { 'aria-label': title, title, disabled: isDisabled });
  const number = k + 1;
  return [
    tool('↑', t.moveUp(number), k === 0, () =>
      editTable(page, 'move', (one) => moveRow(one, k, k - 1)),
    ),
    tool('↓', t.moveDown(number), number === rows, () =>
      editTable(page, 'move', (one) => moveRow(one, k, k + 1)),
    ),
    tool('+', t.addAfter(number), false, () => editTable(page, 'add', (one) => addRow(one, k))),
    tool('×', t.remove(number), rows === 1, () =>
      editTable(page, 'remove', (one) => removeRow(one, k)),
    ),
  ];
}
