/** The sections of numbers: folded or open, asked for only while open. */
import * as api from './api';
import { button, h, replace } from './dom';
import { opened, t } from './i18n';
import { Latest } from './latest';
import type { Model } from './model';
import type { Page } from './page';
import { jacobianPanel } from './panels/jacobian';
import { linksPanel } from './panels/links';
import type { Panel } from './panels/panel';
import { posePanel } from './panels/pose';
import { singularityPanel } from './panels/singularity';
import type { Section, State } from './state';

const LAZY = {
  ik: async () => (await import('./panels/ik')).ikPanel,
  path: async () => (await import('./panels/path')).pathPanel,
  reproduce: async () => (await import('./panels/reproduce')).reproducePanel,
};

/** After this time numbers that did not come are asked for again, ms. */
const AGAIN = 2000;

/** What asks for other numbers than those on the page. */
const INPUTS: readonly (keyof State)[] = [
  'q',
  'angle',
  'euler',
  'reference',
  'task',
  'open',
  'view',
  'digits',
  'row',
];

export function sectionsView(page: Page): HTMLElement {
  const { store } = page;
  const panels = [posePanel(page), linksPanel(page), jacobianPanel(page), singularityPanel(page)];
  const lines = new Map<Section, HTMLDetailsElement>();
  const live = new Latest();
  let again: ReturnType<typeof setTimeout>;
  let failing = false;

  function section(id: Section, title: string, body: HTMLElement, copies: boolean): HTMLElement {
    const copy =
      copies &&
      button(
        '‹›',
        () => {
          store.set({ open: [...new Set<Section>([...store.state.open, 'reproduce'])] });
          page.calls.delete('reproduce');
          const call = page.calls.get(id);
          if (call) page.calls.set('reproduce', call);
          reproduced = id;
          for (const tell of page.onNumbers) tell();
          lines.get('reproduce')?.scrollIntoView({ block: 'nearest' });
        },
        { class: 'copy', title: t.showRequest, 'aria-label': `${t.showRequest}: ${title}` },
      );
    const details = h(
      'details',
      {
        class: 'fold',
        id: `section-${id}`,
        ontoggle: () => {
          const open = new Set(store.state.open);
          if (details.open === open.has(id)) return;
          if (details.open) open.add(id);
          else open.delete(id);
          store.set({ open: [...open] });
        },
      },
      h('summary', {}, h('h2', {}, title)),
      body,
    );
    lines.set(id, details);
    return h('section', { class: 'card', 'aria-label': title }, details, copy);
  }

  async function fill(id: keyof typeof LAZY, place: HTMLElement): Promise<void> {
    if (place.childElementCount) return;
    const make = await opened(LAZY[id]());
    if (!place.childElementCount) replace(place, make(page));
  }

  const places = { ik: h('div'), path: h('div'), reproduce: h('div') };

  function fold(state: State): void {
    for (const [id, details] of lines) details.open = state.open.includes(id);
    for (const id of Object.keys(places) as (keyof typeof places)[]) {
      if (state.open.includes(id)) void fill(id, places[id]);
    }
  }

  function wanted(state: State): Panel[] {
    return panels.filter(
      ({ id }) =>
        state.open.includes(id) ||
        (id === 'singularity' && (state.view.lost || state.view.ellipsoid !== 'none')) ||
        (id === 'pose' && state.open.some((one) => one === 'ik' || one === 'path')),
    );
  }

  function refresh(): void {
    const { model } = page;
    if (!model) return;
    live.run(async (signal) => {
      const { state } = store;
      const now = page.model;
      let failed = false;
      if (!now || state.q.length !== now.joints.length || isOfAnother(now, state)) return;
      const asked = wanted(state).map(async (panel) => {
        const call = panel.call(now, state);
        const details = lines.get(panel.id);
        details?.parentElement?.toggleAttribute('hidden', call === null);
        if (!call) return;
        page.calls.set(panel.id, call);
        try {
          const answer = await api.json(call, signal);
          details?.classList.remove('stale');
          panel.show(answer, now, state);
        } catch (error) {
          if (!(error instanceof api.Refusal || error instanceof api.Unreachable)) throw error;
          details?.classList.add('stale');
          failed ||= api.willPass(error);
          page.tell(error instanceof api.Refusal ? error.detail : t.unreachable, true);
        }
      });
      await Promise.all(asked);
      clearTimeout(again);
      if (failed) again = setTimeout(refresh, AGAIN);
      else if (failing) page.tell('');
      failing = failed;
      for (const tell of page.onNumbers) tell();
    });
  }

  store.listen((state, before) => {
    fold(state);
    if (INPUTS.some((name) => state[name] !== before[name])) refresh();
  });
  page.onModel.push(refresh);
  const element = h(
    'div',
    { class: 'sections' },
    ...panels.map((one) => section(one.id, one.title, one.body, true)),
    section('ik', t.ik, places.ik, true),
    section('path', t.path, places.path, true),
    section('reproduce', t.reproduce, places.reproduce, false),
  );
  fold(store.state);
  return element;
}

/** The section whose request "Reproduce" shows. */
export let reproduced: Section = 'pose';

export function reproduce(id: Section): void {
  reproduced = id;
}

/** A robot that was just chosen is on its way: its posture is not for the one before. */
function isOfAnother({ ref }: Model, { source }: State): boolean {
  return source.kind === 'stored'
    ? !('id' in ref) || ref.id !== source.id
    : 'id' in ref && source.kind === 'urdf';
}
