/** A section of numbers: what it asks the service and how it shows the answer. */
import type { Call } from '../api';
import type { Model } from '../model';
import type { Section, State } from '../state';

export interface Panel {
  readonly id: Section;
  readonly title: string;
  readonly body: HTMLElement;
  /** What to ask; null where this robot has no such thing. */
  call(model: Model, state: State): Call | null;
  show(answer: unknown, model: Model, state: State): void;
}
