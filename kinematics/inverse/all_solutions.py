"""Find all q that reach a target: in closed form, by polynomial equations, or by search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from dh_to_urdf.messages import say
from kinematics.chain import Chain, chain_of
from kinematics.errors import InvalidOption
from kinematics.inverse.api import solve_ik
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.closed_form import closed_form_of, solutions, swivel_of
from kinematics.inverse.continuation.real import chain_fibre, real_solutions
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.result import IKOptions, IKStatus, Tolerance
from kinematics.inverse.search import search
from kinematics.inverse.self_motion.families import (
    Family,
    Representative,
    joint_family,
    swivel_family,
)
from kinematics.inverse.self_motion.parameter import parameter_of
from kinematics.inverse.solutions import IKSolution, IKSolutions
from kinematics.inverse.windings import apart, on_limits, task_errors, turned, within_limits
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

SWIVELS = 16
OWN_SECONDS = 0.05
"""Time for the numeric solver beside the curves of an arm."""
IDENTICAL = 1e-7
"""Largest joint difference of two solutions on a limit that count as one."""


def all_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    options: IKOptions | None = None,
    swivel: float | None = None,
) -> IKSolutions:
    """Find every q that brings a frame to a target.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: Reference for turns, free joints and the order; default mid-range.
        options: For the search.
        swivel: Swivel angle that is wished, rad, of an arm with a spherical shoulder and wrist;
            None: several are shown.

    Returns:
        The solutions, also those beyond the limits where they are not searched.

    Raises:
        UnknownFrame: The robot has no such frame.
        InvalidOption: The arm has no swivel angle.
    """
    name = robot.tip_frame if frame is None else frame
    options = options or IKOptions()
    found = exact_solutions(
        robot, target, frame=name, task=task, seed=seed, tolerance=options.tolerance, swivel=swivel
    )
    if found is not None:
        return found
    chain, start = chain_of(robot, name), _start(robot, seed)
    if parameter_of(chain, task) is None:
        return _ordered(search(robot, chain, target, name, task, start, options))
    own = solve_ik(
        robot, target, frame=name, task=task, seed=start, options=options.within(OWN_SECONDS)
    )
    known = own.q if own.status is IKStatus.CONVERGED else None
    found = curve_solutions(robot, target, frame=name, task=task, seed=seed, known=known)
    assert found is not None
    return found


def exact_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    tolerance: Tolerance | None = None,
    swivel: float | None = None,
) -> IKSolutions | None:
    """Find every q that brings a frame to a target, without search.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: Reference for turns, free joints and the order; default mid-range.
        tolerance: For solutions that touch a limit.
        swivel: As of :func:`all_solutions`.

    Returns:
        The solutions, also those beyond the limits; None where the arm has neither a closed form
        nor as many joints as the task has rows.

    Raises:
        UnknownFrame: The robot has no such frame.
        InvalidOption: The arm has no swivel angle.
    """
    chain = chain_of(robot, robot.tip_frame if frame is None else frame)
    start, tolerance = _start(robot, seed), tolerance or Tolerance()
    if swivel is not None:
        _check_swivel(chain, task, swivel)
    found = _closed_form(robot, chain, target, task, start, tolerance, swivel)
    if found is None:
        found = _algebraic(robot, chain, target, task, start, tolerance)
    return None if found is None else _ordered(found)


def _start(robot: Robot, seed: FloatArray | None) -> FloatArray:
    bounds = JointBounds.of(robot)
    return bounds.inside(bounds.middle() if seed is None else seed)


def _check_swivel(chain: Chain, task: Task, swivel: float) -> None:
    form = closed_form_of(chain.mechanism)
    if form is None or form.kind != "srs" or task.name not in form.tasks:
        raise InvalidOption(
            say(
                "swivel is the angle of an arm of seven joints with a spherical shoulder and wrist,"
                " for task pose, which this is not; leave it out, and give a seed instead"
            ),
            argument="swivel",
            value=swivel,
        )


def curve_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    known: FloatArray | None = None,
) -> IKSolutions | None:
    """Return solutions on the self-motions of an arm with one joint more than the task has rows.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: As of :func:`all_solutions`.
        known: A solution that is known, shape (dof,).

    Returns:
        None where the arm is another.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    chain = chain_of(robot, robot.tip_frame if frame is None else frame)
    start = _start(robot, seed)
    point = None if known is None else known[chain.columns]
    family = joint_family(robot, chain, task, target, start, point)
    if family is None:
        return None
    collected: list[IKSolution] = []
    for one in family.representatives:
        _add(robot, collected, _shown(robot, chain, target, task, one))
    found = IKSolutions(
        "algebraic", False, family.description, start, tuple(collected), family.motion
    )
    return _ordered(found)


