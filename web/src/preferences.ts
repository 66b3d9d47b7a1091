/** Choices that outlive the visit, where the browser keeps them. */

export function remember(name: 'language' | 'theme', value: string): void {
  try {
    localStorage.setItem(`denavit.${name}`, value);
  } catch {
    // Private windows refuse to store: the choice then lasts as long as the page.
  }
}

export function remembered(name: 'language' | 'theme'): string | null {
  try {
    return localStorage.getItem(`denavit.${name}`);
  } catch {
    return null;
  }
}
