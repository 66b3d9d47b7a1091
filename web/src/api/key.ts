/** The key that the page shows to the service; it is kept for the visit and nowhere else. */

const NAME = 'denavit.key';
/** Why a key is asked for: there is none, or the service no longer accepts the one that was shown. */
export type Lack = 'missing' | 'revoked';

let held = read();
let ask: (lack: Lack) => Promise<boolean> = () => Promise.resolve(false);
let asking: Promise<boolean> | null = null;
let isDeclined = false;

/** The key; '' without one. */
export function key(): string {
  return held;
}

/** Show another key from now on; '' for none. */
export function holdKey(next: string): void {
  held = next;
  isDeclined = false;
  try {
    if (next) sessionStorage.setItem(NAME, next);
    else sessionStorage.removeItem(NAME);
  } catch {
    // Where the browser stores nothing the key lasts as long as the page.
  }
}

/** Have a function ask the reader for a key; it answers whether there is one. */
export function askForKeyBy(asked: typeof ask): void {
  ask = asked;
}

/** Wait while the reader is asked for a key. */
export async function keyAsked(): Promise<void> {
  await asking;
}

/**
 * Ask for a key after a request was refused for that which it showed.
 *
 * @returns Whether there is another one now. All requests share one question, and a reader who has
 *   declined is not asked again.
 */
export async function anotherKey(shown: string): Promise<boolean> {
  if (shown !== held) return true;
  if (isDeclined) return false;
  asking ??= ask(shown ? 'revoked' : 'missing').finally(() => {
    asking = null;
  });
  const isGiven = await asking;
  isDeclined = !isGiven;
  return isGiven;
}

function read(): string {
  try {
    return sessionStorage.getItem(NAME) ?? '';
  } catch {
    return '';
  }
}
