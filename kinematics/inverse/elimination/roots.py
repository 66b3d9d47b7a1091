"""Compiled: complex solutions from eigenvalues, each brought there by Newton's method."""

from __future__ import annotations

import cmath
import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.continuation.complex_chain import Closure, Way, linearise, solve
from kinematics.inverse.elimination.eliminating import loop_end
from kinematics.inverse.elimination.resultant import Resultant
from kinematics.kernels import Array

ROOTS = 16
STEPS = 6
NEARBY = 0.05
"""Largest first correction of what an eigenvalue says, rad: farther away is another solution."""
SETTLED = 1e-10
"""Last correction, rad."""
LEAST_PIVOT = 1e-6
"""Pivot of the Jacobian, in parts of the largest, below which solutions may meet."""
APART = 1e-5
"""Least difference of two solutions."""


@inner
def _half_turned(tangent: complex, over: complex, is_real: bool) -> complex:
    """Return θ of ``tan(θ / 2) = tangent / over``."""
    if is_real:
        return complex(2.0 * math.atan2(tangent.real, over.real), 0.0)
    return -1j * cmath.log((over + 1j * tangent) / (over - 1j * tangent))


@inner
def _turned(sine: complex, cosine: complex, is_real: bool) -> complex:
    """Return θ of a sine and a cosine that are right but for rounding."""
    if is_real:
        return complex(math.atan2(sine.real, cosine.real), 0.0)
    plus, minus = cosine + 1j * sine, cosine - 1j * sine
    if abs(plus) > abs(minus):
        return -1j * cmath.log(plus)
    return 1j * cmath.log(minus)


@inner
def _back(C: Array, r: Array) -> None:
    """Turn r by the inverse of a rotation of constants."""
    x, y, z = r[0], r[1], r[2]
    for i in range(3):
        r[i] = C[0, i] * x + C[1, i] * y + C[2, i] * z


@inner
def _turn_back(angle: complex, r: Array) -> None:
    """Turn r by -angle about z."""
    c, s, x, y = cmath.cos(angle), cmath.sin(angle), r[0], r[1]
    r[0], r[1] = c * x + s * y, c * y - s * x


@inner
def _angles(
    arm: Resultant,
    X: Array,
    mu: complex,
    w: Array,
    Z: Array,
    R: Array,
    L: Array,
    v: Array,
    q: Array,
) -> None:
    """Compute the angles of an eigenvalue, shape (6,)."""
    is_real = mu.imag == 0.0
    for i in range(12):
        s = 0j
        for k in range(16):
            s += Z[i, k] * w[k]
        v[i] = s
    # Of the pairs of monomials whose ratio is a tangent, the largest.
    best2, best3, p2, p3 = -1.0, -1.0, 0, 0
    for i in range(9):
        size = abs(v[i]) + abs(v[i + 3])
        if size > best2:
            best2, p2 = size, i
    for i in range(11):
        if i % 3 < 2:
            size = abs(v[i]) + abs(v[i + 1])
            if size > best3:
                best3, p3 = size, i
    theta = np.empty(6, np.complex128)
    theta[1] = _half_turned(1.0 + 0j, mu, is_real)
    theta[2] = _half_turned(v[p2 + 3], v[p2], is_real)
    theta[3] = _half_turned(v[p3 + 1], v[p3], is_real)
    scale = 1.0 / (v[0] + v[2] + v[6] + v[8])
    norm = 1.0 / (1.0 + mu * mu)
    sine, cosine = 2.0 * mu * norm, (mu * mu - 1.0) * norm
    y = np.empty(8, np.complex128)
    for n in range(7, -1, -1):
        s = 0j
        for j in range(9):
            s += (sine * L[n, j] + cosine * L[n, 9 + j] + L[n, 18 + j]) * v[j]
        s *= scale
        for j in range(n + 1, 8):
            s -= R[n, j] * y[j]
        y[n] = s / R[n, n]
    theta[5] = _turned(y[2], y[5], is_real)
    theta[0] = _turned(y[6], y[7], is_real)
    for k in range(3):
        theta[1 + k] += arm.offsets[k]
    r = np.empty(3, np.complex128)
    r[0], r[1], r[2] = arm.loop[4, 0, 0] + 0j, arm.loop[4, 0, 1] + 0j, arm.loop[4, 0, 2] + 0j
    _turn_back(theta[5], r)
    a, b, c = r[0], r[1], r[2]
    for i in range(3):
        r[i] = X[i, 0] * a + X[i, 1] * b + X[i, 2] * c
    _turn_back(theta[0], r)
    for k in range(3):
        _back(arm.loop[k], r)
        _turn_back(theta[1 + k], r)
    _back(arm.loop[3], r)
    theta[4] = _turned(r[1], r[0], is_real)
    for k in range(6):
        if arm.reverses != 0.0:
            q[5 - k] = -theta[k]
        else:
            q[k] = theta[k]


