"""Three axes through one point: a rotation as three turns about them, compiled.

``R(a, qa) R(b, qb) R(c, qc) = D`` for unit vectors a, b, c with a, b and b, c not parallel; they
need not be perpendicular. Subproblem 4 (by the spherical triangle) for qb, subproblem 1 for qa
and qc. D enters as what it does to two vectors: c, and v perpendicular to c.
"""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner
from kinematics.inverse.closed_form.subproblems import align, dihedral
from kinematics.inverse.closed_form.vectors import (
    Vector,
    angle_between,
    cross,
    dot,
    turn,
    vector,
)
from kinematics.kernels import Array
from robots.robot import FloatArray


def triple(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return the constants of three axes for :func:`three_turns`.

    Args:
        a: Direction of the first axis, unit, shape (3,).
        b: Of the second.
        c: Of the third.

    Returns:
        Shape (15,): a, b, c, the angles between a and b and between b and c, the angle about b
        from a to c, and a unit vector perpendicular to c.
    """
    ab, bc = np.cross(a, b), np.cross(b, c)
    first = np.arctan2(np.linalg.norm(ab), a @ b)
    second = np.arctan2(np.linalg.norm(bc), b @ c)
    from_a, to_c = a - (a @ b) * b, c - (c @ b) * b
    zero = np.arctan2(b @ np.cross(from_a, to_c), from_a @ to_c)
    v = np.cross(c, np.eye(3)[int(np.argmin(np.abs(c)))])
    v /= np.linalg.norm(v)
    return np.concatenate((a, b, c, [first, second, zero], v))


@inner
def bend(numbers: Array, start: int, image_c: Vector) -> tuple[bool, float]:
    """Return how far the middle joint is bent, the same in both solutions up to the sign.

    Args:
        numbers: Holds what :func:`triple` gives.
        start: Where it does.
        image_c: D c.

    Returns:
        Whether there are solutions, and the angle about b from a to ``R(b, qb) c``, in [0, pi].
    """
    a = vector(numbers, start)
    return dihedral(numbers[start + 9], numbers[start + 10], angle_between(a, image_c))


@inner
def three_turns(
    numbers: Array, start: int, image_c: Vector, image_v: Vector, bent: float, given: float
) -> tuple[bool, float, float, float]:
    """Return one of the two solutions.

    Args:
        numbers: Holds what :func:`triple` gives.
        start: Where it does.
        image_c: D c.
        image_v: D v.
        bent: What :func:`bend` gives, or its negative; rad.
        given: qa to take where it is free, rad.

    Returns:
        Whether qa is free (a and c end up parallel), and qa, qb, qc in rad.
    """
    a = vector(numbers, start)
    b = vector(numbers, start + 3)
    c = vector(numbers, start + 6)
    qb = bent - numbers[start + 11]
    cb, sb = math.cos(qb), math.sin(qb)
    determined, qa = align(a, turn(b, cb, sb, c), image_c, 1.0)
    if not determined:
        qa = given
    v = vector(numbers, start + 12)
    w = turn(b, cb, -sb, turn(a, math.cos(qa), -math.sin(qa), image_v))
    return not determined, qa, qb, math.atan2(dot(c, cross(v, w)), dot(v, w))
