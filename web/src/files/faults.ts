/** What is wrong with a URDF, each fault beside the lines of the file that it is about. */
import type { FieldError, Refusal } from '../api';
import { dialog } from '../dialog';
import { h } from '../dom';
import { t } from '../i18n';

/** Lines of the file before and after the one at fault. */
const AROUND = 2;
/** Characters of a line that are shown. */
const SHOWN = 200;

/** Show the faults that the service lists, and how many there are besides. */
export function faultsDialog(name: string, text: string, { errors, more }: Refusal): void {
  const lines = text.split(/\r\n|\n|\r/);
  dialog(
    t.faultsTitle(name),
    h('p', { class: 'note' }, t.faultsHelp),
    h('ol', { class: 'faults' }, ...errors.map((one) => fault(one, lines))),
    ...(more ? [h('p', { class: 'verdict bad' }, t.moreFaults(more))] : []),
  );
}

function fault({ message, line, xpath }: FieldError, lines: readonly string[]): HTMLElement {
  const place = line === undefined ? '' : `${t.lineOfFile(line)}: `;
  return h(
    'li',
    {},
    h('p', {}, `${place}${message}`),
    xpath && h('p', { class: 'note' }, h('code', {}, xpath)),
    line !== undefined && excerpt(line, lines),
  );
}

/** The lines around one, numbered; that one is marked. */
function excerpt(line: number, lines: readonly string[]): HTMLElement {
  const first = Math.max(1, line - AROUND);
  const last = Math.min(lines.length, line + AROUND);
  const width = String(last).length;
  const shown = [];
  for (let k = first; k <= last; k += 1) {
    const row = `${String(k).padStart(width)}  ${(lines[k - 1] ?? '').slice(0, SHOWN)}\n`;
    shown.push(k === line ? h('mark', {}, row) : row);
  }
  return h('pre', { tabindex: 0, 'aria-label': t.lineOfFile(line) }, ...shown);
}
