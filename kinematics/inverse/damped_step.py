"""Compiled: the linear equations of a damped step, and joint values within limits."""

from __future__ import annotations

import math

from kinematics.compiled import inner, jit
from kinematics.kernels import Array

TURN = 2.0 * math.pi
LOWER, UPPER, WRAPS = 0, 1, 2
"""Rows of the limits of n unknowns, shape (3, n): lower (-inf: none) and upper (inf: none),
rad and m, and nonzero where an angle's range spans a turn, so that a step beyond one limit
re-enters at the other."""


@inner
def damped(W: Array, n: int, K: int, damping: float) -> None:
    """Solve ``(J Jᵀ + λ I) y = e`` by symmetric elimination (LDLᵀ).

    Every pivot is at least the damping, but for rounding, which is not let below it.

    Args:
        W: Workspace with the columns J_k and the error e; y is written to ``W[K + 1, 6:12]``.
        n: Number of unknowns.
        K: Number of joints.
        damping: λ, above 0.
    """
    a00 = a11 = a22 = a33 = a44 = a55 = damping
    a10 = a20 = a30 = a40 = a50 = a21 = a31 = a41 = a51 = 0.0
    a32 = a42 = a52 = a43 = a53 = a54 = 0.0
    for k in range(n):
        j0, j1, j2, j3, j4, j5 = W[k, 6], W[k, 7], W[k, 8], W[k, 9], W[k, 10], W[k, 11]
        a00 += j0 * j0
        a10, a11 = a10 + j1 * j0, a11 + j1 * j1
        a20, a21, a22 = a20 + j2 * j0, a21 + j2 * j1, a22 + j2 * j2
        a30, a31, a32, a33 = a30 + j3 * j0, a31 + j3 * j1, a32 + j3 * j2, a33 + j3 * j3
        a40, a41, a42 = a40 + j4 * j0, a41 + j4 * j1, a42 + j4 * j2
        a43, a44 = a43 + j4 * j3, a44 + j4 * j4
        a50, a51, a52 = a50 + j5 * j0, a51 + j5 * j1, a52 + j5 * j2
        a53, a54, a55 = a53 + j5 * j3, a54 + j5 * j4, a55 + j5 * j5
    e = W[K + 1]
    y0, y1, y2, y3, y4, y5 = e[0], e[1], e[2], e[3], e[4], e[5]

    r0 = 1.0 / a00
    f1, f2, f3, f4, f5 = a10 * r0, a20 * r0, a30 * r0, a40 * r0, a50 * r0
    a11 -= f1 * a10
    a21, a22 = a21 - f2 * a10, a22 - f2 * a20
    a31, a32, a33 = a31 - f3 * a10, a32 - f3 * a20, a33 - f3 * a30
    a41, a42, a43, a44 = a41 - f4 * a10, a42 - f4 * a20, a43 - f4 * a30, a44 - f4 * a40
    a51, a52, a53 = a51 - f5 * a10, a52 - f5 * a20, a53 - f5 * a30
    a54, a55 = a54 - f5 * a40, a55 - f5 * a50
    y1, y2, y3, y4, y5 = y1 - f1 * y0, y2 - f2 * y0, y3 - f3 * y0, y4 - f4 * y0, y5 - f5 * y0

    r1 = 1.0 / max(a11, damping)
    f2, f3, f4, f5 = a21 * r1, a31 * r1, a41 * r1, a51 * r1
    a22 -= f2 * a21
    a32, a33 = a32 - f3 * a21, a33 - f3 * a31
    a42, a43, a44 = a42 - f4 * a21, a43 - f4 * a31, a44 - f4 * a41
    a52, a53, a54, a55 = a52 - f5 * a21, a53 - f5 * a31, a54 - f5 * a41, a55 - f5 * a51
    y2, y3, y4, y5 = y2 - f2 * y1, y3 - f3 * y1, y4 - f4 * y1, y5 - f5 * y1

    r2 = 1.0 / max(a22, damping)
    f3, f4, f5 = a32 * r2, a42 * r2, a52 * r2
    a33 -= f3 * a32
    a43, a44 = a43 - f4 * a32, a44 - f4 * a42
    a53, a54, a55 = a53 - f5 * a32, a54 - f5 * a42, a55 - f5 * a52
    y3, y4, y5 = y3 - f3 * y2, y4 - f4 * y2, y5 - f5 * y2

    r3 = 1.0 / max(a33, damping)
    f4, f5 = a43 * r3, a53 * r3
    a44 -= f4 * a43
    a54, a55 = a54 - f5 * a43, a55 - f5 * a53
    y4, y5 = y4 - f4 * y3, y5 - f5 * y3

    r4 = 1.0 / max(a44, damping)
    f5 = a54 * r4
    a55 -= f5 * a54
    y5 -= f5 * y4

    y5 = y5 / max(a55, damping)
    y4 = (y4 - a54 * y5) * r4
    y3 = (y3 - a43 * y4 - a53 * y5) * r3
    y2 = (y2 - a32 * y3 - a42 * y4 - a52 * y5) * r2
    y1 = (y1 - a21 * y2 - a31 * y3 - a41 * y4 - a51 * y5) * r1
    y0 = (y0 - a10 * y1 - a20 * y2 - a30 * y3 - a40 * y4 - a50 * y5) * r0
    e[6], e[7], e[8], e[9], e[10], e[11] = y0, y1, y2, y3, y4, y5


@inner
def inside(value: float, lower: float, upper: float, wraps: bool) -> float:
    """Return a joint value within its limits: by whole turns where it wraps, else the nearest."""
    if wraps:
        if value < lower:
            value += TURN * math.ceil((lower - value) / TURN)
        elif value > upper:
            value -= TURN * math.ceil((value - upper) / TURN)
    return min(max(value, lower), upper)


@jit
def inside_all(q: Array, lower: Array, upper: Array, wraps: Array, result: Array) -> None:
    """Apply :func:`inside` to each joint; arrays of shape (K,)."""
    for k in range(len(q)):
        result[k] = inside(q[k], lower[k], upper[k], wraps[k])


@inner
def nearest_turn(value: float, reference: float, lower: float, upper: float, wraps: bool) -> float:
    """Return the same angle by whole turns, within the limits, nearest to a reference, rad."""
    if not wraps:
        return value
    candidate = value + TURN * math.floor((reference - value) / TURN + 0.5)
    if candidate > upper:
        candidate -= TURN
    elif candidate < lower:
        candidate += TURN
    return candidate if lower <= candidate <= upper else value
