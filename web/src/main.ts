/** The page starts here: its parts, and how the state becomes a robot and a link. */
import * as api from './api';
import { h } from './dom';
import { headerView, remember, remembered, withRobot } from './header';
import { type Language, opened, preferred, speak, t } from './i18n';
import { jointsView } from './joints';
import { isAbort, Latest } from './latest';
import { fromHash, isIncomplete, toHash } from './link';
import { atRest, resolve, taskOf } from './model';
import type { Page } from './page';
import { sectionsView } from './sections';
import { START, type State, Store } from './state';
import { tableView } from './table/view';

/** The state of the address; a robot too long for it is in the entry of the browser's history. */
async function present(): Promise<State> {
  const state = await fromHash(location.hash);
  const { source } = (history.state ?? {}) as { source?: State['source'] };
  return source && isIncomplete(location.hash) ? { ...state, source } : state;
}

const theme = remembered('theme');
if (theme) document.documentElement.dataset.theme = theme;

function languageOf(text: string | null): Language {
  return text === 'en' || text === 'fr' ? text : preferred();
}

const language = languageOf(remembered('language'));
const [first] = await Promise.all([present(), speak(language)]);
const store = new Store(
  first.q.length || first.source !== START.source
    ? first
    : { ...first, ...withRobot(first, 'puma560') },
);

const status = h('p', { class: 'hidden', role: 'status', 'aria-live': 'polite' });
const toast = h('p', { class: 'toast', role: 'alert', hidden: true });
let toastTimer: ReturnType<typeof setTimeout>;

const page: Page = {
  store,
  model: null,
  calls: new Map(),
  answers: { fk: null, singularity: null },
  say(words) {
    status.textContent = words;
  },
  tell(words, bad = false) {
    clearTimeout(toastTimer);
    toast.hidden = !words;
    // Words that are there already are not said again.
    if (toast.textContent !== words) toast.textContent = words;
    toast.classList.toggle('bad', bad);
    toastTimer = setTimeout(() => (toast.hidden = true), bad ? 8000 : 3000);
  },
  onModel: [],
  onNumbers: [],
  onExtras: [],
};

const table = tableView(page);
const stage = h('section', { class: 'stage', id: 'stage', 'aria-label': t.scene });
const models = new Latest();
/** After this time a service that did not answer is asked again, ms. */
const AGAIN = 2000;

/** The robot of the state; while a table cannot be used, the last one that could stays. */
function load(): void {
  models.run(async (signal) => {
    const { state } = store;
    try {
      const model = await resolve(state.source, state.angle, signal);
      // What was asked for meanwhile is on its way; this one's posture is no longer there.
      if (store.state.source !== state.source) return;
      page.model = model;
      table.showErrors([]);
      if (document.body.classList.contains('stale')) page.tell('');
      document.body.classList.remove('stale');
      document.title = model.title ? `${model.title} · Denavit` : 'Denavit';
      const { q, angle, task } = store.state;
      if (q.length !== model.joints.length) {
        store.set({
          q: atRest(model.joints, angle),
          ...(task === START.task ? { task: taskOf(model) } : {}),
        });
      }
      for (const tell of page.onModel) tell();
    } catch (error) {
      if (isAbort(error)) throw error;
      document.body.classList.add('stale');
      if (api.willPass(error)) {
        page.tell(error instanceof api.Refusal ? error.detail : t.unreachable, true);
        // Where the user has gone on meanwhile, that is on its way itself.
        setTimeout(() => {
          if (store.state.source === state.source && document.body.classList.contains('stale'))
            load();
        }, AGAIN);
      } else if (error instanceof api.Refusal) {
        table.showErrors(
          error.errors.length ? error.errors : [{ pointer: '', message: error.detail }],
        );
        if (state.source.kind !== 'table') page.tell(error.detail, true);
      } else throw error;
    }
  });
}

/** What a screen reader is told once the numbers rest. */
let speaking: ReturnType<typeof setTimeout>;
page.onNumbers.push(() => {
  clearTimeout(speaking);
  speaking = setTimeout(() => {
    const pose = Object.values(page.answers.fk?.poses ?? {})[0];
    const rank = page.answers.singularity;
    const place = pose ? `${t.position} ${pose.position.map((x) => x.toFixed(3)).join(', ')}` : '';
    page.say([place, rank ? `${t.rank} ${rank.rank}` : ''].filter(Boolean).join('; '));
  }, 900);
});

let linking: ReturnType<typeof setTimeout>;
let hash = location.hash;
let entry = entryOf(store.state);
store.listen((state, before) => {
  const shown = state.source.kind !== 'table' && state.angle !== before.angle;
  if (state.source !== before.source || shown) load();
  clearTimeout(linking);
  linking = setTimeout(() => void link(state), 250);
});

/** Another robot is another entry of the browser's history; whatever else changes is not. */
function entryOf({ source }: State): string {
  return source.kind === 'stored' ? source.id : source.kind;
}

async function link(state: State): Promise<void> {
  const next = `#${await toHash(state)}`;
  if (store.state !== state) return;
  const before = entry;
  hash = next;
  entry = entryOf(state);
  const kept = isIncomplete(hash) ? { source: state.source } : null;
  if (entry === before) history.replaceState(kept, '', hash);
  else history.pushState(kept, '', hash);
}

addEventListener('hashchange', () => {
  if (location.hash === hash) return;
  hash = location.hash;
  void present().then((state) => {
    entry = entryOf(state);
    store.set(state, 'link');
  });
});

document.body.prepend(
  h(
    'a',
    {
      class: 'skip',
      href: '#numbers',
      onclick: (event) => {
        event.preventDefault();
        document.getElementById('numbers')?.focus();
      },
    },
    t.skip,
  ),
  headerView(page, {
    language,
    speak(chosen) {
      remember('language', chosen);
      void link(store.state).then(() => location.reload());
    },
  }),
  h(
    'main',
    {},
    h(
      'div',
      { class: 'column model' },
      table.element,
      h(
        'section',
        { class: 'card', 'aria-labelledby': 'joints-title' },
        h('h2', { id: 'joints-title' }, t.joints),
        jointsView(page),
      ),
    ),
    stage,
    h('div', { class: 'column numbers', id: 'numbers', tabindex: -1 }, sectionsView(page)),
  ),
  status,
  toast,
);
load();
if (isIncomplete(location.hash) && !history.state) page.tell(t.tooLong, true);
// The view comes after the first numbers, which need less than it does.
let staged = false;
page.onNumbers.push(() => {
  if (staged) return;
  staged = true;
  void opened(import('./stage')).then(({ stageView }) => stageView(page, stage));
});
