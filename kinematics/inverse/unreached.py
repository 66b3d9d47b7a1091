"""Why a target is not reached: what can be proved of it, in words."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dh_to_urdf.messages import chained, say
from kinematics.chain import Chain, chain_of
from kinematics.inverse.all_solutions import exact_solutions
from kinematics.inverse.api import solve_ik
from kinematics.inverse.closed_form.geometry import axis_lines
from kinematics.inverse.forbidden import Forbidden, Forbids, branches_beyond, least_misses
from kinematics.inverse.orientations import orientation_gap
from kinematics.inverse.reachable import GivenUp, Reachable, reachable_parts
from kinematics.inverse.result import IKOptions, IKStatus
from kinematics.inverse.solutions import IKSolutions
from kinematics.task import Task, task_from
from robots.robot import FloatArray, Robot

POSITION_SECONDS = 0.05
"""Time for the search of the position alone."""
PARTS_BUDGET = 0.5
"""Time budget of a target, s, from which on it is looked for what of it is within reach: that takes
some tenths of a second."""
NAMED = 3
"""Joints beyond their limits that a sentence names."""


@dataclass(frozen=True)
class Reasons:
    """What is known about a target that was not reached.

    Attributes:
        sentences: Each proved, or measured.
        proven: Whether they prove, whatever the limits, that no q comes within the tolerance.
        forbidden: What forbids the target; None where it is within reach.
        reachable: What of it is within reach, the best first.
    """

    sentences: tuple[str, ...]
    proven: bool
    forbidden: Forbidden | None = None
    reachable: tuple[Reachable, ...] = ()


def why_unreached(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task,
    seed: FloatArray | None = None,
    options: IKOptions,
    found: IKSolutions | None = None,
) -> Reasons:
    """Return what can be said about a target that was not reached, and what of it is reached.

    Args:
        robot: The robot.
        target: Pose of the frame in base axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: Reference for the solution nearest to it, shape (dof,), rad and m.
        options: Tolerance, and time for the position alone.
        found: All solutions, where they are known already.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    why = _reasons(robot, target, frame=frame, task=task, seed=seed, options=options, found=found)
    if options.time_budget < PARTS_BUDGET:
        return why
    parts = reachable_parts(
        robot, target, frame=frame, task=task, seed=seed, tolerance=options.tolerance
    )
    if not parts:
        return why
    forbidden = why.forbidden
    if forbidden is not None:
        forbidden = _agreed(forbidden, parts, is_bound=why.proven)
    least = _least(parts[0], None if why.proven else forbidden)
    return Reasons((*why.sentences, *least), why.proven, forbidden, parts)


def _agreed(forbidden: Forbidden, parts: tuple[Reachable, ...], is_bound: bool) -> Forbidden | None:
    """Return what forbids a target, by no more than the parts miss that are reached.

    Bounds that are proved are below these but for rounding; what a search found need not be.
    """
    best, position, orientation = parts[0], forbidden.position_miss, forbidden.orientation_miss
    if is_bound:
        if position is not None:
            position = min(position, *(one.position_error for one in parts))
        if orientation is not None:
            orientation = min(orientation, *(one.orientation_error for one in parts))
    elif not best.given_up:
        return None
    elif GivenUp.POSITION in best.given_up:
        if forbidden.by is Forbids.POSITION and position is not None:
            position = min(position, best.position_error)
    elif forbidden.by is Forbids.POSITION:
        return Forbidden(Forbids.ORIENTATION, False, orientation_miss=best.orientation_error)
    elif orientation is not None:
        orientation = min(orientation, best.orientation_error)
    return replace(forbidden, position_miss=position, orientation_miss=orientation)


def _least(best: Reachable, searched: Forbidden | None) -> tuple[str, ...]:
    """Say how near a search came to the orientation at the position."""
    if GivenUp.POSITION in best.given_up or not best.given_up:
        return ()
    least = best.orientation_error
    if searched is not None and searched.orientation_miss is not None:
        least = min(least, searched.orientation_miss)
    return (
        say(
            "within the limits, the least by which the orientation was found to be missed at the"
            " position is {least:.6g}°",
            least=np.rad2deg(least),
        ),
    )


