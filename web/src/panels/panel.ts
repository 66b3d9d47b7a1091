/** A section of numbers: what it asks the service and how it shows the answer. */
import type { Call } from '../api';
import type { Model } from '../model';
import type { Answers, State } from '../state';

export interface Panel<Id extends keyof Answers> {
  readonly id: Id;
  readonly title: string;
  readonly body: HTMLElement;
  /** The request; null where this robot has no such numbers. */
  call(model: Model, state: State): Call<Answers[Id]> | null;
  show(answer: Answers[Id], model: Model, state: State): void;
}

export type AnyPanel = Panel<keyof Answers>;
