/** Plays the configurations of a path at their times. */
import type { PathAnswer } from '../../api';
import { button, h } from '../../dom';
import { t } from '../../i18n';
import type { Page } from '../../page';

export interface Player {
  readonly element: HTMLElement;
  /** Show the player for a path, at its first configuration. */
  load(path: PathAnswer): void;
  start(): void;
  stop(): void;
  /** Stop, and hide the player. */
  close(): void;
}

export function pathPlayer({ history }: Page): Player {
  let path: PathAnswer | null = null;
  let frame = 0;
  const seek = h('input', {
    type: 'range',
    min: 0,
    max: 0,
    step: 1,
    'aria-label': t.sample,
    oninput: () => {
      stop();
      show(seek.valueAsNumber);
    },
  });
  const toggle = button(t.play, () => (frame ? stop() : start()));
  const element = h('div', { class: 'line player', hidden: true }, toggle, seek);

  function show(k: number): void {
    const q = path?.q[k];
    if (!q) return;
    seek.value = String(k);
    history.change({ q }, 'play');
  }

  function start(): void {
    if (!path) return;
    toggle.textContent = t.pause;
    const { t: times, q } = path;
    const last = q.length - 1;
    const from = seek.valueAsNumber < last ? (times[seek.valueAsNumber] ?? 0) : 0;
    const begun = performance.now() - 1000 * from;
    const tick = (): void => {
      const seconds = (performance.now() - begun) / 1000;
      const next = times.findIndex((one) => one > seconds);
      show(next < 0 ? last : next);
      if (next < 0) stop();
      else frame = requestAnimationFrame(tick);
    };
    frame = requestAnimationFrame(tick);
  }

  function stop(): void {
    cancelAnimationFrame(frame);
    frame = 0;
    toggle.textContent = t.play;
  }

  return {
    element,
    load(answer) {
      path = answer;
      element.hidden = false;
      seek.max = String(answer.q.length - 1);
      seek.value = '0';
    },
    start,
    stop,
    close() {
      stop();
      element.hidden = true;
    },
  };
}
