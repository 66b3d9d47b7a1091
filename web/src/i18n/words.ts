/** The words of a language: those of English, with the same arguments. */
import type { en } from './en';
import type { later } from './later.en';

/** Texts for texts, functions with the same arguments for functions, at any depth. */
type Same<T> = T extends string
  ? string
  : T extends (...given: infer G) => string
    ? (...given: G) => string
    : { [K in keyof T]: Same<T[K]> };

export type First = Same<typeof en>;
export type Later = Same<typeof later>;
export type Words = First & Later;
