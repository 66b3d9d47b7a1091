/** What the scene draws of the service's answers on singularity. */
import type { LostDirection, SceneEllipsoid } from '../scene/types';
import { type State, tipPose } from '../state';

/** The ellipsoids that are chosen, of translation where the task has one, else of rotation. */
export function ellipsoidsOf(state: State): SceneEllipsoid[] {
  const { translation = null, rotation = null } = state.answers.singularity?.ellipsoids ?? {};
  const shape = translation ?? rotation;
  const pose = tipPose(state);
  if (!shape || !pose) return [];
  const { ellipsoid } = state.view;
  return (['velocity', 'force'] as const)
    .filter((kind) => ellipsoid === kind || ellipsoid === 'both')
    .map((kind) => ({
      kind,
      center: pose.position,
      axes: shape.axes,
      semiAxes: shape[`${kind}_semi_axes`],
    }));
}

/**
 * The directions that the arm has lost in a singular configuration, at the tip.
 *
 * An arm with fewer joints than the task has rows lacks some directions always: those are not lost.
 */
export function lostDirectionsOf(state: State): LostDirection[] {
  const { singularity } = state.answers;
  const pose = tipPose(state);
  if (!singularity?.singular || !pose || !state.view.lost) return [];
  return singularity.lost_directions.map((direction) => {
    const part = (names: readonly string[]): number[] =>
      names.map((name) => direction[singularity.rows.indexOf(name)] ?? 0);
    return {
      at: pose.position,
      linear: part(['vx', 'vy', 'vz']),
      angular: part(['wx', 'wy', 'wz']),
    };
  });
}
