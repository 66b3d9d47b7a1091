/** The 3D view and its toolbar; without WebGL the service's picture. */
import { h, replace } from '../dom';
import { t } from '../i18n';
import type { Page } from '../page';
import { NoWebGL, type Scene, type SceneCallbacks } from '../scene/types';
import { follow } from '../solve';
import { fromRadians } from '../units';
import { drawScene, ghostsOf } from './drawing';
import { pictureView } from './picture';
import { toolbar } from './toolbar';

export async function stageView(page: Page, place: HTMLElement): Promise<void> {
  const host = h('div', { class: 'host', role: 'img', 'aria-label': t.sceneHelp });
  let scene: Scene | null = null;
  const tools = toolbar(page, () => scene?.fit());
  replace(place, host, tools);
  scene = await sceneIn(host, callbacks(page));
  if (scene) {
    drawScene(page, scene);
  } else {
    tools.remove();
    pictureView(page, host);
  }
}

/** The scene; null where the browser has no WebGL. */
async function sceneIn(host: HTMLElement, callbacks: SceneCallbacks): Promise<Scene | null> {
  // Asked before three.js is loaded, which would log an error of its own.
  if (!document.createElement('canvas').getContext('webgl2')) return null;
  const { createScene } = await import('../scene');
  try {
    return createScene(host, callbacks);
  } catch (error) {
    if (error instanceof NoWebGL) return null;
    throw error;
  }
}

function callbacks(page: Page): SceneCallbacks {
  const { store, history } = page;
  return {
    onJointChange(index, value) {
      const { model, q, angle } = store.state;
      const joint = model?.joints[index];
      if (!joint) return;
      history.change({ q: q.with(index, fromRadians(joint, value, angle)) }, `q${index}`);
    },
    onTargetDrag(pose, done) {
      history.change({ target: { matrix: pose } }, 'target');
      follow(page, done);
    },
    onFramePick(frame) {
      const [, number = '0'] = /^frame_(\d+)$/.exec(frame ?? '') ?? [];
      history.change({ row: Number(number) > 0 ? Number(number) - 1 : null, step: 4 }, 'row');
    },
    onGhostPick(index) {
      const q = ghostsOf(store.state)[index]?.q;
      if (q) history.change({ q }, 'ghost');
    },
  };
}
