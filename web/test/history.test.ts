import { beforeEach, describe, expect, it, vi } from 'vitest';
import { History } from '../src/history';
import { newSession, START, type State } from '../src/state';
import { Store } from '../src/store';

let store: Store<State>;
let history: History;
let now = 0;

beforeEach(() => {
  now = 0;
  vi.spyOn(performance, 'now').mockImplementation(() => now);
  store = new Store<State>({ ...START, ...newSession(false) });
  history = new History(store);
});

function change(kind: string, q: readonly number[], after: number): void {
  now += after;
  history.change({ q }, kind);
}

describe('undo and redo', () => {
  it('go back and forth in steps', () => {
    change('q0', [1], 0);
    change('q1', [2], 10);
    history.undo();
    expect([store.state.q, history.canUndo, history.canRedo]).toEqual([[1], true, true]);
    history.undo();
    expect([store.state.q, history.canUndo]).toEqual([[], false]);
    history.redo();
    history.redo();
    history.redo();
    expect([store.state.q, history.canRedo]).toEqual([[2], false]);
  });

  it('take quick changes of one kind as one step', () => {
    change('q0', [1], 0);
    change('q0', [2], 700);
    change('q0', [3], 700);
    change('q0', [4], 900);
    history.undo();
    expect(store.state.q).toEqual([3]);
    history.undo();
    expect(store.state.q).toEqual([]);
  });

  it('leave what belongs to the visit, and forget the future after a new change', () => {
    change('q0', [1], 0);
    store.set({ reproduced: 'ik', open: ['pose'] });
    history.undo();
    expect([store.state.reproduced, store.state.open]).toEqual(['ik', START.open]);
    change('q0', [5], 10);
    expect(history.canRedo).toBe(false);
  });
});
