/** Stores the robot on the service under a name. */
import { json, Refusal } from '../api';
import { createRobot } from '../api/files';
import { dialog } from '../dialog';
import { button, h } from '../dom';
import { reasonsOf } from '../failure';
import { t } from '../i18n';
import type { Page } from '../page';
import { sendable } from '../table/exchange';

/** Kind of a refusal because a robot of that name is stored already. */
const TAKEN = 'robot-exists';

export function saveDialog({ store, history, tell }: Page): void {
  const { source } = store.state;
  if (source.kind === 'stored') return;
  const field = h('input', {
    type: 'text',
    autocomplete: 'off',
    spellcheck: 'false',
    value: source.kind === 'table' ? (source.table.name ?? '') : source.name,
    onkeydown: (event) => {
      if ((event as KeyboardEvent).key === 'Enter') void save();
    },
  });
  const problem = h('p', { class: 'verdict bad', role: 'alert' });
  const replace = button(t.replace, () => void save(true), { hidden: true });
  field.addEventListener('input', () => {
    replace.hidden = true;
  });

  async function save(overwrite = false): Promise<void> {
    if (source.kind === 'stored') return;
    const name = field.value.trim();
    const document = source.kind === 'table' ? sendable({ ...source.table, name }) : source.urdf;
    try {
      const { id } = await json(createRobot(name, document, overwrite));
      window.close();
      history.change({ source: { kind: 'stored', id, convention: null } }, 'save');
      tell(t.saved(id));
    } catch (error) {
      const taken = error instanceof Refusal && error.kind === TAKEN;
      if (taken) problem.removeAttribute('lang');
      else problem.lang = 'en';
      problem.textContent = taken ? t.nameTaken(name) : reasonsOf(error, '; ');
      replace.hidden = !taken;
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
    replace,
  );
  field.focus();
}
