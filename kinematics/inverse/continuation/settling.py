"""Compiled: bring real joint values onto a target from nearby, also where solutions meet."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_form.candidates import WORK, improve
from kinematics.inverse.damped_step import damped
from kinematics.inverse.task_error import TaskChain, columns, residual, workspace
from kinematics.inverse.triangular import LEAST, triangular
from kinematics.kernels import Array

STEPS = 200
CLOSE = 1e-11
"""Error, m and rad, from which on Gauss-Newton steps do the rest."""
FIRST_DAMPING, LEAST_DAMPING = 1e-4, 1e-14
"""Parts of the trace of J Jᵀ."""
NEWTON_STEPS = 50
LONGEST = 0.3
"""Longest of Newton's steps, rad or m: one that is longer leads away."""


@jit
def settle(chain: TaskChain, target: Array, q: Array, errors: Array) -> bool:
    """Bring q onto a target and measure it.

    Levenberg-Marquardt steps, which also converge where the Jacobian loses rank; Newton's, which
    also do where it nearly does; then those of
    :func:`kinematics.inverse.closed_form.candidates.improve`.

    Args:
        chain: The arm and the task.
        target: Pose in the base's axes, shape (4, 4).
        q: Joint values nearby, shape (K,); changed in place.
        errors: Filled with the norms of the position error, m, and of the rotation error, rad.

    Returns:
        Whether q reaches the target as closely as a closed form's solution does.
    """
    K = len(q)
    W, G, trial = workspace(K), target.reshape(16), q.copy()
    position, rotation = residual(chain, G, q, W)
    error, damping = math.sqrt(position + rotation), FIRST_DAMPING
    for _ in range(STEPS):
        if error <= CLOSE:
            break
        columns(chain, W)
        trace = 1e-300
        for k in range(K):
            for i in range(6, 12):
                trace += W[k, i] * W[k, i]
        damped(W, K, K, max(damping, LEAST_DAMPING) * trace)
        for k in range(K):
            change = 0.0
            for i in range(6, 12):
                change += W[k, i] * W[K + 1, i]
            trial[k] = q[k] + change
        position, rotation = residual(chain, G, trial, W)
        next_error = math.sqrt(position + rotation)
        if next_error < error:
            error, damping = next_error, 0.1 * damping
            for k in range(K):
                q[k] = trial[k]
        else:
            damping = 3.0 * max(damping, LEAST_DAMPING)
            if damping > 1e6:
                break
            residual(chain, G, q, W)
    if K <= 6:
        _newton(chain, G, q, W)
    return bool(improve(chain, target, q, errors, np.empty((WORK, 6))))


@inner
def _newton(chain: TaskChain, G: Array, q: Array, W: Array) -> None:
    """Take Newton's steps while they make the error smaller; no product of Jacobians is formed.

    Args:
        chain: The arm and the task.
        G: Pose of the target, 16 numbers.
        q: Joint values, shape (K,), K up to 6; changed in place.
        W: Workspace.
    """
    K = len(q)
    J, e, before = np.empty((6, K)), np.empty((6, 1)), q.copy()
    position, rotation = residual(chain, G, q, W)
    error = math.sqrt(position + rotation)
    for _ in range(NEWTON_STEPS):
        columns(chain, W)
        for i in range(6):
            e[i, 0] = W[K + 1, i]
            for k in range(K):
                J[i, k] = W[k, 6 + i]
        if not triangular(J, e) > LEAST:
            return
        for k in range(K - 1, -1, -1):
            for j in range(k + 1, K):
                e[k, 0] -= J[k, j] * e[j, 0]
            e[k, 0] /= J[k, k]
            if not abs(e[k, 0]) < LONGEST:
                return
        for k in range(K):
            before[k] = q[k]
            q[k] += e[k, 0]
        position, rotation = residual(chain, G, q, W)
        next_error = math.sqrt(position + rotation)
        if not next_error < error:
            for k in range(K):
                q[k] = before[k]
            return
        error = next_error


@jit
def settle_all(chain: TaskChain, target: Array, Q: Array, errors: Array, reached: Array) -> None:
    """Bring regular solutions onto a target and measure them.

    Args:
        chain: The arm and the task.
        target: Pose in the base's axes, shape (4, 4).
        Q: Joint values that are right but for rounding, shape (N, K); changed in place.
        errors: Filled as by :func:`settle`, shape (N, 2).
        reached: Filled with whether each reaches the target, shape (N,).
    """
    work = np.empty((WORK, 6))
    for n in range(len(Q)):
        reached[n] = improve(chain, target, Q[n], errors[n], work)


@jit
def error_and_columns(chain: TaskChain, target: Array, q: Array, error: Array, J: Array) -> None:
    """Compute the error of the task, shape (6,), and the columns of its Jacobian, one a row."""
    K = len(q)
    W = workspace(K)
    residual(chain, target.reshape(16), q, W)
    columns(chain, W)
    for i in range(6):
        error[i] = W[K + 1, i]
        for k in range(K):
            J[k, i] = W[k, 6 + i]


@jit
def task_columns(chain: TaskChain, q: Array, J: Array) -> None:
    """Compute the columns of the task Jacobian, one a row, shape (K, 6); see ``columns``."""
    K = len(q)
    W = workspace(K)
    residual(chain, np.eye(4).reshape(16), q, W)
    columns(chain, W)
    for k in range(K):
        for i in range(6):
            J[k, i] = W[k, 6 + i]
