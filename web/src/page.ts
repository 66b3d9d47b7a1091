/** What all parts of the page share. */
import type { Call, FKAnswer, SingularityAnswer } from './api';
import type { Model } from './model';
import type { Section, Store } from './state';

export interface Page {
  readonly store: Store;
  /** The last robot that could be used; null before the first. */
  model: Model | null;
  /** What was last sent for each section: what "Reproduce" shows. */
  readonly calls: Map<Section, Call>;
  /** What the service last said of this posture. */
  answers: { fk: FKAnswer | null; singularity: SingularityAnswer | null };
  /** Tells a screen reader; replaces what was said before. */
  say(words: string): void;
  /** Shows a passing message, of an error or a success. */
  tell(words: string, bad?: boolean): void;
  /** Listeners for a new model, and for new numbers. */
  readonly onModel: (() => void)[];
  readonly onNumbers: (() => void)[];
  /** Listeners for what the scene shows besides the state: solutions, a path that was followed. */
  readonly onExtras: (() => void)[];
}
