/** What a language must say: what English says, with the same arguments. */
import type { en } from './en';
import type { later } from './later.en';

/** Texts are texts and functions take the same arguments, all the way down. */
type Same<T> = T extends string
  ? string
  : T extends (...given: infer G) => string
    ? (...given: G) => string
    : { [K in keyof T]: Same<T[K]> };

export type First = Same<typeof en>;
export type Later = Same<typeof later>;
export type Words = First & Later;
