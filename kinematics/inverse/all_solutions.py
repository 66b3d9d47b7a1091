"""Find all q that reach a target: in closed form, by polynomial equations, or by search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from dh_to_urdf.messages import say
from kinematics.chain import Chain, chain_of
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.closed_form import closed_form_of, solutions, swivel_of
from kinematics.inverse.continuation.real import chain_fibre, real_solutions
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.result import IKOptions, Tolerance
from kinematics.inverse.search import search
from kinematics.inverse.solutions import IKSolution, IKSolutions
from kinematics.inverse.windings import apart, on_limits, turned, within_limits
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

SWIVELS = 16
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
        The solutions, also those beyond the limits where they are not searched.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    name = robot.tip_frame if frame is None else frame
    options = options or IKOptions()
    found = exact_solutions(
        robot, target, frame=name, task=task, seed=seed, tolerance=options.tolerance
    )
    if found is not None:
        return found
    return _ordered(
        search(robot, chain_of(robot, name), target, name, task, _start(robot, seed), options)
    )


def exact_solutions(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    tolerance: Tolerance | None = None,
) -> IKSolutions | None:
    """Find every q that brings a frame to a target, without search.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name; default the tip.
        task: The task space.
        seed: Reference for turns, free joints and the order; default mid-range.
        tolerance: For solutions that touch a limit.

    Returns:
        The solutions, also those beyond the limits; None where the arm has neither a closed form
        nor as many joints as the task has rows.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    chain = chain_of(robot, robot.tip_frame if frame is None else frame)
    start, tolerance = _start(robot, seed), tolerance or Tolerance()
    found = _closed_form(robot, chain, target, task, start, tolerance)
    if found is None:
        found = _algebraic(robot, chain, target, task, start, tolerance)
    return None if found is None else _ordered(found)


def _start(robot: Robot, seed: FloatArray | None) -> FloatArray:
    bounds = JointBounds.of(robot)
    return bounds.inside(bounds.middle() if seed is None else seed)


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
    if redundant:
        description += say(
            "; a one-parameter family, shown at {swivels} swivel angles", swivels=SWIVELS
        )
    return IKSolutions("closed_form", not redundant, description, start, tuple(collected))


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
