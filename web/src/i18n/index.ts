/** The page's languages. A dictionary that lacks a word does not compile. */
import type { Words } from './en';

export type Language = 'en' | 'fr';
export type { Words };

const LOADERS: Record<Language, () => Promise<Words>> = {
  en: async () => (await import('./en')).en,
  fr: async () => (await import('./fr')).fr,
};

/** The present dictionary; set before anything is drawn. */
export let t: Words;

export async function speak(language: Language): Promise<void> {
  t = await LOADERS[language]();
  document.documentElement.lang = language;
}

/** French where the browser prefers it to English. */
export function preferred(): Language {
  const first = navigator.languages.find((one) => /^(en|fr)\b/i.test(one));
  return first?.toLowerCase().startsWith('fr') ? 'fr' : 'en';
}
