"""Equivalents of a solution: the same pose with joints turned by whole turns, within the limits."""

from __future__ import annotations

from itertools import product

import numpy as np

from dh_to_urdf.messages import say
from kinematics.chain import Chain
from kinematics.errors import InvalidOption
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.solutions import IKSolution, IKSolutions
from robots.robot import FloatArray, Robot

MOST = 4096
"""Solutions that are listed at most."""
ROUND = 1e-12


def with_equivalents(robot: Robot, chain: Chain, found: IKSolutions) -> IKSolutions:
    """Return solutions together with all their equivalents, the nearest to the seed first.

    Those within the limits are turned by whole turns in every way that stays within them. A joint
    without limits, which has no end of turns, keeps that nearest to the seed.

    Args:
        robot: The robot.
        chain: The joints that move.
        found: Solutions, each turned towards the seed.

    Raises:
        InvalidOption: There are more than 4096.
    """
    choices = [_choices(robot, chain, one) for one in found.solutions]
    count = sum(int(np.prod([len(values) for values in each])) for each in choices)
    if count > MOST:
        raise InvalidOption(
            say(
                "windings all would list {count} solutions, and at most {most} are; leave windings"
                " out for those nearest to the seed, or narrow the limits of joints of more than a"
                " turn",
                count=count,
                most=MOST,
            ),
            argument="windings",
            value=count,
        )
    listed = [
        IKSolution(
            np.array(q),
            one.posture,
            one.within_limits,
            one.position_error,
            one.orientation_error,
            one.free,
            one.swivel,
            one.multiplicity,
        )
        for one, each in zip(found.solutions, choices, strict=True)
        for q in product(*each)
    ]
    listed.sort(key=lambda one: (not one.within_limits, float(np.linalg.norm(one.q - found.seed))))
    return IKSolutions(
        found.method,
        found.complete,
        found.description,
        found.seed,
        tuple(listed),
        found.self_motion,
    )


def _choices(robot: Robot, chain: Chain, one: IKSolution) -> list[FloatArray]:
    """Return the values that each joint may have, shape (dof,) each, its own among them."""
    values = [np.array([value]) for value in one.q]
    if not one.within_limits:
        return values
    for column in chain.columns[chain.is_periodic]:
        lower, upper = float(robot.lower[column]), float(robot.upper[column])
        if not np.isfinite(upper - lower):
            continue
        q = float(one.q[column])
        first, last = np.ceil((lower - ROUND - q) / TURN), np.floor((upper + ROUND - q) / TURN)
        turned = q + TURN * np.arange(first, last + 1.0)
        values[int(column)] = np.clip(turned, lower, upper)
    return values
