/** What the service found doubtful in the robot or in a request, above the numbers. */
import { h, replace } from './dom';
import { t } from './i18n';
import type { Page } from './page';
import type { State } from './state';

export function warningsView({ store }: Page): HTMLElement {
  const list = warningList();
  const render = (): void => showWarnings(list, warningsOf(store.state));
  store.subscribe(({ model, answers, solved }) => [model, answers, solved], render);
  render();
  return list;
}

/** An empty list, hidden. */
export function warningList(): HTMLUListElement {
  return h('ul', { class: 'warnings', 'aria-label': t.warnings, hidden: true });
}

export function showWarnings(list: HTMLElement, warnings: readonly string[]): void {
  list.hidden = warnings.length === 0;
  replace(list, ...warnings.map((one) => h('li', {}, one)));
}

/** Each warning once, those about the request first. */
export function warningsOf({
  model,
  answers,
  solved,
}: Pick<State, 'model' | 'answers' | 'solved'>) {
  const told = [
    solved?.answer?.warnings,
    answers.pose?.warnings,
    answers.links?.warnings,
    answers.jacobian?.warnings,
    model?.warnings,
  ];
  return [...new Set(told.flatMap((one) => one ?? []))];
}
