"""Compiled: subproblems of inverse kinematics in lanes, where they have two solutions apart.

The lanes of :mod:`kinematics.inverse.closed_form.subproblems`, by the same formulas. What is at the
edge of having solutions, or free, is not decided here: a lane where that is so is *unsure*, and
scalar code solves its target. With an angle goes how *sharp* it is: the sine, or the part of the
arm's length, that divides the rounding of what it follows from.
"""

from __future__ import annotations

from typing import Any

from kinematics.compiled import inner
from kinematics.inverse.closed_form.subproblems import SLACK
from kinematics.inverse.closed_form.vectors import cross, dot, scale, sub
from kinematics.lanes.trigonometry import angle, sine_cosine
from kinematics.lanes.vector import Vector, absolute, larger, select, smaller, splat, square_root

Mask = Any
Three = Any
"""Three vectors, or three floats."""
Two = tuple[Mask, Mask, Vector, Vector, Vector]
"""Where there are two solutions, where that is unsure, how sharp they are; their middle and half
their difference, rad or m."""

SMALL = 1e-6
"""Lengths, in parts of the arm's, below which lanes are unsure."""


@inner
def norm(a: Three) -> Vector:
    """Return the Euclidean length."""
    return square_root(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


@inner
def signed_angle(s: Vector, c: Vector) -> Vector:
    """Return ``atan2(s, c)``, rad."""
    turned = angle(absolute(s), c)
    return select(s < 0.0, -turned, turned)


@inner
def angle_between(a: Three, b: Three) -> Vector:
    """Return the angle of two vectors, 0 to pi, rad."""
    return angle(norm(cross(a, b)), dot(a, b))


@inner
def align(h: Three, u: Three, v: Three, size: float) -> tuple[Mask, Vector, Vector]:
    """Solve subproblem 1; see :func:`kinematics.inverse.closed_form.subproblems.align`.

    Returns:
        Where it is unsure: u or v is nearly along h; how sharp; q in rad.
    """
    up = sub(u, scale(dot(h, u), h))
    vp = sub(v, scale(dot(h, v), h))
    sharp = square_root(smaller(dot(up, up), dot(vp, vp))) / size
    return sharp < SMALL, sharp, signed_angle(dot(h, cross(up, vp)), dot(up, vp))


@inner
def harmonic(a: Any, b: Any, d: Vector, size: float) -> Two:
    """Solve subproblem 4 in scalar form: ``a cos q + b sin q = d``."""
    none = splat(0.0, d)
    x, y = a + none, b + none
    r = square_root(x * x + y * y)
    inside = (r - d) * (r + d)
    exists = inside > 0.0
    unsure = (~exists & (absolute(d) - r <= 2.0 * SLACK * size)) | (r <= SMALL * size)
    root = square_root(larger(inside, none))
    half = angle(root, d)
    return exists, unsure, root / r, signed_angle(y, x), half


@inner
def component(g: Three, h: Three, y: Three, d: Vector, size: float) -> Two:
    """Solve subproblem 4: ``g · R(h, q) y = d``."""
    along = dot(g, h) * dot(h, y)
    return harmonic(dot(g, y) - along, dot(g, cross(h, y)), d - along, size)


@inner
def distance(h: Three, y: Three, c: Three, square: Vector, size: float) -> Two:
    """Solve subproblem 3: ``|R(h, q) y - c|² = square``, all from one point of the axis."""
    d = 0.5 * (dot(y, y) + dot(c, c) - square)
    return component(c, h, y, d, size * size)


@inner
def slid_to(d: Three, x: Three, square: Vector, size: float) -> Two:
    """Solve ``|x + t d|² = square`` for t."""
    along = dot(d, x)
    inside = along * along - dot(x, x) + square
    exists = inside > 0.0
    unsure = ~exists & (inside >= -2e-9 * size * size)
    root = square_root(larger(inside, splat(0.0, inside)))
    return exists, unsure, root / size, -along, root


@inner
def dihedral(a: Any, b: Any, g: Vector) -> tuple[Mask, Mask, Vector, Vector]:
    """Solve the spherical triangle with sides a, b, g for the angle between a and b, rad.

    Returns:
        Where there is one, where that is unsure, how sharp it is, and the angle in [0, pi].
    """
    over = _sine(0.5 * (g + a - b)) * _sine(0.5 * (g - a + b))
    under = _sine(0.5 * (a + b + g)) * _sine(0.5 * (a + b - g))
    exists = (over > 0.0) & (under > 0.0)
    unsure = ~exists & (over >= -2.0 * SLACK) & (under >= -2.0 * SLACK)
    one, other = (
        square_root(larger(over, splat(0.0, over))),
        square_root(larger(under, splat(0.0, under))),
    )
    return exists, unsure, 2.0 * one * other / (over + under), 2.0 * angle(one, other)


@inner
def _sine(q: Vector) -> Vector:
    sine, _ = sine_cosine(q, 0.0)
    return sine
