/** The header of the page: the robot, undo, link, units, language, theme. */
import * as api from './api';
import { button, h, replace, select } from './dom';
import { EXAMPLES, storedRobot } from './examples';
import { reasonOf } from './failure';
import { type Language, opened, t } from './i18n';
import { isIncomplete } from './link';
import type { Page } from './page';
import { type Linked, linkedValues, type State } from './state';
import { switchTheme } from './theme';
import { converted } from './units';
import { askForKey } from './unlocking';

export interface Choices {
  readonly language: Language;
  speak(language: Language): void;
}

export function headerView(page: Page, choices: Choices): HTMLElement {
  const { store, history } = page;
  const choose = (id: string): void => history.change(storedRobot(id, store.state.angle), 'robot');
  const examples = EXAMPLES.map(({ id, name }) => ({ id, chip: button(name, () => choose(id)) }));
  const robots = select(t.allRobots, [['', t.allRobots]], '', (id) => {
    if (id) choose(id);
  });
  const isListed = (id: string): boolean => [...robots.options].some((one) => one.value === id);
  const file = h('input', {
    type: 'file',
    hidden: true,
    accept:
      '.urdf,.zip,.xml,.yaml,.yml,.json,.csv,.par,.txt,.md,.tex,.m,.py,.tsv,.html,.xlsx,.ods,text/*',
    onchange: () => {
      const chosen = file.files?.[0];
      if (chosen)
        void opened(import('./files/open')).then(({ openFile }) => openFile(page, chosen));
      file.value = '';
    },
  });
  const undo = button('↶', () => history.undo(), {
    'aria-label': t.undo,
    title: `${t.undo} (Ctrl+Z)`,
  });
  const redo = button('↷', () => history.redo(), {
    'aria-label': t.redo,
    title: `${t.redo} (Ctrl+Y)`,
  });
  const angle = select(
    t.angleUnit,
    [
      ['deg', '°'],
      ['rad', 'rad'],
    ],
    store.state.angle,
    (value) => history.change(withAngle(store.state, value as api.AngleUnit), 'angle'),
  );
  const digits = select(
    t.digits,
    [3, 4, 6, 9, 12].map((n) => [String(n), t.digitsShown(n)]),
    String(store.state.digits),
    (value) => history.change({ digits: Number(value) }, 'digits'),
  );
  const language = select(
    t.language,
    [
      ['en', 'English'],
      ['fr', 'Français'],
    ],
    choices.language,
    (value) => choices.speak(value as Language),
  );
  const theme = button('◐', () => switchTheme(store), { 'aria-label': t.theme, title: t.theme });
  const download = button(
    t.download,
    () =>
      void opened(import('./files/download')).then(({ downloadDialog }) => downloadDialog(page)),
  );
  const save = button(
    t.save,
    () => void opened(import('./files/save')).then(({ saveDialog }) => saveDialog(page)),
  );
  const keyButton = button(t.key, () => void askForKey(page, 'change'));
  const share = button(t.copyLink, () => {
    if (isIncomplete(location.hash)) page.tell(t.tooLong, true);
    else
      void navigator.clipboard.writeText(location.href).then(
        () => page.tell(t.linkCopied),
        () => page.tell(location.href),
      );
  });

  /** Id of the chosen robot; '' where the service has not stored it. */
  function chosenId(): string {
    const { source } = store.state;
    return source.kind === 'stored' ? source.id : '';
  }

  function render(): void {
    const { state } = store;
    const id = chosenId();
    for (const one of examples) one.chip.setAttribute('aria-pressed', String(one.id === id));
    if (isListed(id)) robots.value = id;
    undo.disabled = !history.canUndo;
    redo.disabled = !history.canRedo;
    angle.value = state.angle;
    digits.value = String(state.digits);
    keyButton.hidden = !state.keys && !api.key();
    save.disabled = state.source.kind === 'stored';
  }

  async function list(): Promise<void> {
    try {
      const { robots: lines } = await api.json(api.listRobots());
      replace(
        robots,
        h('option', { value: '' }, t.allRobots),
        group(t.uploaded, lines, (one) => !one.shipped),
        group(t.dhTables, lines, (one) => one.shipped && one.kind === 'dh'),
        group('URDF', lines, (one) => one.shipped && one.kind === 'urdf'),
      );
      render();
    } catch (error) {
      page.tell(reasonOf(error), true);
    }
  }

  document.addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const field = document.activeElement;
    // Text typed in a dialog is not in the state: there the browser's own undo is left to work.
    if (!'zy'.includes(key) || !(field instanceof HTMLElement) || field.closest('dialog')) return;
    event.preventDefault();
    // A focused field keeps its text when the state changes: without focus it shows the new value.
    field.blur();
    if (key === 'z' && !event.shiftKey) history.undo();
    else history.redo();
    field.focus({ preventScroll: true });
  });
  store.subscribe(linkedValues, render);
  store.subscribe(
    ({ keys }) => keys,
    () => {
      render();
      if (robots.options.length < 2) void list();
    },
  );
  store.subscribe(
    ({ model }) => model,
    () => {
      const id = chosenId();
      if (id && !isListed(id)) void list();
    },
  );
  render();
  void list();
  return h(
    'header',
    {},
    h('h1', {}, 'Denavit'),
    h(
      'nav',
      { class: 'line', 'aria-label': t.robot },
      ...examples.map((one) => one.chip),
      robots,
      button(t.upload, () => file.click()),
      file,
      save,
      download,
    ),
    h(
      'div',
      { class: 'line end', role: 'group', 'aria-label': t.settings },
      undo,
      redo,
      share,
      angle,
      digits,
      language,
      theme,
      keyButton,
      h('a', { href: `labs/${choices.language}` }, t.labs),
      h('a', { href: 'guide' }, 'Guide'),
      h('a', { href: 'docs' }, 'API'),
    ),
  );
}

function group(
  label: string,
  lines: readonly api.RobotLine[],
  belongs: (one: api.RobotLine) => boolean,
): HTMLElement | false {
  const found = lines.filter(belongs);
  return (
    found.length > 0 &&
    h(
      'optgroup',
      { label },
      ...found.map((one) => h('option', { value: one.id }, `${one.title} · ${one.dof}`)),
    )
  );
}

/** The change to the other unit of angles: the same configurations, without a target. */
function withAngle(
  { model, angle: before, q, kept }: State,
  angle: api.AngleUnit,
): Partial<Linked> {
  if (angle === before) return {};
  const joints = model?.joints ?? [];
  return {
    angle,
    q: converted(joints, q, angle),
    kept: kept.map((one) => converted(joints, one, angle)),
    target: null,
  };
}
