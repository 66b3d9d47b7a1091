/** The service's picture of the arm, where the browser has no WebGL. */
import * as api from '../api';
import { picture } from '../api/motion';
import { h, replace } from '../dom';
import { t } from '../i18n';
import { Latest } from '../latest';
import type { Page } from '../page';

/** A picture waits as long as the numbers, which come with it; ms. */
const WITH_NUMBERS = 600;

export function pictureView({ store }: Page, host: HTMLElement): void {
  const image = h('img', { class: 'picture', alt: t.scene });
  const latest = new Latest(() => 1, WITH_NUMBERS);
  replace(host, image, h('p', { class: 'note' }, t.noWebGL));
  // The image has a description of its own.
  host.removeAttribute('role');
  host.removeAttribute('aria-label');

  function draw(): void {
    latest.run(async (signal) => {
      const { model, q, angle } = store.state;
      if (!model || q.length !== model.joints.length) return;
      const [width, height] = [pixels(host.clientWidth), pixels(host.clientHeight)];
      try {
        const call = picture(model.ref, q, angle, width, height);
        const response = await api.send(call, signal);
        show(URL.createObjectURL(await response.blob()));
      } catch (error) {
        if (!(error instanceof api.Refusal || error instanceof api.Unreachable)) throw error;
        // The numbers, asked for at the same time, show the reason.
        image.hidden = true;
      }
    });
  }

  function show(url: string): void {
    const before = image.src;
    image.src = url;
    image.hidden = false;
    if (before) URL.revokeObjectURL(before);
  }

  store.subscribe(({ model, q, angle, keys }) => [model, q, angle, keys], draw);
  draw();
}

/** The nearest size that the service draws. */
function pixels(length: number): number {
  return Math.round(Math.min(2000, Math.max(200, length)));
}
