/** The frames of a robot: axes that move with its links, with their names. */
import { Group, type Object3D, Vector3 } from 'three';
import { AXES, axes, label, numberOf, type Scale } from './parts';
import type { RobotModel } from './robot';
import { clear } from './space';
import type { FramesShown } from './types';

/** Most frames that are drawn. */
const MOST = 40;

export class Frames {
  private readonly made: Object3D[] = [];

  /** Draw the axes anew. */
  show(
    model: RobotModel,
    shown: FramesShown | readonly string[],
    scale: Scale,
    dark: boolean,
  ): void {
    for (const one of this.made) {
      one.removeFromParent();
      clear(one);
    }
    this.made.length = 0;
    const { baseFrame, tipFrame } = model.robot;
    for (const name of named(model, shown)) {
      const frame = model.frame(name);
      if (!frame) continue;
      const group = new Group();
      group.add(axes(scale.axis));
      const number = numberOf(name);
      const beyond = 1.18 * scale.axis;
      if (number !== null) {
        group.add(label(`x${number}`, new Vector3(beyond, 0, 0), AXES[0], dark));
        group.add(label(`z${number}`, new Vector3(0, 0, beyond), AXES[2], dark));
      } else if (name === baseFrame || name === tipFrame) {
        group.add(label(name, new Vector3(0, 0, beyond), dark ? 0xdfe4ea : 0x1c2430, dark));
      }
      frame.add(group);
      this.made.push(group);
    }
  }
}

function named(model: RobotModel, shown: FramesShown | readonly string[]): readonly string[] {
  const { baseFrame, tipFrame, convention } = model.robot;
  if (typeof shown !== 'string') return shown;
  if (shown === 'none') return [];
  if (shown === 'ends') return [baseFrame, tipFrame];
  const all = model.frames.filter((name) => !convention || name !== baseFrame);
  return all.slice(0, MOST);
}
