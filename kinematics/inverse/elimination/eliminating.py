"""Compiled: the matrix whose eigenvalues are the solutions of a target."""

from __future__ import annotations

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.elimination.resultant import Resultant
from kinematics.inverse.triangular import LEAST, triangular
from kinematics.kernels import Array


@inner
def moved(T: Array, v: Array, result: Array) -> None:
    """Compute what a rigid motion makes of a lifted axis, or of a coefficient of one.

    Args:
        T: The motion, shape (4, 4).
        v: Shape (15,): the 14 of :func:`resultant.lift`, then the coefficient of 1.
        result: Likewise.
    """
    t0, t1, t2 = T[0, 3], T[1, 3], T[2, 3]
    for block in (0, 3, 8, 11):
        x, y, z = v[block], v[block + 1], v[block + 2]
        for i in range(3):
            result[block + i] = T[i, 0] * x + T[i, 1] * y + T[i, 2] * z
    p0, p1, p2 = result[0], result[1], result[2]
    l0, l1, l2 = result[3], result[4], result[5]
    m0, m1, m2 = result[8], result[9], result[10]
    square, along = t0 * t0 + t1 * t1 + t2 * t2, t0 * l0 + t1 * l1 + t2 * l2
    one, product = v[14], v[7]
    result[0], result[1], result[2] = p0 + one * t0, p1 + one * t1, p2 + one * t2
    result[6] = v[6] + 2.0 * (t0 * p0 + t1 * p1 + t2 * p2) + one * square
    result[7] = product + along
    c0, c1, c2 = t1 * m2 - t2 * m1, t2 * m0 - t0 * m2, t0 * m1 - t1 * m0
    result[8], result[9] = m0 + t1 * l2 - t2 * l1, m1 + t2 * l0 - t0 * l2
    result[10] = m2 + t0 * l1 - t1 * l0
    s = 2.0 * (product + along)
    result[11] += square * l0 - 2.0 * c0 - s * t0
    result[12] += square * l1 - 2.0 * c1 - s * t1
    result[13] += square * l2 - 2.0 * c2 - s * t2
    result[14] = one


@inner
def _turned_back(v: Array, sine: Array, cosine: Array, one: Array) -> None:
    """Split what a turn about z by -θ makes of a lifted axis by sin θ, cos θ and 1."""
    for n in range(15):
        sine[n] = cosine[n] = 0.0
        one[n] = v[n]
    for block in (0, 3, 8, 11):
        x, y = v[block], v[block + 1]
        sine[block], sine[block + 1] = y, -x
        cosine[block], cosine[block + 1] = x, y
        one[block] = one[block + 1] = 0.0


@inner
def _right_sides(arm: Resultant, X: Array, right: Array) -> None:
    """Compute the lifted right sides, shape (14, 9): of s5 s0, s5 c0, s5, c5 s0, …, 1."""
    v, parts, moving = np.empty(15), np.empty((3, 15)), np.empty(15)
    ends = np.empty((3, 15))
    for n in range(14):
        v[n] = arm.axis[n]
    v[14] = 1.0
    _turned_back(v, parts[0], parts[1], parts[2])
    for a in range(3):
        moved(X, parts[a], moving)
        _turned_back(moving, ends[0], ends[1], ends[2])
        for b in range(3):
            for n in range(14):
                right[n, 3 * a + b] = ends[b, n]


@inner
def _solved(M: Array, B: Array) -> float:
    """Solve M X = B in place with partial pivoting; return the least pivot in parts of the most."""
    n, m, least, largest = M.shape[0], B.shape[1], np.inf, 0.0
    for k in range(n):
        row, best = k, abs(M[k, k])
        for i in range(k + 1, n):
            if abs(M[i, k]) > best:
                row, best = i, abs(M[i, k])
        least, largest = min(least, best), max(largest, best)
        if best == 0.0:
            return 0.0
        if row != k:
            for j in range(k, n):
                M[k, j], M[row, j] = M[row, j], M[k, j]
            for j in range(m):
                B[k, j], B[row, j] = B[row, j], B[k, j]
        inverse = 1.0 / M[k, k]
        for i in range(k + 1, n):
            f = M[i, k] * inverse
            if f != 0.0:
                for j in range(k + 1, n):
                    M[i, j] -= f * M[k, j]
                for j in range(m):
                    B[i, j] -= f * B[k, j]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            f = M[k, i]
            for j in range(m):
                B[k, j] -= f * B[i, j]
        inverse = 1.0 / M[k, k]
        for j in range(m):
            B[k, j] *= inverse
    return least / largest


