/** Robots to begin with, and the state of a page that changes to another robot. */
import { type Linked, START } from './state';

/** Arms that a course begins with; configurations in degrees and m. */
export const EXAMPLES: readonly {
  readonly id: string;
  readonly name: string;
  readonly q: readonly number[];
  readonly task: string;
  /** Index of the prismatic joint, if there is one. */
  readonly prismatic?: number;
}[] = [
  { id: 'planar_2r', name: '2R', q: [30, 60], task: 'xy' },
  { id: 'scara', name: 'SCARA', q: [20, 40, 0.08, 0], task: 'xyz_phi', prismatic: 2 },
  { id: 'puma560', name: 'PUMA 560', q: [0, 45, -90, 0, 45, 0], task: 'pose' },
  { id: 'ur5', name: 'UR5', q: [0, -60, 90, -120, -90, 0], task: 'pose' },
  { id: 'pa10', name: 'PA10', q: [0, 30, 0, 60, 0, 60, 0], task: 'pose' },
  { id: 'panda', name: 'Panda', q: [0, -30, 0, -120, 0, 100, 45], task: 'pose' },
];

/** What belongs to the robot before; a page that changes to another starts without it. */
export const NEW_ROBOT = {
  q: [],
  task: START.task,
  row: null,
  target: null,
  kept: [],
  path: START.path,
} as const satisfies Partial<Linked>;

/** The change to a stored robot: an example's own configuration, or none yet. */
export function storedRobot(id: string, angle: Linked['angle']): Partial<Linked> {
  const example = EXAMPLES.find((one) => one.id === id);
  const factor = angle === 'deg' ? 1 : Math.PI / 180;
  return {
    ...NEW_ROBOT,
    source: { kind: 'stored', id, convention: null },
    ...(example && {
      q: example.q.map((x, k) => (k === example.prismatic ? x : x * factor)),
      task: example.task,
    }),
  };
}
