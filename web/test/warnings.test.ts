import { expect, test } from 'vitest';
import type { State } from '../src/state';
import { warningsOf } from '../src/warnings';

const told = (model: string[], pose: string[], solved: string[] | null) =>
  warningsOf({
    model: { warnings: model },
    answers: { pose: { warnings: pose } },
    solved: solved && { answer: { warnings: solved }, error: '' },
  } as unknown as State);

test('a right robot and request have no warning', () => {
  expect(told([], [], null)).toEqual([]);
  expect(warningsOf({ model: null, answers: {}, solved: null } as unknown as State)).toEqual([]);
});

test('each warning is told once, those about the request first', () => {
  expect(told(['alpha', 'names'], ['q', 'alpha'], ['target', 'alpha'])).toEqual([
    'target',
    'alpha',
    'q',
    'names',
  ]);
});