@inner
def _spread(N: Array, first: int, count: int, M: Array, column: int, width: int) -> None:
    """Write rows 8 to 13 of a block twice: as they are, and times x_2."""
    for i in range(6):
        for j in range(count):
            M[i, column + j] += N[8 + i, first + j]
            M[6 + i, column + width + j] += N[8 + i, first + j]


@jit
def eigenproblem(arm: Resultant, target: Array, E: Array, Z: Array, R: Array, L: Array) -> float:
    """Compute the matrix whose eigenvalues are ``1 / tan((q_1 - offset) / 2)``.

    Args:
        arm: The arm.
        target: Pose of the frame, 4x4, lengths in units of the arm's size.
        E: Filled with the matrix, shape (16, 16).
        Z: Filled with what makes monomials of an eigenvector, shape (12, 16).
        R: Filled with the triangle of the right sides, shape (14, 8).
        L: Filled with the left sides beside it, shape (14, 27).

    Returns:
        The least pivot on the way, in parts of the largest; 0 where there is no such matrix.
    """
    # X⁻¹ of the loop is C_0⁻¹ T C_6⁻¹; read backwards it is inverted.
    X = np.empty((4, 4))
    loop_end(arm, target, X)
    right = np.empty((14, 9))
    _right_sides(arm, X, right)
    N = np.empty((14, 35))
    for n in range(14):
        for j in range(8):
            R[n, j] = right[n, j]
        for m in range(3):
            for j in range(9):
                N[n, 9 * m + j] = arm.left[m, n, j]
        # The constant of the right side times (1 + x_2²)(1 + x_3²).
        for j in (0, 2, 6, 8):
            N[n, 18 + j] -= right[n, 8]
        for j in range(4):
            N[n, 27 + j], N[n, 31 + j] = arm.factor[0, n, j], arm.factor[1, n, j]
    if not triangular(R, N) > LEAST:
        return 0.0
    for n in range(14):
        for j in range(27):
            L[n, j] = N[n, j]
    M, V = np.zeros((12, 12)), np.zeros((16, 12))
    for m in (9, 18):
        _spread(N, m, 9, M, 0, 3)
    Z[:] = 0.0
    for part in range(2):
        sign = 1.0 if part == 0 else -1.0
        for i in range(6):
            for j in range(4):
                Z[i, 8 * part + j] = sign * N[8 + i, 27 + 4 * part + j]
                Z[6 + i, 8 * part + 4 + j] = sign * N[8 + i, 27 + 4 * part + j]
        for i in range(4):
            for j in range(9):
                V[8 * part + i, j] = V[8 * part + 4 + i, 3 + j] = arm.rows[part, i, j]
    least = _solved(M, Z)
    if not least > LEAST:
        return 0.0
    for i in range(12):
        for j in range(8):
            Z[i, j], Z[i, 8 + j] = Z[i, 8 + j], -Z[i, j]
    for i in range(16):
        for j in range(16):
            s = 0.0
            for k in range(12):
                s += V[i, k] * Z[k, j]
            E[i, j] = -2.0 * s
    for i in range(8):
        E[i, 8 + i] -= 1.0
        E[8 + i, i] += 1.0
    return least


@inner
def loop_end(arm: Resultant, target: Array, X: Array) -> None:
    """Compute X⁻¹ of the loop."""
    A, Y = np.empty((4, 4)), np.empty((4, 4))
    for i in range(4):
        for j in range(4):
            s = 0.0
            for k in range(4):
                s += target[i, k] * arm.after[k, j]
            A[i, j] = s
    C = arm.before
    for i in range(3):
        for j in range(4):
            s = 0.0
            for k in range(3):
                s += C[k, i] * (A[k, j] - (C[k, 3] if j == 3 else 0.0))
            Y[i, j] = s
    Y[3, 0] = Y[3, 1] = Y[3, 2] = 0.0
    Y[3, 3] = 1.0
    X[:] = Y
    if arm.reverses != 0.0:
        for i in range(3):
            for j in range(3):
                X[i, j] = Y[j, i]
            X[i, 3] = -(Y[0, i] * Y[0, 3] + Y[1, i] * Y[1, 3] + Y[2, i] * Y[2, 3])
