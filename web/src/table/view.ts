/** The card of the table: its convention, its rows as they are typed, and what is wrong with them. */
import type { Convention, TableDocument } from '../api';
import { button, h, replace, select } from '../dom';
import { opened, t } from '../i18n';
import type { Page } from '../page';
import { Cells } from './cells';
import type { Column } from './convention';
import { newTable, readAs } from './document';
import { convertTo, editTable, replaceTable } from './editing';
import { formula } from './formula';
import { tableGrid } from './grid';
import type { Placements } from './placements';
import { showProblems } from './problems';
import { shownTable } from './shown';

const CONVENTIONS = ['standard', 'modified', 'khalil'] as const;

export function tableView(page: Page): HTMLElement {
  const { store, history } = page;
  const conventions = CONVENTIONS.map((one) => [one, t.conventions[one]] as const);
  const convention = select(t.convention, conventions, 'standard', (value) => {
    // Where the service cannot convert it the table stays, and the select shows so.
    void convertTo(page, value as Convention).then(render);
  });
  const other = select(t.readAs, [['', t.readAs], ...conventions], '', (value) => {
    other.value = '';
    if (value) editTable(page, 'read as', (one) => readAs(one, value as Convention));
  });
  other.title = t.readAsHelp;
  const units = h('span', { class: 'note' });
  const rows = h('div', {
    class: 'scroll',
    role: 'region',
    tabindex: 0,
    'aria-label': t.tableRows,
    onpaste: (event) => pasted(event as ClipboardEvent),
  });
  const help = h('p', { class: 'note help', id: 'column-help' });
  const problems = h('ul', { class: 'problems', 'aria-label': t.problems, hidden: true });
  const motions = formula(page);
  const ends = h(
    'details',
    { class: 'fold', ontoggle: () => void openEnds() },
    h('summary', {}, t.baseAndTool),
  );
  const cells = new Cells({ isEdited: () => store.state.source.kind === 'table', explain });
  let placements: Placements | null = null;
  let built = '';

  function explain(column: Column): void {
    const document = shownTable(store.state);
    if (document) help.textContent = t.columns[document.convention][column];
  }

  /** Base and tool, whose code is loaded when they are opened first. */
  async function openEnds(): Promise<void> {
    const { placementsView } = await import('./placements');
    if (!placements) {
      placements = placementsView((document, kind) => replaceTable(page, document, kind));
      ends.append(placements.element);
    }
    const document = shownTable(store.state);
    if (document) placements.render(document);
  }

  function openPaste(text: string, atOnce: boolean): void {
    void opened(import('./paste')).then(({ pasteDialog }) => pasteDialog(page, text, atOnce));
  }

  /** Text of more than one cell is a table. */
  function pasted(event: ClipboardEvent): void {
    const text = event.clipboardData?.getData('text/plain') ?? '';
    if (!/[\n\t|&]/.test(text.trim())) return;
    event.preventDefault();
    openPaste(text, true);
  }

  function startNew(): void {
    const { state } = store;
    const table = newTable(shownTable(state)?.convention ?? 'standard', state.angle);
    history.change(
      { source: { kind: 'table', table }, q: [], row: null, target: null, kept: [] },
      'new',
    );
  }

  /** Build the rows anew where they are others; else only their values change. */
  function build(document: TableDocument): void {
    const { convention: name, joints } = document;
    const shape = JSON.stringify([name, joints.map((row) => [row.type, row.name, row.ant])]);
    if (shape === built) return;
    built = shape;
    cells.clear();
    replace(rows, tableGrid(page, document, cells, explain));
  }

  function render(): void {
    const { state } = store;
    const document = shownTable(state);
    card.classList.toggle('empty', !document);
    if (!document) {
      replace(rows, h('p', { class: 'note' }, state.model ? t.noTable : t.loading));
      built = '';
      return;
    }
    build(document);
    cells.fill(document);
    convention.value = document.convention;
    const { angle = 'rad', length = 'm' } = document.units ?? {};
    units.textContent = t.tableUnits(angle, length);
    for (const [k, line] of [...rows.querySelectorAll('tbody tr')].entries()) {
      const isChosen = k === state.row;
      line.classList.toggle('chosen', isChosen);
      line.querySelector('.row-number')?.setAttribute('aria-pressed', String(isChosen));
    }
    motions.render(document);
    placements?.render(document);
  }

  function fieldOf(pointer: string): HTMLElement | undefined {
    return (
      cells.get(pointer) ??
      placements?.field(pointer) ??
      cells.get(`${pointer}/theta`) ??
      cells.get(`${pointer}/type`)
    );
  }

  const card = h(
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
        button(t.newTable, startNew),
        button(t.paste, () => openPaste('', false)),
      ),
    ),
    motions.element,
    rows,
    problems,
    help,
    ends,
  );
  store.subscribe(({ source, model, row, step }) => [source, model, row, step], render);
  store.subscribe(
    ({ errors }) => errors,
    (errors) => {
      const { source } = store.state;
      showProblems(problems, card, errors, fieldOf, source.kind === 'urdf' ? source.urdf : '');
    },
  );
  render();
  return card;
}
