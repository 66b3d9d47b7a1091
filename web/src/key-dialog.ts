/** The field for a key. */
import { holdKey, isAccepted, key, type Lack } from './api';
import { dialog } from './dialog';
import { button, h } from './dom';
import { reasonOf } from './failure';
import { t } from './i18n';

/** What a header can carry. */
const KEY = /^[\x21-\x7e]+$/;

/**
 * Ask for a key until the service accepts one, or the reader closes the dialog.
 *
 * @returns Whether there is another key than before: one that is accepted, or none on purpose.
 */
export function keyDialog(why: Lack | 'change'): Promise<boolean> {
  // No password field: browsers offer to keep what is typed there.
  const field = h('input', {
    type: 'text',
    class: 'secret',
    autocomplete: 'off',
    autocapitalize: 'off',
    spellcheck: 'false',
    onkeydown: (event) => {
      if ((event as KeyboardEvent).key === 'Enter') void use();
    },
  });
  const problem = h('p', { class: 'verdict bad', role: 'alert' });
  let isGiven = false;

  async function use(): Promise<void> {
    const given = field.value.trim();
    problem.textContent = '';
    if (!KEY.test(given)) {
      problem.textContent = t.keyOdd;
      return;
    }
    try {
      if (!(await isAccepted(given))) problem.textContent = t.keyUnknown;
      else close(given);
    } catch (error) {
      problem.textContent = reasonOf(error);
    }
  }

  function close(next: string): void {
    holdKey(next);
    isGiven = true;
    window.close();
  }

  const forget = button(t.keyForget, () => close(''));
  forget.hidden = why !== 'change' || !key();
  const window = dialog(
    t.keyTitle,
    h('p', {}, t.keyLacks[why === 'change' && !key() ? 'missing' : why]),
    h(
      'div',
      { class: 'line' },
      h('label', {}, `${t.keyField} `, field),
      button(t.keyUse, () => void use(), { class: 'main' }),
      forget,
    ),
    problem,
    h('p', { class: 'note' }, t.keyKept),
  );
  field.focus();
  return new Promise((done) => {
    window.element.addEventListener('close', () => done(isGiven), { once: true });
  });
}
