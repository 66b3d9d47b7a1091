import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { Pace } from '../src/api/pace';

beforeEach(() => {
  vi.useFakeTimers();
});
afterEach(() => {
  vi.useRealTimers();
});

const told = (of: number, left: number, seconds: number): Headers =>
  new Headers({
    'RateLimit-Limit': String(of),
    'RateLimit-Remaining': String(left),
    'RateLimit-Reset': String(seconds),
  });

/** The most of these times that lie within a span, ms. */
function most(times: readonly number[], span: number): number {
  return Math.max(...times.map((from) => times.filter((t) => t >= from && t < from + span).length));
}

/** A service that counts in windows which begin with their first request, as Denavit does. */
function counting(...limits: readonly (readonly [number, number])[]) {
  const windows = limits.map(([amount, seconds]) => ({ amount, seconds, count: 0, end: 0 }));
  return (now: number): { isRefused: boolean; headers: Headers } => {
    const standings = windows.map((one) => {
      if (now >= one.end) Object.assign(one, { count: 0, end: now + 1000 * one.seconds });
      one.count += 1;
      const left = Math.max(0, one.amount - one.count);
      const reset = Math.max(1, Math.ceil((one.end - now) / 1000));
      return { isRefused: one.count > one.amount, left, reset, of: one.amount };
    });
    const [worst] = standings.toSorted(
      (a, b) => Number(b.isRefused) - Number(a.isRefused) || a.left - b.left,
    );
    if (!worst) throw new Error('no limits');
    const headers = told(worst.of, worst.left, worst.reset);
    if (worst.isRefused) headers.set('Retry-After', String(worst.reset));
    return { isRefused: worst.isRefused, headers };
  };
}

/** Drag for so long: numbers in groups, an arm that follows, and files beside them. */
async function drag(pace: Pace, service: ReturnType<typeof counting>, ms: number) {
  const sent: number[] = [];
  const [shown, refused] = [{ numbers: 0, arm: 0, files: 0 }, [] as number[]];
  const end = performance.now() + ms;
  const send = async (): Promise<void> => {
    await pace.take();
    sent.push(performance.now());
    await new Promise((done) => setTimeout(done, 12));
    const answer = service(performance.now());
    pace.ended();
    pace.learn(answer.headers);
    if (answer.isRefused) refused.push(pace.refused(answer.headers));
  };
  const loop = async (kind: keyof typeof shown, work: () => Promise<unknown>): Promise<void> => {
    while (performance.now() < end) {
      await work();
      shown[kind] += 1;
      await new Promise((done) => setTimeout(done, 1));
    }
  };
  const all = Promise.all([
    loop('numbers', async () => {
      await pace.admit(3, 600);
      await Promise.all([send(), send(), send()]);
    }),
    loop('arm', async () => {
      await pace.admit(1, 0);
      await send();
    }),
    loop('files', send),
  ]);
  await vi.advanceTimersByTimeAsync(ms + 70_000);
  await all;
  return { sent, shown, refused };
}

it('lets requests pass at once where nobody counts', async () => {
  const pace = new Pace();
  const at = performance.now();
  for (let k = 0; k < 100; k += 1) await pace.take();
  await pace.admit(50, 0);
  expect(performance.now()).toBe(at);
});

it('keeps the documented limit through long drags, and all that is shown goes on', async () => {
  const pace = new Pace();
  pace.learn(told(20, 19, 1));
  const { sent, shown, refused } = await drag(pace, counting([20, 1], [600, 60]), 150_000);
  expect(refused).toEqual([]);
  expect(most(sent, 1000)).toBeLessThan(10);
  expect(most(sent, 60_000)).toBeLessThan(600);
  expect(sent.length).toBeGreaterThan(150 * 6);
  for (const count of Object.values(shown)) expect(count).toBeGreaterThan(100);
  expect(shown.arm).toBeGreaterThan(shown.numbers);
});

it.each([
  [[5, 1]],
  [[60, 60]],
  [
    [10, 1],
    [100, 60],
  ],
] as [number, number][][])('keeps other limits, too: %j', async (...limits) => {
  const pace = new Pace();
  pace.learn(told(limits[0]?.[0] ?? 1, limits[0]?.[0] ?? 1, 1));
  const { refused, shown } = await drag(pace, counting(...limits), 120_000);
  expect(refused.length).toBeLessThan(5);
  for (const count of Object.values(shown)) expect(count).toBeGreaterThan(2);
});

it('sends nothing while a refusal holds', async () => {
  const pace = new Pace();
  expect(pace.refused(new Headers({ 'Retry-After': '7' }))).toBe(7);
  const begun = performance.now();
  const asked = [pace.take(), pace.take(), pace.admit(2, 0)];
  await vi.advanceTimersByTimeAsync(20_000);
  await Promise.all(asked);
  const times: number[] = [];
  const next = pace.take().then(() => times.push(performance.now() - begun));
  await vi.advanceTimersByTimeAsync(1000);
  await next;
  expect(times[0]).toBeGreaterThanOrEqual(7000);
});

it('forgets a request that is no longer wanted', async () => {
  const pace = new Pace();
  pace.refused(new Headers({ 'Retry-After': '1' }));
  const given = new AbortController();
  const waits = pace.take(given.signal);
  given.abort();
  await expect(waits).rejects.toThrow();
  const other = pace.take();
  await vi.advanceTimersByTimeAsync(1100);
  await other;
});
