/** The sections of numbers: folded or open, computed only while they are needed. */
import * as api from './api';
import { button, h, replace } from './dom';
import { reasonOf } from './failure';
import { opened, t } from './i18n';
import { Latest } from './latest';
import type { Model } from './model';
import type { Page } from './page';
import { jacobianPanel } from './panels/jacobian';
import { linksPanel } from './panels/links';
import type { AnyPanel } from './panels/panel';
import { posePanel } from './panels/pose';
import { singularityPanel } from './panels/singularity';
import type { Answers, Section, State } from './state';
import { warningsView } from './warnings';

/** Sections whose code is loaded when they are opened first. */
const LAZY = {
  ik: async () => (await import('./panels/ik')).ikPanel,
  path: async () => (await import('./panels/path')).pathPanel,
  reproduce: async () => (await import('./panels/reproduce')).reproducePanel,
};

/** The arm that is dragged may go before its numbers for this time, ms. */
const NUMBERS_WAIT = 600;
/** Numbers that did not arrive are asked for again after this time, ms. */
const RETRY = 2000;

export function sectionsView(page: Page): HTMLElement {
  const { store } = page;
  const panels: readonly AnyPanel[] = [
    posePanel(page),
    linksPanel(page),
    jacobianPanel(page),
    singularityPanel(page),
  ];
  const folds = new Map<Section, HTMLDetailsElement>();
  const latest = new Latest(
    () => panels.filter(({ id }) => isNeeded(id, store.state)).length,
    NUMBERS_WAIT,
  );
  let again: ReturnType<typeof setTimeout>;
  let isFailing = false;

  function section(id: Section, title: string, body: HTMLElement): HTMLElement {
    const fold = h(
      'details',
      {
        class: 'fold',
        id: `section-${id}`,
        ontoggle: () => {
          const open = new Set(store.state.open);
          if (fold.open === open.has(id)) return;
          if (fold.open) open.add(id);
          else open.delete(id);
          store.set({ open: [...open] });
        },
      },
      h('summary', {}, h('h2', {}, title)),
      body,
    );
    folds.set(id, fold);
    const copy =
      id !== 'reproduce' &&
      button('‹›', () => reproduce(id), {
        class: 'copy',
        title: t.showRequest,
        'aria-label': `${t.showRequest}: ${title}`,
      });
    return h('section', { class: 'card', 'aria-label': title }, fold, copy);
  }

  function reproduce(id: Section): void {
    const open = [...new Set<Section>([...store.state.open, 'reproduce'])];
    store.set({ open, reproduced: id });
    folds.get('reproduce')?.scrollIntoView({ block: 'nearest' });
  }

  const places = { ik: h('div'), path: h('div'), reproduce: h('div') };

  async function fill(id: keyof typeof LAZY, place: HTMLElement): Promise<void> {
    if (place.childElementCount) return;
    const make = await opened(LAZY[id]());
    if (!place.childElementCount) replace(place, make(page));
  }

  function unfold(open: readonly Section[]): void {
    for (const [id, fold] of folds) fold.open = open.includes(id);
    for (const id of Object.keys(places) as (keyof typeof places)[]) {
      if (open.includes(id)) void fill(id, places[id]);
    }
  }

  async function ask(
    panel: AnyPanel,
    call: api.Call<Answers[keyof Answers]>,
    model: Model,
    state: State,
    signal: AbortSignal,
  ): Promise<{ answer?: unknown; isFailed: boolean }> {
    const fold = folds.get(panel.id)?.classList;
    try {
      const answer = await api.json(call, signal);
      fold?.remove('stale');
      panel.show(answer, model, state);
      return { answer, isFailed: false };
    } catch (error) {
      page.tell(reasonOf(error), true);
      fold?.add('stale');
      return { isFailed: api.isTemporary(error) };
    }
  }

  function refresh(): void {
    latest.run(async (signal) => {
      const { state } = store;
      const { model } = state;
      if (!model || state.q.length !== model.joints.length || isOfAnother(model, state)) return;
      const asked = panels.flatMap((panel) => {
        if (!isNeeded(panel.id, state)) return [];
        const call = panel.call(model, state);
        folds.get(panel.id)?.parentElement?.toggleAttribute('hidden', call === null);
        return call ? [{ panel, call }] : [];
      });
      const calls = Object.fromEntries(asked.map(({ panel, call }) => [panel.id, call]));
      store.set({ calls: { ...store.state.calls, ...calls } });
      const found = await Promise.all(
        asked.map(({ panel, call }) => ask(panel, call, model, state, signal)),
      );
      clearTimeout(again);
      const hasFailed = found.some((one) => one.isFailed);
      if (hasFailed) again = setTimeout(refresh, RETRY);
      else if (isFailing) page.tell('');
      isFailing = hasFailed;
      const answers = Object.fromEntries(
        asked.flatMap(({ panel }, k) => {
          const answer = found[k]?.answer;
          return answer === undefined ? [] : [[panel.id, answer]];
        }),
      );
      store.set({ answers: { ...store.state.answers, ...answers } });
    });
  }

  store.subscribe(({ open }) => open, unfold);
  store.subscribe(
    (s) => [
      s.model,
      s.q,
      s.angle,
      s.euler,
      s.reference,
      s.task,
      s.open,
      s.view,
      s.digits,
      s.row,
      s.keys,
    ],
    refresh,
  );
  const element = h(
    'div',
    { class: 'sections' },
    warningsView(page),
    ...panels.map((one) => section(one.id, one.title, one.body)),
    section('ik', t.ik, places.ik),
    section('path', t.path, places.path),
    section('reproduce', t.reproduce, places.reproduce),
  );
  unfold(store.state.open);
  return element;
}

/** Whether a section's numbers are shown: in it, in the view, or in another section. */
function isNeeded(id: Section, { open, view }: State): boolean {
  if (open.includes(id)) return true;
  if (id === 'singularity') return view.lost || view.ellipsoid !== 'none';
  return id === 'pose' && (open.includes('ik') || open.includes('path'));
}

/** Whether another robot was chosen, which is being loaded: the configuration is not for this one. */
function isOfAnother({ ref }: Model, { source }: State): boolean {
  if (source.kind === 'stored') return !('id' in ref) || ref.id !== source.id;
  return 'id' in ref && source.kind === 'urdf';
}
