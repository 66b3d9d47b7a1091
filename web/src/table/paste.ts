/** A table from a spreadsheet, Markdown, LaTeX, MATLAB or Python; the service reads it. */
import * as api from '../api';
import { readPasted } from '../api/files';
import { dialog } from '../dialog';
import { button, h, select } from '../dom';
import { reasonsOf } from '../failure';
import { t } from '../i18n';
import type { Page } from '../page';
import { editable } from './exchange';
import { shownTable } from './shown';

const EXAMPLE =
  '| i | α_i | a_i | d_i | θ_i       |\n|---|-----|-----|-----|-----------|\n| 1 | 90° | 0   | 0,4 | θ_1       |\n| 2 | 0   | 0.3 | 0   | θ_2 - π/2 |';

/**
 * @param given A text, or a workbook with its media type.
 * @param atOnce Whether to read it without waiting for the button.
 */
export function pasteDialog({ store, history }: Page, given: string | File, atOnce: boolean): void {
  const workbook = typeof given === 'string' ? null : given;
  const now = shownTable(store.state);
  const text = h('textarea', {
    rows: 10,
    spellcheck: 'false',
    'aria-label': t.pastedText,
    placeholder: EXAMPLE,
  });
  text.value = typeof given === 'string' ? given : '';
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
  const problem = h('p', { class: 'verdict bad', role: 'alert' });

  async function read(): Promise<void> {
    problem.textContent = '';
    try {
      const table = await api.json(
        readPasted(workbook ?? text.value, {
          convention: convention.value as api.Convention,
          angle: angle.value as api.AngleUnit | '',
          length: length.value as api.LengthUnit,
          values: values.value,
          columns: columns.value,
        }),
      );
      history.change({ source: { kind: 'table', table: editable(table) }, row: null }, 'paste');
      window.close();
    } catch (error) {
      problem.textContent = reasonsOf(error, '\n');
    }
  }

  const window = dialog(
    workbook ? t.readWorkbook(workbook.name) : t.pasteTitle,
    ...(workbook ? [] : [h('p', { class: 'note' }, t.pasteHelp), text]),
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
  if (!workbook) text.focus();
  if (atOnce) void read();
}
