/** What all parts of the page share. */
import type { History } from './history';
import type { State } from './state';
import type { Store } from './store';

export interface Page {
  readonly store: Store<State>;
  /** Changes of the state that can be undone. */
  readonly history: History;
  /** Tell a screen reader; replaces what was said before. */
  say(words: string): void;
  /** Show a passing message of a success, or of an error. */
  tell(words: string, isError?: boolean): void;
}
