/** Inverse kinematics for the target: while it is dragged, on demand, and all solutions. */
import { type Call, json } from './api';
import { ik, ikSolutions } from './api/motion';
import { reasonOf } from './failure';
import { Latest } from './latest';
import type { Model } from './model';
import type { Page } from './page';
import type { Solved, State } from './state';

/** Time budget of the inverse kinematics while the target is dragged, ms. */
const DRAG_MS = 30;
const latest = new Latest(() => 1);

/** Move the arm from its configuration to the target; in a short time while it is dragged. */
export function follow(page: Page, done: boolean): void {
  const { store } = page;
  store.set({ solutions: [] });
  ask(page, async (model, { target, task, q, angle }, signal) => {
    const limits = done ? {} : { time_budget_ms: DRAG_MS, max_restarts: 2 };
    const call = ik(model.ref, { target, task, seed: q, ...limits }, angle);
    record(page, call);
    const answer = await json(call, signal);
    if (answer.status === 'converged' || !done) page.history.change({ q: answer.q }, 'ik');
    return answer;
  });
}

/** Find all solutions, and show them as ghosts to choose from. */
export function findAll(page: Page): void {
  ask(page, async (model, { target, task, q, angle }, signal) => {
    const call = ikSolutions(model.ref, { target, task, seed: q }, angle);
    record(page, call);
    const answer = await json(call, signal);
    const solutions = answer.solutions.map((one, k) => ({ q: one.q, label: String(k + 1) }));
    page.store.set({ solutions });
    return answer;
  });
}

function record({ store }: Page, call: Call): void {
  store.set({ calls: { ...store.state.calls, ik: call } });
}

function ask(
  { store }: Page,
  question: (model: Model, state: State, signal: AbortSignal) => Promise<Solved['answer']>,
): void {
  const { model, target } = store.state;
  if (!model || !target) return;
  latest.run(async (signal) => {
    try {
      store.set({ solved: { answer: await question(model, store.state, signal), error: '' } });
    } catch (error) {
      store.set({ solved: { answer: null, error: reasonOf(error) } });
    }
  });
}
