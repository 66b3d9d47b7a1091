/** The 3D part: a lazy chunk with three.js and urdf-loader. */
import {
  AmbientLight,
  AxesHelper,
  Box3,
  DirectionalLight,
  GridHelper,
  Group,
  Object3D,
  PerspectiveCamera,
  Scene as ThreeScene,
  Sphere,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import URDFLoader, { type URDFRobot } from 'urdf-loader';
import { NoWebGL, type Scene, type SceneCallbacks, type SceneRobot } from './types';

/**
 * Creates the scene in a host element, which it fills.
 *
 * @throws NoWebGL where the browser gives no WebGL context.
 */
export function createScene(host: HTMLElement, _callbacks: SceneCallbacks): Scene {
  Object3D.DEFAULT_UP.set(0, 0, 1);
  const renderer = newRenderer();
  host.append(renderer.domElement);
  const world = new ThreeScene();
  const camera = new PerspectiveCamera(40, 1, 0.01, 100);
  camera.up.set(0, 0, 1);
  camera.position.set(2, -2.2, 1.6);
  const controls = new OrbitControls(camera, renderer.domElement);
  const light = new DirectionalLight(0xffffff, 2);
  light.position.set(2, -3, 5);
  const grid = new GridHelper(4, 20, 0x888888, 0xcccccc);
  grid.rotation.x = Math.PI / 2;
  const place = new Group();
  world.add(new AmbientLight(0xffffff, 1.5), light, grid, place);

  let shown: SceneRobot | null = null;
  let model: URDFRobot | null = null;
  let requested = 0;

  const draw = (): void => {
    if (!requested) {
      requested = requestAnimationFrame(() => {
        requested = 0;
        renderer.render(world, camera);
      });
    }
  };
  controls.addEventListener('change', draw);
  const observer = new ResizeObserver(() => {
    const { clientWidth: width, clientHeight: height } = host;
    if (width && height) {
      renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
      renderer.setSize(width, height);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
      draw();
    }
  });
  observer.observe(host);

  const scene: Scene = {
    setRobot(robot) {
      if (shown?.key === robot.key) return;
      const loader = new URDFLoader();
      loader.loadMeshCb = (_url, _manager, _material, done) => done(new Object3D());
      const next = loader.parse(robot.urdf);
      for (const joint of Object.values(next.joints)) joint.ignoreLimits = true;
      for (const frame of Object.values(next.links)) frame.add(new AxesHelper(0.1));
      if (model) place.remove(model);
      place.add(next);
      model = next;
      shown = robot;
      scene.fit();
    },
    setQ(q) {
      shown?.joints.forEach((joint, k) => model?.setJointValue(joint.name, q[k] ?? 0));
      draw();
    },
    setFramesShown: draw,
    setDimensions: draw,
    setMotionStep: draw,
    setEllipsoids: draw,
    setGhosts: draw,
    setOther: draw,
    setObstacles: draw,
    setPath: draw,
    setTarget: draw,
    setLostDirections: draw,
    setCloud: draw,
    fit() {
      if (!model) return;
      model.updateMatrixWorld(true);
      const ball = new Box3().setFromObject(model).getBoundingSphere(new Sphere());
      const radius = Math.max(ball.radius, 0.1);
      controls.target.copy(ball.center);
      camera.position.copy(ball.center).addScaledVector(new Vector3(0.6, -0.7, 0.4), radius * 4);
      controls.update();
      draw();
    },
    setTheme: draw,
    dispose() {
      observer.disconnect();
      controls.dispose();
      renderer.dispose();
      renderer.domElement.remove();
    },
  };
  return scene;
}

function newRenderer(): WebGLRenderer {
  try {
    return new WebGLRenderer({ antialias: true, alpha: true });
  } catch (error) {
    throw new NoWebGL(String(error));
  }
}
