"""All solutions in closed form, or of polynomial equations, in the robot's q."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.chain import Chain
from kinematics.inverse.closed_form import closed_form_of, solutions, swivel_of
from kinematics.inverse.continuation.real import (
    RealSolutions,
    chain_elimination,
    square_solutions,
)
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.elimination.finishing import TOUCHES, WITHIN
from kinematics.inverse.elimination.roots import ROOTS
from kinematics.inverse.result import Tolerance
from kinematics.inverse.self_motion.families import Family, Representative, swivel_family
from kinematics.inverse.single_angle import as_orientation
from kinematics.inverse.solutions import IKSolution, IKSolutions
from kinematics.inverse.task_error import TaskChain, task_chain
from kinematics.inverse.windings import (
    TOUCH,
    apart,
    on_limits,
    task_errors,
    turned,
    within_limits,
)
from kinematics.task import Task
from robots.robot import FloatArray, Robot

SWIVELS = 16
FREE_VALUES = 73
"""Values of a joint that a singular target leaves free, among which one within limits is sought."""
IDENTICAL = 1e-7
"""Largest joint difference of two solutions on a limit that count as one."""


def shown(
    robot: Robot, chain: Chain, target: FloatArray, task: Task, one: Representative
) -> IKSolution:
    """Return a solution that stands for a set of them, measured."""
    errors = task_errors(chain, target, task, one.q[chain.columns])
    return IKSolution(
        one.q, one.posture, within_limits(robot, one.q), *errors, one.free, one.swivel
    )


def add(robot: Robot, collected: list[IKSolution], one: IKSolution) -> None:
    """Add a solution that is not among those of its branch yet."""
    if not any(
        other.posture == one.posture
        and apart(robot, one.q, other.q) < IDENTICAL
        and other.within_limits >= one.within_limits
        for other in collected
    ):
        collected.append(one)


def closed_form_solutions(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
    wished: float | None,
) -> IKSolutions | None:
    """Return the solutions of a closed form, None where there is none; see ``exact_solutions``."""
    if chain.is_coupled and chain.inverse is None:
        return None
    found = _closed_form_at(robot, chain, target, task, start, tolerance, wished, start)
    if found is None or chain.is_coupled:
        return found
    better = {
        k: moved
        for k, one in enumerate(found.solutions)
        if one.free and not one.within_limits and one.swivel is None
        if (moved := _within(robot, chain, target, task, start, tolerance, one)) is not None
    }
    if not better:
        return found
    every = tuple(better.get(k, one) for k, one in enumerate(found.solutions))
    return ordered(replace(found, solutions=every))


def closed_form_once(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
) -> IKSolutions | None:
    """Return the solutions of a closed form, joints that are free at the values of the start."""
    return _closed_form_at(robot, chain, target, task, start, tolerance, None, start)


def _within(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
    one: IKSolution,
) -> IKSolution | None:
    """Return a solution of the same branch within the limits, by other values of a free joint.

    The nearest to the seed of so many values of each free joint; None where there is none.
    """
    for name in one.free:
        k = chain.names.index(name)
        column = chain.columns[k]
        low = max(chain.lower[k], start[column] - np.pi)
        high = min(chain.upper[k], start[column] + np.pi)
        values = np.linspace(low, high, FREE_VALUES) if low < high else np.empty(0)
        for value in sorted(values.tolist(), key=lambda one: abs(one - start[column])):
            given = start.copy()
            given[column] = value
            found = _closed_form_at(robot, chain, target, task, start, tolerance, None, given)
            for other in () if found is None else found.solutions:
                if other.within_limits and (other.posture, other.free) == (one.posture, one.free):
                    return other
    return None


def _closed_form_at(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
    wished: float | None,
    free: FloatArray,
) -> IKSolutions | None:
    """Return the solutions of a closed form; ``free`` holds the values of joints left free."""
    # Where joints are coupled, the closed form is that of their values, which q follows from.
    form = closed_form_of(chain.mechanism)
    if form is None or task.name not in form.tasks:
        return None
    redundant = form.kind == "srs"
    swivels: Iterable[float] = (0.0,)
    given = chain.values(free[chain.columns])
    if redundant:
        own = swivel_of(form, given)
        swivels = own + np.arange(SWIVELS) * (TURN / SWIVELS) if wished is None else (wished,)
    names = chain.names
    collected: list[IKSolution] = []
    for swivel in swivels:
        angle = float((swivel + np.pi) % TURN - np.pi)
        branch = solutions(form, chain.mechanism, target, task=task, given=given, swivel=angle)
        postures = branch.postures(form)
        measured = np.stack((branch.position_errors, branch.orientation_errors), axis=1)
        rows = _in_q(robot, chain, target, task, start, tolerance, branch.q, measured)
        for k, (q, errors, within, on) in enumerate(rows):
            one = IKSolution(
                q=q,
                posture=postures[k],
                within_limits=within,
                position_error=errors[0],
                orientation_error=errors[1],
                free=_named(names, branch.free[k]),
                swivel=angle if redundant else None,
            )
            # Two solutions on one limit may be one: an arm that is stretched there.
            if not on or not any(
                other.swivel == one.swivel and apart(robot, q, other.q) < IDENTICAL
                for other in collected
            ):
                collected.append(one)
    description = form.description
    family: Family | None = None
    if redundant:
        if not chain.is_coupled:
            family = swivel_family(robot, chain, form, task, target, start, wished)
            for one_shown in family.representatives:
                add(robot, collected, shown(robot, chain, target, task, one_shown))
        description += _where(wished, family)
    motion = None if family is None else family.motion
    return ordered(
        IKSolutions("closed_form", not redundant, description, start, tuple(collected), motion)
    )


def _where(wished: float | None, family: Family | None) -> str:
    """Say at which swivel angles a family of solutions is shown."""
    if wished is not None:
        return say(
            "; a one-parameter family, shown at the swivel angle and, where limits forbid it, at"
            " the nearest they allow"
        )
    if family is None:
        return say("; a one-parameter family, shown at {swivels} swivel angles", swivels=SWIVELS)
    return say(
        "; a one-parameter family, shown at {swivels} swivel angles, and of each interval within"
        " the limits at its ends, its middle, and nearest to the seed",
        swivels=SWIVELS,
    )


def algebraic_solutions(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
) -> IKSolutions | None:
    """Return the solutions of the polynomial equations; see ``exact_solutions``.

    None where there are more joints than equations, no target is general, coupled joints do not
    tell q, or nothing was found and nothing is proved.
    """
    if chain.is_coupled and chain.inverse is None:
        return None
    mechanism = chain.mechanism
    if not chain.is_coupled:
        at_once = _at_once(robot, chain, target, task, start, tolerance)
        if at_once is not None:
            return at_once
    given = chain.values(start[chain.columns])
    answer = _square(mechanism, task, target, given)
    if answer is None or not (answer.solutions or answer.is_complete):
        return None
    values = np.array([one.q for one in answer.solutions]).reshape(-1, chain.length)
    measured = np.array(
        [(one.position_error, one.orientation_error) for one in answer.solutions]
    ).reshape(-1, 2)
    rows = _in_q(robot, chain, target, task, start, tolerance, values, measured)
    collected = tuple(
        IKSolution(
            q,
            (),
            within,
            *errors,
            free=_named(chain.names, found.free),
            multiplicity=found.multiplicity,
        )
        for found, (q, errors, within, _) in zip(answer.solutions, rows, strict=True)
    )
    description = _equations(chain, answer)
    return ordered(IKSolutions("algebraic", answer.is_complete, description, start, collected))


def _square(
    chain: Chain, task: Task, target: FloatArray, given: FloatArray
) -> RealSolutions | None:
    """Return the solutions of a chain of free joints, measured in the task; None as above."""
    if chain.length >= len(task.rows) or len(task.rotations) != 1 or task.own_axes:
        return square_solutions(chain, task, target, given)
    # Joints that are added turn the frame about other axes too, where one angle is no polynomial.
    whole = as_orientation(chain, task, target)
    answer = None if whole is None else square_solutions(chain, *whole, given)
    if answer is None:
        return None
    measured = []
    for one in answer.solutions:
        position, orientation = task_errors(chain, target, task, one.q)
        measured.append(replace(one, position_error=position, orientation_error=orientation))
    return replace(answer, solutions=tuple(measured))


def _at_once(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
) -> IKSolutions | None:
    """Return all solutions where elimination finds them, in order; else None."""
    elimination = chain_elimination(chain, task)
    if elimination is None:
        return None
    constants, limits, whole = _constants(chain, task, robot.dof)
    reference = start if whole else start[chain.columns]
    found = elimination.real(constants, target, reference, limits, TOUCH)
    if found is None:
        return None
    collected = []
    touched = False
    for values, (position, orientation, state, _) in zip(found[0], found[1], strict=True):
        q, on = values, None
        if not whole:
            q = start.copy()
            q[chain.columns] = values
        if state == TOUCHES:
            on = on_limits(robot, chain, target, task, q, tolerance)
        if on is None:
            collected.append(IKSolution(q, (), state == WITHIN, position, orientation))
        else:
            touched = True
            collected.append(IKSolution(on[0], (), within_limits(robot, on[0]), *on[1]))
    answer = IKSolutions("algebraic", True, _found(chain.length), start, tuple(collected))
    return ordered(answer) if touched else answer


@lru_cache(maxsize=256)
def _constants(chain: Chain, task: Task, dof: int) -> tuple[TaskChain, FloatArray, bool]:
    """Return what finishing knows of an arm, and whether its joints are all of q, in order."""
    whole = np.array_equal(chain.columns, np.arange(dof))
    return task_chain(chain, task), np.stack((chain.lower, chain.upper)), whole


def ordered(found: IKSolutions) -> IKSolutions:
    """Return the solutions within the limits first, the closest to the seed first among each."""
    if not found.solutions:
        return found
    away = np.array([one.q for one in found.solutions]) - found.seed
    distances = np.sqrt(np.square(away).sum(axis=1)).tolist()
    keys = [(not one.within_limits, d) for one, d in zip(found.solutions, distances, strict=True)]
    order = sorted(range(len(keys)), key=keys.__getitem__)
    return replace(found, solutions=tuple(found.solutions[k] for k in order))


@lru_cache
def _found(length: int) -> str:
    """Say that all solutions were found at once."""
    return say("the polynomial equations of {length} joints", length=length) + say(
        ": all {degree} complex solutions of the target were found, and checked", degree=ROOTS
    )


def _equations(chain: Chain, answer: RealSolutions) -> str:
    """Say how the solutions were found."""
    if not answer.was_followed:
        return _found(chain.length)
    description = say("the polynomial equations of {length} joints", length=chain.length)
    if answer.added:
        description += say(" and {added} more that a solution leaves at 0", added=answer.added)
    description += say(
        ": each of their {degree} complex solutions was followed to the target",
        degree=answer.degree,
    )
    if answer.is_doubtful:
        description += say(
            ", but solutions nearly meet here, and the arm has axes that are parallel or meet but"
            " for rounding; there may be others"
        )
    elif not answer.is_complete:
        description += say(", but not all to the end; there may be others")
    return description


def _named(names: tuple[str, ...], free: NDArray[np.bool_]) -> tuple[str, ...]:
    return tuple(names[k] for k in np.flatnonzero(free)) if free.any() else ()


Row = tuple[FloatArray, tuple[float, float], bool, bool]


def _in_q(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
    values: FloatArray,
    measured: FloatArray,
) -> list[Row]:
    """Return q for joint values, (N, K), turned towards the start and put on limits they touch.

    Also the measured errors, whether it is within the limits, and whether it was put on one.
    """
    q = np.tile(start, (len(values), 1))
    q[:, chain.columns] = (
        values if chain.inverse is None else (values - chain.offset) @ chain.inverse.T
    )
    q = turned(robot, q, start, chain)
    inside = np.asarray(((q >= robot.lower) & (q <= robot.upper)).all(axis=1))
    rows: list[Row] = []
    for one, errors, within in zip(q, measured.tolist(), inside.tolist(), strict=True):
        on = None if within else on_limits(robot, chain, target, task, one, tolerance)
        if on is None:
            rows.append((one, (errors[0], errors[1]), within, False))
        else:
            rows.append((*on, within_limits(robot, on[0]), True))
    return rows