def _reasons(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None,
    task: Task,
    seed: FloatArray | None,
    options: IKOptions,
    found: IKSolutions | None,
) -> Reasons:
    name = robot.tip_frame if frame is None else frame
    chain = chain_of(robot, name)
    if chain.length == 0:
        return Reasons((), False)
    far = _too_far(chain, target, task, options.tolerance.position)
    if far is not None:
        away, sentence = far
        return Reasons((sentence,), True, Forbidden(Forbids.POSITION, True, position_miss=away))
    tilted = _wrong_orientation(chain, target, task, options.tolerance.orientation)
    if tilted is not None:
        gap, sentence = tilted
        alone = _position_alone(robot, target, name, task, seed, options)
        by = Forbidden(Forbids.ORIENTATION, True, orientation_miss=gap)
        return Reasons((sentence, *alone), True, by)
    if found is None:
        found = exact_solutions(
            robot, target, frame=frame, task=task, seed=seed, tolerance=options.tolerance
        )
    proved = found is not None and _is_proof(found)
    if found is None or not (proved or found.solutions):
        alone = _position_alone(robot, target, name, task, seed, options)
        return Reasons(alone, False, _missed(robot, target, name, task, seed, options, False))
    if any(one.within_limits for one in found.solutions):
        return Reasons((), False)
    if found.solutions:
        by = Forbidden(Forbids.LIMITS, proved, branches=branches_beyond(robot, found))
        if not proved:
            alone = _position_alone(robot, target, name, task, seed, options)
            return Reasons((_beyond(robot, found, all_known=False), *alone), False, by)
        return Reasons((_beyond(robot, found),), False, by)
    none = say(
        "no joint values reach the target to 1e-9 m and rad, whatever their limits ({description})",
        description=found.description,
    )
    alone = _position_alone(robot, target, name, task, seed, options)
    return Reasons((none, *alone), False, _missed(robot, target, name, task, seed, options, True))


def _is_proof(found: IKSolutions) -> bool:
    """Return whether there are no other solutions within the limits."""
    motion = found.self_motion
    return found.complete or (motion is not None and motion.complete and not motion.curves)


def _missed(
    robot: Robot,
    target: FloatArray,
    frame: str,
    task: Task,
    seed: FloatArray | None,
    options: IKOptions,
    proven: bool,
) -> Forbidden | None:
    """Return whether position or orientation forbids a target, by the least misses found.

    None where the search comes upon a q that reaches the target.
    """
    alone = _positions(task) if task.positions else task
    options = options.within(POSITION_SECONDS)
    best = solve_ik(robot, target, frame=frame, task=alone, seed=seed, options=options)
    tolerance = options.tolerance
    position, orientation = least_misses(robot, target, frame, task, seed, tolerance, (best.q,))
    if orientation is not None and orientation <= tolerance.orientation:
        return None
    if orientation is not None:
        return Forbidden(Forbids.ORIENTATION, proven, position, orientation)
    if not task.positions:
        return Forbidden(Forbids.ORIENTATION, proven)
    return Forbidden(Forbids.POSITION, proven and not task.rotations, best.position_error)


def _positions(task: Task) -> Task:
    return task_from([int(row in task.positions) for row in range(6)])


def beyond_limits(robot: Robot, q: FloatArray) -> tuple[str, ...]:
    """Return the names of the joints of q, shape (dof,), that are beyond their limits."""
    outside = (q < robot.lower) | (q > robot.upper)
    return tuple(robot.joints[k].name for k in np.flatnonzero(outside))


