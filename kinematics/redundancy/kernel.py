"""Compiled task error and task Jacobian of an arm, orthonormal rows, pseudo-inverse steps.

The workspace W of an arm is that of :func:`kinematics.inverse.task_error.workspace`, with a row for
each link at its end.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse import task_error
from kinematics.inverse.task_error import TaskChain, columns, residual, twist_error
from kinematics.kernels import Array
from kinematics.singularity import RANK_TOLERANCE


class ArmConstants(NamedTuple):
    """What compiled functions know of an arm of K unknowns with a task of m rows.

    Attributes:
        chain: The chain, and the task as a mask.
        rows: Rows of the task, 0 to 5, shape (m,).
        own: Whether rotations are taken in the frame's own axes.
    """

    chain: TaskChain
    rows: Array
    own: bool


@jit
def task_rows(arm: ArmConstants, W: Array, e: Array, J: Array) -> None:
    """Compute the rows of error and Jacobian that a task counts, from the workspace.

    Args:
        arm: Constants of the arm.
        W: Workspace, after ``residual`` and ``columns``.
        e: Filled with the error, m and rad, shape (m,).
        J: Filled with the Jacobian, shape (m, K).
    """
    rows, joints = arm.rows, len(arm.chain.is_revolute)
    T, error, K = W[joints], W[joints + 1], J.shape[1]
    for i in range(len(rows)):
        row = rows[i]
        if arm.own and row >= 3:
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
    arm: ArmConstants, G: Array, q: Array, W: Array, e: Array, J: Array
) -> tuple[float, float]:
    """Compute the task's error to a pose and its Jacobian at q.

    Args:
        arm: Constants of the arm.
        G: Pose of the target in base axes, 12 numbers.
        q: Joint values, rad and m, shape (K,).
        W: Workspace.
        e: Filled with the error, m and rad, shape (m,).
        J: Filled with the Jacobian, shape (m, K).

    Returns:
        Squared position error, m², and squared rotation error, rad².
    """
    position, rotation = residual(arm.chain, G, q, W)
    columns(arm.chain, W)
    task_rows(arm, W, e, J)
    return position, rotation


@inner
def orthonormal_rows(J: Array, Q: Array, L: Array, order: Array) -> int:
    """Factor J as ``J[order] = L Q`` with Q's rows orthonormal, the longest remainder first.

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
    """Fill step, shape (K,), with ``J† e`` of full row rank.

    Args:
        Q: See :func:`orthonormal_rows`; shape (m, K).
        L: Shape (m, m).
        order: Shape (m,).
        e: Right-hand side, shape (m,).
        y: Memory, shape (m,).
        step: Filled, shape (K,).
    """
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
    """Project z, shape (K,), on the null space in place: ``z ← (I − J†J) z``."""
    m, K = Q.shape
    for i in range(m):
        s = 0.0
        for k in range(K):
            s += Q[i, k] * z[k]
        for k in range(K):
            z[k] -= s * Q[i, k]


@jit
def exact_error_columns(chain: TaskChain, W: Array) -> None:
    """Turn the Jacobian's columns in W into minus the derivative of the error, and mask both.

    The error's rotation is ``φ = log(R_G R_Tᵀ)``; where the frame turns by δ in base axes, φ
    changes by ``−J_r⁻¹(φ) δ`` with ``J_r⁻¹(φ) = I + ½ [φ]ₓ + c [φ]ₓ²`` and
    ``c = 1/θ² − (1 + cos θ) / (2 θ sin θ)`` (Chirikjian, *Stochastic Models*, vol. 2, 10.86).

    Args:
        chain: The chain and the task.
        W: Workspace, after ``residual`` and ``columns`` with a mask of ones.
    """
    mask, K = chain.mask, len(chain.is_revolute)
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
def increment(chain: TaskChain, G: Array, H: Array, W: Array) -> None:
    """Write the twist from pose G to pose H, 12 numbers each, into the error's row of W."""
    K = len(chain.is_revolute)
    twist_error(G, H, W[K + 1])
    for i in range(6):
        W[K + 1, i] *= chain.mask[i]


def workspace(K: int, links: int = 0) -> Array:
    """Return memory for a chain of K joints that carry links."""
    return np.zeros((len(task_error.workspace(K)) + links, 12))
