"""Compiled task error and task Jacobian of a chain, orthonormal rows, pseudo-inverse steps.

The workspace W of a chain of K joints has 12 columns: rows 0 to K - 1 hold axis, origin and column
of the Jacobian of each joint, row K the pose, row K + 1 the error, the last ones the links.
"""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse import damped_least_squares as inverse
from kinematics.inverse.damped_least_squares import columns, residual, twist_error
from kinematics.kernels import Array

RANK_TOLERANCE = 1e-10
"""As in :mod:`kinematics.singularity`: relative to max(1, largest)."""


@jit
def task_rows(rows: Array, own: bool, K: int, W: Array, e: Array, J: Array) -> None:
    """Compute the rows of error and Jacobian that a task counts, from the workspace.

    Args:
        rows: Rows of the task, 0 to 5, shape (m,).
        own: Whether rotations are taken in the frame's own axes.
        K: Number of joints.
        W: Workspace, after ``residual`` and ``columns``.
        e: Filled, shape (m,).
        J: Filled, shape (m, K).
    """
    T, error = W[K], W[K + 1]
    for i in range(len(rows)):
        row = rows[i]
        if own and row >= 3:
            a, b, c = T[row - 3], T[row + 1], T[row + 5]
            e[i] = a * error[3] + b * error[4] + c * error[5]
            for k in range(K):
                J[i, k] = a * W[k, 9] + b * W[k, 10] + c * W[k, 11]
        else:
            e[i] = error[row]
            for k in range(K):
                J[i, k] = W[k, 6 + row]


@jit
def task_at(
    C: Array,
    is_revolute: Array,
    mask: Array,
    rows: Array,
    own: bool,
    G: Array,
    q: Array,
    W: Array,
    e: Array,
    J: Array,
) -> tuple[float, float]:
    """Compute error to G and Jacobian at q; return the squared position and rotation errors."""
    position, rotation = residual(C, is_revolute, mask, G, q, W)
    columns(is_revolute, mask, len(q), W)
    task_rows(rows, own, len(q), W, e, J)
    return position, rotation


@inner
def orthonormal_rows(J: Array, Q: Array, L: Array, order: Array) -> int:
    """Factor the rows of J as ``J[order] = L Q`` with orthonormal rows of Q, pivoted.

    Gram-Schmidt with the longest remainder first, each row orthogonalised twice.

    Args:
        J: Shape (m, K).
        Q: Filled, shape (m, K).
        L: Filled below and on the diagonal, shape (m, m).
        order: Filled, shape (m,).

    Returns:
        The rank; rows of Q beyond it are meaningless.
    """
    m, K = J.shape
    for i in range(m):
        order[i] = i
        for k in range(K):
            Q[i, k] = J[i, k]
        for j in range(m):
            L[i, j] = 0.0
    largest = 1.0
    for i in range(m):
        best, pivot = -1.0, i
        for r in range(i, m):
            s = 0.0
            for k in range(K):
                s += Q[r, k] * Q[r, k]
            if s > best:
                best, pivot = s, r
        norm = math.sqrt(best)
        if i == 0:
            largest = max(1.0, norm)
        if not norm > RANK_TOLERANCE * largest:
            return i
        if pivot != i:
            order[i], order[pivot] = order[pivot], order[i]
            for k in range(K):
                Q[i, k], Q[pivot, k] = Q[pivot, k], Q[i, k]
            for j in range(i):
                L[i, j], L[pivot, j] = L[pivot, j], L[i, j]
        for j in range(i):  # second pass: removes the rounding error along the rows before
            s = 0.0
            for k in range(K):
                s += Q[i, k] * Q[j, k]
            L[i, j] += s
            for k in range(K):
                Q[i, k] -= s * Q[j, k]
        norm = 0.0
        for k in range(K):
            norm += Q[i, k] * Q[i, k]
        norm = math.sqrt(norm)
        L[i, i] = norm
        for k in range(K):
            Q[i, k] /= norm
        for r in range(i + 1, m):
            s = 0.0
            for k in range(K):
                s += Q[r, k] * Q[i, k]
            L[r, i] = s
            for k in range(K):
                Q[r, k] -= s * Q[i, k]
    return int(m)


@inner
def least_step(Q: Array, L: Array, order: Array, e: Array, y: Array, step: Array) -> None:
    """Compute ``J† e`` of full row rank from :func:`orthonormal_rows`; y is memory, shape (m,)."""
    m, K = Q.shape
    for i in range(m):
        s = e[order[i]]
        for j in range(i):
            s -= L[i, j] * y[j]
        y[i] = s / L[i, i]
    for k in range(K):
        step[k] = 0.0
        for i in range(m):
            step[k] += Q[i, k] * y[i]


@inner
def project_null(Q: Array, z: Array) -> None:
    """Project z onto the null space in place, ``z ← (I − J†J) z``."""
    m, K = Q.shape
    for i in range(m):
        s = 0.0
        for k in range(K):
            s += Q[i, k] * z[k]
        for k in range(K):
            z[k] -= s * Q[i, k]


@jit
def exact_error_columns(mask: Array, K: int, W: Array) -> None:
    """Turn the Jacobian's columns in W into minus the derivative of the error.

    The error's rotation is ``φ = log(R_G R_Tᵀ)``; where the frame turns by δ in base axes, φ
    changes by ``−J_r⁻¹(φ) δ`` with ``J_r⁻¹(φ) = I + ½ [φ]ₓ + c [φ]ₓ²`` and
    ``c = 1/θ² − (1 + cos θ) / (2 θ sin θ)`` (Chirikjian, *Stochastic Models*, vol. 2, 10.86).
    Call it after ``residual`` with a mask of ones in its rows of rotation, and ``columns``.
    """
    e = W[K + 1]
    x, y, z = e[3], e[4], e[5]
    t2 = x * x + y * y + z * z
    if t2 < 1e-6:
        c = 1.0 / 12.0 + t2 / 720.0
    else:
        t = math.sqrt(t2)
        c = 1.0 / t2 - (1.0 + math.cos(t)) / (2.0 * t * math.sin(t))
    for k in range(K):
        a, b, d = W[k, 9], W[k, 10], W[k, 11]
        u, v, w = y * d - z * b, z * a - x * d, x * b - y * a
        W[k, 9] = mask[3] * (a + 0.5 * u + c * (y * w - z * v))
        W[k, 10] = mask[4] * (b + 0.5 * v + c * (z * u - x * w))
        W[k, 11] = mask[5] * (d + 0.5 * w + c * (x * v - y * u))
        for i in range(3):
            W[k, 6 + i] *= mask[i]
    for i in range(6):
        e[i] *= mask[i]


@inner
def increment(G: Array, H: Array, mask: Array, W: Array, K: int) -> None:
    """Write the twist from pose G to pose H into the error's row of the workspace."""
    twist_error(G, H, W[K + 1])
    for i in range(6):
        W[K + 1, i] *= mask[i]


def workspace(K: int, links: int = 0) -> Array:
    """Return memory for a chain of K joints that carry links."""
    chain = len(inverse.workspace(K))
    return np.zeros((chain + links, 12))
