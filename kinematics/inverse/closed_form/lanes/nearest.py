"""Compiled: the solution nearest to the seed in every lane, as solutions come."""

from __future__ import annotations

from typing import NamedTuple

from kinematics.compiled import inner
from kinematics.inverse.closed_form.lanes.subproblems import Mask
from kinematics.inverse.damped_step import LOWER, TURN, UPPER
from kinematics.lanes.memory import Pointer, load, store
from kinematics.lanes.vector import Vector, absolute, floor, larger, select, smaller, splat

TOUCH = 1e-12
"""A limit exceeded by no more than this is rounding, rad or m."""
BAND = 1e-7
"""Differences of joint values, rad or m, and of distances from the seed, that rounding might make
up for where a solution is not sharp."""
LEAST_SHARP = 1e-8
"""What every solution has to be as sharp as, lest rounding decide which is the nearest."""


class Joints(NamedTuple):
    """What solutions are chosen by.

    Attributes:
        K: Number of joints.
        limits: 3 K numbers; see :mod:`~.damped_step`.
        turns: Nonzero for an angle; K numbers.
        seed: K numbers.
        q: Lane memory of K rows for a solution.
        best: Lane memory of K rows: the solution nearest to the seed so far.
    """

    K: int
    limits: Pointer
    turns: Pointer
    seed: Pointer
    q: Pointer
    best: Pointer


class Chosen(NamedTuple):
    """The solution nearest to the seed so far; its q is in lane memory.

    Attributes:
        distance: The square of its distance from the seed; infinite where there is none.
        sharp: How sharp it is; see :mod:`~.subproblems`.
        unsure: Where rounding might decide.
    """

    distance: Vector
    sharp: Vector
    unsure: Mask


@inner
def consider(joints: Joints, exists: Mask, sharp: Vector, chosen: Chosen, like: Vector) -> Chosen:
    """Take a solution where it is within the limits and nearer to the seed than those before.

    Angles are turned by whole turns as near to the seed as the limits allow.

    Args:
        joints: The joints; ``q`` is the solution, and is changed.
        exists: Where it is one.
        sharp: How sharp it is.
        chosen: What was chosen before.
        like: A vector of the width.
    """
    K, limits, q, best = joints.K, joints.limits, joints.q, joints.best
    total = splat(0.0, like)
    within, edge = exists, like < 0.0
    for k in range(K):
        low, high = splat(limits[LOWER * K + k], like), splat(limits[UPPER * K + k], like)
        value, origin = load(q, k, like), splat(joints.seed[k], like)
        if joints.turns[k] != 0.0:
            value = value + TURN * floor((origin - value) / TURN + 0.5)
            edge = edge | (absolute(value - origin) > 0.5 * TURN - BAND)
            edge = edge | _is_near(value - low) | _is_near(value - high)
            down = (value > high + TOUCH) & (value - TURN >= low - TOUCH)
            up = (value < low - TOUCH) & (value + TURN <= high + TOUCH)
            value = select(down, value - TURN, select(up, value + TURN, value))
        else:
            edge = edge | (absolute(value - low) < BAND) | (absolute(value - high) < BAND)
        within = within & (value <= high + TOUCH) & (value >= low - TOUCH)
        value = smaller(larger(value, low), high)
        store(q, k, value)
        total = total + (value - origin) * (value - origin)
    nearer = within & (total < chosen.distance)
    band = BAND * (1.0 + total)
    tie = within & (absolute(total - chosen.distance) <= band)
    unsure = chosen.unsure | (exists & (edge | ~(sharp > LEAST_SHARP))) | tie
    for k in range(K):
        store(best, k, select(nearer, load(q, k, like), load(best, k, like)))
    return Chosen(
        select(nearer, total, chosen.distance), select(nearer, sharp, chosen.sharp), unsure
    )


@inner
def _is_near(excess: Vector) -> Mask:
    """Return where an angle and a limit differ by whole turns, but for rounding."""
    return absolute(excess - TURN * floor(excess / TURN + 0.5)) < BAND
