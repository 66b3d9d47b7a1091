"""Compiled: bring real joint values onto a target from nearby, also where solutions meet."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import jit
from kinematics.inverse.closed_form.candidates import WORK, improve
from kinematics.inverse.damped_step import damped
from kinematics.inverse.task_error import TaskChain, columns, residual, workspace
from kinematics.kernels import Array

STEPS = 200
CLOSE = 1e-11
"""Error, m and rad, from which on Gauss-Newton steps do the rest."""
FIRST_DAMPING, LEAST_DAMPING = 1e-4, 1e-14
"""Parts of the trace of J Jᵀ."""


@jit
def settle(chain: TaskChain, target: Array, q: Array, errors: Array) -> bool:
    """Bring q onto a target and measure it.

    Levenberg-Marquardt steps, which also converge where the Jacobian loses rank, then those of
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
    return bool(improve(chain, target, q, errors, np.empty((WORK, 6))))


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
