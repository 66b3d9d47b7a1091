/** Asks the reader for a key. */
import type { Lack } from './api';
import { opened } from './i18n';
import type { Page } from './page';

/**
 * Ask, for want of a key or to change it.
 *
 * @returns Whether there is one that the service accepts.
 */
export async function askForKey({ store }: Page, why: Lack | 'change'): Promise<boolean> {
  const told = (): void => store.set({ keys: store.state.keys + 1 });
  // From now on the header has its button.
  if (!store.state.keys) told();
  const { keyDialog } = await opened(import('./key-dialog'));
  const isGiven = await keyDialog(why);
  if (isGiven) told();
  return isGiven;
}
