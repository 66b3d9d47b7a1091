"""Compiled: sines, cosines and angles of vectors, without branches and without the C library."""

from __future__ import annotations

from typing import Any

from kinematics.compiled import inner
from kinematics.kernels import QUARTER_HIGH, QUARTER_LOW, QUARTER_MIDDLE
from kinematics.lanes.vector import Vector, absolute, floor, larger, select, smaller

EIGHTH = 0.41421356237309503
"""Tangent of π/8."""
HALF, QUARTER, WHOLE = 1.5707963267948966, 0.7853981633974483, 3.141592653589793


@inner
def sine_cosine(q: Vector, quarters: Any) -> tuple[Vector, Vector]:
    """Return sine and cosine of ``q + quarters π/2`` to 2e-16 for values up to 1e6.

    Quarters are one number for all lanes, or one for each. The algorithm of
    :func:`kinematics.kernels.sines_and_cosines`; whole quarter turns are exact.
    """
    n = floor(q * 0.63661977236758134308 + 0.5)
    r = ((q - n * QUARTER_HIGH) - n * QUARTER_MIDDLE) - n * QUARTER_LOW
    z = r * r
    p = -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10
    p = -1.98412698298579493134e-04 + z * (2.75573137070700676789e-06 + z * p)
    p = -1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * p)
    sine = r + r * z * p
    p = 2.08757232129817482790e-09 + z * -1.13596475577881948265e-11
    p = 2.48015872894767294178e-05 + z * (-2.75573143513906633035e-07 + z * p)
    p = 4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * p)
    cosine = 1.0 - 0.5 * z + z * z * p
    n = n + quarters
    quadrant = n - 4.0 * floor(0.25 * n)
    odd = (quadrant == 1.0) | (quadrant == 3.0)
    x, y = select(odd, sine, cosine), select(odd, cosine, sine)
    negative = (quadrant == 1.0) | (quadrant == 2.0)
    return select(quadrant >= 2.0, -y, y), select(negative, -x, x)


@inner
def angle(s: Vector, c: Vector) -> Vector:
    """Return ``atan2(s, c)`` for s ≥ 0, rad, to 4e-16; 0 where both are 0.

    Reduction to tan π/8 and the rational function of Cephes (Moshier, 1989).
    """
    across = absolute(c)
    high = larger(s, across)
    ratio = smaller(s, across) / select(high == 0.0, 1.0, high)
    wide = ratio > EIGHTH
    x = select(wide, (ratio - 1.0) / (ratio + 1.0), ratio)
    z = x * x
    p = -1.228866684490136173410e2 + z * (
        -7.500855792314704667340e1
        + z * (-1.615753718733365076637e1 + z * -8.750608600031904122785e-1)
    )
    p = -6.485021904942025371773e1 + z * p
    q = 4.328810604912902668951e2 + z * (
        1.650270098316988542046e2 + z * (2.485846490142306297962e1 + z)
    )
    q = 1.945506571482613964425e2 + z * (4.853903996359136964868e2 + z * q)
    y = x + x * (z * p / q)
    y = select(wide, y + QUARTER, y)
    y = select(s > across, HALF - y, y)
    return select(c < 0.0, WHOLE - y, y)


@inner
def angle_over_sine(s: Vector, c: Vector) -> Vector:
    """Return ``atan2(s, c) / s`` for s ≥ 0; 1 where s < 1e-9."""
    return select(s < 1e-9, 1.0, angle(s, c) / select(s < 1e-9, 1.0, s))
