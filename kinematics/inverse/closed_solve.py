"""Compiled: of the solutions in closed form of one target, that nearest to the seed."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner
from kinematics.inverse.closed_form import Kind, parallel_axes, planar, spherical_wrist
from kinematics.inverse.closed_form.candidates import (
    WORK,
    Candidates,
    FormConstants,
    improve,
)
from kinematics.inverse.criteria import Criteria, reached
from kinematics.inverse.damped_step import LOWER, TURN, UPPER
from kinematics.inverse.solver_constants import SolverConstants
from kinematics.inverse.task_error import residual
from kinematics.kernels import Array

SPHERICAL_WRIST, PARALLEL_AXES, PLANAR = 0, 1, 2
KINDS: dict[Kind, int] = {
    "three_joints": SPHERICAL_WRIST,
    "spherical_wrist": SPHERICAL_WRIST,
    "parallel_axes": PARALLEL_AXES,
    "planar_2r": PLANAR,
    "planar_3r": PLANAR,
    "planar": PLANAR,
    "scara": PLANAR,
}
"""Classes whose solutions are finitely many."""

TOUCH = 1e-12
"""A limit exceeded by no more than this is rounding, rad or m."""
MOST = 33
"""Rows for the candidates of any class."""


@inner
def _nearest(
    candidates: Candidates,
    count: int,
    limits: Array,
    is_revolute: Array,
    criteria: Criteria,
    seed: Array,
    q: Array,
) -> int:
    """Choose the candidate nearest to the seed within the limits and the tolerance.

    Angles are turned by whole turns as near to the seed as the limits allow, in place.

    Args:
        candidates: Solutions in closed form.
        count: How many there are.
        limits: Limits of the joints, shape (3, K).
        is_revolute: Nonzero for an angle, shape (K,).
        criteria: The tolerance.
        seed: Shape (K,).
        q: Filled, shape (K or more,).

    Returns:
        Its index, or -1 where there is none.
    """
    found, errors = candidates.q, candidates.errors
    K = len(seed)
    best, index = math.inf, -1
    for i in range(count):
        if errors[i, 0] ** 2 > criteria.position or errors[i, 1] ** 2 > criteria.rotation:
            continue
        distance = 0.0
        for k in range(K):
            low, high, value = limits[LOWER, k], limits[UPPER, k], found[i, k]
            if is_revolute[k]:
                value += TURN * math.floor((seed[k] - value) / TURN + 0.5)
                if value > high + TOUCH and value - TURN >= low - TOUCH:
                    value -= TURN
                elif value < low - TOUCH and value + TURN <= high + TOUCH:
                    value += TURN
            if value > high + TOUCH or value < low - TOUCH:
                distance = math.inf
                break
            value = min(max(value, low), high)
            found[i, k] = value
            distance += (value - seed[k]) ** 2
        if distance < best:
            best, index = distance, i
    if index >= 0:
        for k in range(K):
            q[k] = found[index, k]
    return index


@inner
def nearest_closed(
    constants: SolverConstants, criteria: Criteria, target: Array, seed: Array, answer: Array
) -> bool:
    """Put the closed-form solution nearest to the seed, and its two errors, into the answer.

    Returns:
        Whether there is one within the limits and the tolerance.
    """
    chain, limits, K = constants.chain, constants.limits, len(seed)
    form = FormConstants(constants.form, chain)
    candidates = Candidates(
        np.empty((MOST, K)),
        np.empty((MOST, 3), np.int64),
        np.empty(MOST, np.int64),
        np.empty((MOST, 2)),
    )
    errors, work = candidates.errors, np.empty((WORK, 6))
    if constants.kind == SPHERICAL_WRIST:
        count = spherical_wrist.solve(form, target, seed, 0.0, False, candidates)
    elif constants.kind == PARALLEL_AXES:
        count = parallel_axes.solve(form, target, seed, 0.0, False, candidates)
    else:
        count = planar.solve(form, target, seed, 0.0, False, candidates)
    while True:
        index = _nearest(candidates, count, limits, chain.is_revolute, criteria, seed, answer)
        if index < 0:
            return False
        candidate = candidates.q[index]
        if improve(chain, target, candidate, errors[index], work):
            position, rotation = errors[index, 0] ** 2, errors[index, 1] ** 2
            moved = False
            for k in range(K):
                answer[k] = min(max(candidate[k], limits[LOWER, k]), limits[UPPER, k])
                moved = moved or answer[k] != candidate[k]
            if moved:
                W = work[: 2 * K + 12].reshape((K + 6, 12))
                position, rotation = residual(chain, target.reshape(16), answer[:K], W)
            if reached(criteria, position, rotation):
                answer[K], answer[K + 1] = math.sqrt(position), math.sqrt(rotation)
                return True
        errors[index, 0] = np.inf
