/** The languages of the page. A missing translation does not compile. */
import type { First, Later, Words } from './words';

export type Language = 'en' | 'fr';
export type { Words };

interface Loaders {
  first(): Promise<First>;
  later(): Promise<Later>;
}

const LOADERS: Record<Language, Loaders> = {
  en: {
    first: async () => (await import('./en')).en,
    later: async () => (await import('./later.en')).later,
  },
  fr: {
    first: async () => (await import('./fr')).fr,
    later: async () => (await import('./later.fr')).later,
  },
};

/** The dictionary in use; its later words are there once a part was loaded by `opened`. */
export let t: Words;
let spoken: Language = 'en';

/** Use a language. */
export async function speak(language: Language): Promise<void> {
  spoken = language;
  // Before anything is asked: requests are sent in the language of the page.
  document.documentElement.lang = language;
  t = (await LOADERS[language].first()) as Words;
}

/** Load a part of the page together with its words. */
export async function opened<T>(part: Promise<T>): Promise<T> {
  const [loaded, words] = await Promise.all([part, LOADERS[spoken].later()]);
  t = { ...t, ...words };
  return loaded;
}

/** The first of the browser's languages that the page has; else English. */
export function preferred(): Language {
  const first = navigator.languages.find((one) => /^(en|fr)\b/i.test(one));
  return first?.toLowerCase().startsWith('fr') ? 'fr' : 'en';
}
