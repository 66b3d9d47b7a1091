"""Compiled: triangular form by Householder reflections, for matrices of a few rows."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner
from kinematics.kernels import Array

LEAST = 1e-13
"""Part of a column, in parts of the largest, below which columns are dependent."""


@inner
def triangular(Q: Array, N: Array) -> float:
    """Bring columns to triangular form by reflections, and what stands beside them.

    Args:
        Q: Shape (m, n), m ≥ n; its upper triangle is left.
        N: Shape (m, k), reflected likewise.

    Returns:
        The least part of a column that those before it do not have, in parts of the largest; 0
        where there is none.
    """
    rows, columns, largest, least = Q.shape[0], Q.shape[1], 0.0, np.inf
    for k in range(columns):
        norm = 0.0
        for i in range(k, rows):
            norm += Q[i, k] * Q[i, k]
        norm = math.sqrt(norm)
        largest, least = max(largest, norm), min(least, norm)
        if norm == 0.0:
            return 0.0
        alpha = -norm if Q[k, k] > 0.0 else norm
        head = Q[k, k] - alpha
        square = norm * norm - alpha * Q[k, k]
        scale = 1.0 / square
        Q[k, k] = head
        for j in range(k + 1, columns):
            f = 0.0
            for i in range(k, rows):
                f += Q[i, k] * Q[i, j]
            f *= scale
            for i in range(k, rows):
                Q[i, j] -= f * Q[i, k]
        _reflect(Q, N, k, scale)
        Q[k, k] = alpha
    return float(least / largest)


@inner
def _reflect(Q: Array, N: Array, k: int, scale: float) -> None:
    for j in range(N.shape[1]):
        f = 0.0
        for i in range(k, Q.shape[0]):
            f += Q[i, k] * N[i, j]
        f *= scale
        for i in range(k, Q.shape[0]):
            N[i, j] -= f * Q[i, k]