def _shown(
    robot: Robot, chain: Chain, target: FloatArray, task: Task, one: Representative
) -> IKSolution:
    errors = task_errors(chain, target, task, one.q[chain.columns])
    return IKSolution(
        one.q, one.posture, within_limits(robot, one.q), *errors, one.free, one.swivel
    )


def _add(robot: Robot, collected: list[IKSolution], one: IKSolution) -> None:
    """Add a solution that is not among those of its branch yet."""
    if not any(
        other.posture == one.posture
        and apart(robot, one.q, other.q) < IDENTICAL
        and other.within_limits >= one.within_limits
        for other in collected
    ):
        collected.append(one)


def _ordered(found: IKSolutions) -> IKSolutions:
    """Return the solutions within the limits first, the closest to the seed first among each."""
    ordered = sorted(
        found.solutions,
        key=lambda one: (not one.within_limits, float(np.linalg.norm(one.q - found.seed))),
    )
    return replace(found, solutions=tuple(ordered))


def _closed_form(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
    wished: float | None,
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
        swivels = own + np.arange(SWIVELS) * (TURN / SWIVELS) if wished is None else (wished,)
    names = chain.names
    collected: list[IKSolution] = []
    for swivel in swivels:
        angle = float((swivel + np.pi) % TURN - np.pi)
        branch = solutions(form, chain.mechanism, target, task=task, given=given, swivel=angle)
        postures = branch.postures(form)
        for k, values in enumerate(branch.q):
            errors = float(branch.position_errors[k]), float(branch.orientation_errors[k])
            q, errors, on = _in_q(robot, chain, target, task, start, tolerance, values, errors)
            one = IKSolution(
                q=q,
                posture=postures[k],
                within_limits=within_limits(robot, q),
                position_error=errors[0],
                orientation_error=errors[1],
                free=tuple(n for n, free in zip(names, branch.free[k], strict=True) if free),
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
            for shown in family.representatives:
                _add(robot, collected, _shown(robot, chain, target, task, shown))
        description += _where(wished, family)
    motion = None if family is None else family.motion
    return IKSolutions("closed_form", not redundant, description, start, tuple(collected), motion)


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


def _algebraic(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
) -> IKSolutions | None:
    if chain.is_coupled and chain.inverse is None:
        return None
    mechanism = chain.mechanism
    fibre = chain_fibre(mechanism, task)
    if fibre is None:
        return None
    given = chain.values(start[chain.columns])
    answer = real_solutions(fibre, mechanism, task, target, given)
    collected = []
    for found in answer.solutions:
        errors = found.position_error, found.orientation_error
        q, errors, _ = _in_q(robot, chain, target, task, start, tolerance, found.q, errors)
        free = tuple(n for n, free in zip(chain.names, found.free, strict=True) if free)
        collected.append(
            IKSolution(
                q,
                (),
                within_limits(robot, q),
                *errors,
                free=free,
                multiplicity=found.multiplicity,
            )
        )
    added = fibre.system.added
    description = (
        say("the polynomial equations of {length} joints", length=chain.length)
        + (say(" and {added} more that a solution leaves at 0", added=added) if added else "")
        + say(
            ": each of their {degree} complex solutions was followed to the target",
            degree=answer.degree,
        )
    )
    if not answer.is_complete:
        description += say(", but not all to the end; there may be others")
    return IKSolutions("algebraic", answer.is_complete, description, start, tuple(collected))


def _in_q(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    start: FloatArray,
    tolerance: Tolerance,
    values: FloatArray,
    errors: tuple[float, float],
) -> tuple[FloatArray, tuple[float, float], bool]:
    """Return the q of joint values, turned towards the start and put on limits that it touches.

    Also its measured errors, and whether it was put on a limit.
    """
    q = start.copy()
    q[chain.columns] = values if chain.inverse is None else chain.inverse @ (values - chain.offset)
    q = turned(robot, q, start, chain)
    on = on_limits(robot, chain, target, task, q, tolerance)
    return (q, errors, False) if on is None else (*on, True)
