/** A state, and the listeners that are called when a part of it changes. */

/** Holds an immutable state, which is replaced as a whole; parts are compared by identity. */
export class Store<S extends object> {
  private readonly checks = new Set<() => void>();

  constructor(private current: S) {}

  get state(): S {
    return this.current;
  }

  /** Replace parts of the state, then call the listeners whose selection has changed. */
  set(change: Partial<S>): void {
    this.current = { ...this.current, ...change };
    for (const check of this.checks) check();
  }

  /**
   * Call a listener after each change of what it selects, in the order of subscription.
   *
   * @param select A pure function; an array is compared item by item, so that it may select several
   *   parts of the state.
   * @returns A function that ends the subscription.
   */
  subscribe<const T>(select: (state: S) => T, listener: (selected: T) => void): () => void {
    let selected = select(this.current);
    const check = (): void => {
      const before = selected;
      selected = select(this.current);
      if (!isSame(selected, before)) listener(selected);
    };
    this.checks.add(check);
    return () => this.checks.delete(check);
  }
}

function isSame(a: unknown, b: unknown): boolean {
  if (!Array.isArray(a) || !Array.isArray(b)) return Object.is(a, b);
  return a.length === b.length && a.every((one, k) => Object.is(one, b[k]));
}
