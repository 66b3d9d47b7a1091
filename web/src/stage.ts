/** The 3D view and what is shown in it; without WebGL the service's picture. */
import * as api from './api';
import { button, h, replace, select } from './dom';
import { isDark } from './header';
import { t } from './i18n';
import { Latest } from './latest';
import { type Model, resolve, sceneRobot, sceneRows, shown, toScene } from './model';
import type { Page } from './page';
import { NoWebGL, type Scene, type SceneEllipsoid } from './scene/types';
import type { State, View } from './state';
import { matrixOf } from './target';

const CLOUD = 20_000;

export async function stageView(page: Page, place: HTMLElement): Promise<void> {
  const { store } = page;
  const host = h('div', { class: 'host', role: 'img', 'aria-label': t.sceneHelp });
  replace(
    place,
    host,
    toolbar(page, () => scene?.fit()),
  );
  let scene: Scene | null = null;
  if (!hasWebGL()) {
    pictureView(page, host);
    return;
  }
  const { createScene } = await import('./scene');
  try {
    scene = createScene(host, {
      onJointChange(index, value) {
        const joint = page.model?.joints[index];
        if (joint)
          store.set(
            { q: store.state.q.with(index, shown(joint, value, store.state.angle)) },
            `q${index}`,
          );
      },
      onTargetDrag(pose, done) {
        store.set({ target: { matrix: pose } }, 'target');
        void import('./solve').then(({ follow }) => follow(page, done));
      },
      onFramePick(frame) {
        const row = /^frame_(\d+)$/.exec(frame ?? '');
        store.set({ row: row && Number(row[1]) > 0 ? Number(row[1]) - 1 : null, step: 4 }, 'row');
      },
      onGhostPick(index) {
        const q = ghosts(page)[index]?.q;
        if (q) store.set({ q }, 'ghost');
      },
    });
  } catch (error) {
    if (!(error instanceof NoWebGL)) throw error;
    pictureView(page, host);
    return;
  }
  drawIn(page, scene);
}

/** Asked first: three.js itself complains on the console. */
function hasWebGL(): boolean {
  return document.createElement('canvas').getContext('webgl2') !== null;
}

/** What stands beside the arm as ghosts: solutions to pick from, and postures kept. */
export const solutions: { q: readonly number[]; label: string }[] = [];
export const playback: { path: api.Matrix | null; wanted: api.Matrix } = { path: null, wanted: [] };

function ghosts(page: Page): { q: readonly number[]; label: string }[] {
  const kept = page.store.state.kept.map((q, k) => ({ q, label: `${t.kept} ${k + 1}` }));
  return [...solutions, ...kept].filter(({ q }) => q.length === page.model?.joints.length);
}

