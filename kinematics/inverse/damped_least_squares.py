"""Compiled inverse kinematics: what a solve ends with, after its starts.

The method is damped least squares, start after start, with damping by the error (Chan and Lawrence
1988; Sugihara, IEEE T-RO 27(5), 2011): with the residual ``E = ½ eᵀe``,
``Δq = Jᵀ (J Jᵀ + λ I)⁻¹ e`` and ``λ = 0.03 E + 1e-10``. A start that stalls is given up for the
next point of a low-discrepancy sequence; see :mod:`kinematics.inverse.lanes`.
"""

from __future__ import annotations

import math

import numpy as np

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
from kinematics.inverse.damped_step import LOWER, UPPER, WRAPS, nearest_turn
from kinematics.inverse.lanes.descent import (
    measure,
    move,
    put_target,
    room_at,
    rows_of_room,
)
from kinematics.inverse.lanes.problem import Problem
from kinematics.kernels import Array
from kinematics.lanes.memory import Pointer, past, start_of, store
from kinematics.lanes.vector import one_lane, splat


@inner
def settle(problem: Problem, criteria: Criteria, G: Pointer, best: Pointer) -> int:
    """Move the best q down to the nearest pose, every step a descent (Marquardt's rule).

    Args:
        problem: The chain and the task.
        criteria: When it ends.
        G: Target, 12 numbers or more.
        best: The best q of all starts, its energy and its squared errors, kept up to date; n + 3
            numbers.

    Returns:
        Steps.
    """
    n, K, like = problem.n, problem.K, one_lane()
    memory = np.empty(rows_of_room(n, K))
    room = room_at(start_of(memory), n, K, 1)
    put_target(room, 0, 1, G, best, n)
    damping = DAMPING * best[n] + FLOOR
    iteration = 0
    while iteration < criteria.steps and damping <= MAX_DAMPING:
        iteration += 1
        for k in range(n):
            room.q[k] = best[k]
        pose, e, _, _ = measure(problem, room, like)
        move(problem, room, pose, e, splat(damping, like), 1, like)
        _, _, positions, rotations = measure(problem, room, like)
        store(room.progress, 0, positions)
        store(room.progress, 1, rotations)
        position, rotation = room.progress[0], room.progress[1]
        energy = 0.5 * (position + rotation)
        if energy < best[n]:
            settled = energy > SETTLED * best[n]
            best[n], best[n + 1], best[n + 2] = energy, position, rotation
            for k in range(n):
                best[k] = room.q[k]
            if settled or reached(criteria, position, rotation):
                break
            damping /= 5.0
        else:
            damping *= 4.0
    memory[0] = 0.0  # the memory is in use until here
    return iteration


@inner
def errors_at(problem: Problem, G: Pointer, q: Pointer) -> tuple[float, float]:
    """Return the squares of position and rotation error at q, m² and rad²."""
    n, K = problem.n, problem.K
    memory = np.empty(rows_of_room(n, K))
    room = room_at(start_of(memory), n, K, 1)
    put_target(room, 0, 1, G, q, n)
    for k in range(n):
        room.q[k] = q[k]
    _, _, positions, rotations = measure(problem, room, one_lane())
    store(room.progress, 0, positions)
    store(room.progress, 1, rotations)
    position, rotation = room.progress[0], room.progress[1]
    memory[0] = 0.0  # the memory is in use until here
    return position, rotation


@inner
def near_seed(problem: Problem, seed: Pointer, answer: Pointer) -> bool:
    """Put the best q into an answer, angles turned as near to the seed as the limits allow.

    Args:
        problem: The chain and the task.
        seed: n numbers.
        answer: As of :func:`conclude`.

    Returns:
        Whether it is yet to be measured: an angle is another, or no start was made.
    """
    n, limits = problem.n, problem.limits
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
    P: Array,
    problem: Problem,
    criteria: Criteria,
    G: Pointer,
    seed: Pointer,
    code: int,
    answer: Pointer,
) -> tuple[int, int]:
    """Make the answer of the best q of all starts.

    Where no start has converged, it is moved down to the nearest pose. Angles are turned as near
    to the seed as the limits allow, and measured again.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        problem: The same by addresses.
        criteria: When it ends.
        G: Target, 12 numbers or more.
        seed: n numbers.
        code: How the starts ended.
        answer: The best q, its energy and its squared errors from place n + 2 on; filled: q, its
            position and rotation error; 2 n + 5 numbers.

    Returns:
        Steps, and the code of the answer.
    """
    n, steps = problem.n, 0
    if code == GIVEN_UP and criteria.steps > 0:
        steps = settle(problem, criteria, G, past(answer, n + 2))
    position, rotation = answer[2 * n + 3], answer[2 * n + 4]
    if near_seed(problem, seed, answer):
        position, rotation = errors_at(problem, G, answer)
    return steps, told(P, criteria, G, code, position, rotation, past(answer, n))


@inner
def told(
    P: Array,
    criteria: Criteria,
    G: Pointer,
    code: int,
    position: float,
    rotation: float,
    errors: Pointer,
) -> int:
    """Write both errors, of which the squares are given, and return the code of the answer."""
    errors[0], errors[1] = math.sqrt(position), math.sqrt(rotation)
    if reached(criteria, position, rotation):
        return CONVERGED
    if beyond(P, criteria, G):
        return UNREACHABLE
    if code == GIVEN_UP and is_proof(P, criteria):
        return UNREACHABLE
    # What converged and does not after a turn is rounding at the edge of the tolerance.
    return GIVEN_UP if code == CONVERGED else code
