/** The table as it is typed, with what the service says of its cells. */
import * as api from '../api';
import { button, h, replace, select } from '../dom';
import { opened, t } from '../i18n';
import type { Page } from '../page';
import {
  addRow,
  COLUMNS,
  type Column,
  carried,
  editable,
  moveRow,
  moving,
  newTable,
  ownColumn,
  readAs,
  removeRow,
  SYMBOLS,
  sendable,
  setCell,
  setLimit,
  setType,
  typeOf,
} from './document';
import { formula } from './formula';
import type { Placements } from './placements';

const LETTERS: Record<api.JointType, string> = {
  revolute: 'R',
  prismatic: 'P',
  continuous: 'C',
  fixed: 'F',
};
const CONVENTIONS = ['standard', 'modified', 'khalil'] as const;

export interface TableView {
  readonly element: HTMLElement;
  /** What the service refused, by pointer; none: all is well. */
  showErrors(errors: readonly api.FieldError[]): void;
}

/** The table that is shown: the one being typed, or that of a stored robot. */
export function shownTable(page: Page): api.TableDocument | null {
  const { source } = page.store.state;
  return source.kind === 'table' ? source.table : (page.model?.table ?? null);
}

export function tableView(page: Page): TableView {
  const { store } = page;
  const convention = select(
    t.convention,
    CONVENTIONS.map((one) => [one, t.conventions[one]]),
    'standard',
    (value) => void convert(page, value as api.Convention),
  );
  const units = h('span', { class: 'note' });
  const other = select(
    t.readAs,
    [['', t.readAs], ...CONVENTIONS.map((one) => [one, t.conventions[one]] as const)],
    '',
    (value) => {
      other.value = '';
      if (value) change('read as', (one) => readAs(one, value as api.Convention));
    },
  );
  other.title = t.readAsHelp;
  const grid = h('div', {
    class: 'scroll',
    role: 'region',
    tabindex: 0,
    'aria-label': t.tableRows,
  });
  const help = h('p', { class: 'note help', id: 'column-help' });
  const problems = h('ul', { class: 'problems', 'aria-label': t.problems });
  const links = formula(page, choose);
  const ends = h(
    'details',
    {
      class: 'fold',
      ontoggle: () =>
        void import('./placements').then(({ placements }) => {
          if (!places) ends.append((places = placements(edit)).element);
          const document = current();
          if (document) places.render(document);
        }),
    },
    h('summary', {}, t.baseAndTool),
  );
  let places: Placements | null = null;
  let built = '';
  let cells = new Map<string, HTMLInputElement | HTMLSelectElement>();

  /** The table from now on; joints keep their values, and the row that is shown stays shown. */
  function edit(document: api.TableDocument, kind: string): void {
    const { q, row } = store.state;
    const before = current();
    const joints =
      before && moving(before).length === q.length ? moving(before) : (page.model?.joints ?? []);
    const name = row === null ? undefined : before?.joints[row]?.name;
    const found = document.joints.findIndex((one) => one.name === name);
    store.set(
      {
        source: { kind: 'table', table: document },
        ...(joints.length === q.length ? { q: carried(joints, document, q) } : {}),
        row: row === null || found < 0 ? null : found,
      },
      kind,
    );
  }

  /** Shows a row in its motions; a URDF has no such frames, its table does. */
  function choose(change: { row: number | null; step: number }): void {
    const document = current();
    if (document && page.model?.kind === 'urdf' && store.state.source.kind !== 'table') {
      edit(document, 'row');
      page.tell(t.tableShown);
    }
    store.set(change, 'row');
  }

  function current(): api.TableDocument | null {
    return shownTable(page);
  }

  function change(kind: string, how: (document: api.TableDocument) => api.TableDocument): void {
    const document = current();
    if (document) edit(how(document), kind);
  }

  function explain(column: Column): void {
    const document = current();
    if (document) help.textContent = t.columns[document.convention][column];
  }

  function build(document: api.TableDocument): void {
    const columns = COLUMNS[document.convention];
    const tree = document.joints.some(
      (row) => row.ant !== undefined || row.b !== undefined || row.gamma !== undefined,
    );
    const extra = tree ? (['ant', 'gamma', 'b'] as const) : [];
    cells = new Map();
    const input = (
      pointer: string,
      label: string,
      changed: (value: string) => void,
      column?: Column,
    ): HTMLTableCellElement => {
      const field = h('input', {
        type: 'text',
        inputmode: 'text',
        autocomplete: 'off',
        spellcheck: 'false',
        'aria-label': label,
        oninput: () => changed(field.value),
        onfocus: () => {
          field.select();
          if (column) explain(column);
        },
        onkeydown: (event) => step(event as KeyboardEvent, pointer),
      });
      cells.set(pointer, field);
      return h('td', { class: column ? 'cell' : 'bound' }, field);
    };
    const heads = columns.map((column) =>
      h(
        'th',
        { scope: 'col' },
        h(
          'button',
          {
            type: 'button',
            class: `axis-${column === 'alpha' || column === 'a' || (column === 'd' && document.convention === 'khalil') ? 'x' : 'z'}`,
            'aria-describedby': 'column-help',
            title: t.columns[document.convention][column],
            onclick: () => explain(column),
            onmouseenter: () => explain(column),
          },
          SYMBOLS[column],
          h('sub', {}, subscript(document.convention, column)),
        ),
      ),
    );
    const body = document.joints.map((row, k) => {
      const name = `${t.row} ${k + 1}`;
      const pointer = `/joints/${k}`;
      const type = select(
        `${name}, ${t.jointType}`,
        (['revolute', 'prismatic', 'fixed', 'continuous'] as const).map(
          (one) => [one, `${LETTERS[one]}`] as const,
        ),
        typeOf(row),
        (value) => change('type', (one) => setType(one, k, value as api.JointType)),
      );
      type.title = t.types[typeOf(row)];
      cells.set(`${pointer}/type`, type);
      const numberButton = h(
        'button',
        {
          type: 'button',
          class: 'row-number',
          'aria-label': `${name}, ${row.name ?? ''}`,
          title: row.name ?? '',
          onclick: () => choose({ row: store.state.row === k ? null : k, step: 4 }),
        },
        k + 1,
      );
      return h(
        'tr',
        {},
        h('th', { scope: 'row' }, numberButton),
        h('td', {}, type),
        ...extra.map((field) =>
          input(`${pointer}/${field}`, `${name}, ${field}`, (value) =>
            change(`${pointer}/${field}`, (one) =>
              setCell(one, k, field, field === 'ant' ? Number(value) : value),
            ),
          ),
        ),
        ...columns.map((column) =>
          input(
            `${pointer}/${column}`,
            `${name}, ${SYMBOLS[column]}`,
            (value) => change(`${pointer}/${column}`, (one) => setCell(one, k, column, value)),
            column,
          ),
        ),
        ...(['lower', 'upper'] as const).map((bound) =>
          typeOf(row) === 'fixed' || typeOf(row) === 'continuous'
            ? h('td')
            : input(`${pointer}/limits/${bound}`, `${name}, ${t[bound]}`, (value) =>
                change(`${pointer}/limits/${bound}`, (one) => setLimit(one, k, bound, value)),
              ),
        ),
        h(
          'td',
          { class: 'tools' },
          button('↑', () => change('move', (one) => moveRow(one, k, k - 1)), {
            'aria-label': t.moveUp(k + 1),
            title: t.moveUp(k + 1),
            disabled: k === 0,
          }),
          button('↓', () => change('move', (one) => moveRow(one, k, k + 1)), {
            'aria-label': t.moveDown(k + 1),
            title: t.moveDown(k + 1),
            disabled: k === document.joints.length - 1,
          }),
          button('+', () => change('add', (one) => addRow(one, k)), {
            'aria-label': t.addAfter(k + 1),
            title: t.addAfter(k + 1),
          }),
          button('×', () => change('remove', (one) => removeRow(one, k)), {
            'aria-label': t.remove(k + 1),
            title: t.remove(k + 1),
            disabled: document.joints.length === 1,
          }),
        ),
      );
    });
    replace(
      grid,
      h(
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
            h(
              'th',
              { scope: 'col', title: t.jointType },
              h('span', { class: 'hidden' }, t.jointType),
            ),
            ...extra.map((one) => h('th', { scope: 'col' }, one)),
            ...heads,
            h('th', { scope: 'col', class: 'bound' }, t.lower),
            h('th', { scope: 'col', class: 'bound' }, t.upper),
            h('td'),
          ),
        ),
        h('tbody', {}, ...body),
      ),
    );
  }

  function fill(document: api.TableDocument): void {
    document.joints.forEach((row, k) => {
      const write = (pointer: string, value: unknown, digits = 12): void => {
        const field = cells.get(`/joints/${k}/${pointer}`);
        if (
          !field ||
          (field === window.document.activeElement && field.value !== '' && isTyping(field))
        )
          return;
        const text =
          value === undefined || value === null ? '' : cellText(value as api.Cell, digits);
        if (field.value !== text) field.value = text;
        // What is longer than its cell can be read all the same.
        const whole = String(value ?? '');
        if (!(field instanceof HTMLSelectElement)) field.title = whole.length > 7 ? whole : '';
      };
      for (const column of ['theta', 'd', 'a', 'alpha', 'r', 'b', 'gamma', 'ant'] as const)
        write(column, row[column]);
      write('limits/lower', row.limits?.lower, 4);
      write('limits/upper', row.limits?.upper, 4);
      const own = ownColumn(row, document.convention);
      for (const column of COLUMNS[document.convention]) {
        cells.get(`/joints/${k}/${column}`)?.classList.toggle('variable', column === own);
      }
    });
  }

  /** A cell is being typed into: its text is the state's already. */
  function isTyping(field: HTMLElement): boolean {
    return store.state.source.kind === 'table' && field.dataset.typing === 'yes';
  }

  function step(event: KeyboardEvent, pointer: string): void {
    const down = event.key === 'ArrowDown' || event.key === 'Enter';
    if (!down && event.key !== 'ArrowUp') return;
    const next = pointer.replace(/\d+/, (k) => String(Number(k) + (down ? 1 : -1)));
    const field = cells.get(next);
    if (field) {
      event.preventDefault();
      field.focus();
    }
  }

  function render(): void {
    const document = current();
    element.classList.toggle('empty', !document);
    if (!document) {
      replace(grid, h('p', { class: 'note' }, page.model ? t.noTable : t.loading));
      built = '';
      return;
    }
    const shape = JSON.stringify([
      document.convention,
      document.joints.map((row) => [row.type, row.name, row.ant]),
      t.lower,
    ]);
    if (shape !== built) {
      build(document);
      built = shape;
    }
    fill(document);
    convention.value = document.convention;
    const { angle = 'rad', length = 'm' } = document.units ?? {};
    units.textContent = t.tableUnits(angle, length);
    for (const [k, line] of [...grid.querySelectorAll('tbody tr')].entries()) {
      line.classList.toggle('chosen', k === store.state.row);
      line
        .querySelector('.row-number')
        ?.setAttribute('aria-pressed', String(k === store.state.row));
    }
    links.render(document);
    places?.render(document);
  }

  grid.addEventListener('input', (event) => mark(event.target, 'yes'));
  grid.addEventListener('focusout', (event) => mark(event.target, ''));
  function mark(target: EventTarget | null, value: string): void {
    if (target instanceof HTMLElement) target.dataset.typing = value;
  }

  grid.addEventListener('paste', (event) => {
    const pasted = event.clipboardData?.getData('text/plain') ?? '';
    if (!/[\n\t|&]/.test(pasted.trim())) return;
    event.preventDefault();
    void opened(import('./paste')).then(({ pasteDialog }) => pasteDialog(page, pasted, true));
  });

  const element = h(
    'section',
    { class: 'card', 'aria-labelledby': 'table-title' },
    h(
      'div',
      { class: 'line spread' },
      h('h2', { id: 'table-title' }, t.table),
      h('label', {}, `${t.convention} `, convention),
    ),
    h(
      'div',
      { class: 'line spread small' },
      units,
      h(
        'span',
        { class: 'line' },
        other,
        button(t.newTable, () => {
          const start = current();
          const table = newTable(start?.convention ?? 'standard', store.state.angle);
          store.set(
            { source: { kind: 'table', table }, q: [], row: null, target: null, kept: [] },
            'new',
          );
        }),
        button(
          t.paste,
          () =>
            void opened(import('./paste')).then(({ pasteDialog }) => pasteDialog(page, '', false)),
        ),
      ),
    ),
    links.element,
    grid,
    problems,
    help,
    ends,
  );

  store.listen(render);
  page.onModel.push(render);
  render();

  return {
    element,
    showErrors(errors) {
      for (const field of element.querySelectorAll('[aria-invalid]')) {
        field.removeAttribute('aria-invalid');
        field.removeAttribute('aria-describedby');
      }
      const lines = errors.map((error, k) => {
        const pointer = error.pointer.replace(/^\/robot/, '').replace(/\/(offset|sign)$/, '');
        const field =
          [...cells.entries()].find(([key]) => key === pointer)?.[1] ??
          places?.field(pointer) ??
          cells.get(`${pointer}/theta`) ??
          cells.get(`${pointer}/type`);
        field?.setAttribute('aria-invalid', 'true');
        field?.setAttribute('aria-describedby', `problem-${k}`);
        const text = h('span', { lang: 'en', id: `problem-${k}` }, error.message);
        return h(
          'li',
          {},
          field ? button('→', () => field.focus(), { 'aria-label': t.goToCell }) : false,
          text,
        );
      });
      replace(problems, ...lines);
      problems.hidden = !lines.length;
    },
  };
}

