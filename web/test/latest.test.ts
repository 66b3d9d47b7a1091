import { expect, it } from 'vitest';
import { Latest } from '../src/latest';

it('runs one task at a time, and of those that wait only the last', async () => {
  const latest = new Latest();
  const log: string[] = [];
  const task = (name: string, ms: number) => async (): Promise<void> => {
    log.push(`${name} starts`);
    await new Promise((done) => setTimeout(done, ms));
    log.push(`${name} ends`);
  };
  latest.run(task('a', 20));
  latest.run(task('b', 1));
  latest.run(task('c', 1));
  await new Promise((done) => setTimeout(done, 60));
  expect(log).toEqual(['a starts', 'a ends', 'c starts', 'c ends']);
});

it('gives up a slow task once a newer one waits', async () => {
  const latest = new Latest();
  const log: string[] = [];
  latest.run(async (signal) => {
    await new Promise((_, failed) => signal.addEventListener('abort', () => failed(signal.reason)));
  });
  latest.run(async () => void log.push('newer'));
  await new Promise((done) => setTimeout(done, 400));
  expect(log).toEqual(['newer']);
});
