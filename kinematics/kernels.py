"""Compiled poses along one chain, with the axes of its joints."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from numpy.typing import NDArray

from kinematics.compiled import jit

Array: TypeAlias = NDArray[Any]


QUARTER_HIGH = 1.57079632673412561417
QUARTER_MIDDLE = 6.07710050630396597660e-11
QUARTER_LOW = 2.02226624879595063154e-21
"""π/2 in three parts; products of the first two with whole numbers up to a million are exact."""


@jit
def sines_and_cosines(q: Array, trig: Array) -> None:
    """Compute sines and cosines to 2e-16 for values up to 1e6, without branches.

    Reduction to ±π/4 after Cody and Waite, then the minimax polynomials of fdlibm (Sun, 1993); a
    third of the time of the C library.

    Args:
        q: Angles, rad, shape (K,).
        trig: Filled with the sines, then the cosines, shape (2 K,).
    """
    K = len(q)
    for k in range(K):
        n = math.floor(q[k] * 0.63661977236758134308 + 0.5)
        r = ((q[k] - n * QUARTER_HIGH) - n * QUARTER_MIDDLE) - n * QUARTER_LOW
        z = r * r
        p = -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10
        p = -1.98412698298579493134e-04 + z * (2.75573137070700676789e-06 + z * p)
        p = -1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * p)
        sine = r + r * z * p
        p = 2.08757232129817482790e-09 + z * -1.13596475577881948265e-11
        p = 2.48015872894767294178e-05 + z * (-2.75573143513906633035e-07 + z * p)
        p = 4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * p)
        cosine = 1.0 - 0.5 * z + z * z * p
        quadrant = n - 4.0 * math.floor(0.25 * n)
        odd = (quadrant == 1.0) or (quadrant == 3.0)
        x, y = (sine, cosine) if odd else (cosine, sine)
        trig[K + k] = -x if (quadrant == 1.0 or quadrant == 2.0) else x
        trig[k] = -y if quadrant >= 2.0 else y


@jit
def forward(C: Array, is_revolute: Array, q: Array, trig: Array, W: Array, T: Array) -> None:
    """Compute the poses along a chain, in the terms of :class:`kinematics.chain.Chain`.

    Args:
        C: Constant placements, shape (K + 1, 12): upper three rows of 4x4 matrices.
        is_revolute: Nonzero for an angle, shape (K,).
        q: Joint values, shape (K,).
        trig: Memory, shape (2 K,).
        W: Filled with axes and origins of the joints, m, in columns 0 to 2 and 3 to 5 of K rows.
        T: Filled with the pose of the frame, 12 numbers.
    """
    K = len(q)
    sines_and_cosines(q, trig)
    r00, r01, r02, p0 = C[0, 0], C[0, 1], C[0, 2], C[0, 3]
    r10, r11, r12, p1 = C[0, 4], C[0, 5], C[0, 6], C[0, 7]
    r20, r21, r22, p2 = C[0, 8], C[0, 9], C[0, 10], C[0, 11]
    for k in range(K):
        if is_revolute[k]:
            c, s = trig[K + k], trig[k]
            r00, r01 = c * r00 + s * r01, c * r01 - s * r00
            r10, r11 = c * r10 + s * r11, c * r11 - s * r10
            r20, r21 = c * r20 + s * r21, c * r21 - s * r20
        else:
            p0 += q[k] * r02
            p1 += q[k] * r12
            p2 += q[k] * r22
        W[k, 0], W[k, 1], W[k, 2] = r02, r12, r22
        W[k, 3], W[k, 4], W[k, 5] = p0, p1, p2
        x = C[k + 1]
        p0 += r00 * x[3] + r01 * x[7] + r02 * x[11]
        p1 += r10 * x[3] + r11 * x[7] + r12 * x[11]
        p2 += r20 * x[3] + r21 * x[7] + r22 * x[11]
        a, b, c = r00, r01, r02
        r00 = a * x[0] + b * x[4] + c * x[8]
        r01 = a * x[1] + b * x[5] + c * x[9]
        r02 = a * x[2] + b * x[6] + c * x[10]
        a, b, c = r10, r11, r12
        r10 = a * x[0] + b * x[4] + c * x[8]
        r11 = a * x[1] + b * x[5] + c * x[9]
        r12 = a * x[2] + b * x[6] + c * x[10]
        a, b, c = r20, r21, r22
        r20 = a * x[0] + b * x[4] + c * x[8]
        r21 = a * x[1] + b * x[5] + c * x[9]
        r22 = a * x[2] + b * x[6] + c * x[10]
    T[0], T[1], T[2], T[3] = r00, r01, r02, p0
    T[4], T[5], T[6], T[7] = r10, r11, r12, p1
    T[8], T[9], T[10], T[11] = r20, r21, r22, p2
