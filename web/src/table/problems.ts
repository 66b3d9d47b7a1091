/** What the service refused in the table: a list, and marks at the fields at fault. */
import type { FieldError } from '../api';
import { button, h, replace } from '../dom';
import { t } from '../i18n';

/** Characters of a line of a file that are shown. */
const SHOWN = 160;

/**
 * Show errors.
 *
 * @param list Where they are listed.
 * @param card What holds the fields.
 * @param fieldOf The field at fault; undefined where the table has no such field.
 * @param file The URDF that was opened, '' for a table: its lines are shown beside their errors.
 */
export function showProblems(
  list: HTMLElement,
  card: HTMLElement,
  errors: readonly FieldError[],
  fieldOf: (pointer: string) => HTMLElement | undefined,
  file: string,
): void {
  const rows = file.split('\n');
  for (const field of card.querySelectorAll('[aria-invalid]')) {
    field.removeAttribute('aria-invalid');
    field.removeAttribute('aria-describedby');
  }
  const lines = errors.map(({ pointer, message, line }, k) => {
    // A cell that is sent as `theta` with its `offset` and `sign` is one field here.
    const field = fieldOf(pointer.replace(/^\/robot/, '').replace(/\/(offset|sign)$/, ''));
    const id = `problem-${k}`;
    field?.setAttribute('aria-invalid', 'true');
    field?.setAttribute('aria-describedby', id);
    const go = field && button('→', () => field.focus(), { 'aria-label': t.goToCell });
    const words = line === undefined ? message : `${t.lineOfFile(line)}: ${message}`;
    const row = line === undefined ? '' : (rows[line - 1]?.trim() ?? '').slice(0, SHOWN);
    return h('li', {}, go, h('span', { id }, words), row && h('code', {}, row));
  });
  replace(list, ...lines);
  list.hidden = lines.length === 0;
}
