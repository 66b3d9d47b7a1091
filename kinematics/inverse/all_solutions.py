"""All q that reach a target: in closed form where the arm has one, else by search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Literal

import numpy as np

from kinematics.chain import Chain, chain_of
from kinematics.deadline import checked
from kinematics.inverse.api import solve_ik
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.closed_form import closed_form_of, solutions, swivel_of
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.result import IKOptions, IKStatus, Tolerance
from kinematics.inverse.starts import starts
from kinematics.inverse.task_error import residual, task_chain, workspace
from kinematics.jacobian import jacobian, task_jacobian
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

SEARCH_STARTS = 64
SWIVELS = 16
TIGHT = 1e-9
"""Tolerance of the search, m and rad: solutions are to be told apart."""
SAME = 1e-4
"""Largest joint difference, rad or m, of two answers that count as one."""
TOUCH = 1e-6
"""Largest excess of a limit that may be rounding, rad or m: measured before it counts as met."""
IDENTICAL = 1e-7
"""Largest joint difference of two solutions on a limit that count as one."""
FREE = 1e-9
"""Motion of the task by a joint that counts as none, m/rad or rad/rad."""
DOUBLE = 1e-3
"""Joint difference up to which answers beside a singular one count as it."""


class Choice(StrEnum):
    """Which of several solutions to take."""

    CLOSEST = "closest"
    MOST_MANIPULABLE = "most_manipulable"
    FARTHEST_FROM_LIMITS = "farthest_from_limits"


@dataclass(frozen=True)
class IKSolution:
    """One q that reaches the target, checked by forward kinematics.

    Attributes:
        q: Shape (dof,); the turns of its angles nearest to the seed within the limits.
        posture: Names of the branches, such as front, up, noflip; empty where there are none.
        within_limits: Whether every joint is within its limits; one that touches its limit is on
            it.
        position_error: Measured, m.
        orientation_error: Measured, rad.
        free: Joints that a singular branch leaves free; they have the seed's value.
        swivel: Arm angle of a redundant arm, rad.
    """

    q: FloatArray
    posture: tuple[str, ...]
    within_limits: bool
    position_error: float
    orientation_error: float
    free: tuple[str, ...] = ()
    swivel: float | None = None


@dataclass(frozen=True)
class IKSolutions:
    """What was found.

    Attributes:
        method: ``closed_form``, or ``search``: many starts of the numeric solver.
        complete: True where mathematics says that there are no others (but for whole turns).
        description: What was recognised of the arm, or what was done.
        seed: The q that ``free`` joints and turns refer to; shape (dof,).
        solutions: Closest to the seed first, those within the limits before the others.
    """

    method: Literal["closed_form", "search"]
    complete: bool
    description: str
    seed: FloatArray
    solutions: tuple[IKSolution, ...]


def all_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    options: IKOptions | None = None,
) -> IKSolutions:
    """Find every q that brings a frame to a target.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: Reference for turns, free joints and the order; default mid-range.
        options: For the search.

    Returns:
        The solutions, also those beyond the limits where there is a closed form.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    name = robot.tip_frame if frame is None else frame
    chain, bounds = chain_of(robot, name), JointBounds.of(robot)
    start = bounds.inside(bounds.middle() if seed is None else seed)
    options = options or IKOptions()
    found = _closed_form(robot, chain, target, task, start, options.tolerance)
    if found is None:
        found = _search(robot, chain, target, name, task, start, options)
    ordered = sorted(
        found.solutions,
        key=lambda one: (not one.within_limits, float(np.linalg.norm(one.q - start))),
    )
    return replace(found, solutions=tuple(ordered))


def _closed_form(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
) -> IKSolutions | None:
    if chain.is_coupled and chain.inverse is None:
        return None
    # Where joints are coupled, the closed form is that of their values, which q follows from.
    form = closed_form_of(chain.mechanism)
    if form is None or task.name not in form.tasks:
        return None
    redundant = form.kind == "srs"
    swivels: Iterable[float] = (0.0,)
    given = chain.values(start[chain.columns])
    if redundant:
        own = swivel_of(form, given)
        swivels = own + np.arange(SWIVELS) * (TURN / SWIVELS)
    names = chain.names
    collected: list[IKSolution] = []
    for swivel in swivels:
        angle = float((swivel + np.pi) % TURN - np.pi)
        branch = solutions(form, chain.mechanism, target, task=task, given=given, swivel=angle)
        postures = branch.postures(form)
        for k, values in enumerate(branch.q):
            q = start.copy()
            q[chain.columns] = (
                values if chain.inverse is None else chain.inverse @ (values - chain.offset)
            )
            q = turned(robot, q, start, chain)
            errors = float(branch.position_errors[k]), float(branch.orientation_errors[k])
            on = _on_limits(robot, chain, target, task, q, tolerance)
            if on is not None:
                q, errors = on
            one = IKSolution(
                q=q,
                posture=postures[k],
                within_limits=_within(robot, q),
                position_error=errors[0],
                orientation_error=errors[1],
                free=tuple(n for n, free in zip(names, branch.free[k], strict=True) if free),
                swivel=angle if redundant else None,
            )
            # Two solutions on one limit may be one: an arm that is stretched there.
            if on is None or not any(
                other.swivel == one.swivel and _apart(robot, q, other.q) < IDENTICAL
                for other in collected
            ):
                collected.append(one)
    description = form.description
    if redundant:
        description += f"; a one-parameter family, shown at {SWIVELS} swivel angles"
    return IKSolutions("closed_form", not redundant, description, start, tuple(collected))


