"""Subproblems of inverse kinematics with an exact answer, compiled.

After Paden and Kahan (Murray, Li and Sastry, *A Mathematical Introduction to Robotic
Manipulation*, 1994, ch. 3) and Elias and Wen, *IK-Geo: Unified Robot Inverse Kinematics Using
Subproblem Decomposition*, arXiv 2211.05737. h is a unit vector, R(h, q) the rotation about it.

A number of solutions of ``FREE`` (-1) says that any angle is one. Equations that miss a solution
by rounding only (``SLACK``) count as met at the boundary: what comes of it is measured later on.
"""

from __future__ import annotations

import math

from kinematics.compiled import jit
from kinematics.inverse.closed_form.vectors import (
    Vector,
    cross,
    dot,
    scale,
    sub,
)

FREE = -1
SLACK = 1e-7
NOTHING = 1e-12


@jit
def align(h: Vector, u: Vector, v: Vector, size: float) -> tuple[bool, float]:
    """Solve subproblem 1: the q with ``R(h, q) u`` towards v, seen along h.

    Args:
        h: Unit axis.
        u: What is turned.
        v: Where it points afterwards.
        size: Length that u and v are compared with.

    Returns:
        False where u or v is along h, so that any q does; q in rad.
    """
    up = sub(u, scale(dot(h, u), h))
    vp = sub(v, scale(dot(h, v), h))
    smallest = NOTHING * size
    determined = dot(up, up) > smallest * smallest and dot(vp, vp) > smallest * smallest
    return determined, math.atan2(dot(h, cross(up, vp)), dot(up, vp))


@jit
def harmonic(a: float, b: float, d: float, size: float) -> tuple[int, float, float]:
    """Solve subproblem 4 in scalar form: ``a cos q + b sin q = d``.

    Args:
        a: Factor of the cosine.
        b: Factor of the sine.
        d: Right-hand side.
        size: Usual magnitude of a, b and d.

    Returns:
        Number of solutions (0, 2, or ``FREE``), and two angles, equal at the boundary.
    """
    r = math.hypot(a, b)
    if r <= NOTHING * size:
        if abs(d) <= SLACK * size:
            return FREE, 0.0, 0.0
        return 0, 0.0, 0.0
    inside = (r - d) * (r + d)
    if inside < 0.0:
        if abs(d) - r > SLACK * size:
            return 0, 0.0, 0.0
        inside = 0.0
    middle = math.atan2(b, a)
    half = math.atan2(math.sqrt(inside), d)
    return 2, middle + half, middle - half


@jit
def component(g: Vector, h: Vector, y: Vector, d: float, size: float) -> tuple[int, float, float]:
    """Solve subproblem 4: ``g · R(h, q) y = d``.

    Args:
        g: Direction of the measured component.
        h: Unit axis.
        y: What is turned.
        d: The component.
        size: Usual magnitude of the product.

    Returns:
        As :func:`harmonic`.
    """
    along = dot(g, h) * dot(h, y)
    return harmonic(dot(g, y) - along, dot(g, cross(h, y)), d - along, size)


@jit
def distance(
    h: Vector, y: Vector, c: Vector, length: float, size: float
) -> tuple[int, float, float]:
    """Solve subproblem 3: ``|R(h, q) y - c| = length``, all from one point of the axis.

    Args:
        h: Unit axis.
        y: What is turned, m.
        c: The other end, m.
        length: Their distance, m.
        size: Length of the arm, m.

    Returns:
        As :func:`harmonic`.
    """
    d = 0.5 * (dot(y, y) + dot(c, c) - length * length)
    return component(c, h, y, d, size * size)


@jit
def dihedral(a: float, b: float, g: float) -> tuple[bool, float]:
    """Solve the spherical triangle with sides a, b, g for the angle between a and b.

    Solves ``cos g = cos a cos b + sin a sin b cos x`` by half angles, without the loss of half
    the digits that the arc cosine has near 0 and pi (Todhunter, *Spherical Trigonometry*, § 45).

    Args:
        a: Side, rad, in (0, pi).
        b: Side, rad, in (0, pi).
        g: Side, rad, in [0, pi].

    Returns:
        Whether there is such a triangle, and x in [0, pi].
    """
    over = math.sin(0.5 * (g + a - b)) * math.sin(0.5 * (g - a + b))
    under = math.sin(0.5 * (a + b + g)) * math.sin(0.5 * (a + b - g))
    if over < -SLACK or under < -SLACK:
        return False, 0.0
    return True, 2.0 * math.atan2(math.sqrt(max(over, 0.0)), math.sqrt(max(under, 0.0)))
