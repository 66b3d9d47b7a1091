/** The requests behind the numbers, as commands to run elsewhere. */
import { key } from '../api';
import { button, h, replace } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import { asCurl, asHttpx, asPowerShell } from '../reproduction';
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

export function reproducePanel({ store, tell }: Page): HTMLElement {
  const sources = h('div', { class: 'chips', role: 'group', 'aria-label': t.request });
  const forms = h('div', { class: 'chips', role: 'group', 'aria-label': t.language });
  const code = h('pre', { class: 'code', tabindex: 0, role: 'region', 'aria-label': t.request });
  let form: keyof typeof FORMS = 'curl';

  function render(): void {
    const { calls, reproduced } = store.state;
    const asked = SOURCES.filter((one) => calls[one]);
    const chosen = asked.find((one) => one === reproduced) ?? asked[0];
    const chips = asked.map((one) =>
      button(t[one], () => store.set({ reproduced: one }), {
        'aria-pressed': String(one === chosen),
      }),
    );
    replace(sources, ...chips);
    const choose = (one: keyof typeof FORMS): void => {
      form = one;
      render();
    };
    const names = Object.keys(FORMS) as (keyof typeof FORMS)[];
    replace(
      forms,
      ...names.map((one) =>
        button(one, () => choose(one), { 'aria-pressed': String(one === form) }),
      ),
    );
    const call = chosen && calls[chosen];
    const text = call ? FORMS[form](call, key() !== '') : '';
    if (code.textContent !== text) code.textContent = text;
  }

  const copy = button(
    t.copy,
    () =>
      void navigator.clipboard.writeText(code.textContent ?? '').then(
        () => tell(t.copied),
        () => tell(t.notCopied, true),
      ),
    { class: 'main' },
  );
  store.subscribe(({ calls, reproduced, keys }) => [calls, reproduced, keys], render);
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
