/** A modal dialog of the browser: Escape closes it, the focus stays in it. */
import { button, h } from './dom';
import { t } from './i18n';

export interface Dialog {
  readonly element: HTMLDialogElement;
  close(): void;
}

let opened = 0;

export function dialog(title: string, ...content: Node[]): Dialog {
  const close = (): void => {
    element.close();
    element.remove();
  };
  // One may be opened over another.
  opened += 1;
  const id = `dialog-title-${opened}`;
  const element = h(
    'dialog',
    { 'aria-labelledby': id, onclose: () => element.remove() },
    h(
      'div',
      { class: 'line spread' },
      h('h2', { id }, title),
      button('×', close, { 'aria-label': t.close }),
    ),
    ...content,
  );
  document.body.append(element);
  element.showModal();
  return { element, close };
}
