"""Candidates of a closed form: measured on the chain and, where rounding shows, improved; compiled.

A Gauss-Newton step with a trace of damping, ``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e``, kept where it makes the
error smaller. What does not come within ``ACCEPTED`` of the target is no solution.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner
from kinematics.inverse.closed_form.vectors import Vector, wrapped
from kinematics.inverse.damped_step import damped
from kinematics.inverse.task_error import TaskChain, columns, residual
from kinematics.kernels import Array

ACCEPTED = 1e-9
ENOUGH = 2e-14
STEPS = 6
DAMPING = 1e-13
SAME = 1e-7
WORK = 64
"""Length of the first axis of the working memory, shape (WORK, 6)."""


class FormConstants(NamedTuple):
    """What the solver of a class knows of an arm of K joints.

    Attributes:
        numbers: Geometry of the axes at q = 0, in the order of the class.
        chain: The arm as it is, and the task.
    """

    numbers: Array
    chain: TaskChain


class Candidates(NamedTuple):
    """Room for N solutions.

    Attributes:
        q: Joint values, rad and m, shape (N, K).
        codes: Which of its two values each posture has, shape (N, number of postures).
        free: A bit for each joint that a singular branch leaves free, which took its given
            value; shape (N,).
        errors: Norms of the position error, m, and of the rotation error, rad; shape (N, 2).
    """

    q: Array
    codes: Array
    free: Array
    errors: Array


@inner
def pose_parts(target: Array, work: Array) -> tuple[Vector, Array]:
    """Return position, and rotation row by row (9 numbers in the working memory), of a 4x4 pose."""
    rotation = work[WORK - 16 : WORK - 14].reshape(-1)
    for i in range(3):
        for j in range(3):
            rotation[3 * i + j] = target[i, j]
    return (target[0, 3], target[1, 3], target[2, 3]), rotation


@inner
def improve(chain: TaskChain, target: Array, q: Array, errors: Array, work: Array) -> bool:
    """Bring q closer to the target where it can be, and measure it.

    Args:
        chain: The arm and the task.
        target: Pose in the base's axes, shape (4, 4).
        q: A candidate, shape (K,); changed in place.
        errors: Filled with the norms of the position error, m, and of the rotation error, rad.
        work: Working memory, shape (WORK, 6).

    Returns:
        Whether q reaches the target within ``ACCEPTED``.
    """
    K = len(q)
    W, kept = work[: 2 * K + 12].reshape((K + 6, 12)), work[WORK - 2 :].reshape(-1)
    best = np.inf
    for attempt in range(STEPS + 1):
        position, rotation = residual(chain, target.reshape(16), q, W)
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
        columns(chain, W)
        scale = 1e-300
        for k in range(K):
            for i in range(6, 12):
                scale += W[k, i] * W[k, i]
        damped(W, K, K, DAMPING * scale)
        for k in range(K):
            kept[k] = q[k]
            for i in range(6, 12):
                q[k] += W[k, i] * W[K + 1, i]
    return bool(best <= ACCEPTED)


@inner
def put(
    candidates: Candidates,
    n: int,
    values: tuple[float, ...],
    codes: tuple[int, int, int],
    free: int,
) -> None:
    """Write a candidate into row n: joint values, codes of its postures, bits of free joints."""
    for k in range(len(values)):
        candidates.q[n, k] = values[k]
    for i in range(3):
        candidates.codes[n, i] = codes[i]
    candidates.free[n] = free


@inner
def none_yet() -> int:
    """Return 0, of a type that lets the compiler make one version of what counts on from it."""
    return int(np.int64(0))


@inner
def keep(
    form: FormConstants, target: Array, measured: bool, candidates: Candidates, n: int, work: Array
) -> int:
    """Make row n of the candidates a solution if it is one and no earlier row is the same.

    Who wants one solution only measures what it picks: without ``measured`` every candidate is
    taken, and its errors are 0.

    Args:
        form: Constants of the arm.
        target: Pose in the base's axes, shape (4, 4).
        measured: See above.
        candidates: Solutions so far, then a candidate in row n.
        n: Number of solutions so far.
        work: Working memory, shape (WORK, 6).

    Returns:
        Number of solutions now, n or n + 1.
    """
    q, errors, is_revolute = candidates.q, candidates.errors, form.chain.is_revolute
    candidate = q[n]
    if not measured:
        errors[n, 0] = errors[n, 1] = 0.0
        return n + 1
    if not improve(form.chain, target, candidate, errors[n], work):
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
