"""The whole of a solve, compiled: the closed form where there is one, then the numeric solver."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_form import Kind, parallel_axes, planar, spherical_wrist
from kinematics.inverse.closed_form.candidates import (
    WORK,
    Candidates,
    FormConstants,
    improve,
)
from kinematics.inverse.criteria import (
    CONVERGED,
    GIVEN_UP,
    OUT_OF_STEPS,
    Criteria,
    criteria_from,
    last_start,
    reached,
)
from kinematics.inverse.damped_least_squares import conclude, near_seed, told
from kinematics.inverse.damped_step import LOWER, TURN, UPPER
from kinematics.inverse.lanes.descent import measure, put_target, room_at, rows_of_room
from kinematics.inverse.lanes.problem import problem_of
from kinematics.inverse.lanes.starts import first_start, later_starts
from kinematics.inverse.lanes.targets import FOUND, PENDING
from kinematics.inverse.solver_constants import NUMERIC, SolverConstants, unpacked
from kinematics.inverse.task_error import residual
from kinematics.kernels import Array
from kinematics.lanes.memory import lane_memory, past, start_of, store
from kinematics.lanes.vector import LANES, eight_lanes

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
def _closed(
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
    if asked and _closed(unpacked(P), ending, target, seed, answer):
        return 0, 0, CONVERGED, answer[problem.n], answer[problem.n + 1]
    G, origin = start_of(target), start_of(seed)
    best = past(start_of(answer), problem.n + 2)
    last, steps, s, converged = last_start(P, ending, G), 0, first, False
    if first == 0:
        steps, converged = first_start(problem, ending, G, origin, best)
    after = max(first, 1)
    if not converged and after <= last and steps < budget:
        more, s, converged = later_starts(
            problem, ending, G, origin, after, last, budget - steps, best
        )
        steps += more
    code = CONVERGED if converged else GIVEN_UP if s >= last else OUT_OF_STEPS
    more, code = conclude(P, problem, ending, G, origin, code, start_of(answer))
    return steps + more, s, code, answer[problem.n], answer[problem.n + 1]


@jit
def solve_closed(
    P: Array, targets: Array, seed: Array, criteria: Array, answers: Array, ends: Array
) -> None:
    """Solve those of many targets that have a solution in closed form; mark the others.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        targets: Poses of the frame in base axes, shape (n, 4, 4).
        seed: Of all, shape (K,).
        criteria: Squared tolerances, most steps of a start, most restarts; shape (4,).
        answers: Filled as ``answer`` of :func:`solve_one`; shape (n, 2 K + 5).
        ends: Filled: steps, last start, code, which is ``PENDING`` of the others; shape (n, 3).
    """
    constants, ending = unpacked(P), criteria_from(criteria)
    asked = constants.kind != NUMERIC and ending.steps > 0.0
    for i in range(len(targets)):
        ends[i, 0] = ends[i, 1] = 0
        found = asked and _closed(constants, ending, targets[i], seed, answers[i])
        ends[i, 2] = CONVERGED if found else PENDING


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