def _search(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    frame: str,
    task: Task,
    start: FloatArray,
    options: IKOptions,
) -> IKSolutions:
    bounds = JointBounds.of(robot)
    low, high = bounds.ranges(chain.reach if np.isfinite(chain.reach) else 1.0)
    offset, ratio, lowest, span = starts(
        options.random_seed, low[chain.columns], high[chain.columns]
    )
    tight = Tolerance(
        min(options.tolerance.position, TIGHT), min(options.tolerance.orientation, TIGHT)
    )
    once = replace(options, max_restarts=0, tolerance=tight)
    collected: list[IKSolution] = []
    families = False
    for number in checked(range(SEARCH_STARTS), 1):
        q = start.copy()
        if number:
            q[chain.columns] = lowest + (offset + number * ratio) % 1.0 * span
        result = solve_ik(robot, target, frame=frame, task=task, seed=q, options=once)
        if result.status is not IKStatus.CONVERGED:
            continue
        answer = turned(robot, result.q, start, chain)
        J = task_jacobian(robot, answer, task, frame)[:, chain.columns]
        idle = np.linalg.norm(J, axis=0) <= FREE
        answer[chain.columns[idle]] = start[chain.columns[idle]]
        sigma = np.linalg.svd(J[:, ~idle], compute_uv=False)
        families = families or int(np.count_nonzero(~idle)) > len(task.rows)
        near = DOUBLE if sigma.min(initial=np.inf) <= DOUBLE * sigma.max(initial=0.0) else SAME
        if any(_apart(robot, answer, other.q) < near for other in collected):
            continue
        errors = result.position_error, result.orientation_error
        free = tuple(robot.joints[int(k)].name for k in chain.columns[idle])
        collected.append(IKSolution(answer, (), True, *errors, free))
    description = f"{SEARCH_STARTS} starts of the numeric solver; there may be others"
    if families:
        description += (
            "; the arm has more joints than the task needs: each is one of infinitely many"
        )
    return IKSolutions("search", False, description, start, tuple(collected))


def _on_limits(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    q: FloatArray,
    tolerance: Tolerance,
) -> tuple[FloatArray, tuple[float, float]] | None:
    """Return q with joints that touch their limits put on them, and its measured errors.

    None where none does, another joint is beyond its limits, or q then misses the target.
    """
    inside = np.clip(q, robot.lower, robot.upper)
    if np.array_equal(inside, q) or np.abs(inside - q).max() > TOUCH:
        return None
    position, orientation = task_errors(chain, target, task, inside[chain.columns])
    if position > tolerance.position or orientation > tolerance.orientation:
        return None
    return inside, (position, orientation)


def task_errors(chain: Chain, target: FloatArray, task: Task, q: FloatArray) -> tuple[float, float]:
    """Return the position error, m, and the rotation error, rad, of a chain's q, shape (K,)."""
    pose = np.array(target, dtype=np.float64).reshape(16)
    position, rotation = residual(
        task_chain(chain, task), pose, np.array(q), workspace(chain.length)
    )
    return float(np.sqrt(position)), float(np.sqrt(rotation))


def turned(robot: Robot, q: FloatArray, reference: FloatArray, chain: Chain) -> FloatArray:
    """Turn the angles of a chain by whole turns as near to a reference as the limits allow.

    Args:
        robot: The robot.
        q: Shape (dof,), rad and m.
        reference: Shape (dof,), rad and m.
        chain: Whose joints are turned.
    """
    q = q.copy()
    for column in chain.columns[chain.is_periodic]:
        nearest = q[column] + TURN * np.round((reference[column] - q[column]) / TURN)
        # A limit met to rounding counts as met.
        lower, upper = robot.lower[column] - 1e-12, robot.upper[column] + 1e-12
        candidates = [nearest, nearest - TURN, nearest + TURN]
        fitting = [value for value in candidates if lower <= value <= upper]
        value = min(fitting or [nearest], key=lambda v: abs(v - reference[column]))
        q[column] = min(max(value, robot.lower[column]), robot.upper[column]) if fitting else value
    return q


def choose(robot: Robot, found: IKSolutions, frame: str, choice: Choice) -> IKSolution | None:
    """Return the solution within the limits that a choice prefers, None where there is none.

    ``most_manipulable`` compares ``sqrt(det(J Jᵀ))``, ``farthest_from_limits`` the smallest
    distance to a limit relative to the joint's range.
    """
    within = [one for one in found.solutions if one.within_limits]
    if not within:
        return None
    if choice is Choice.CLOSEST:
        return within[0]
    if choice is Choice.MOST_MANIPULABLE:
        return max(
            within,
            key=lambda one: float(
                np.prod(np.linalg.svd(jacobian(robot, one.q, frame), compute_uv=False))
            ),
        )
    limited = np.isfinite(robot.lower) & np.isfinite(robot.upper) & (robot.upper > robot.lower)
    span = np.where(limited, robot.upper - robot.lower, 1.0)

    def margin(one: IKSolution) -> float:
        gaps = np.minimum(one.q - robot.lower, robot.upper - one.q) / span
        return float(gaps[limited].min()) if limited.any() else 0.0

    return max(within, key=margin)


def _within(robot: Robot, q: FloatArray) -> bool:
    return bool(((q >= robot.lower) & (q <= robot.upper)).all())


def _apart(robot: Robot, q: FloatArray, other: FloatArray) -> float:
    """Return the largest difference of two configurations, angles by the shorter way."""
    difference = q - other
    difference = np.where(robot.is_periodic, (difference + np.pi) % TURN - np.pi, difference)
    return float(np.abs(difference).max())
