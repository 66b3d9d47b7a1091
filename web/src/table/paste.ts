/** A table out of a handout, a spreadsheet, LaTeX, MATLAB, Markdown; the service reads it. */
import * as api from '../api';
import { dialog } from '../dialog';
import { button, h, select } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import { editable } from './document';
import { shownTable } from './view';

const EXAMPLE =
  '| i | α_i | a_i | d_i | θ_i       |\n|---|-----|-----|-----|-----------|\n| 1 | 90° | 0   | 0,4 | θ_1       |\n| 2 | 0   | 0.3 | 0   | θ_2 - π/2 |';

/** @param atOnce Whether to read the text without being asked. */
export function pasteDialog(page: Page, pasted: string, atOnce: boolean): void {
  const now = shownTable(page);
  const text = h('textarea', {
    rows: 10,
    spellcheck: 'false',
    'aria-label': t.pastedText,
    placeholder: EXAMPLE,
  });
  text.value = pasted;
  const convention = select(
    t.convention,
    (['standard', 'modified', 'khalil'] as const).map((one) => [one, t.conventions[one]]),
    now?.convention ?? 'standard',
    () => {},
  );
  const angle = select(
    t.angles,
    [
      ['', t.asWritten],
      ['deg', t.degrees],
      ['rad', 'rad'],
    ],
    '',
    () => {},
  );
  const length = select(
    t.lengths,
    [
      ['m', 'm'],
      ['mm', 'mm'],
    ],
    'm',
    () => {},
  );
  const columns = h('input', { type: 'text', placeholder: 'theta,d,a,alpha', autocomplete: 'off' });
  const values = h('input', { type: 'text', placeholder: 'L1:0.4,L2:300mm', autocomplete: 'off' });
  const problem = h('p', { class: 'verdict bad', role: 'alert', lang: 'en' });

  async function read(): Promise<void> {
    problem.textContent = '';
    try {
      const table = await api.json<api.TableDocument>(
        api.readPasted(
          text.value,
          convention.value as api.Convention,
          angle.value as api.AngleUnit | '',
          length.value as 'm' | 'mm',
          values.value,
          columns.value,
        ),
      );
      page.store.set({ source: { kind: 'table', table: editable(table) }, row: null }, 'paste');
      window.close();
    } catch (error) {
      if (!(error instanceof api.Refusal || error instanceof api.Unreachable)) throw error;
      problem.textContent =
        error instanceof api.Refusal
          ? error.errors.map((one) => one.message).join('\n') || error.detail
          : t.unreachable;
    }
  }

  const window = dialog(
    t.pasteTitle,
    h('p', { class: 'note' }, t.pasteHelp),
    text,
    h(
      'div',
      { class: 'line' },
      h('label', {}, `${t.convention} `, convention),
      h('label', {}, `${t.angles} `, angle),
      h('label', {}, `${t.lengths} `, length),
    ),
    h(
      'div',
      { class: 'line' },
      h('label', {}, `${t.columnOrder} `, columns),
      h('label', {}, `${t.namedValues} `, values),
    ),
    problem,
    h(
      'div',
      { class: 'line end' },
      button(t.readTable, () => void read(), { class: 'main' }),
    ),
  );
  text.focus();
  if (atOnce) void read();
}