def _too_far(
    chain: Chain, target: FloatArray, task: Task, tolerance: float
) -> tuple[float, str] | None:
    rows = list(task.positions)
    away = float(np.linalg.norm((target[:3, 3] - chain.placements[0, [3, 7, 11]])[rows]))
    if not rows or away <= chain.reach * (1.0 + 1e-9) + tolerance:
        return None
    return away - chain.reach, say(
        "the target is {away:.6g} m from joint 1, and the arm, stretched with"
        " all its slides out, is at most {reach:.6g} m long",
        away=away,
        reach=chain.reach,
    )


def _wrong_orientation(
    chain: Chain, target: FloatArray, task: Task, tolerance: float
) -> tuple[float, str] | None:
    if task.rotations != (0, 1, 2) and not task.own_axes:
        return None
    lines = axis_lines(chain)
    axes = lines.directions[lines.is_revolute]
    R = lines.pose[:3, :3]
    if task.own_axes:
        gap, free = orientation_gap(axes, R[:, 2], target[:3, 2])
        what = say("the frame's z axis to this direction")
    else:
        gap, free = orientation_gap(axes, None, target[:3, :3] @ R.T)
        what = say("the frame to this orientation")
    if gap <= tolerance + 1e-6:
        return None
    least = say("by {gap:.6g}° at least", gap=np.rad2deg(gap))
    if free == 0:
        return gap, say(
            "this structure cannot turn the frame; the target's orientation is missed {least}",
            least=least,
        )
    if free == 1:
        axis = ", ".join(f"{x + 0.0:.6g}" for x in np.where(np.abs(axes[0]) < 1e-12, 0.0, axes[0]))
        return gap, say(
            "this structure cannot bring {what}: it turns the frame about ({axis})"
            " only, and misses it {least}",
            what=what,
            axis=axis,
            least=least,
        )
    return gap, say(
        "the turning axes of this structure cannot bring {what}: they miss it {least}",
        what=what,
        least=least,
    )


def _position_alone(
    robot: Robot,
    target: FloatArray,
    frame: str,
    task: Task,
    seed: FloatArray | None,
    options: IKOptions,
) -> tuple[str, ...]:
    """Say whether the position alone is within reach, where the task has an orientation too."""
    if not task.positions or not task.rotations:
        return ()
    alone = _positions(task)
    found = solve_ik(
        robot, target, frame=frame, task=alone, seed=seed, options=options.within(POSITION_SECONDS)
    )
    if found.status is IKStatus.CONVERGED:
        return (say("the position alone is within reach (task {alone})", alone=alone.name),)
    if found.status is IKStatus.UNREACHABLE:
        return (say("the position alone is out of reach too"),)
    return (say("a search did not find the position alone either, which proves nothing"),)


def _beyond(robot: Robot, found: IKSolutions, all_known: bool = True) -> str:
    nearest = min(found.solutions, key=lambda one: _excess(robot, one.q))
    parts = []
    for k in np.flatnonzero((nearest.q < robot.lower) | (nearest.q > robot.upper))[:NAMED]:
        value = float(nearest.q[k])
        limit = float(robot.lower[k] if value < robot.lower[k] else robot.upper[k])
        shown, bound = (_value(x, bool(robot.is_revolute[k])) for x in (value, limit))
        parts.append(
            say(
                "{joint} at {shown}, its limit is {bound}",
                joint=robot.joints[k].name,
                shown=shown,
                bound=bound,
            )
        )
    count = len(found.solutions)
    are = (
        say("the one solution is") if count == 1 else say("all {count} solutions are", count=count)
    )
    if not all_known:
        are = say("of those that were found {are}", are=are)
    return say(
        "{are} beyond the limits; the nearest to them has {parts}",
        are=are,
        parts=chained("; ", parts),
    )


def _excess(robot: Robot, q: FloatArray) -> float:
    return float(np.maximum(np.maximum(robot.lower - q, q - robot.upper), 0.0).max())


def _value(value: float, is_revolute: bool) -> str:
    if not is_revolute:
        return f"{value + 0.0:.9g} m"
    return say(
        "{value:.9g} rad ({value_2:.7g}°)", value=value + 0.0, value_2=np.rad2deg(value) + 0.0
    )
