/** The 3D part: a chunk of its own, with three.js and urdf-loader, loaded after the first screen. */
import { Object3D } from 'three';
import type { Scene, SceneCallbacks } from './types';
import { View } from './view';

/**
 * Create the scene in a host element, which it fills.
 *
 * @throws NoWebGL where the browser gives no WebGL context.
 */
export function createScene(host: HTMLElement, callbacks: SceneCallbacks): Scene {
  Object3D.DEFAULT_UP.set(0, 0, 1);
  return new View(host, callbacks);
}
