"""What of a target is within reach where the whole is not: q, what it misses, what is given up."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from kinematics.chain import Chain, chain_of
from kinematics.inverse.all_solutions import exact_solutions
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.held_position import Held, held_at
from kinematics.inverse.motion_of_many import ManyPoses
from kinematics.inverse.nearest_orientation import (
    best_orientations,
    nearest_positions,
    samples,
)
from kinematics.inverse.orientations import turn_of
from kinematics.inverse.result import Tolerance
from kinematics.inverse.windings import apart, turned
from kinematics.task import Task, task_from
from robots.robot import FloatArray, Robot

MOST = 8
"""Parts that are told, the best first."""
MOST_JOINTS = 16
FINITE = 3
"""Joints up to which an arm has finitely many q for a position."""
FIRST = 1e4
"""Weight of the direction of the tool's axis against the whole orientation."""
SAME = 1e-4
"""Joint difference, rad or m, up to which two q are one."""
ROUNDING = 1e-9
"""Excess of a limit that is rounding, rad or m."""


class GivenUp(StrEnum):
    """What of a target a q does not reach."""

    POSITION = "position"
    DIRECTION = "direction_of_tool_axis"
    ROTATION = "rotation_about_tool_axis"


@dataclass(frozen=True, eq=False)
class Reachable:
    """A q within the limits that reaches a part of a target, and measures of the rest.

    Attributes:
        q: Shape (dof,), rad and m.
        position_error: m.
        orientation_error: Of the whole orientation, or of the axis where the task has that alone;
            rad.
        direction_error: Of the frame's z axis, rad.
        rotation_error: About the frame's z axis, rad; None where the task leaves it open.
        given_up: What is not reached; nothing where the whole target is.
    """

    q: FloatArray
    position_error: float
    orientation_error: float
    direction_error: float
    rotation_error: float | None
    given_up: tuple[GivenUp, ...]


def reachable_parts(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task,
    seed: FloatArray | None = None,
    tolerance: Tolerance,
) -> tuple[Reachable, ...]:
    """Return what of a pose, or of a position with a direction, is within reach, the best first.

    The q that keep the position exactly and whose orientation is nearest to the target's, each
    nearer than all others around it; with a pose also those that keep the direction of the tool's
    axis too, where that is within reach. Where the position is out of reach, the q that comes
    nearest to it. All within the limits.

    Args:
        robot: The robot.
        target: Pose of the frame in base axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: A start, and the reference for whole turns, shape (dof,); default mid-range.
        tolerance: With which a part counts as reached.

    Returns:
        At most ``MOST``; none where the task has no position, or neither the whole orientation nor
        a direction.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    name = robot.tip_frame if frame is None else frame
    chain = chain_of(robot, name)
    whole = task.rotations == (0, 1, 2) and not task.own_axes
    if not task.positions or not (whole or task.own_axes):
        return ()
    if not 0 < chain.length <= MOST_JOINTS:
        return ()
    bounds = JointBounds.of(robot)
    start = bounds.inside(bounds.middle() if seed is None else seed)
    alone = task_from([int(row in task.positions) for row in range(6)])
    held = held_at(chain, bounds.wraps[chain.columns], target[:3, 3], task.positions)
    low, high = bounds.ranges(held.reach)
    known = [start[chain.columns]]
    if chain.length <= FINITE:
        known += _columns(robot, chain, target, name, alone, seed)
    spread = samples(held, low[chain.columns], high[chain.columns], np.array(known))
    axis = np.outer(target[:3, 2], [0.0, 0.0, 1.0])
    rows = list(best_orientations(held, target[:3, :3] if whole else axis, spread))
    if whole and rows and not _is_turned(chain, target, rows[0], tolerance):
        rows += _along_axis(held, target, spread, tolerance)
    rows = rows or list(nearest_positions(held, spread)[:1])
    found: list[Reachable] = []
    for row in rows:
        one = _measured(robot, chain, target, task, start, row, tolerance)
        if one is not None and all(apart(robot, one.q, other.q) > SAME for other in found):
            found.append(one)
    return tuple(sorted(found, key=lambda one: one.orientation_error)[:MOST])


def _is_turned(chain: Chain, target: FloatArray, row: FloatArray, tolerance: Tolerance) -> bool:
    R = ManyPoses.at(chain, row[None]).rotation[0]
    return turn_of(R.T @ target[:3, :3]) <= tolerance.orientation


def _along_axis(
    held: Held, target: FloatArray, spread: FloatArray, tolerance: Tolerance
) -> list[FloatArray]:
    """Return the q that keep the direction of the tool's axis too, turned as far as they can be.

    The direction counts ``FIRST`` times as much as the rest, then alone, from there.
    """
    axis = np.outer(target[:3, 2], [0.0, 0.0, 1.0])

    def kept(q: FloatArray) -> FloatArray:
        z = ManyPoses.at(held.chain, q).rotation[:, :, 2]
        away = np.linalg.norm(np.cross(z, target[:3, 2]), axis=1)
        return np.asarray(q[(away <= tolerance.orientation) & (z @ target[:3, 2] > 0.0)])

    found = kept(best_orientations(held, axis, spread))
    if not len(found):
        return []
    found = best_orientations(held, target[:3, :3] + FIRST * axis, np.vstack((found, spread)))
    return list(kept(best_orientations(held, axis, found)))


def _columns(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    frame: str,
    task: Task,
    seed: FloatArray | None,
) -> list[FloatArray]:
    """Return the q of the chain, within the limits, of all solutions of a part of the target."""
    found = exact_solutions(robot, target, frame=frame, task=task, seed=seed)
    if found is None:
        return []
    return [one.q[chain.columns] for one in found.solutions if one.within_limits]


def _measured(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    row: FloatArray,
    tolerance: Tolerance,
) -> Reachable | None:
    """Return a q with its errors; None where whole turns do not bring it within the limits."""
    q = start.copy()
    q[chain.columns] = row
    q = turned(robot, q, start, chain)
    inside = np.clip(q, robot.lower, robot.upper)
    if float(np.abs(inside - q).max(initial=0.0)) > ROUNDING:
        return None
    poses = ManyPoses.at(chain, inside[chain.columns][None])
    R, rows = poses.rotation[0], list(task.positions)
    away = float(np.linalg.norm((target[:3, 3] - poses.position[0])[rows]))
    between = R.T @ target[:3, :3]
    direction = float(np.arctan2(np.hypot(between[0, 2], between[1, 2]), between[2, 2]))
    rotation: float | None = None
    if not task.own_axes:
        # The part about z of the rotation that is missed: swing and twist.
        rotation = 2.0 * float(
            np.arctan2(between[1, 0] - between[0, 1], 1.0 + float(np.trace(between)))
        )
    given_up = []
    if away > tolerance.position:
        given_up.append(GivenUp.POSITION)
    if direction > tolerance.orientation:
        given_up.append(GivenUp.DIRECTION)
    if rotation is not None and abs(rotation) > tolerance.orientation:
        given_up.append(GivenUp.ROTATION)
    orientation = direction if rotation is None else turn_of(between)
    return Reachable(inside, away, orientation, direction, rotation, tuple(given_up))
