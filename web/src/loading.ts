/** Loads the robot that the state names. */
import * as api from './api';
import { reasonOf } from './failure';
import { t } from './i18n';
import { isAbort, Latest } from './latest';
import { defaultTask } from './model';
import type { Page } from './page';
import { resolve } from './resolve';
import { START } from './state';
import { restingConfiguration } from './units';

/** A service that did not answer is asked again after this time, ms. */
const RETRY = 2000;

/** Load the robot now, and whenever another is chosen; until then the last usable one stays. */
export function keepModel({ store, tell }: Page): void {
  const latest = new Latest();
  const classes = document.body.classList;

  function load(): void {
    latest.run(async (signal) => {
      const { source, angle } = store.state;
      try {
        const model = await resolve(source, angle, signal);
        // Another robot that was chosen meanwhile is being loaded: this one is outdated.
        if (store.state.source !== source) return;
        if (classes.contains('stale')) tell('');
        classes.remove('stale');
        document.title = model.title ? `${model.title} · Denavit` : 'Denavit';
        const { q, task } = store.state;
        const fits = q.length === model.joints.length;
        store.set({
          model,
          errors: [],
          solved: null,
          solutions: [],
          followed: null,
          ...(!fits && { q: restingConfiguration(model.joints, store.state.angle) }),
          ...(!fits && task === START.task && { task: defaultTask(model) }),
        });
      } catch (error) {
        if (isAbort(error)) throw error;
        classes.add('stale');
        if (api.isTemporary(error)) {
          tell(error instanceof api.Refusal ? error.detail : t.unreachable, true);
          setTimeout(() => {
            // A robot that was chosen meanwhile is being loaded already.
            if (store.state.source === source && classes.contains('stale')) load();
          }, RETRY);
        } else if (error instanceof api.Refusal) {
          const { status, more } = error;
          const rest = more ? [{ pointer: '', message: t.moreFaults(more) }] : [];
          const errors = [...error.errors, ...rest];
          const words = reasonOf(error);
          const isOfTable = errors.length > 0 && status !== 401;
          store.set({ errors: isOfTable ? errors : [{ pointer: '', message: words }] });
          if (source.kind !== 'table') tell(words, true);
        } else throw error;
      }
    });
  }

  // The service gives a stored robot's table in the unit shown; a typed table has its own.
  store.subscribe(
    ({ source, angle, keys }) => [source, source.kind === 'table' || angle, keys],
    load,
  );
  load();
}
