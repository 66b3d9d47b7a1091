"""Compiled: poses, errors and Jacobians of a chain at complex joint values.

Poses are the upper three rows of 4x4 matrices, row by row (12 complex numbers). Rotations are
complex orthogonal: sines and cosines of complex angles. Lengths are in units of the chain's size.
"""

from __future__ import annotations

import cmath
import math
from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner
from kinematics.kernels import Array


class Closure(NamedTuple):
    """The equations of a chain of K joints that its frame is at a target: m rows in m unknowns.

    Attributes:
        C: Constant placements C_0 … C_K, shape (K + 1, 12), in units of the chain's size.
        is_revolute: Nonzero for an angle, shape (K,).
        rows: Rows of vx, vy, vz, wx, wy, wz that count, shape (m,).
        own_axes: Nonzero where the rows of rotation are those about the frame's own x and y.
        unknowns: The joints that are sought, shape (m,).
        driven: The others, which go along a given way, shape (K - m,).
    """

    C: Array
    is_revolute: Array
    rows: Array
    own_axes: float
    unknowns: Array
    driven: Array


class Way(NamedTuple):
    """A way of targets, t from 0 to 1: ``R(t) = exp([w] t) R_0``, ``p(t) = p_0 + v t``.

    Attributes:
        G: Pose at 0, 12 complex numbers.
        w: Rotation vector of the whole way, shape (3,), complex.
        v: Translation of the whole way, shape (3,), complex.
        start: Values of the driven joints at 0, shape (K - m,), complex.
        change: Their change over the whole way, likewise.
    """

    G: Array
    w: Array
    v: Array
    start: Array
    change: Array


@inner
def complex_forward(chain: Closure, q: Array, W: Array, P: Array) -> None:
    """Compute the poses along a chain at complex joint values.

    Args:
        chain: The chain.
        q: Joint values, shape (K,), complex.
        W: Filled with axes and origins of the joints, shape (K, 6).
        P: Filled with the pose of the frame, 12 numbers.
    """
    C = chain.C
    r00, r01, r02, p0 = C[0, 0] + 0j, C[0, 1] + 0j, C[0, 2] + 0j, C[0, 3] + 0j
    r10, r11, r12, p1 = C[0, 4] + 0j, C[0, 5] + 0j, C[0, 6] + 0j, C[0, 7] + 0j
    r20, r21, r22, p2 = C[0, 8] + 0j, C[0, 9] + 0j, C[0, 10] + 0j, C[0, 11] + 0j
    for k in range(len(q)):
        if chain.is_revolute[k] != 0.0:
            grown = math.exp(q[k].imag)
            cosh, sinh = 0.5 * (grown + 1.0 / grown), 0.5 * (grown - 1.0 / grown)
            sine, cosine = math.sin(q[k].real), math.cos(q[k].real)
            c = complex(cosine * cosh, -sine * sinh)
            s = complex(sine * cosh, cosine * sinh)
            r00, r01 = c * r00 + s * r01, c * r01 - s * r00
            r10, r11 = c * r10 + s * r11, c * r11 - s * r10
            r20, r21 = c * r20 + s * r21, c * r21 - s * r20
        else:
            p0, p1, p2 = p0 + q[k] * r02, p1 + q[k] * r12, p2 + q[k] * r22
        W[k, 0], W[k, 1], W[k, 2] = r02, r12, r22
        W[k, 3], W[k, 4], W[k, 5] = p0, p1, p2
        D = C[k + 1]
        p0, p1, p2 = (
            p0 + r00 * D[3] + r01 * D[7] + r02 * D[11],
            p1 + r10 * D[3] + r11 * D[7] + r12 * D[11],
            p2 + r20 * D[3] + r21 * D[7] + r22 * D[11],
        )
        r00, r01, r02 = (
            r00 * D[0] + r01 * D[4] + r02 * D[8],
            r00 * D[1] + r01 * D[5] + r02 * D[9],
            r00 * D[2] + r01 * D[6] + r02 * D[10],
        )
        r10, r11, r12 = (
            r10 * D[0] + r11 * D[4] + r12 * D[8],
            r10 * D[1] + r11 * D[5] + r12 * D[9],
            r10 * D[2] + r11 * D[6] + r12 * D[10],
        )
        r20, r21, r22 = (
            r20 * D[0] + r21 * D[4] + r22 * D[8],
            r20 * D[1] + r21 * D[5] + r22 * D[9],
            r20 * D[2] + r21 * D[6] + r22 * D[10],
        )
    P[0], P[1], P[2], P[3] = r00, r01, r02, p0
    P[4], P[5], P[6], P[7] = r10, r11, r12, p1
    P[8], P[9], P[10], P[11] = r20, r21, r22, p2


