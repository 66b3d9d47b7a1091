/** Downloads of the robot: its URDF, and its table in each format. */
import * as api from '../api';
import { asText } from '../api/files';
import { dialog } from '../dialog';
import { button, h } from '../dom';
import { reasonsOf } from '../failure';
import { t } from '../i18n';
import type { Page } from '../page';
import { sendable } from '../table/exchange';
import { shownTable } from '../table/shown';

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

export function downloadDialog({ store, tell }: Page): void {
  const { model, source, angle } = store.state;
  const table = shownTable(store.state);
  const name = model && 'id' in model.ref ? model.ref.id : (table?.name ?? 'robot');
  const line = (label: string, ending: string, read: () => Promise<string>): HTMLElement =>
    button(
      label,
      () =>
        void read().then(
          (text) => save(text, `${name}.${ending}`),
          (error: unknown) => tell(reasonsOf(error, '; '), true),
        ),
    );
  const tableCall = ({ convention, ...rest }: api.TableDocument): api.Call<api.TableDocument> => {
    if (source.kind === 'stored') return api.readTable(source.id, convention, angle);
    const document = sendable({ name, convention, ...rest });
    return api.convertTable(document, convention, document.units?.angle ?? 'rad');
  };
  const tables = table
    ? FORMATS.map(([format, label, ending]) =>
        line(label, ending, () => api.text(asText(tableCall(table), format))),
      )
    : [];
  const urdf = line('URDF', 'urdf', () => Promise.resolve(model?.urdf ?? ''));
  dialog(t.download, h('div', { class: 'line' }, urdf, ...tables));
}

function save(text: string, name: string): void {
  const url = URL.createObjectURL(new Blob([text]));
  h('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
