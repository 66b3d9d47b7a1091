/** The very request, to be run elsewhere. */
import { button, h, replace } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import { asCurl, asHttpx, asPowerShell } from '../reproduction';
import { reproduce, reproduced } from '../sections';
import type { Section } from '../state';

const FORMS = { curl: asCurl, Python: asHttpx, PowerShell: asPowerShell };
const SOURCES = [
  'pose',
  'links',
  'jacobian',
  'singularity',
  'ik',
  'path',
] as const satisfies readonly Section[];

export function reproducePanel(page: Page): HTMLElement {
  const sources = h('div', { class: 'chips', role: 'group', 'aria-label': t.request });
  const forms = h('div', { class: 'chips', role: 'group', 'aria-label': t.language });
  const code = h('pre', { class: 'code', tabindex: 0, role: 'region', 'aria-label': t.request });
  let form: keyof typeof FORMS = 'curl';

  function render(): void {
    const given = SOURCES.filter((one) => page.calls.has(one));
    const chosen = given.find((one) => one === reproduced) ?? given[0];
    replace(
      sources,
      ...given.map((one) =>
        button(
          t[one],
          () => {
            reproduce(one);
            render();
          },
          { 'aria-pressed': String(one === chosen) },
        ),
      ),
    );
    replace(
      forms,
      ...(Object.keys(FORMS) as (keyof typeof FORMS)[]).map((one) =>
        button(
          one,
          () => {
            form = one;
            render();
          },
          { 'aria-pressed': String(one === form) },
        ),
      ),
    );
    const call = chosen && page.calls.get(chosen);
    const text = call ? FORMS[form](call) : '';
    if (code.textContent !== text) code.textContent = text;
  }

  const copy = button(
    t.copy,
    () => {
      void navigator.clipboard.writeText(code.textContent ?? '').then(
        () => page.tell(t.copied),
        () => page.tell(t.notCopied, true),
      );
    },
    { class: 'main' },
  );
  page.onNumbers.push(render);
  render();
  return h(
    'div',
    {},
    h('p', { class: 'note' }, t.reproduceHelp),
    sources,
    h('div', { class: 'line spread' }, forms, copy),
    code,
  );
}
