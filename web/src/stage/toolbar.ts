/** What the view shows. */
import * as api from '../api';
import { button, h, replace, select } from '../dom';
import { reasonOf } from '../failure';
import { t } from '../i18n';
import type { Page } from '../page';
import type { View } from '../state';

type Toggle = 'dimensions' | 'lost' | 'cloud';

export function toolbar(page: Page, fit: () => void): HTMLElement {
  const { store, history } = page;
  const put = (change: Partial<View>): void =>
    history.change({ view: { ...store.state.view, ...change } }, 'view');
  const frames = select(
    t.frames,
    [
      ['all', t.framesAll],
      ['ends', t.framesEnds],
      ['none', t.framesNone],
    ],
    store.state.view.frames,
    (value) => put({ frames: value as View['frames'] }),
  );
  const ellipsoid = select(
    t.ellipsoid,
    [
      ['none', t.ellipsoidNone],
      ['velocity', t.ellipsoidVelocity],
      ['force', t.ellipsoidForce],
      ['both', t.ellipsoidBoth],
    ],
    store.state.view.ellipsoid,
    (value) => put({ ellipsoid: value as View['ellipsoid'] }),
  );
  const toggle = (name: Toggle, text: string): { name: Toggle; element: HTMLButtonElement } => ({
    name,
    element: button(text, () => put({ [name]: !store.state.view[name] })),
  });
  const toggles = [
    toggle('dimensions', t.dimensions),
    toggle('lost', t.lostArrow),
    toggle('cloud', t.cloud),
  ];
  const keep = button(t.keepPosture, () =>
    history.change({ kept: [...store.state.kept, store.state.q] }, 'keep'),
  );
  const drop = button(t.dropPostures, () => history.change({ kept: [] }, 'keep'));
  const other = otherRobot(page, put);

  function render(): void {
    const { view, kept } = store.state;
    frames.value = view.frames;
    ellipsoid.value = view.ellipsoid;
    for (const { name, element } of toggles) {
      element.setAttribute('aria-pressed', String(view[name]));
    }
    drop.hidden = !kept.length;
    other.show(view.other);
  }

  store.subscribe(({ view, kept }) => [view, kept], render);
  render();
  return h(
    'div',
    { class: 'toolbar', role: 'toolbar', 'aria-label': t.view },
    button(t.fit, fit),
    frames,
    ellipsoid,
    ...toggles.map((one) => one.element),
    keep,
    drop,
    other.element,
  );
}

/** A select of the robots that fit the configuration; they are listed when it is opened. */
function otherRobot(
  { store, tell }: Page,
  put: (change: Partial<View>) => void,
): { element: HTMLElement; show(id: string): void } {
  const none = (): HTMLElement => h('option', { value: '' }, t.compareWith);
  const element = select(t.compareWith, [['', t.compareWith]], '', (value) =>
    put({ other: value }),
  );
  let listed: number | undefined;

  async function list(): Promise<void> {
    const dof = store.state.model?.joints.length;
    if (listed === dof) return;
    try {
      const { robots } = await api.json(api.listRobots());
      listed = dof;
      const chosen = element.value;
      const fitting = robots.filter((one) => one.dof === dof);
      const options = fitting.map((one) => h('option', { value: one.id }, one.title));
      replace(element, none(), ...options);
      element.value = chosen;
    } catch (error) {
      tell(reasonOf(error), true);
    }
  }

  element.addEventListener('focus', () => void list());
  return {
    element,
    show(id) {
      if (![...element.options].some((one) => one.value === id)) {
        element.append(h('option', { value: id }, id));
        void list();
      }
      element.value = id;
    },
  };
}
