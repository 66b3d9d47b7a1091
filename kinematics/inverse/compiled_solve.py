"""The whole of a solve, compiled: the closed form where there is one, then the numeric solver."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import jit
from kinematics.inverse.closed_form import Kind, parallel_axes, planar, spherical_wrist
from kinematics.inverse.closed_form.polish import WORK, improve
from kinematics.inverse.damped_least_squares import (
    CONVERGED,
    GIVEN_UP,
    HEAD,
    NUMERIC,
    UNREACHABLE,
    nearest,
    proceed,
    residual,
    unpacked,
    workspace,
)
from kinematics.kernels import Array

SPHERICAL_WRIST, PARALLEL_AXES, PLANAR = 0, 1, 2
KINDS: dict[Kind, int] = {
    "spherical_wrist": SPHERICAL_WRIST,
    "parallel_axes": PARALLEL_AXES,
    "planar_2r": PLANAR,
    "planar_3r": PLANAR,
    "scara": PLANAR,
}
"""Classes whose solutions are finitely many."""

EXACT = 1e-9
"""What a closed form promises, m and rad; a finer tolerance is the numeric solver's."""
MOST = 33
"""Rows for the candidates of any class."""
DOUBTS = 20
"""Starts of the numeric solver before a closed form without solution is taken at its word."""


@jit
def _closed(P: Array, target: Array, seed: Array, limits: Array, answer: Array) -> bool:
    """The solution nearest to the seed, and its two errors, into the answer; False: none."""
    K, _, mask, bounds, C = unpacked(P)
    kind, constants = int(P[2]), P[HEAD + 20 * K + 12 :]
    found, errors, work = np.empty((MOST, K)), np.empty((MOST, 2)), np.empty((WORK, 6))
    codes, free = np.empty((MOST, 3), np.int64), np.empty(MOST, np.int64)
    is_revolute = bounds[6]
    if kind == SPHERICAL_WRIST:
        count = spherical_wrist.solve(
            constants, C, is_revolute, mask, target, seed, 0.0, False, found, codes, free, errors
        )
    elif kind == PARALLEL_AXES:
        count = parallel_axes.solve(
            constants, C, is_revolute, mask, target, seed, 0.0, False, found, codes, free, errors
        )
    else:
        count = planar.solve(
            constants, C, is_revolute, mask, target, seed, 0.0, False, found, codes, free, errors
        )
    while True:
        index = nearest(found, errors, count, P, seed, limits, answer)
        if index < 0:
            return False
        candidate = found[index]
        if improve(C, is_revolute, target, mask, candidate, errors[index], work):
            position, rotation = errors[index, 0] ** 2, errors[index, 1] ** 2
            moved = False
            for k in range(K):
                answer[k] = min(max(candidate[k], bounds[0, k]), bounds[1, k])
                moved = moved or answer[k] != candidate[k]
            if moved:
                W = work[: 2 * K + 12].reshape((K + 6, 12))
                position, rotation = residual(
                    C, is_revolute, mask, target.reshape(16), answer[:K], W
                )
            if position <= limits[0] and rotation <= limits[1]:
                answer[K], answer[K + 1] = math.sqrt(position), math.sqrt(rotation)
                return True
        errors[index, 0] = np.inf


@jit
def solve_in(
    P: Array,
    target: Array,
    seed: Array,
    first: int,
    budget: int,
    limits: Array,
    answer: Array,
    W: Array,
) -> tuple[int, int, int]:
    """As :func:`solve_one`, in a workspace."""
    most, proven = int(limits[3]), False
    if P[2] != NUMERIC and limits[2] > 0.0:
        if first == 0 and _closed(P, target, seed, limits, answer):
            return 0, 0, CONVERGED
        # Finding nothing means that there is nothing, where the tolerance is that of the form.
        proven = limits[0] >= EXACT * EXACT and limits[1] >= EXACT * EXACT
        if proven:
            most = min(most, DOUBTS)
    steps, start, code = proceed(
        P, target.reshape(16), seed, first, budget, limits, most, answer, W
    )
    if proven and code == GIVEN_UP:
        code = UNREACHABLE
    return steps, start, code


@jit
def solve_one(
    P: Array, target: Array, seed: Array, first: int, budget: int, limits: Array, answer: Array
) -> tuple[int, int, int]:
    """Solves one target, or goes on with it; see :func:`~.damped_least_squares.proceed`.

    Args:
        P: Constants of the chain; see :func:`kinematics.inverse.damped_least_squares.packed`.
        target: Shape (4, 4).
        seed: In the chain's order, within the limits; shape (K,).
        first: The start to begin with.
        budget: Steps after which no new start is begun.
        limits: Squared tolerances, most steps of a start, most restarts.
        answer: Filled: q, its two errors, what the next call needs; shape (2 K + 5,).

    Returns:
        Steps, the start that came last, and a code of :mod:`~.damped_least_squares`.
    """
    return solve_in(P, target, seed, first, budget, limits, answer, workspace(int(P[0])))


@jit
def solve_many(
    P: Array, targets: Array, seed: Array, budget: int, limits: Array, answers: Array, ends: Array
) -> None:
    """Target by target.

    Args:
        P: Constants of the chain.
        targets: Shape (n, 4, 4).
        seed: Of all, shape (K,).
        budget: Steps of each target.
        limits: Squared tolerances, most steps of a start, most restarts.
        answers: Filled as ``answer`` of :func:`solve_one`; shape (n, 2 K + 5).
        ends: Filled: steps, last start, code; shape (n, 3).
    """
    W = workspace(int(P[0]))
    for i in range(len(targets)):
        steps, start, code = solve_in(P, targets[i], seed, 0, budget, limits, answers[i], W)
        ends[i, 0], ends[i, 1], ends[i, 2] = steps, start, code
