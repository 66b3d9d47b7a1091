import * as api from './api';
import { h } from './dom';
import { preferred, speak, t } from './i18n';
import type { Scene } from './scene/types';

await speak(preferred());

const host = h('div', { id: 'scene', role: 'img', 'aria-label': t.scene });
const picker = h('select', { id: 'robot' });
const sliders = h('div');
const pose = h('pre', { id: 'pose' });
document.body.append(
  h('header', {}, h('label', {}, `${t.robot} `, picker)),
  h('div', { id: 'panel' }, h('h2', {}, t.joints), sliders, h('h2', {}, t.pose), pose),
  host,
);

let scene: Scene | null = null;
let robot: api.RobotView;
let q: number[] = [];

async function show(id: string): Promise<void> {
  const [view, urdf] = await Promise.all([
    api.json<api.RobotView>(api.readRobot(id)),
    api.text(api.readURDF(id)),
  ]);
  robot = view;
  q = view.joints.map(() => 0);
  scene?.setRobot({
    key: view.revision,
    urdf,
    joints: view.joints,
    baseFrame: view.base_frame,
    tipFrame: view.tip_frame,
    convention: view.convention,
    id,
  });
  sliders.replaceChildren(
    ...view.joints.map((joint, k) => {
      const input = h('input', {
        type: 'range', min: joint.lower ?? -Math.PI, max: joint.upper ?? Math.PI, step: 'any', value: 0,
        'aria-label': joint.name,
        oninput: () => { q[k] = input.valueAsNumber; void moved(); },
      });
      return h('label', {}, joint.name, input);
    }),
  );
  await moved();
}

async function moved(): Promise<void> {
  scene?.setQ(q);
  const answer = await api.json<api.FKAnswer>(api.fk({ id: robot.id }, q, 'ZXZ', 'rad'));
  const found = answer.poses[robot.tip_frame];
  pose.textContent = found?.matrix.map((row) => row.map((x) => x.toFixed(4).padStart(9)).join(' ')).join('\n') ?? '';
}

const { robots } = await api.json<{ robots: api.RobotLine[] }>(api.listRobots());
picker.append(...robots.map((one) => h('option', { value: one.id }, one.title)));
picker.value = 'puma560';
picker.addEventListener('change', () => void show(picker.value));
const { createScene } = await import('./scene');
scene = createScene(host, {
  onJointChange: () => {}, onTargetDrag: () => {}, onFramePick: () => {}, onGhostPick: () => {},
});
await show('puma560');
