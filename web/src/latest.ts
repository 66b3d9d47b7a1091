/** Runs one task at a time, and of those that wait only the last. */

/** A task that runs for longer than this is aborted for a newer one, ms. */
const PATIENCE = 150;

export class Latest {
  private running: AbortController | null = null;
  private next: ((signal: AbortSignal) => Promise<void>) | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** Run a task now, or after the one that runs; a task that still waits is dropped. */
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
