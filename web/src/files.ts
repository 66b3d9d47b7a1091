/** Robots in and out: files that are opened, downloads, and what is stored on the service. */
import * as api from './api';
import { dialog } from './dialog';
import { button, h } from './dom';
import { t } from './i18n';
import { resolve } from './model';
import type { Page } from './page';
import { START } from './state';
import { editable, sendable } from './table/document';
import { shownTable } from './table/view';

const KINDS: Record<string, string> = {
  yaml: 'application/yaml',
  yml: 'application/yaml',
  json: 'application/json',
  csv: 'text/csv',
  par: 'text/x-symoro',
};
const FORMATS = [
  ['yaml', 'YAML', 'yaml'],
  ['json', 'JSON', 'json'],
  ['csv', 'CSV', 'csv'],
  ['markdown', 'Markdown', 'md'],
  ['latex', 'LaTeX', 'tex'],
  ['matlab', 'MATLAB', 'm'],
  ['par', 'SYMORO', 'par'],
  ['tsv', 'TSV', 'tsv'],
] as const;

/** Opens a URDF, or a table in any form; nothing is stored on the service. */
export async function openFile(page: Page, file: File): Promise<void> {
  const text = await file.text();
  const [, stem = 'robot', ending = ''] = /^(.*?)\.?([^.]*)$/.exec(file.name) ?? [];
  const { store } = page;
  if (
    ['urdf', 'xml'].includes(ending.toLowerCase()) ||
    /^\s*(<\?xml[^>]*>\s*)?(<!--[\s\S]*?-->\s*)*<robot\b/.test(text)
  ) {
    const source = { kind: 'urdf', name: stem, urdf: text } as const;
    try {
      // One that cannot be used leaves the page as it is.
      await resolve(source, store.state.angle, new AbortController().signal);
      store.set(
        { source, q: [], task: START.task, row: null, target: null, kept: [], path: START.path },
        'open',
      );
    } catch (error) {
      page.tell(words(error), true);
    }
    return;
  }
  const kind = KINDS[ending.toLowerCase()];
  if (!kind) {
    const { pasteDialog } = await import('./table/paste');
    pasteDialog(page, text, true);
    return;
  }
  const said = /["']?convention["']?\s*:\s*["']?([\w-]+)/i.exec(text)?.[1];
  const shown = shownTable(page)?.convention ?? 'standard';
  const to = kind === 'text/x-symoro' ? 'khalil' : (said ?? shown);
  const query: Record<string, string> = { to, angle: store.state.angle };
  if (kind === 'text/csv') query.convention = to;
  if (kind !== 'text/x-symoro') query.name = stem.replace(/[^\w.-]+/g, '-') || 'table';
  try {
    const call: api.Call = { method: 'POST', path: 'v1/convert-dh', query, body: text, type: kind };
    const table = await api.json<api.TableDocument>(call);
    store.set(
      {
        source: { kind: 'table', table: editable(table) },
        q: [],
        task: START.task,
        row: null,
        target: null,
        kept: [],
        path: START.path,
      },
      'open',
    );
  } catch (error) {
    page.tell(words(error), true);
  }
}

export function downloadDialog(page: Page): void {
  const table = shownTable(page);
  const name = page.model && 'id' in page.model.ref ? page.model.ref.id : (table?.name ?? 'robot');
  const { state } = page.store;
  const line = (text: string, ending: string, read: () => Promise<string>): HTMLElement =>
    button(
      text,
      () =>
        void read().then(
          (found) => give(found, `${name}.${ending}`),
          (error: unknown) => page.tell(words(error), true),
        ),
    );
  const written = (format: string): Promise<string> => {
    if (state.source.kind === 'stored') {
      const convention = table?.convention ?? 'standard';
      return api.text(api.readTable(state.source.id, convention, state.angle, format));
    }
    const document = sendable({
      name,
      ...table,
      joints: table?.joints ?? [],
      convention: table?.convention ?? 'standard',
    });
    return api.text(
      api.convertTable(document, document.convention, document.units?.angle ?? 'rad', format),
    );
  };
  dialog(
    t.download,
    h(
      'div',
      { class: 'line' },
      line('URDF', 'urdf', () => Promise.resolve(page.model?.urdf ?? '')),
      ...(table
        ? FORMATS.map(([format, label, ending]) => line(label, ending, () => written(format)))
        : []),
    ),
  );
}

function give(text: string, name: string): void {
  const url = URL.createObjectURL(new Blob([text]));
  h('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** Stores the robot on the service under a name of its own. */
export function saveDialog(page: Page): void {
  const { store } = page;
  const { source } = store.state;
  if (source.kind === 'stored') return;
  const start = source.kind === 'table' ? (source.table.name ?? '') : source.name;
  const field = h('input', {
    type: 'text',
    autocomplete: 'off',
    spellcheck: 'false',
    value: start,
    onkeydown: (event) => {
      if ((event as KeyboardEvent).key === 'Enter') void save();
    },
  });
  const problem = h('p', { class: 'verdict bad', role: 'alert', lang: 'en' });
  async function save(): Promise<void> {
    if (source.kind === 'stored') return;
    const name = field.value.trim();
    const document = source.kind === 'table' ? sendable({ ...source.table, name }) : source.urdf;
    try {
      const view = await api.json<api.RobotView>(api.createRobot(name, document));
      window.close();
      store.set({ source: { kind: 'stored', id: view.id, convention: null } }, 'save');
      page.tell(t.saved(view.id));
    } catch (error) {
      problem.textContent = words(error);
    }
  }
  const window = dialog(
    t.save,
    h('p', { class: 'note' }, t.saveHelp),
    h(
      'div',
      { class: 'line' },
      h('label', {}, `${t.name} `, field),
      button(t.save, () => void save(), { class: 'main' }),
    ),
    problem,
  );
  field.focus();
}

function words(error: unknown): string {
  if (error instanceof api.Refusal)
    return error.errors.map((one) => one.message).join('; ') || error.detail;
  if (error instanceof api.Unreachable) return t.unreachable;
  throw error;
}
