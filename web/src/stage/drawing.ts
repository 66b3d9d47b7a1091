/** Draws the state in the scene whenever it changes. */
import { reasonOf } from '../failure';
import { t } from '../i18n';
import { Latest } from '../latest';
import type { Model } from '../model';
import type { Page } from '../page';
import { resolve } from '../resolve';
import type { Scene } from '../scene/types';
import { type Ghost, linkedValues, type State } from '../state';
import { matrixOf } from '../target';
import { toRadians } from '../units';
import { cloudOf } from './cloud';
import { ellipsoidsOf, lostDirectionsOf } from './numbers';
import { sceneRobot, sceneRows } from './robot';

/** The configurations beside the arm's own: solutions to choose from, and those kept. */
export function ghostsOf({ kept, solutions, model }: State): Ghost[] {
  const named = kept.map((q, k) => ({ q, label: `${t.kept} ${k + 1}` }));
  return [...solutions, ...named].filter(({ q }) => q.length === model?.joints.length);
}

/** Draw now, and after each change of the state. */
export function drawScene({ store, tell }: Page, scene: Scene): void {
  let shown: Model | null = null;
  const drawCloud = cloudDrawing();
  const drawOther = otherDrawing();

  function draw(): void {
    const { state } = store;
    const { model, q } = state;
    if (!model) return;
    const isNew = model !== shown;
    shown = model;
    if (isNew) scene.setRobot(sceneRobot(model));
    if (q.length === model.joints.length) {
      drawConfiguration(scene, model, state);
      drawCloud(state.view.cloud ? model : null);
      drawOther(state);
    }
    if (isNew) drawAnswers();
  }

  function drawAnswers(): void {
    const { state } = store;
    const { pose, singularity } = state.answers;
    scene.setTheme(state.dark);
    if (!pose || !singularity) return;
    scene.setEllipsoids(ellipsoidsOf(state));
    scene.setLostDirections(lostDirectionsOf(state));
  }

  /** Run a request for the scene; where it fails, the next drawing asks again. */
  async function request(work: () => Promise<void>, askAgain: () => void): Promise<void> {
    try {
      await work();
    } catch (error) {
      askAgain();
      tell(reasonOf(error), true);
    }
  }

  function cloudDrawing(): (model: Model | null) => void {
    const latest = new Latest();
    let drawn = '';
    return (model) => {
      const key = model?.key ?? '';
      if (key === drawn) return;
      drawn = key;
      if (!model) {
        scene.setCloud(null);
        return;
      }
      const work = async (signal: AbortSignal): Promise<void> => {
        const points = await cloudOf(model, signal);
        if (drawn === key) scene.setCloud(points);
      };
      latest.run((signal) =>
        request(
          () => work(signal),
          () => {
            drawn = '';
          },
        ),
      );
    };
  }

  /** The second robot; it is loaded when another is chosen. */
  function otherDrawing(): (state: State) => void {
    const latest = new Latest();
    let id = '';
    let model: Model | null = null;

    function drawOther({ view, q, angle }: State): void {
      if (view.other === id) {
        if (model) scene.setOther(sceneRobot(model), toRadians(model.joints, q, angle));
        return;
      }
      id = view.other;
      model = null;
      scene.setOther(null, []);
      if (id) load(id, angle);
    }

    function load(wanted: string, angle: State['angle']): void {
      const source = { kind: 'stored', id: wanted, convention: null } as const;
      const work = async (signal: AbortSignal): Promise<void> => {
        const found = await resolve(source, angle, signal);
        if (id !== wanted) return;
        model = found;
        drawOther(store.state);
      };
      latest.run((signal) =>
        request(
          () => work(signal),
          () => {
            id = '';
          },
        ),
      );
    }

    return drawOther;
  }

  store.subscribe((s) => [s.model, s.solutions, s.followed, ...linkedValues(s)], draw);
  store.subscribe(({ answers, dark }) => [answers, dark], drawAnswers);
  draw();
}

function drawConfiguration(scene: Scene, model: Model, state: State): void {
  const { angle, view, row } = state;
  const q = toRadians(model.joints, state.q, angle);
  scene.setQ(q);
  scene.setFramesShown(view.frames);
  const hasDimensions = view.dimensions || row !== null;
  scene.setDimensions(model.rows?.convention ?? null, hasDimensions ? sceneRows(model, q) : []);
  scene.setMotionStep(row, state.step);
  scene.setTarget(state.target && matrixOf(state.target, angle));
  scene.setObstacles(state.path.obstacles);
  scene.setPath(state.followed);
  const ghosts = ghostsOf(state).map((one) => ({
    q: toRadians(model.joints, one.q, angle),
    label: one.label,
    chosen: one.q.every((x, k) => Math.abs(x - (state.q[k] ?? 0)) < 1e-9),
  }));
  scene.setGhosts(ghosts);
}
