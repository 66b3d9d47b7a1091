/** Which robot, undo, link, units, language, colours. */
import * as api from './api';
import { button, h, replace, select } from './dom';
import { type Language, opened, t } from './i18n';
import { isIncomplete } from './link';
import type { Page } from './page';
import { START, type State } from './state';

/** Arms that a course begins with; postures in degrees and m. */
const EXAMPLES: readonly { id: string; name: string; q: readonly number[]; task: string }[] = [
  { id: 'planar_2r', name: '2R', q: [30, 60], task: 'xy' },
  { id: 'scara', name: 'SCARA', q: [20, 40, 0.08, 0], task: 'xyz_phi' },
  { id: 'puma560', name: 'PUMA 560', q: [0, 45, -90, 0, 45, 0], task: 'pose' },
  { id: 'ur5', name: 'UR5', q: [0, -60, 90, -120, -90, 0], task: 'pose' },
  { id: 'pa10', name: 'PA10', q: [0, 30, 0, 60, 0, 60, 0], task: 'pose' },
  { id: 'panda', name: 'Panda', q: [0, -30, 0, -120, 0, 100, 45], task: 'pose' },
];

/** The state with another robot of the service: its posture, and nothing of the one before. */
export function withRobot(state: State, id: string): Partial<State> {
  const example = EXAMPLES.find((one) => one.id === id);
  const factor = state.angle === 'deg' ? 1 : Math.PI / 180;
  const slides = id === 'scara' ? 2 : -1;
  return {
    source: { kind: 'stored', id, convention: null },
    q: example ? example.q.map((x, k) => (k === slides ? x : x * factor)) : [],
    task: example?.task ?? START.task,
    row: null,
    target: null,
    kept: [],
    path: START.path,
  };
}

export interface Choices {
  readonly language: Language;
  speak(language: Language): void;
}

export function headerView(page: Page, choices: Choices): HTMLElement {
  const { store } = page;
  const examples = EXAMPLES.map((one) => {
    const chip = button(one.name, () => store.set(withRobot(store.state, one.id), 'robot'));
    return { id: one.id, chip };
  });
  const robots = select(t.allRobots, [['', t.allRobots]], '', (id) => {
    if (id) store.set(withRobot(store.state, id), 'robot');
  });
  const file = h('input', {
    type: 'file',
    hidden: true,
    accept: '.urdf,.xml,.yaml,.yml,.json,.csv,.par,.txt,.md,.tex,.m,.py,.tsv',
    onchange: () => {
      const chosen = file.files?.[0];
      if (chosen) void opened(import('./files')).then(({ openFile }) => openFile(page, chosen));
      file.value = '';
    },
  });
  const undo = button('↶', () => store.undo(), {
    'aria-label': t.undo,
    title: `${t.undo} (Ctrl+Z)`,
  });
  const redo = button('↷', () => store.redo(), {
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
    (value) => store.set(withAngle(page, value as api.AngleUnit), 'angle'),
  );
  const digits = select(
    t.digits,
    [3, 4, 6, 9, 12].map((n) => [String(n), t.digitsShown(n)]),
    String(store.state.digits),
    (value) => store.set({ digits: Number(value) }, 'digits'),
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
  const theme = button('◐', () => switchTheme(page), { 'aria-label': t.theme, title: t.theme });
  const download = button(
    t.download,
    () => void opened(import('./files')).then(({ downloadDialog }) => downloadDialog(page)),
  );
  const save = button(
    t.save,
    () => void opened(import('./files')).then(({ saveDialog }) => saveDialog(page)),
  );
  const share = button(t.copyLink, () => {
    if (isIncomplete(location.hash)) page.tell(t.tooLong, true);
    else
      void navigator.clipboard.writeText(location.href).then(
        () => page.tell(t.linkCopied),
        () => page.tell(location.href),
      );
  });

  function render(state: State): void {
    const id = state.source.kind === 'stored' ? state.source.id : '';
    for (const one of examples) one.chip.setAttribute('aria-pressed', String(one.id === id));
    if ([...robots.options].some((one) => one.value === id)) robots.value = id;
    undo.disabled = !store.canUndo;
    redo.disabled = !store.canRedo;
    angle.value = state.angle;
    digits.value = String(state.digits);
    save.disabled = state.source.kind === 'stored';
  }

  async function list(): Promise<void> {
    try {
      const answer = await api.json<{ robots: api.RobotLine[] }>(api.listRobots());
      const group = (label: string, lines: api.RobotLine[]): HTMLElement | false =>
        lines.length > 0 &&
        h(
          'optgroup',
          { label },
          ...lines.map((one) => h('option', { value: one.id }, `${one.title} · ${one.dof}`)),
        );
      replace(
        robots,
        h('option', { value: '' }, t.allRobots),
        group(
          t.uploaded,
          answer.robots.filter((one) => !one.shipped),
        ),
        group(
          t.dhTables,
          answer.robots.filter((one) => one.shipped && one.kind === 'dh'),
        ),
        group(
          'URDF',
          answer.robots.filter((one) => one.shipped && one.kind === 'urdf'),
        ),
      );
      render(store.state);
    } catch {
      page.tell(t.unreachable, true);
    }
  }

  document.addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const field = document.activeElement;
    // What is typed in a dialog is not of the state yet: there the browser undoes.
    if (!'zy'.includes(key) || !(field instanceof HTMLElement) || field.closest('dialog')) return;
    event.preventDefault();
    // A field that is being typed into keeps its text; it shall show what undo makes of it.
    field.blur();
    if (key === 'z' && !event.shiftKey) store.undo();
    else store.redo();
    field.focus({ preventScroll: true });
  });
  page.onModel.push(() => {
    const id = store.state.source.kind === 'stored' ? store.state.source.id : '';
    if (id && ![...robots.options].some((one) => one.value === id)) void list();
  });
  store.listen(render);
  render(store.state);
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
      h('a', { href: 'guide' }, 'Guide'),
      h('a', { href: 'docs' }, 'API'),
    ),
  );
}

/** The same posture in the other unit. */
function withAngle(page: Page, angle: api.AngleUnit): Partial<State> {
  const { state } = page.store;
  if (angle === state.angle) return {};
  const factor = angle === 'deg' ? 180 / Math.PI : Math.PI / 180;
  const turned = (q: readonly number[]): number[] =>
    q.map((x, k) =>
      page.model?.joints[k]?.type === 'prismatic' ? x : Number((x * factor).toPrecision(12)),
    );
  return { angle, q: turned(state.q), kept: state.kept.map(turned), target: null };
}

export function isDark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
}

function switchTheme(page: Page): void {
  const theme = isDark() ? 'light' : 'dark';
  document.documentElement.dataset.theme = theme;
  remember('theme', theme);
  for (const tell of page.onNumbers) tell();
}

/** A choice that outlives the page; a browser may refuse to keep it. */
export function remember(name: string, value: string): void {
  try {
    localStorage.setItem(`denavit.${name}`, value);
  } catch {
    // Private windows keep nothing; the choice then lasts as long as the page.
  }
}

export function remembered(name: string): string | null {
  try {
    return localStorage.getItem(`denavit.${name}`);
  } catch {
    return null;
  }
}
