/** The grid on the ground. */
import { Color, GridHelper, type Group } from 'three';
import { clear } from './space';

/** Draw squares of a round size, 1 m or a tenth of it and so on, around the base. */
export function drawGround(group: Group, extent: number, dark: boolean): void {
  clear(group);
  const cell = 10 ** Math.floor(Math.log10(extent / 2));
  const count = 2 * Math.ceil((1.4 * extent) / cell);
  const [major, minor] = dark ? [0x59636f, 0x2b323b] : [0xa4adb8, 0xe1e5ea];
  const grid = new GridHelper(count * cell, count, new Color(major), new Color(minor));
  grid.rotation.x = Math.PI / 2;
  // A little below z = 0, where flat robots lie.
  grid.position.z = -1e-4 * extent;
  group.add(grid);
}
