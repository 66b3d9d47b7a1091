import { describe, expect, it } from 'vitest';
import { Store } from '../src/store';

interface State {
  readonly q: readonly number[];
  readonly angle: string;
  readonly model: { readonly name: string } | null;
}

const newStore = (): Store<State> => new Store<State>({ q: [1, 2], angle: 'deg', model: null });

describe('a subscription', () => {
  it('hears of what it selects, once a change', () => {
    const store = newStore();
    const heard: string[] = [];
    store.subscribe(
      (state) => state.angle,
      (angle) => heard.push(angle),
    );
    store.set({ q: [3] });
    store.set({ angle: 'rad', q: [4] });
    store.set({ angle: 'rad' });
    expect(heard).toEqual(['rad']);
  });

  it('compares a list item by item, and anything else by identity', () => {
    const store = newStore();
    let [lists, models] = [0, 0];
    store.subscribe(
      ({ q, angle }) => [...q, angle],
      () => {
        lists += 1;
      },
    );
    store.subscribe(
      ({ model }) => model,
      () => {
        models += 1;
      },
    );
    store.set({ q: [1, 2], model: { name: 'a' } });
    store.set({ q: [1, 2, 3], model: { name: 'a' } });
    expect([lists, models]).toEqual([1, 2]);
  });

  it('ends', () => {
    const store = newStore();
    let heard = 0;
    const end = store.subscribe(
      (state) => state.angle,
      () => {
        heard += 1;
        end();
      },
    );
    store.set({ angle: 'rad' });
    store.set({ angle: 'deg' });
    expect(heard).toBe(1);
  });

  it('hears once of a change that another listener makes, with the state as it is then', () => {
    const store = newStore();
    const heard: (readonly [string, number])[] = [];
    store.subscribe(
      (state) => state.angle,
      () => store.set({ q: [7] }),
    );
    store.subscribe(
      ({ angle, q }) => [angle, q[0] ?? 0] as const,
      (seen) => heard.push(seen),
    );
    store.set({ angle: 'rad' });
    expect(heard).toEqual([['rad', 7]]);
  });
});