function drawIn(page: Page, scene: Scene): void {
  const { store } = page;
  let model: Model | null = null;
  const clouds = new Latest();
  const others = new Latest();
  let clouded = '';
  let other = '';
  let second: Model | null = null;

  function drawRobot(): void {
    if (!page.model) return;
    model = page.model;
    scene.setRobot(sceneRobot(model));
    draw(store.state);
    numbers();
  }

  function draw(state: State): void {
    if (!model || state.q.length !== model.joints.length) return;
    const q = toScene(model.joints, state.q, state.angle);
    scene.setQ(q);
    scene.setFramesShown(state.view.frames);
    const rows = sceneRows(model, q);
    const convention = model.rows?.convention ?? null;
    scene.setDimensions(convention, state.view.dimensions || state.row !== null ? rows : []);
    scene.setMotionStep(state.row, state.step);
    scene.setTarget(state.target && matrixOf(state.target, state.angle));
    scene.setObstacles(state.path.obstacles);
    scene.setPath(playback.path && { wanted: playback.wanted, reached: playback.path });
    const { joints } = model;
    scene.setGhosts(
      ghosts(page).map((one) => ({
        q: toScene(joints, one.q, state.angle),
        label: one.label,
        chosen: one.q.every((x, k) => Math.abs(x - (state.q[k] ?? 0)) < 1e-9),
      })),
    );
    cloud(state, model);
    compare(state);
  }

  function cloud(state: State, now: Model): void {
    const key = state.view.cloud ? now.key : '';
    if (key === clouded) return;
    clouded = key;
    if (!key) scene.setCloud(null);
    else
      clouds.run((signal) =>
        told(
          async () => scene.setCloud(await cloudOf(now, signal)),
          () => (clouded = ''),
        ),
      );
  }

  function compare(state: State): void {
    const id = state.view.other;
    if (second && other === id)
      scene.setOther(sceneRobot(second), toScene(second.joints, state.q, state.angle));
    if (id === other) return;
    other = id;
    second = null;
    scene.setOther(null, []);
    if (!id) return;
    others.run((signal) =>
      told(
        async () => {
          const found = await resolve(
            { kind: 'stored', id, convention: null },
            state.angle,
            signal,
          );
          if (other !== id) return;
          second = found;
          compare(store.state);
        },
        () => (other = ''),
      ),
    );
  }

  /** @param undone What is to be asked for again. */
  async function told(work: () => Promise<void>, undone: () => void): Promise<void> {
    try {
      await work();
    } catch (error) {
      undone();
      if (error instanceof api.Refusal) page.tell(error.detail, true);
      else if (error instanceof api.Unreachable) page.tell(t.unreachable, true);
      else throw error;
    }
  }

  function numbers(): void {
    scene.setTheme(isDark());
    const { singularity, fk } = page.answers;
    const { view } = store.state;
    const pose = Object.values(fk?.poses ?? {})[0];
    if (!singularity || !pose) return;
    // Of a task that only turns, that of the turning.
    const shape = singularity.ellipsoids.translation ?? singularity.ellipsoids.rotation;
    const kinds = (['velocity', 'force'] as const).filter(
      (one) => shape && (view.ellipsoid === one || view.ellipsoid === 'both'),
    );
    scene.setEllipsoids(
      kinds.map(
        (kind): SceneEllipsoid => ({
          kind,
          center: pose.position,
          axes: shape?.axes ?? [],
          semiAxes: shape?.[`${kind}_semi_axes`] ?? [],
        }),
      ),
    );
    // With fewer joints than rows some directions are never there; an arrow marks what this posture loses.
    scene.setLostDirections(
      !view.lost || !singularity.singular
        ? []
        : singularity.lost_directions.map((one) => {
            const part = (names: readonly string[]): number[] =>
              names.map((name) => one[singularity.rows.indexOf(name)] ?? 0);
            return {
              at: pose.position,
              linear: part(['vx', 'vy', 'vz']),
              angular: part(['wx', 'wy', 'wz']),
            };
          }),
    );
  }

  store.listen(draw);
  page.onModel.push(drawRobot);
  page.onNumbers.push(numbers);
  page.onExtras.push(() => draw(store.state));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', numbers);
  drawRobot();
}

/** Positions of the tip over its workspace, by the service. */
async function cloudOf(model: Model, signal: AbortSignal): Promise<Float32Array> {
  const response = await api.send(api.workspace(model.ref, CLOUD), signal);
  return Float32Array.from(readNpy(await response.arrayBuffer()));
}

/** Numbers of an npy file: little-endian doubles behind a header that says its own length. */
function readNpy(buffer: ArrayBuffer): Float64Array {
  const header = new DataView(buffer);
  const long = header.getUint8(6) > 1;
  const start = long ? 12 + header.getUint32(8, true) : 10 + header.getUint16(8, true);
  return new Float64Array(buffer.slice(start));
}

/** A size that the service draws. */
function pixels(length: number): number {
  return Math.round(Math.min(2000, Math.max(200, length)));
}

