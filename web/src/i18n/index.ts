/** The page's languages. A dictionary that lacks a word does not compile. */
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

/** The present dictionary; those who are loaded by `opened` find all of it. */
export let t: Words;
let spoken: Language = 'en';

export async function speak(language: Language): Promise<void> {
  spoken = language;
  t = (await LOADERS[language].first()) as Words;
  document.documentElement.lang = language;
}

/** A part of the page that is loaded when it is opened, together with its words. */
export async function opened<T>(part: Promise<T>): Promise<T> {
  const [loaded, words] = await Promise.all([part, LOADERS[spoken].later()]);
  t = { ...t, ...words };
  return loaded;
}

/** French where the browser prefers it to English. */
export function preferred(): Language {
  const first = navigator.languages.find((one) => /^(en|fr)\b/i.test(one));
  return first?.toLowerCase().startsWith('fr') ? 'fr' : 'en';
}
