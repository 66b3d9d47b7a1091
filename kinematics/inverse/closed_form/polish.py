"""Every candidate is measured on the chain and, where rounding shows, improved; compiled.

A Gauss-Newton step with a trace of damping, ``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e``, kept where it makes the
error smaller. What does not come within ``ACCEPTED`` of the target is no solution.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kinematics.compiled import inner
from kinematics.inverse.closed_form.vectors import wrapped
from kinematics.inverse.damped_least_squares import columns, damped, residual
from robots.robot import FloatArray

ACCEPTED = 1e-9
ENOUGH = 2e-14
STEPS = 6
DAMPING = 1e-13
SAME = 1e-7
WORK = 64
"""Length of the first axis of the working memory, shape (WORK, 6)."""

IntArray = NDArray[np.int64]


@inner
def improve(
    placements: FloatArray,
    is_revolute: FloatArray,
    target: FloatArray,
    mask: FloatArray,
    q: FloatArray,
    errors: FloatArray,
    work: FloatArray,
) -> bool:
    """Brings q closer to the target where it can, and measures it.

    Args:
        placements: C_0 … C_K, shape (K + 1, 12).
        is_revolute: Nonzero for an angle, shape (K,).
        target: Pose in the base's axes, shape (4, 4).
        mask: 1 for the rows of the error that count, else 0; shape (6,).
        q: A candidate, shape (K,); changed in place.
        errors: Receives the norms of the position error, m, and of the rotation error, rad.
        work: Working memory, shape (WORK, 6).

    Returns:
        Whether q reaches the target within ``ACCEPTED``.
    """
    K = len(q)
    W, kept = work[: 2 * K + 12].reshape((K + 6, 12)), work[WORK - 2 :].reshape(-1)
    J, e, y = W[0:K, 6:12], W[K + 1, 0:6], W[K + 1, 6:12]
    best = np.inf
    for attempt in range(STEPS + 1):
        position, rotation = residual(placements, is_revolute, mask, target.reshape(16), q, W)
        position, rotation = math.sqrt(position), math.sqrt(rotation)
        error = position + rotation
        if not error < best:
            if attempt > 0:
                for k in range(K):
                    q[k] = kept[k]
            break
        settled = error > 0.5 * best
        best, errors[0], errors[1] = error, position, rotation
        if error <= ENOUGH or settled or attempt == STEPS:
            break
        columns(is_revolute, mask, K, W)
        scale = 1e-300
        for k in range(K):
            for i in range(6):
                scale += J[k, i] * J[k, i]
        damped(J, K, DAMPING * scale, e, y)
        for k in range(K):
            kept[k] = q[k]
            for i in range(6):
                q[k] += J[k, i] * y[i]
    return bool(best <= ACCEPTED)


@inner
def none_yet() -> int:
    """0, of a type that lets the compiler make one version of what counts on from it."""
    return int(np.int64(0))


@inner
def keep(
    placements: FloatArray,
    is_revolute: FloatArray,
    target: FloatArray,
    mask: FloatArray,
    q: FloatArray,
    n: int,
    measured: bool,
    errors: FloatArray,
    work: FloatArray,
) -> int:
    """Row n of q becomes a solution if it is one and no earlier row is the same.

    Who wants one solution only measures what it picks: without ``measured`` every candidate is
    taken, and its errors are 0.

    Args:
        placements: C_0 … C_K, shape (K + 1, 12).
        is_revolute: Nonzero for an angle, shape (K,).
        target: Pose in the base's axes, shape (4, 4).
        mask: 1 for the rows of the error that count, else 0; shape (6,).
        q: Solutions so far, then a candidate in row n; shape (N, K).
        n: Number of solutions so far.
        measured: See above.
        errors: Position and rotation errors of the solutions, m and rad; shape (N, 2).
        work: Working memory.

    Returns:
        Number of solutions now, n or n + 1.
    """
    candidate = q[n]
    if not measured:
        errors[n, 0] = errors[n, 1] = 0.0
        return n + 1
    if not improve(placements, is_revolute, target, mask, candidate, errors[n], work):
        return n
    for k in range(len(candidate)):
        if is_revolute[k]:
            candidate[k] = wrapped(candidate[k])
    for i in range(n):
        same = True
        for k in range(len(candidate)):
            difference = candidate[k] - q[i, k]
            if is_revolute[k]:
                difference = wrapped(difference)
            if abs(difference) > SAME:
                same = False
                break
        if same:
            return n
    return n + 1