@inner
def target_at(way: Way, t: float, G: Array) -> None:
    """Compute the target of a way at t, by Rodrigues' formula, into 12 complex numbers."""
    x, y, z = way.w[0] * t, way.w[1] * t, way.w[2] * t
    square = x * x + y * y + z * z
    if abs(square) < 1e-12:
        f, g = 1.0 - square / 6.0, 0.5 - square / 24.0
    else:
        angle = cmath.sqrt(square)
        f, g = cmath.sin(angle) / angle, (1.0 - cmath.cos(angle)) / square
    e00, e01, e02 = 1.0 - g * (y * y + z * z), g * x * y - f * z, g * x * z + f * y
    e10, e11, e12 = g * x * y + f * z, 1.0 - g * (x * x + z * z), g * y * z - f * x
    e20, e21, e22 = g * x * z - f * y, g * y * z + f * x, 1.0 - g * (x * x + y * y)
    for j in range(3):
        a, b, c = way.G[j], way.G[4 + j], way.G[8 + j]
        G[j] = e00 * a + e01 * b + e02 * c
        G[4 + j] = e10 * a + e11 * b + e12 * c
        G[8 + j] = e20 * a + e21 * b + e22 * c
    for i in range(3):
        G[4 * i + 3] = way.G[4 * i + 3] + way.v[i] * t


@inner
def linearise(chain: Closure, way: Way, G: Array, q: Array, W: Array, P: Array, A: Array) -> None:
    """Compute the linear equations of a Newton step and of the direction of the way.

    Args:
        chain: The chain and its task.
        way: The way of the target.
        G: The target now, 12 numbers.
        q: Joint values, shape (K,).
        W: Memory, shape (K + 2, 6).
        P: Memory, 12 numbers.
        A: Filled with the Jacobian, the error and the velocity of the way; shape (m, m + 2).
    """
    K, m = len(q), len(chain.rows)
    complex_forward(chain, q, W, P)
    error, velocity = W[K], W[K + 1]
    error[0], error[1], error[2] = G[3] - P[3], G[7] - P[7], G[11] - P[11]
    if chain.own_axes != 0.0:
        x, y, z, u, v, w = P[2], P[6], P[10], G[2], G[6], G[10]
        error[3], error[4], error[5] = y * w - z * v, z * u - x * w, x * v - y * u
    else:
        error[3] = error[4] = error[5] = 0j
        for j in range(3):
            x, y, z, u, v, w = P[j], P[4 + j], P[8 + j], G[j], G[4 + j], G[8 + j]
            error[3] += 0.5 * (y * w - z * v)
            error[4] += 0.5 * (z * u - x * w)
            error[5] += 0.5 * (x * v - y * u)
    for i in range(3):
        velocity[i], velocity[3 + i] = way.v[i], way.w[i]
    for k in range(K):
        x, y, z = W[k, 0], W[k, 1], W[k, 2]
        if chain.is_revolute[k] != 0.0:
            a, b, c = P[3] - W[k, 3], P[7] - W[k, 4], P[11] - W[k, 5]
            W[k, 0], W[k, 1], W[k, 2] = y * c - z * b, z * a - x * c, x * b - y * a
            W[k, 3], W[k, 4], W[k, 5] = x, y, z
        else:
            W[k, 3] = W[k, 4] = W[k, 5] = 0j
    for j in range(len(chain.driven)):
        for i in range(6):
            velocity[i] -= W[chain.driven[j], i] * way.change[j]
    for r in range(m):
        i = chain.rows[r]
        if chain.own_axes != 0.0 and i >= 3:
            x, y, z = P[i - 3], P[i + 1], P[i + 5]
            for c in range(m):
                column = W[chain.unknowns[c]]
                A[r, c] = x * column[3] + y * column[4] + z * column[5]
            A[r, m] = x * error[3] + y * error[4] + z * error[5]
            A[r, m + 1] = x * velocity[3] + y * velocity[4] + z * velocity[5]
        else:
            for c in range(m):
                A[r, c] = W[chain.unknowns[c], i]
            A[r, m], A[r, m + 1] = error[i], velocity[i]


@inner
def solve(A: Array) -> float:
    """Solve m complex equations for two right sides in place, with partial pivoting.

    Args:
        A: Shape (m, m + 2); the solutions are left in the last two columns.

    Returns:
        The smallest pivot in parts of the largest; 0 where one vanishes.
    """
    m, least, largest = A.shape[0], np.inf, 0.0
    for k in range(m):
        best, row = 0.0, k
        for i in range(k, m):
            size = abs(A[i, k].real) + abs(A[i, k].imag)
            if size > best:
                best, row = size, i
        if best < 1e-14:
            return 0.0
        least, largest = min(least, best), max(largest, best)
        if row != k:
            for j in range(k, m + 2):
                A[k, j], A[row, j] = A[row, j], A[k, j]
        square = 1.0 / (A[k, k].real * A[k, k].real + A[k, k].imag * A[k, k].imag)
        inverse = complex(A[k, k].real * square, -A[k, k].imag * square)
        for i in range(k + 1, m):
            f = A[i, k] * inverse
            for j in range(k + 1, m + 2):
                A[i, j] -= f * A[k, j]
        A[k, k] = inverse
    for k in range(m - 1, -1, -1):
        a, b = A[k, m], A[k, m + 1]
        for j in range(k + 1, m):
            a -= A[k, j] * A[j, m]
            b -= A[k, j] * A[j, m + 1]
        A[k, m], A[k, m + 1] = a * A[k, k], b * A[k, k]
    return least / largest
