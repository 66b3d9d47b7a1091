"""Compiled inverse kinematics: start after start of damped least squares, without allocation.

Damping by the error (Chan and Lawrence 1988; Sugihara, IEEE T-RO 27(5), 2011): with the residual
``E = ½ eᵀe``, ``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e`` and ``λ = 0.03 E + 1e-10``. A start that stalls is given
up for the next point of a low-discrepancy sequence.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from kinematics.compiled import inner
from kinematics.inverse.damped_step import LOWER, UPPER, WRAPS, nearest_turn, step
from kinematics.inverse.solver_constants import SolverConstants
from kinematics.inverse.task_error import TaskChain, residual
from kinematics.kernels import Array

DAMPING = 0.03
FLOOR = 1e-10
STALL_RATIO = 0.9
STALLS = 3
SETTLED = 1.0 - 1e-9
MAX_DAMPING = 1e6

CONVERGED, GIVEN_UP, UNREACHABLE, OUT_OF_STEPS = 1, 0, 2, 3
UNREACHABLE_RESTARTS = 2


class Criteria(NamedTuple):
    """When a solve ends.

    Attributes:
        position: Square of the largest position error that is accepted, m².
        rotation: Square of the largest rotation error that is accepted, rad².
        steps: Most steps of a start; 0 where there is no time.
        restarts: Most starts after the first.
    """

    position: float
    rotation: float
    steps: float
    restarts: int


@inner
def reached(criteria: Criteria, position: float, rotation: float) -> bool:
    """Return whether squared errors, m² and rad², are accepted."""
    return position <= criteria.position and rotation <= criteria.rotation


@inner
def descend(
    chain: TaskChain,
    limits: Array,
    criteria: Criteria,
    G: Array,
    q: Array,
    best: Array,
    W: Array,
) -> tuple[int, int]:
    """Work at one start from q until it converges, stalls or is out of steps.

    Args:
        chain: The chain and the task.
        limits: Limits of its joints, shape (3, K).
        criteria: When it ends.
        G: Target, 12 numbers.
        q: The start, moved; shape (K,).
        best: The best q of all starts, its energy ``½ eᵀe`` and its squared errors, kept up to
            date; shape (K + 3,).
        W: Workspace.

    Returns:
        Steps, and CONVERGED or GIVEN_UP.
    """
    K = len(q)
    stalls, lowest = 0, math.inf
    iteration = 0
    while True:
        position, rotation = residual(chain, G, q, W)
        energy = 0.5 * (position + rotation)
        converged = reached(criteria, position, rotation)
        if converged or energy < best[K]:
            best[K], best[K + 1], best[K + 2] = energy, position, rotation
            for k in range(K):
                best[k] = q[k]
        if converged:
            return iteration, CONVERGED
        stalls = 0 if energy < STALL_RATIO * lowest else stalls + 1
        lowest = min(lowest, energy)
        if stalls >= STALLS or iteration >= criteria.steps:
            return iteration, GIVEN_UP
        step(chain, limits, q, DAMPING * energy + FLOOR, W, q)
        iteration += 1


@inner
def settle(
    chain: TaskChain,
    limits: Array,
    criteria: Criteria,
    G: Array,
    best: Array,
    W: Array,
    q: Array,
) -> int:
    """Move the best q down to the nearest pose, every step a descent (Marquardt's rule).

    Args:
        chain: The chain and the task.
        limits: Limits of its joints, shape (3, K).
        criteria: When it ends.
        G: Target, 12 numbers.
        best: As of :func:`descend`; shape (K + 3,).
        W: Workspace.
        q: Memory, shape (K,).

    Returns:
        Steps.
    """
    K = len(q)
    damping = DAMPING * best[K] + FLOOR
    iteration = 0
    while iteration < criteria.steps and damping <= MAX_DAMPING:
        iteration += 1
        residual(chain, G, best[:K], W)
        step(chain, limits, best[:K], damping, W, q)
        position, rotation = residual(chain, G, q, W)
        energy = 0.5 * (position + rotation)
        if energy < best[K]:
            settled = energy > SETTLED * best[K]
            best[K], best[K + 1], best[K + 2] = energy, position, rotation
            for k in range(K):
                best[k] = q[k]
            if settled or reached(criteria, position, rotation):
                break
            damping /= 5.0
        else:
            damping *= 4.0
    return iteration


@inner
def _beyond(chain: TaskChain, reach: float, criteria: Criteria, G: Array) -> bool:
    """Return whether a target is provably farther away than the arm is long."""
    away = 0.0
    for i in range(3):
        away += chain.mask[i] * (G[4 * i + 3] - chain.C[0, 4 * i + 3]) ** 2
    limit = reach * (1.0 + 1e-9) + math.sqrt(criteria.position)
    return away > limit * limit


@inner
def proceed(
    constants: SolverConstants,
    criteria: Criteria,
    G: Array,
    seed: Array,
    first: int,
    budget: int,
    answer: Array,
    W: Array,
) -> tuple[int, int, int]:
    """Solve one target, or go on with it: starts first …, until the budget of steps is spent.

    Start 0 is the seed, start s the s-th point of the sequence.

    Args:
        constants: Of the chain.
        criteria: When it ends.
        G: Target, 12 or 16 numbers.
        seed: Start 0, within the limits; shape (K,).
        first: The start to begin with; above 0, the answer must be as the last call left it.
        budget: Steps after which no new start is begun.
        answer: Filled: q, its position and rotation error, then the best q of all starts, its
            energy and squared errors; shape (2 K + 5,).
        W: Workspace.

    Returns:
        Steps, the start that came last, and a code. After OUT_OF_STEPS the next start may follow.
    """
    chain, limits, starts = constants.chain, constants.limits, constants.starts
    K = len(seed)
    best = answer[K + 2 : 2 * K + 5]
    q = W[len(chain.is_revolute) + 2 :].reshape(-1)[:K]
    unreachable = _beyond(chain, constants.reach, criteria, G)
    most = criteria.restarts
    last = min(most, UNREACHABLE_RESTARTS) if unreachable else most
    if first == 0:
        best[K] = math.inf
        for k in range(K):
            best[k] = seed[k]
    steps, s = 0, first
    while True:
        for k in range(K):
            u = starts[0, k] + s * starts[1, k]
            q[k] = seed[k] if s == 0 else starts[2, k] + (u - math.floor(u)) * starts[3, k]
        used, code = descend(chain, limits, criteria, G, q, best, W)
        steps += used
        if code == CONVERGED or s >= last or steps + s - first >= budget:
            break
        s += 1
    over = code == CONVERGED or s >= last
    if code != CONVERGED and over and criteria.steps > 0:
        steps += settle(chain, limits, criteria, G, best, W, q)
    position, rotation, turned = best[K + 1], best[K + 2], False
    for k in range(K):
        lower, upper, wraps = limits[LOWER, k], limits[UPPER, k], limits[WRAPS, k]
        answer[k] = nearest_turn(best[k], seed[k], lower, upper, wraps)
        turned = turned or answer[k] != best[k]
    if turned:
        position, rotation = residual(chain, G, answer[:K], W)
    answer[K], answer[K + 1] = math.sqrt(position), math.sqrt(rotation)
    if reached(criteria, position, rotation):
        return steps, s, CONVERGED
    return steps, s, UNREACHABLE if unreachable else GIVEN_UP if over else OUT_OF_STEPS
