"""Compiled inverse kinematics: what a solve ends with, after its starts.

The method is damped least squares, start after start, with damping by the error (Chan and Lawrence
1988; Sugihara, IEEE T-RO 27(5), 2011): with the residual ``E = ½ eᵀe``,
``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e`` and ``λ = 0.03 E + 1e-10``. A start that stalls is given up for the
next point of a low-discrepancy sequence; see :mod:`kinematics.inverse.lanes`.
"""

from __future__ import annotations

import math

from kinematics.compiled import inner
from kinematics.inverse.criteria import (
    CONVERGED,
    DAMPING,
    FLOOR,
    GIVEN_UP,
    MAX_DAMPING,
    SETTLED,
    UNREACHABLE,
    Criteria,
    beyond,
    is_proof,
    reached,
)
from kinematics.inverse.damped_step import LOWER, UPPER, WRAPS, nearest_turn, step
from kinematics.inverse.solver_constants import layout_of, unpacked
from kinematics.inverse.task_error import TaskChain, residual, workspace
from kinematics.kernels import Array
from kinematics.lanes.memory import Pointer, past, pointer


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
def near_seed(P: Array, seed: Pointer, answer: Pointer) -> bool:
    """Put the best q into an answer, angles turned as near to the seed as the limits allow.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        seed: n numbers.
        answer: As of :func:`conclude`.

    Returns:
        Whether it is yet to be measured: an angle is another, or no start was made.
    """
    at, constants = layout_of(P), pointer(P)
    n, limits = at.n, past(constants, at.limits)
    turned = not answer[2 * n + 2] < math.inf
    for k in range(n):
        value = answer[n + 2 + k]
        answer[k] = value
        if limits[WRAPS * n + k] != 0.0:
            lower, upper = limits[LOWER * n + k], limits[UPPER * n + k]
            answer[k] = nearest_turn(value, seed[k], lower, upper, True)
            turned = turned or answer[k] != value
    return turned


@inner
def conclude(
    P: Array, criteria: Criteria, target: Array, seed: Array, code: int, answer: Array
) -> tuple[int, int]:
    """Make the answer of the best q of all starts.

    Where no start has converged, it is moved down to the nearest pose. Angles are turned as near
    to the seed as the limits allow, and measured again.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        criteria: When it ends.
        target: Pose of the frame in base axes, 16 numbers.
        seed: Shape (n,).
        code: How the starts ended.
        answer: The best q, its energy and its squared errors in columns from n + 2 on; filled: q,
            its position and rotation error; shape (2 n + 5,).

    Returns:
        Steps, and the code of the answer.
    """
    steps, n = 0, len(seed)
    best = n + 2
    if code == GIVEN_UP and criteria.steps > 0:
        steps = _settled(P, criteria, target, answer)
    position, rotation = answer[best + n + 1], answer[best + n + 2]
    turned = near_seed(P, pointer(seed), pointer(answer))
    if turned:
        position, rotation = _measured(P, target, answer[:n])
    answer[n], answer[n + 1] = math.sqrt(position), math.sqrt(rotation)
    if reached(criteria, position, rotation):
        return steps, CONVERGED
    if beyond(P, criteria, pointer(target)):
        return steps, UNREACHABLE
    if code == GIVEN_UP and is_proof(P, criteria):
        return steps, UNREACHABLE
    # What converged and does not after a turn is rounding at the edge of the tolerance.
    return steps, GIVEN_UP if code == CONVERGED else code


@inner
def _settled(P: Array, criteria: Criteria, target: Array, answer: Array) -> int:
    """Settle the best q of an answer; arguments as of :func:`conclude`."""
    constants, n = unpacked(P), (len(answer) - 5) // 2
    W = workspace(len(constants.chain.is_revolute))
    best = answer[n + 2 :]
    return settle(constants.chain, constants.limits, criteria, target, best, W, answer[:n])


@inner
def _measured(P: Array, target: Array, q: Array) -> tuple[float, float]:
    """Return the squared errors at q; see :func:`~.task_error.residual`."""
    chain = unpacked(P).chain
    return residual(chain, target, q, workspace(len(chain.is_revolute)))
