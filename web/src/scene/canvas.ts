/** The canvas: draws the world at the next animation frame after a change, labels included. */
import { type Object3D, type PerspectiveCamera, WebGLRenderer } from 'three';
import { layOut, type Placed } from './labels';
import { NoWebGL } from './types';

export class Canvas {
  /** The labels that the last drawing showed. */
  labels: readonly Placed[] = [];
  private readonly renderer = newRenderer();
  private readonly observer: ResizeObserver;
  /** The animation frame that is asked for; 0 for none. */
  private requested = 0;

  /**
   * @param ball No label is drawn over it.
   * @param resized Called when the host has another size.
   * @throws NoWebGL where the browser gives no WebGL context.
   */
  constructor(
    private readonly host: HTMLElement,
    private readonly world: Object3D,
    private readonly camera: PerspectiveCamera,
    private readonly ball: Object3D,
    resized: () => void,
  ) {
    host.append(this.element);
    this.observer = new ResizeObserver(() => {
      if (this.resize()) resized();
    });
    this.observer.observe(host);
  }

  get element(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  readonly draw = (): void => {
    if (this.requested) return;
    this.requested = requestAnimationFrame(() => {
      this.requested = 0;
      const { world, camera, host, ball } = this;
      world.updateMatrixWorld();
      camera.updateMatrixWorld();
      this.labels = layOut(world, camera, host.clientWidth, host.clientHeight, ball);
      this.renderer.render(world, camera);
    });
  };

  dispose(): void {
    this.observer.disconnect();
    this.renderer.dispose();
    this.element.remove();
  }

  /** Take the size of the host, if it has one. */
  private resize(): boolean {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height) return false;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    return true;
  }
}

function newRenderer(): WebGLRenderer {
  try {
    return new WebGLRenderer({ antialias: true, alpha: true });
  } catch (error) {
    throw new NoWebGL(String(error));
  }
}
