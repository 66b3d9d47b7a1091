/** The robot in other configurations, see-through, with labels. */
import { type Group, Vector3 } from 'three';
import { COLORS, label } from './parts';
import { RobotModel } from './robot';
import { clear } from './space';
import type { SceneGhost, SceneRobot } from './types';

const CHOSEN = 0x2b7fd0;
const OPACITY = { chosen: 0.12, other: 0.28 };
const INK = 0x566070;

export class Ghosts {
  models: readonly RobotModel[] = [];
  private key = '';

  /** @param changed Called when the view is to be drawn anew. */
  constructor(
    private readonly group: Group,
    private readonly changed: () => void,
  ) {}

  /**
   * Show ghosts of a robot.
   *
   * @returns Whether there are more than before.
   */
  show(robot: SceneRobot, ghosts: readonly SceneGhost[], dark: boolean): boolean {
    const key = JSON.stringify([robot.key, ghosts]);
    if (key === this.key) return false;
    const before = this.models.length;
    this.clear();
    this.key = key;
    this.models = ghosts.map(({ q, label: text, chosen }) => {
      // Without an id no meshes are loaded.
      const model = new RobotModel({ ...robot, id: null }, this.changed);
      model.setQ(q);
      model.tint(chosen ? CHOSEN : COLORS.ghost, chosen ? OPACITY.chosen : OPACITY.other);
      this.group.add(model.object);
      if (!chosen && model.poseOf(robot.tipFrame)) {
        this.group.add(label(text, middleOf(model), INK, dark));
      }
      return model;
    });
    return this.models.length > before;
  }

  clear(): void {
    for (const one of this.models) one.dispose();
    clear(this.group);
    this.models = [];
    this.key = '';
  }
}

/** The joint in the middle of the arm, where configurations with one tip differ most. */
function middleOf(model: RobotModel): Vector3 {
  const { joints } = model.robot;
  const joint = model.urdf.joints[joints[Math.floor(joints.length / 2)]?.name ?? ''];
  return joint?.getWorldPosition(new Vector3()) ?? new Vector3();
}