/** Numbers with what matters of so many digits: 166.00306198325342 is 166.003061983. */
function cellText(value: api.Cell, digits: number): string {
  return typeof value === 'number' ? String(Number(value.toPrecision(digits))) : value;
}

/** Craig's a and α bear the number of the row before. */
function subscript(convention: api.Convention, column: Column): string {
  return convention === 'modified' && (column === 'a' || column === 'alpha') ? 'k−1' : 'k';
}

/** The same arm in another convention, by the service. */
async function convert(page: Page, to: api.Convention): Promise<void> {
  const { store } = page;
  const { source } = store.state;
  if (source.kind === 'stored') {
    store.set({ source: { ...source, convention: to } }, 'convention');
    return;
  }
  try {
    if (source.kind === 'table') {
      const { angle = 'rad' } = source.table.units ?? {};
      const table = sendable({ name: 'table', ...source.table });
      const converted = await api.json<api.TableDocument>(api.convertTable(table, to, angle));
      store.set({ source: { kind: 'table', table: editable(converted) } }, 'convention');
    } else {
      const table = await api.json<api.TableDocument>(
        api.urdfToTable(source.urdf, to, store.state.angle),
      );
      store.set({ source: { kind: 'table', table: editable(table) } }, 'convention');
    }
  } catch (error) {
    page.tell(error instanceof Error ? error.message : String(error), true);
    store.set({});
  }
}
