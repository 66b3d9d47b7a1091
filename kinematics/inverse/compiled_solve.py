"""The whole of a solve, compiled: the closed form where there is one, then the numeric solver."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_solve import nearest_closed
from kinematics.inverse.criteria import (
    CONVERGED,
    GIVEN_UP,
    OUT_OF_STEPS,
    Criteria,
    criteria_from,
    last_start,
)
from kinematics.inverse.damped_least_squares import conclude, near_seed, told
from kinematics.inverse.lanes.descent import measure, put_target, room_at, rows_of_room
from kinematics.inverse.lanes.problem import Problem, problem_of
from kinematics.inverse.lanes.starts import first_start, later_starts
from kinematics.inverse.lanes.targets import FOUND
from kinematics.inverse.solver_constants import NUMERIC, unpacked
from kinematics.kernels import Array
from kinematics.lanes.memory import (
    STACK,
    Pointer,
    lane_memory,
    past,
    stack_memory,
    start_of,
    store,
)
from kinematics.lanes.vector import LANES, eight_lanes

CRITERIA = 4
"""Numbers of :attr:`kinematics.inverse.result.IKOptions.criteria`."""
FIRST_STEPS = 256
"""Steps after which :func:`solve_at_once` begins no new start: what takes longer begins anew."""


@inner
def _search(
    P: Array,
    problem: Problem,
    criteria: Criteria,
    G: Pointer,
    seed: Pointer,
    first: int,
    budget: int,
    answer: Pointer,
) -> tuple[int, int, int, float, float]:
    """Solve one target by starts first …; arguments and result as of :func:`solve_one`."""
    n = problem.n
    best = past(answer, n + 2)
    steps, s, last, converged = 0, first, 0, False
    if first == 0:
        steps, converged = first_start(problem, criteria, G, seed, best)
    if not converged:
        last, after = last_start(P, criteria, G), max(first, 1)
        if after <= last and steps < budget:
            more, s, converged = later_starts(
                problem, criteria, G, seed, after, last, budget - steps, best
            )
            steps += more
    code = CONVERGED if converged else GIVEN_UP if s >= last else OUT_OF_STEPS
    more, code = conclude(P, problem, criteria, G, seed, code, answer)
    return steps + more, s, code, answer[n], answer[n + 1]


@jit
def solve_one(
    P: Array, target: Array, seed: Array, first: int, budget: int, criteria: Array, answer: Array
) -> tuple[int, int, int, float, float]:
    """Solve one target, or go on with it: starts first …, until the budget of steps is spent.

    The closed form is asked first, then the numeric solver: its start 0 is the seed, start s the
    s-th point of the sequence.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        target: Pose of the frame in base axes, shape (4, 4).
        seed: In the chain's order, within the limits, rad and m; shape (K,).
        first: The start to begin with; above 0, the answer must be as the last call left it.
        budget: Steps after which no new start is begun.
        criteria: Squared tolerances, most steps of a start, most restarts; shape (4,).
        answer: Filled: q, its position and rotation error, then the best q of all starts, its
            energy and squared errors; shape (2 K + 5,).

    Returns:
        Steps, the start that came last, a code of :mod:`~.criteria`, and both errors, m and rad.
        After OUT_OF_STEPS the next start may follow.
    """
    ending, problem = criteria_from(criteria), problem_of(P)
    asked = int(P[2]) != NUMERIC and ending.steps > 0.0 and first == 0
    if asked and nearest_closed(unpacked(P), ending, target, seed, answer):
        return 0, 0, CONVERGED, answer[problem.n], answer[problem.n + 1]
    G, origin, result = start_of(target), start_of(seed), start_of(answer)
    return _search(P, problem, ending, G, origin, first, budget, result)


@jit
def solve_at_once(
    P: Array, target: Array, q: Array, given: bool
) -> tuple[int, int, int, float, float]:
    """Solve one target as :func:`solve_one` does from start 0 on, handing over less.

    An array costs as much to hand over as a third of a step, and memory as much again.

    Args:
        P: The criteria, the default seed, then constants of the chain; see
            :func:`~.solver_constants.packed`.
        target: Pose of the frame in base axes, shape (4, 4).
        q: Filled with the answer; shape (K,).
        given: Whether q holds the seed, in the chain's order, within the limits, rad and m.

    Returns:
        As :func:`solve_one`. After OUT_OF_STEPS, which leaves the seed in q, it is to be asked.
    """
    K = len(q)
    ending, constants = criteria_from(P), P[CRITERIA + K :]
    if not given:
        for k in range(K):
            q[k] = P[CRITERIA + k]
    if int(constants[2]) != NUMERIC and ending.steps > 0.0:
        answer = np.empty(K + 2)
        if nearest_closed(unpacked(constants), ending, target, q, answer):
            for k in range(K):
                q[k] = answer[k]
            return 0, 0, CONVERGED, answer[K], answer[K + 1]
    if 2 * K + 5 > STACK:
        return 0, 0, OUT_OF_STEPS, 0.0, 0.0
    G, seed, result = start_of(target), start_of(q), stack_memory()
    problem = problem_of(constants)
    found = _search(constants, problem, ending, G, seed, 0, FIRST_STEPS, result)
    if found[2] != OUT_OF_STEPS:
        for k in range(K):
            q[k] = result[k]
    return found


@jit
def conclude_many(
    P: Array, targets: Array, seed: Array, criteria: Array, answers: Array, ends: Array
) -> None:
    """Make answers of what the starts of many targets have found.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        targets: Poses of the frame in base axes, shape (n, 16).
        seed: Of all, shape (K,).
        criteria: Squared tolerances, most steps of a start, most restarts; shape (4,).
        answers: The best q of each; filled as ``answer`` of :func:`solve_one`; shape (n, 2 K + 5).
        ends: Codes from ``FOUND`` on become codes of answers; shape (n, 3).
    """
    ending, problem, like = criteria_from(criteria), problem_of(P), eight_lanes()
    n, origin, first = problem.n, start_of(seed), start_of(answers)
    memory = lane_memory(rows_of_room(n, problem.K), LANES)
    memory[:] = 0.0
    room = room_at(start_of(memory), n, problem.K, LANES)
    waiting, count = np.zeros(LANES, np.int64), 0
    for i in range(len(targets)):
        if ends[i, 2] >= FOUND:
            code, ends[i, 2] = ends[i, 2] - FOUND, CONVERGED
            G, answer = past(start_of(targets), 16 * i), past(first, i * (2 * n + 5))
            if code != CONVERGED:
                more, code = conclude(P, problem, ending, G, origin, code, answer)
                ends[i, 0] += more
                ends[i, 2] = code
            elif near_seed(problem, origin, answer):
                put_target(room, count, LANES, G, answer, n)
                for k in range(n):
                    room.q[k * LANES + count] = answer[k]
                waiting[count] = i
                count += 1
            else:
                answer[n], answer[n + 1] = (
                    math.sqrt(answer[2 * n + 3]),
                    math.sqrt(answer[2 * n + 4]),
                )
        if count == LANES or (count > 0 and i + 1 == len(targets)):
            _, _, positions, rotations = measure(problem, room, like)
            store(room.progress, 0, positions)
            store(room.progress, 1, rotations)
            for lane in range(count):
                position, rotation = room.progress[lane], room.progress[LANES + lane]
                G = past(start_of(targets), 16 * waiting[lane])
                errors = past(first, waiting[lane] * (2 * n + 5) + n)
                ends[waiting[lane], 2] = told(P, ending, G, CONVERGED, position, rotation, errors)
            count = 0
    memory[0, 0] = 0.0  # the memory is in use until here
