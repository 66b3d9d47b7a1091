"""Compiled: the real ones of all complex solutions, measured, within limits, nearest first."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_form.candidates import WORK, improve
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.task_error import TaskChain
from kinematics.kernels import Array

MET = 1e-12
"""A limit met to rounding counts as met, rad."""
WITHIN, TOUCHES, BEYOND = 0, 1, 2


@inner
def nearest(value: float, reference: float, lower: float, upper: float) -> float:
    """Return the turn of an angle that is nearest to a reference within the limits, if any is."""
    middle = value + TURN * float(np.round((reference - value) / TURN))
    best, away = middle, np.inf
    for turn in range(3):
        candidate = middle if turn == 0 else (middle - TURN if turn == 1 else middle + TURN)
        if lower - MET <= candidate <= upper + MET and abs(candidate - reference) < away:
            best, away = candidate, abs(candidate - reference)
    return float(min(max(best, lower), upper)) if away < np.inf else float(middle)


@jit
def turned_all(q: Array, reference: Array, limits: Array, turns: Array) -> None:
    """Turn angles in place as near to a reference as the limits allow.

    Args:
        q: Shape (N, n), rad and m.
        reference: Shape (n,).
        limits: Lower and upper ones, shape (2, n).
        turns: Nonzero where a turn leads to the same, shape (n,).
    """
    for k in range(q.shape[1]):
        if turns[k] != 0.0:
            for n in range(q.shape[0]):
                q[n, k] = nearest(q[n, k], reference[k], limits[0, k], limits[1, k])


@jit
def finish(
    chain: TaskChain,
    target: Array,
    Q: Array,
    reference: Array,
    limits: Array,
    touch: float,
    q: Array,
    measured: Array,
) -> int:
    """Bring the real solutions of a target into order.

    Args:
        chain: An arm of revolute joints and the task.
        target: Pose in the base's axes, shape (4, 4).
        Q: Complex solutions, shape (N, K); imaginary parts of real ones are 0.
        reference: What turns and order refer to, shape (K,).
        limits: Lower and upper ones, shape (2, K).
        touch: Excess of a limit up to which a solution may be on it, rad.
        q: Filled with the real ones, those within the limits first, each group from the nearest
            to the reference on; shape (N, K).
        measured: Filled with their errors, m and rad, one of ``WITHIN``, ``TOUCHES``, ``BEYOND``,
            and the distance; shape (N, 4).

    Returns:
        How many are real; -1 where one does not reach the target on the chain.
    """
    work, one, row, count = np.empty((WORK, 6)), np.empty(Q.shape[1]), np.empty(4), 0
    for n in range(len(Q)):
        is_real = True
        for k in range(len(one)):
            is_real = is_real and Q[n, k].imag == 0.0
            one[k] = Q[n, k].real
        if not is_real:
            continue
        if not improve(chain, target, one, row, work):
            return -1
        excess, square = 0.0, 0.0
        for k in range(len(one)):
            one[k] = nearest(one[k], reference[k], limits[0, k], limits[1, k])
            excess = max(excess, limits[0, k] - one[k], one[k] - limits[1, k])
            square += (one[k] - reference[k]) * (one[k] - reference[k])
        row[2] = WITHIN if excess <= 0.0 else (TOUCHES if excess <= touch else BEYOND)
        row[3] = math.sqrt(square)
        at = count
        while at > 0 and _before(row, measured[at - 1]):
            q[at], measured[at] = q[at - 1], measured[at - 1]
            at -= 1
        q[at], measured[at] = one, row
        count += 1
    return count


@inner
def _before(row: Array, other: Array) -> bool:
    beyond, other_beyond = row[2] != WITHIN, other[2] != WITHIN
    if beyond != other_beyond:
        return bool(other_beyond)
    return bool(row[3] < other[3])
