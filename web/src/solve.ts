/** Inverse kinematics for the target: while it is dragged, on demand, and all solutions. */
import * as api from './api';
import { t } from './i18n';
import { Latest } from './latest';
import type { Page } from './page';
import { solutions } from './stage';

const DRAG_MS = 30;
const latest = new Latest();
/** Those who show what became of it. */
export const onSolved: ((
  answer: api.IKAnswer | api.IKSolutionsAnswer | null,
  error: string,
) => void)[] = [];

/** From the present posture to the target; a short time while it is being dragged. */
export function follow(page: Page, done: boolean): void {
  forget();
  ask(page, async (model, state, signal) => {
    const call = api.ik(
      model.ref,
      {
        target: state.target,
        task: state.task,
        seed: state.q,
        ...(done ? {} : { time_budget_ms: DRAG_MS, max_restarts: 2 }),
      },
      state.angle,
    );
    page.calls.set('ik', call);
    const answer = await api.json<api.IKAnswer>(call, signal);
    if (answer.status === 'converged' || !done) page.store.set({ q: answer.q }, 'ik');
    return answer;
  });
}

/** All solutions, as ghosts to pick from; those of another target are gone. */
export function findAll(page: Page): void {
  ask(page, async (model, state, signal) => {
    const call = api.ikSolutions(
      model.ref,
      { target: state.target, task: state.task, seed: state.q },
      state.angle,
    );
    page.calls.set('ik', call);
    const answer = await api.json<api.IKSolutionsAnswer>(call, signal);
    solutions.splice(
      0,
      solutions.length,
      ...answer.solutions.map((one, k) => ({
        q: one.q,
        label: String(k + 1),
      })),
    );
    return answer;
  });
}

export function forget(): void {
  solutions.length = 0;
}

type Question = (
  model: NonNullable<Page['model']>,
  state: Page['store']['state'],
  signal: AbortSignal,
) => Promise<api.IKAnswer | api.IKSolutionsAnswer>;

function ask(page: Page, question: Question): void {
  const { model } = page;
  if (!model || !page.store.state.target) return;
  latest.run(async (signal) => {
    let answer: Awaited<ReturnType<Question>> | null = null;
    let error = '';
    try {
      answer = await question(model, page.store.state, signal);
    } catch (thrown) {
      if (thrown instanceof api.Refusal) error = thrown.detail;
      else if (thrown instanceof api.Unreachable) error = t.unreachable;
      else throw thrown;
    }
    for (const tell of onSolved) tell(answer, error);
    for (const tell of [...page.onNumbers, ...page.onExtras]) tell();
  });
}
