"""Trigonometric equations of degree two, compiled: what general arms reduce to.

``k0 + k1 cos q + k2 sin q + k3 cos 2q + k4 sin 2q = 0`` is a quartic in ``z = exp(iq)``; its roots
on the unit circle are the answers. They are found together by Aberth's iteration (Bini,
*Numerical Algorithms* 13, 1996), which neither needs a starting bracket nor loses double roots.
"""

from __future__ import annotations

import cmath
import math

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_form.subproblems import FREE, harmonic
from robots.robot import FloatArray

ROUNDS = 60
NEAR_CIRCLE = 1e-3
VANISHING = 1e-13


@inner
def times(u: FloatArray, v: FloatArray, factor: float, total: FloatArray) -> None:
    """Add ``factor · u · v`` to a trigonometric polynomial of degree two.

    Args:
        u: 1, cos q, sin q of the first factor, shape (3,).
        v: Of the second factor.
        factor: A number.
        total: k0 … k4, shape (5,); changed in place.
    """
    cosines, sines = 0.5 * factor * u[1] * v[1], 0.5 * factor * u[2] * v[2]
    total[0] += factor * u[0] * v[0] + cosines + sines
    total[1] += factor * (u[0] * v[1] + u[1] * v[0])
    total[2] += factor * (u[0] * v[2] + u[2] * v[0])
    total[3] += cosines - sines
    total[4] += 0.5 * factor * (u[1] * v[2] + u[2] * v[1])


@jit
def roots(k: FloatArray, found: FloatArray) -> int:
    """Solve a trigonometric equation of degree two.

    Args:
        k: k0 … k4, shape (5,).
        found: Receives the angles, rad, shape (4,); double roots twice, and angles where the
            left side almost vanishes may be among them.

    Returns:
        Their number, or ``FREE`` where all factors vanish.
    """
    largest = 0.0
    for i in range(5):
        largest = max(largest, abs(k[i]))
    if largest < 1e-300:
        return FREE
    c4 = complex(k[3], -k[4]) * (0.5 / largest)
    c3 = complex(k[1], -k[2]) * (0.5 / largest)
    c2 = complex(k[0] / largest, 0.0)
    c1, c0 = c3.conjugate(), c4.conjugate()
    if abs(c4) < VANISHING:
        n, found[0], found[1] = harmonic(k[1], k[2], -k[0], largest)
        return n
    z0, z1 = cmath.exp(0.4j), cmath.exp(2.0j)
    z2, z3 = cmath.exp(3.5j), cmath.exp(5.1j)
    for _ in range(ROUNDS):
        moved = 0.0
        for _turn in range(4):
            z = z0
            p = (((c4 * z + c3) * z + c2) * z + c1) * z + c0
            d = ((4.0 * c4 * z + 3.0 * c3) * z + 2.0 * c2) * z + c1
            pull = 0.0j
            for other in (z1, z2, z3):
                gap = z - other
                if abs(gap) > 1e-14:
                    pull += 1.0 / gap
            denominator = d - p * pull
            step = p / denominator if abs(denominator) > 1e-300 else 0.0j
            if abs(step) > 10.0 * (1.0 + abs(z)):
                step *= 10.0 * (1.0 + abs(z)) / abs(step)
            moved = max(moved, abs(step) / (1e-3 + abs(z)))
            z0, z1, z2, z3 = z1, z2, z3, z - step
        if moved < 1e-15:
            break
    n = 0
    for z in (z0, z1, z2, z3):
        if abs(math.log(max(abs(z), 1e-300))) < NEAR_CIRCLE:
            found[n] = _sharpened(k, cmath.phase(z))
            n += 1
    return n


@inner
def _sharpened(k: FloatArray, q: float) -> float:
    """Take two Newton steps, where they are short."""
    for _ in range(2):
        c, s = math.cos(q), math.sin(q)
        c2, s2 = c * c - s * s, 2.0 * s * c
        value = k[0] + k[1] * c + k[2] * s + k[3] * c2 + k[4] * s2
        slope = k[2] * c - k[1] * s + 2.0 * (k[4] * c2 - k[3] * s2)
        if abs(value) < 1e-4 * abs(slope):
            q -= value / slope
    return q
