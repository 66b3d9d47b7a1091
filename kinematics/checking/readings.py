"""What may be computed of a motion instead of what was asked: one list for each quantity."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np

from dh_to_urdf.messages import say
from kinematics.checking.search import Reading
from kinematics.checking.situation import Motion, Structure
from kinematics.checking.slips import DEGREE, Slip
from kinematics.jacobian import ReferenceFrame
from robots.robot import FloatArray

Change = Callable[[FloatArray], FloatArray]
Values = Callable[[Motion], FloatArray]
Project = Callable[[FloatArray, Motion], FloatArray]


def transposed(T: FloatArray) -> FloatArray:
    """Return the transposed matrices."""
    return np.swapaxes(T, -1, -2)


def rotation_transposed(T: FloatArray) -> FloatArray:
    """Return poses with their rotations transposed."""
    changed = T.copy()
    changed[..., :3, :3] = np.swapaxes(T[..., :3, :3], -1, -2)
    return changed


def inverted(T: FloatArray) -> FloatArray:
    """Return the inverse poses."""
    changed = rotation_transposed(T)
    changed[..., :3, 3] = -(changed[..., :3, :3] @ T[..., :3, 3, None])[..., 0]
    return changed


def lengths_scaled(factor: float) -> Change:
    """Return the change of the unit of positions."""

    def scaled(T: FloatArray) -> FloatArray:
        changed = T.copy()
        changed[..., :3, 3] *= factor
        return changed

    return scaled


POSE_CHANGES: tuple[tuple[Slip, Change], ...] = (
    (Slip("transposed", detail="rotation", cost=1.1), rotation_transposed),
    (Slip("transposed", detail="matrix", cost=1.2), transposed),
    (Slip("inverted", cost=1.1), inverted),
    (Slip("mm_for_m", cost=1.0), lengths_scaled(1000.0)),
    (Slip("cm_for_m", cost=1.6), lengths_scaled(100.0)),
)


def pose_readings(values: Values, project: Change) -> list[Reading]:
    """Return a pose, and what it is after one change or two.

    Args:
        values: Gives poses, shape (…, 4, 4).
        project: Gives what was asked of a pose.
    """
    found = [Reading((), lambda motion: project(values(motion)))]
    found += [
        Reading((slip,), lambda motion, change=change: project(change(values(motion))))  # type: ignore[misc]
        for slip, change in POSE_CHANGES
    ]
    for (one, first), (two, second) in combinations(POSE_CHANGES, 2):
        if one.code != two.code:
            found.append(_twice((one, two), values, first, second, project))
    return found


def _twice(
    slips: tuple[Slip, Slip], values: Values, first: Change, second: Change, project: Change
) -> Reading:
    return Reading(slips, lambda motion: project(second(first(values(motion)))))


def _axes(reference: ReferenceFrame) -> str:
    return "frame" if reference is ReferenceFrame.LOCAL else "base"


def jacobian_values(
    reference: ReferenceFrame, point: int | None = None, *, neighbours: bool = False
) -> Values:
    """Return the function that gives geometric Jacobians, shape (N, P, 6, dof).

    Args:
        reference: Point and axes.
        point: Number of the frame whose origin is the point instead, counted along the chain; 0
            is that of the base, None what the reference says.
        neighbours: See :meth:`Motion.jacobian`.
    """

    def values(motion: Motion) -> FloatArray:
        place = None
        if point is not None or reference is ReferenceFrame.WORLD:
            place = np.zeros_like(motion.pose[..., :3, 3])
            if point:
                place = motion.after[..., point - 1, :3, 3]
        J = motion.jacobian(place, neighbours=neighbours)
        if reference is ReferenceFrame.LOCAL:
            Rt = np.swapaxes(motion.pose[..., :3, :3], -1, -2)
            J = np.concatenate((Rt @ J[..., :3, :], Rt @ J[..., 3:, :]), axis=-2)
        return J

    return values


def angular_first(J: FloatArray) -> FloatArray:
    """Return Jacobians with the angular rows above the linear ones."""
    return np.concatenate((J[..., 3:, :], J[..., :3, :]), axis=-2)


def jacobian_readings(
    structure: Structure, reference: ReferenceFrame, project: Project, *, square: bool = False
) -> list[Reading]:
    """Return the Jacobian, and what else may be taken for it.

    Args:
        structure: The chain.
        reference: Point and axes that were asked.
        project: Gives what was asked of the 6-row Jacobian of a motion.
        square: Whether what was asked may be transposed without a sign of it.
    """
    bases: list[tuple[tuple[Slip, ...], Values]] = [((), jacobian_values(reference))]
    for other in ReferenceFrame:
        if other is not reference:
            at = "base" if other is ReferenceFrame.WORLD else "frame"
            at_asked = "base" if reference is ReferenceFrame.WORLD else "frame"
            slips: tuple[Slip, ...] = ()
            if at != at_asked:
                slips += (Slip("other_point", detail="base", cost=1.1),)
            if _axes(other) != _axes(reference):
                slips += (Slip("other_frame", detail=_axes(other), cost=1.1),)
            if len(slips) == 2:
                slips = (Slip("other_frame", detail=f"{other.value}", cost=1.2),)
            bases.append((slips, jacobian_values(other)))
    for number in range(1, structure.count + 1):
        slip = Slip(
            "other_point", say("frame {number}", number=structure.numbers[number - 1]), cost=1.2
        )
        bases.append(((slip,), jacobian_values(reference, number)))
    slip = Slip("axes_of_neighbour_frame", cost=1.1)
    bases.append(((slip,), jacobian_values(reference, neighbours=True)))
    turning = structure.turning

    def per_degree(J: FloatArray) -> FloatArray:
        return np.where(turning, J * DEGREE, J)

    def in_millimetres(J: FloatArray) -> FloatArray:
        return np.concatenate((1000.0 * J[..., :3, :], J[..., 3:, :]), axis=-2)

    changes: list[tuple[Slip, Change]] = [
        (Slip("rows_swapped", cost=1.0), angular_first),
        (Slip("degrees_for_radians", detail="columns", cost=1.3), per_degree),
        (Slip("mm_for_m", cost=1.3), in_millimetres),
    ]
    for k, name in enumerate(structure.joints):
        column = np.where(np.arange(len(structure.joints)) == k, -1.0, 1.0)
        slip = Slip("joint_sign", name, "column", 1.2)
        changes.append((slip, lambda J, column=column: J * column))  # type: ignore[misc]
    found = [
        Reading(slips, lambda motion, values=values: project(values(motion), motion))  # type: ignore[misc]
        for slips, values in bases
    ]
    if square:
        slip = Slip("transposed", detail="matrix", cost=1.1)
        right = found[0]
        found.append(Reading((slip,), lambda motion: transposed(right.values(motion))))
    for own, values in bases:
        for slip, change in changes:
            if len(own) < 2:
                found.append(_changed((*own, slip), values, change, project))
    return found


def _changed(slips: tuple[Slip, ...], values: Values, change: Change, project: Project) -> Reading:
    return Reading(slips, lambda motion: project(change(values(motion)), motion))


def step_readings(readings: Sequence[Reading], step: Change, transpose: Change) -> list[Reading]:
    """Return readings of a Jacobian, turned into steps; one with Jᵀ in the place of J†."""
    found = [
        Reading(one.slips, lambda motion, one=one: step(one.values(motion)))  # type: ignore[misc]
        for one in readings
    ]
    right = readings[0]
    slip = Slip("transpose_for_inverse", cost=1.1)
    return [*found, Reading((slip,), lambda motion: transpose(right.values(motion)))]
