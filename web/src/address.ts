/** The address of the page, which holds the state: each follows the other. */
import { fromHash, isIncomplete, toHash } from './link';
import type { Page } from './page';
import { type Linked, linkedValues } from './state';

/** The address changes once the state has rested for this time, ms. */
const PAUSE = 250;

/** The state of the address; a robot too long for it is in the entry of the browser's history. */
export async function readAddress(): Promise<Linked> {
  const state = await fromHash(location.hash);
  const { source } = (window.history.state ?? {}) as { source?: Linked['source'] };
  return source && isIncomplete(location.hash) ? { ...state, source } : state;
}

/**
 * Keep the address and the state in step.
 *
 * @returns A function that writes the present state into the address at once.
 */
export function keepAddress({ store, history }: Page): () => Promise<void> {
  let hash = location.hash;
  let entry = entryOf(store.state);
  let timer: ReturnType<typeof setTimeout>;
  let changes = 0;

  async function write(): Promise<void> {
    const { state } = store;
    const written = changes;
    const next = `#${await toHash(state)}`;
    if (changes !== written) return;
    const before = entry;
    hash = next;
    entry = entryOf(state);
    const kept = isIncomplete(hash) ? { source: state.source } : null;
    if (entry === before) window.history.replaceState(kept, '', hash);
    else window.history.pushState(kept, '', hash);
  }

  store.subscribe(linkedValues, () => {
    changes += 1;
    clearTimeout(timer);
    timer = setTimeout(() => void write(), PAUSE);
  });
  addEventListener('hashchange', () => {
    if (location.hash === hash) return;
    hash = location.hash;
    void readAddress().then((state) => {
      entry = entryOf(state);
      history.change(state, 'link');
    });
  });
  return write;
}

/** Another robot is another entry of the browser's history; other changes replace the present one. */
function entryOf({ source }: Linked): string {
  return source.kind === 'stored' ? source.id : source.kind;
}
