/** The latest request wins: one at a time, and of those that came meanwhile only the last. */

/** A request under way for longer than this is given up for a newer one, ms. */
const PATIENCE = 150;

export class Latest {
  private running: AbortController | null = null;
  private next: ((signal: AbortSignal) => Promise<void>) | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** Runs the task now, or after the one under way; a task still waiting is dropped. */
  run(task: (signal: AbortSignal) => Promise<void>): void {
    if (this.running) {
      this.next = task;
      return;
    }
    const controller = new AbortController();
    this.running = controller;
    this.timer = setTimeout(() => this.giveUp(), PATIENCE);
    void task(controller.signal)
      .catch((error: unknown) => {
        if (!isAbort(error)) throw error;
      })
      .finally(() => this.done(controller));
  }

  /** Ends what is under way and drops what waits. */
  cancel(): void {
    this.next = null;
    this.running?.abort();
  }

  private giveUp(): void {
    if (this.next) this.running?.abort();
    else if (this.running) this.timer = setTimeout(() => this.giveUp(), PATIENCE);
  }

  private done(controller: AbortController): void {
    if (this.running !== controller) return;
    clearTimeout(this.timer);
    this.running = null;
    const { next } = this;
    this.next = null;
    if (next) this.run(next);
  }
}

export function isAbort(error: unknown): boolean {
  return error instanceof DOMException && error.name === 'AbortError';
}