function pictureView(page: Page, host: HTMLElement): void {
  const { store } = page;
  const image = h('img', { class: 'picture', alt: t.scene });
  const note = h('p', { class: 'note' }, t.noWebGL);
  const latest = new Latest();
  replace(host, image, note);
  host.parentElement?.querySelector('.toolbar')?.remove();
  host.removeAttribute('role');
  host.removeAttribute('aria-label');
  function draw(): void {
    latest.run(async (signal) => {
      const { model } = page;
      const { q, angle } = store.state;
      if (!model || q.length !== model.joints.length) return;
      try {
        const response = await api.send(
          api.picture(model.ref, q, angle, pixels(host.clientWidth), pixels(host.clientHeight)),
          signal,
        );
        const url = URL.createObjectURL(await response.blob());
        const before = image.src;
        image.src = url;
        image.hidden = false;
        if (before) URL.revokeObjectURL(before);
      } catch (error) {
        if (!(error instanceof api.Refusal || error instanceof api.Unreachable)) throw error;
        image.hidden = true;
      }
    });
  }
  store.listen(draw);
  page.onModel.push(draw);
  draw();
}

function toolbar(page: Page, fit: () => void): HTMLElement {
  const { store } = page;
  const put = (change: Partial<View>): void =>
    store.set({ view: { ...store.state.view, ...change } }, 'view');
  const frames = select(
    t.frames,
    [
      ['all', t.framesAll],
      ['ends', t.framesEnds],
      ['none', t.framesNone],
    ],
    store.state.view.frames,
    (value) => put({ frames: value as View['frames'] }),
  );
  const ellipsoid = select(
    t.ellipsoid,
    [
      ['none', t.ellipsoidNone],
      ['velocity', t.ellipsoidVelocity],
      ['force', t.ellipsoidForce],
      ['both', t.ellipsoidBoth],
    ],
    store.state.view.ellipsoid,
    (value) => put({ ellipsoid: value as View['ellipsoid'] }),
  );
  let filled: number | undefined;
  const other = select(t.compareWith, [['', t.compareWith]], '', (value) => put({ other: value }));
  const fill = (): void =>
    void fillOthers().catch((error: unknown) => {
      if (!(error instanceof api.Refusal || error instanceof api.Unreachable)) throw error;
      page.tell(error instanceof api.Refusal ? error.detail : t.unreachable, true);
    });
  other.addEventListener('focus', fill);
  async function fillOthers(): Promise<void> {
    const dof = page.model?.joints.length;
    if (filled === dof) return;
    const { robots } = await api.json<{ robots: api.RobotLine[] }>(api.listRobots());
    filled = dof;
    const chosen = other.value;
    const fitting = robots
      .filter((one) => one.dof === dof)
      .map((one) => h('option', { value: one.id }, one.title));
    replace(other, h('option', { value: '' }, t.compareWith), ...fitting);
    other.value = chosen;
  }
  const toggle = (name: 'dimensions' | 'lost' | 'cloud', text: string): HTMLButtonElement => {
    const made = button(text, () => put({ [name]: !store.state.view[name] }));
    toggles.push([made, name]);
    return made;
  };
  const toggles: [HTMLButtonElement, 'dimensions' | 'lost' | 'cloud'][] = [];
  const keep = button(t.keepPosture, () =>
    store.set({ kept: [...store.state.kept, store.state.q] }, 'keep'),
  );
  const drop = button(t.dropPostures, () => store.set({ kept: [] }, 'keep'));
  const element = h(
    'div',
    { class: 'toolbar', role: 'toolbar', 'aria-label': t.view },
    button(t.fit, fit),
    frames,
    ellipsoid,
    toggle('dimensions', t.dimensions),
    toggle('lost', t.lostArrow),
    toggle('cloud', t.cloud),
    keep,
    drop,
    other,
  );
  const render = ({ view, kept }: State): void => {
    frames.value = view.frames;
    ellipsoid.value = view.ellipsoid;
    for (const [made, name] of toggles) made.setAttribute('aria-pressed', String(view[name]));
    drop.hidden = !kept.length;
    if (![...other.options].some((one) => one.value === view.other)) {
      other.append(h('option', { value: view.other }, view.other));
      fill();
    }
    other.value = view.other;
  };
  store.listen(render);
  render(store.state);
  return element;
}
