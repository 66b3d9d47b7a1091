/** Creation of DOM elements. */

type Child = Node | string | number | null | undefined | false;
type Attributes = Record<string, string | number | boolean | EventListener | null | undefined>;

/** Create an element: `h('button', { class: 'x', onclick: f, 'aria-pressed': 'true' }, 'text')`. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) set(element, name, value);
  add(element, children);
  return element;
}

function set(element: HTMLElement, name: string, value: Attributes[string]): void {
  if (value === null || value === undefined || value === false) return;
  if (typeof value === 'function') element.addEventListener(name.slice(2), value);
  else if (name === 'value' && !(element instanceof HTMLOptionElement))
    (element as HTMLInputElement).value = String(value);
  else element.setAttribute(name, value === true ? '' : String(value));
}

function add(element: HTMLElement, children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    element.append(typeof child === 'number' ? String(child) : child);
  }
}

/** Replace the children of an element. */
export function replace(element: HTMLElement, ...children: Child[]): void {
  element.replaceChildren();
  add(element, children);
}

/** Create a select of [value, text] pairs. */
export function select(
  label: string,
  options: readonly (readonly [string, string])[],
  value: string,
  chosen: (value: string) => void,
): HTMLSelectElement {
  const element = h(
    'select',
    { 'aria-label': label, onchange: () => chosen(element.value) },
    ...options.map(([key, text]) => h('option', { value: key }, text)),
  );
  element.value = value;
  return element;
}

export function button(
  text: string,
  pressed: () => void,
  attributes: Attributes = {},
): HTMLButtonElement {
  return h('button', { type: 'button', onclick: () => pressed(), ...attributes }, text);
}
