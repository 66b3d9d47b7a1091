/**
 * How fast the page asks: as it likes, until an answer says that the service counts requests
 * (`RateLimit-Limit`); then so that no reader is ever refused for asking too often.
 */

/** Most requests within the span, ms: under 10 a second, however late some of them leave. */
const MOST = 9;
const SPAN = 1100;
/** Time that a request of a drag takes up, ms: so its requests come evenly. */
const STEP = 120;
/** What is no part of a drag, such as a mesh, gives way to one for this time, ms. */
const FILES_WAIT = 1000;
/** A refusal that does not say when to come back holds for this time, s. */
const SECOND = 1;

interface Waiter {
  /** Requests that it wants to send together. */
  readonly count: number;
  /** When it wants to be served at the latest; the earliest is served first. */
  readonly due: number;
  readonly go: () => void;
}

export class Pace {
  private isCounted = false;
  /** When the requests of the last span were sent. */
  private sent: number[] = [];
  private last = 0;
  /** Requests without an answer. */
  private open = 0;
  /** No request before this time: the service has refused one, or nothing is left. */
  private closed = 0;
  /** No request of a drag before this time. */
  private rest = 0;
  /** What the service allows until then, as its last answer said. */
  private left = { requests: Number.POSITIVE_INFINITY, of: 0, until: 0 };
  /** Requests that were admitted just now, and go before all that wait. */
  private admitted = 0;
  private drags: Waiter[] = [];
  private others: Waiter[] = [];
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** Wait until a request may be sent; it then counts as sent. */
  async take(signal?: AbortSignal): Promise<void> {
    const isFree = !this.drags.length && !this.others.length && this.wait(1) <= 0;
    if (this.admitted > 0) this.admitted -= 1;
    else if (this.isCounted && !isFree) {
      // Those in the queue are counted when they are served.
      await this.queued(this.others, 1, FILES_WAIT, signal);
      return;
    }
    this.count();
  }

  /**
   * Wait until the requests of a step of a drag may be sent together, at once.
   *
   * @param count How many they are.
   * @param patience Time for which others are let pass, ms.
   */
  async admit(count: number, patience: number): Promise<void> {
    if (this.isCounted) await this.queued(this.drags, Math.min(count, MOST), patience);
  }

  /** A request that was sent has an answer, or will get none. */
  ended(): void {
    this.open -= 1;
  }

  /** Learn from the headers of an answer how much is left. */
  learn(headers: Headers): void {
    const [of, requests, seconds] = ['Limit', 'Remaining', 'Reset'].map((name) =>
      Number(headers.get(`RateLimit-${name}`) ?? Number.NaN),
    ) as [number, number, number];
    if (![of, requests, seconds].every(Number.isFinite)) return;
    this.isCounted = true;
    this.left = { requests: requests - this.open, of, until: performance.now() + 1000 * seconds };
  }

  /** Send nothing for as long as a refusal says. @returns That time, s. */
  refused(headers: Headers): number {
    const seconds = Number(headers.get('Retry-After')) || SECOND;
    this.isCounted = true;
    this.closed = performance.now() + 1000 * seconds;
    return seconds;
  }

  private count(): void {
    const now = performance.now();
    this.sent = [...this.sent.filter((at) => at > now - SPAN), now];
    this.last = now;
    this.left.requests -= 1;
    this.open += 1;
  }

  /** Time until so many requests may be sent, ms; 0 or less for now. */
  private wait(count: number): number {
    const now = performance.now();
    const recent = this.sent.filter((at) => at > now - SPAN);
    const oldest = recent[recent.length + count - MOST - 1];
    let until = Math.max(this.closed, oldest === undefined ? 0 : oldest + SPAN);
    const { requests, of, until: end } = this.left;
    if (end > now && requests < count) until = Math.max(until, end);
    // Of what is scarce, an even share: the rest of a minute is not gone in its first seconds.
    else if (end > now && requests < of / 2) {
      until = Math.max(until, this.last + (end - now) / requests);
    }
    return until - now;
  }

  private queued(
    queue: Waiter[],
    count: number,
    patience: number,
    signal?: AbortSignal,
  ): Promise<void> {
    return new Promise((go, fail) => {
      const waiter = { count, due: performance.now() + patience, go };
      queue.push(waiter);
      queue.sort((a, b) => a.due - b.due);
      const leave = (): void => {
        const at = queue.indexOf(waiter);
        if (at >= 0) queue.splice(at, 1);
        fail(signal?.reason);
      };
      signal?.addEventListener('abort', leave, { once: true });
      this.serve();
    });
  }

  /** Serve whoever may go now, drags first, and come back for the others. */
  private serve(): void {
    clearTimeout(this.timer);
    this.admitted = 0;
    const [drag] = this.drags;
    const [other] = this.others;
    const now = performance.now();
    const waits = [
      drag && { queue: this.drags, ms: Math.max(this.wait(drag.count), this.rest - now) },
      // While a drag rests, those that have waited take what it leaves; when its turn has come
      // they give way.
      other &&
        (!drag || this.rest > now) && {
          queue: this.others,
          ms: Math.max(this.wait(1), drag ? other.due - now : 0),
        },
    ].filter((one) => !!one);
    const ready = waits.find(({ ms }) => ms <= 0);
    const waiter = ready?.queue.shift();
    if (waiter) {
      if (ready?.queue === this.others) this.count();
      else {
        this.rest = now + STEP * waiter.count;
        this.admitted = waiter.count;
      }
      waiter.go();
    }
    if (!waits.length) return;
    // What is admitted is sent before the next one is served.
    const next = waiter ? 0 : Math.min(...waits.map(({ ms }) => ms));
    this.timer = setTimeout(() => this.serve(), next);
  }
}

/** The pace of all requests of the page. */
export const pace = new Pace();
