/** Light or dark: as the reader has chosen, else as the browser prefers. */
import { remember, remembered } from './preferences';
import type { State } from './state';
import type { Store } from './store';

const preference = matchMedia('(prefers-color-scheme: dark)');

/** Apply the theme of an earlier visit, if one was chosen. */
export function restoreTheme(): void {
  const theme = remembered('theme');
  if (theme) document.documentElement.dataset.theme = theme;
}

export function isDark(): boolean {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === 'dark' : preference.matches;
}

export function switchTheme(store: Store<State>): void {
  const theme = isDark() ? 'light' : 'dark';
  document.documentElement.dataset.theme = theme;
  remember('theme', theme);
  store.set({ dark: isDark() });
}

export function followBrowserTheme(store: Store<State>): void {
  preference.addEventListener('change', () => store.set({ dark: isDark() }));
}
