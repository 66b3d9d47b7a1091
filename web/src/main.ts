/** Entry of the page: creates its state and its parts, and lays them out. */
import { keepAddress, readAddress } from './address';
import { askForKeyBy } from './api';
import { h } from './dom';
import { storedRobot } from './examples';
import { headerView } from './header';
import { History } from './history';
import { type Language, opened, preferred, speak, t } from './i18n';
import { jointsView } from './joints';
import { isIncomplete } from './link';
import { keepModel } from './loading';
import type { Page } from './page';
import { remember, remembered } from './preferences';
import { sectionsView } from './sections';
import { newSession, START, type State, tipPose } from './state';
import { Store } from './store';
import { tableView } from './table/view';
import { followBrowserTheme, isDark, restoreTheme } from './theme';
import { askForKey } from './unlocking';

/** A screen reader is told the numbers once they have rested for this time, ms. */
const REST = 900;
const PASSING = { success: 3000, error: 8000 };

function languageOf(text: string | null): Language {
  return text === 'en' || text === 'fr' ? text : preferred();
}

restoreTheme();
const language = languageOf(remembered('language'));
const [linked] = await Promise.all([readAddress(), speak(language)]);
const isEmpty = linked.q.length === 0 && linked.source === START.source;
const store = new Store<State>({
  ...linked,
  ...(isEmpty && storedRobot('puma560', linked.angle)),
  ...newSession(isDark()),
});

const status = h('p', { class: 'hidden', role: 'status', 'aria-live': 'polite' });
const toast = h('p', { class: 'toast', role: 'alert', hidden: true });
let toastTimer: ReturnType<typeof setTimeout>;

const page: Page = {
  store,
  history: new History(store),
  say(words) {
    status.textContent = words;
  },
  tell(words, isError = false) {
    clearTimeout(toastTimer);
    toast.hidden = !words;
    // Setting the same text would make a screen reader repeat it.
    if (toast.textContent !== words) toast.textContent = words;
    toast.classList.toggle('bad', isError);
    toastTimer = setTimeout(() => (toast.hidden = true), PASSING[isError ? 'error' : 'success']);
  },
};

const stage = h('section', { class: 'stage', id: 'stage', 'aria-label': t.scene });
const writeAddress = keepAddress(page);
followBrowserTheme(store);

let speaking: ReturnType<typeof setTimeout>;
store.subscribe(
  (state) => state.answers,
  () => {
    clearTimeout(speaking);
    speaking = setTimeout(() => {
      const { singularity } = store.state.answers;
      const tip = tipPose(store.state);
      const place = tip ? `${t.position} ${tip.position.map((x) => x.toFixed(3)).join(', ')}` : '';
      const rank = singularity ? `${t.rank} ${singularity.rank}` : '';
      page.say([place, rank].filter(Boolean).join('; '));
    }, REST);
  },
);

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
      void writeAddress().then(() => location.reload());
    },
  }),
  h(
    'main',
    {},
    h(
      'div',
      { class: 'column model' },
      tableView(page),
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
askForKeyBy((lack) => askForKey(page, lack));
keepModel(page);
if (isIncomplete(location.hash) && !window.history.state) page.tell(t.tooLong, true);
// The first numbers come before the view, which takes longer to load.
const stop = store.subscribe(
  (state) => state.answers,
  () => {
    stop();
    void opened(import('./stage')).then(({ stageView }) => stageView(page, stage));
  },
);