@inner
def _polished(chain: Closure, way: Way, G: Array, q: Array, W: Array, P: Array, A: Array) -> bool:
    """Bring q to a solution by Newton's method; return whether it is regular and was near."""
    for attempt in range(STEPS):
        linearise(chain, way, G, q, W, P, A)
        if not solve(A) > LEAST_PIVOT:
            return False
        size = 0.0
        for c in range(6):
            size = max(size, abs(A[c, 6].real) + abs(A[c, 6].imag))
        if attempt == 0 and not size < NEARBY:
            return False
        for c in range(6):
            q[c] += A[c, 6]
        # Newton's method squares what is left.
        if size < 1e-6:
            return True
    return False


@jit
def roots(
    chain: Closure,
    arm: Resultant,
    target: Array,
    pose: Array,
    values: Array,
    vectors: Array,
    work: tuple[Array, Array, Array],
    Q: Array,
) -> int:
    """Find the complex solutions that eigenvalues stand for.

    Args:
        chain: Equations of the arm.
        arm: Its elimination.
        target: Pose, 4x4, lengths in units of the arm's size.
        pose: The same as 12 complex numbers.
        values: The eigenvalues, shape (16,).
        vectors: Their vectors in columns, shape (16, 16); of a pair the real, then the imaginary
            part.
        work: Z, R and L of :func:`eliminating.eigenproblem`.
        Q: Filled with the solutions, shape (16, 6).

    Returns:
        16 where all are regular and none comes twice; else the number of the first that is not.
    """
    Z, R, L = work
    X, v, W = np.empty((4, 4)), np.empty(12, np.complex128), np.empty((8, 6), np.complex128)
    P, A = np.empty(12, np.complex128), np.empty((6, 8), np.complex128)
    w, zero = np.empty(16, np.complex128), np.zeros(3, np.complex128)
    way = Way(pose, zero, zero, zero[:0], zero[:0])
    loop_end(arm, target, X)
    n = 0
    while n < ROOTS:
        mu = values[n]
        paired = mu.imag != 0.0
        for k in range(16):
            w[k] = complex(vectors[k, n], vectors[k, n + 1] if paired else 0.0)
        _angles(arm, X, mu, w, Z, R, L, v, Q[n])
        if not _polished(chain, way, pose, Q[n], W, P, A):
            return n
        if paired:
            for k in range(6):
                Q[n + 1, k] = Q[n, k].conjugate()
        for i in range(n + 2 if paired else n + 1):
            for j in range(max(i + 1, n), n + 2 if paired else n + 1):
                if _same(Q[i], Q[j]):
                    return n
        n += 2 if paired else 1
    return ROOTS


@inner
def _same(q: Array, other: Array) -> bool:
    for k in range(6):
        difference = q[k] - other[k]
        turns = math.floor(difference.real / (2.0 * math.pi) + 0.5)
        if abs(difference.real - 2.0 * math.pi * turns) + abs(difference.imag) > APART:
            return False
    return True
