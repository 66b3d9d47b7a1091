"""Which orientations the turning axes of a chain can reach, regardless of limits.

``R = R(u_1, q_1) … R(u_n, q_n) R_0`` with the axes at q = 0. The angle between u_1 and what the
product makes of a vector covers an interval, which follows from the last axis to the first: a
vector at an angle φ from u_{k+1}, turned about it, is from u_k at every angle between |δ - φ| and
π - |π - δ - φ|, with δ the angle between u_k and u_{k+1}. A product of n turns reaches a rotation D
exactly where the angle between u_1 and D u_n is in that interval of u_n.
"""

from __future__ import annotations

import numpy as np

from kinematics.inverse.closed_form.geometry import ANGLE
from robots.robot import FloatArray


def orientation_gap(
    axes: FloatArray, vector: FloatArray | None, wanted: FloatArray
) -> tuple[float, int]:
    """Return how far a rotation, or a direction, is beyond what turns about axes can reach.

    Args:
        axes: Unit vectors of the turning axes at q = 0, from base to frame, shape (n, 3).
        vector: A unit vector at q = 0, whose direction is asked for, shape (3,); None to ask for
            the whole rotation.
        wanted: The direction that the vector is to have, shape (3,), or the rotation from q = 0,
            shape (3, 3).

    Returns:
        The least angle, rad, by which every q misses it, 0 where it is reached; and the number of
        axes that differ, successive parallel ones counted once.
    """
    groups: list[FloatArray] = []
    for axis in axes:
        if not groups or np.linalg.norm(np.cross(groups[-1], axis)) > ANGLE:
            groups.append(axis)
    if not groups:
        return (turn_of(wanted) if vector is None else _between(vector, wanted)), 0
    if vector is None:
        vector, image = groups[-1], wanted @ groups[-1]
        turned = groups[:-1] or groups
    else:
        image, turned = wanted, groups
    low = high = _between(turned[-1], vector)
    for first, second in zip(turned[-2::-1], turned[:0:-1], strict=True):
        low, high = _spread(_between(first, second), low, high)
    angle = _between(turned[0], image)
    return max(low - angle, angle - high, 0.0), len(groups)


def _spread(delta: float, low: float, high: float) -> tuple[float, float]:
    """Return the interval of angles from an axis, given that from the next, delta away."""
    least = 0.0 if low <= delta <= high else min(abs(delta - low), abs(delta - high))
    opposite = np.pi - delta
    most = (
        np.pi
        if low <= opposite <= high
        else max(np.pi - abs(opposite - low), np.pi - abs(opposite - high))
    )
    return least, float(most)


def _between(a: FloatArray, b: FloatArray) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def turn_of(R: FloatArray) -> float:
    """Return the angle of a rotation, rad, in [0, pi]."""
    twist = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(np.linalg.norm(twist), np.trace(R) - 1.0))
