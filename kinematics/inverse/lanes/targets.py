"""Compiled: many targets, eight at once; a lane whose target is done takes the next one."""

from __future__ import annotations

from kinematics.compiled import inner, jit
from kinematics.inverse.criteria import (
    CONVERGED,
    GIVEN_UP,
    OUT_OF_STEPS,
    criteria_from,
    last_start,
)
from kinematics.inverse.lanes.descent import (
    Room,
    proceed,
    put_start,
    put_target,
    room_at,
    rows_of_room,
    steps_of,
)
from kinematics.inverse.lanes.problem import problem_of
from kinematics.kernels import Array
from kinematics.lanes.memory import past, start_of
from kinematics.lanes.vector import LANES, eight_lanes

PENDING = -1
"""Code of a target that is not solved yet."""
FOUND = 8
"""Added to a code until the answer is measured."""

# Rows of the state of the lanes, shape (5, LANES).
ROW = 0
"""The row of its target."""
START = 1
"""Its start."""
SPENT = 2
"""Steps of all its starts."""
LAST = 3
"""The last start that it may try."""
ACTIVE = 4
"""In the first number the lanes that work, as bits."""
ALL = (1 << LANES) - 1


@inner
def _hand_in(
    room: Room, n: int, lane: int, code: int, state: Array, answers: Array, ends: Array
) -> None:
    """Write what a lane has found into the row of its target."""
    i = state[ROW, lane]
    found = past(start_of(answers), i * (2 * n + 5) + n + 2)
    for k in range(n + 3):
        found[k] = room.best[k * LANES + lane]
    ends[i, 0], ends[i, 1], ends[i, 2] = state[SPENT, lane], state[START, lane], FOUND + code
    state[ACTIVE, 0] &= ~(1 << lane)


@jit
def advance(
    P: Array,
    targets: Array,
    seed: Array,
    criteria: Array,
    budget: int,
    rows: Array,
    passes: int,
    memory: Array,
    state: Array,
    answers: Array,
    ends: Array,
) -> int:
    """Work at targets until so many passes are made, or there are none left to take.

    The answer to a target does not depend on the lane, nor on the targets beside it.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        targets: Poses of the frame in base axes, shape (n, 16).
        seed: First start of all, shape (K,).
        criteria: See :attr:`kinematics.inverse.result.IKOptions.criteria`.
        budget: Steps of a target after which no new start is begun.
        rows: The first and the last but one of the targets to take; whether to finish those that
            are begun where none is left; whether to give up all that are begun. Shape (4,).
        passes: Most steps of each lane.
        memory: Lane memory of :func:`memory_rows` rows, kept between calls.
        state: Zeros at first, kept between calls; shape (5, LANES).
        answers: Filled: in its last columns the best q, its energy and squared errors; shape
            (n, 2 K + 5).
        ends: Those with the code ``PENDING`` are worked at. Filled: steps, last start, ``FOUND`` +
            code; shape (n, 3).

    Returns:
        The next target to take.
    """
    problem, ending, like = problem_of(P), criteria_from(criteria), eight_lanes()
    n, origin = problem.n, start_of(seed)
    room = room_at(start_of(memory), n, problem.K, LANES)
    row, end, is_last, stop = rows[0], rows[1], rows[2] != 0, rows[3] != 0
    if stop:
        for lane in range(LANES):
            if (state[ACTIVE, 0] >> lane) & 1 != 0:
                _hand_in(room, n, lane, OUT_OF_STEPS, state, answers, ends)
        return int(row)
    for _ in range(passes):
        if state[ACTIVE, 0] != ALL:
            for lane in range(LANES):
                if (state[ACTIVE, 0] >> lane) & 1 != 0:
                    continue
                while row < end and ends[row, 2] != PENDING:
                    row += 1
                if row >= end:
                    break
                G = past(start_of(targets), row * 16)
                put_target(room, lane, LANES, G, origin, n)
                put_start(room, lane, LANES, problem, 0, origin)
                state[ROW, lane], state[START, lane], state[SPENT, lane] = row, 0, 0
                state[LAST, lane] = last_start(P, ending, G)
                state[ACTIVE, 0] |= 1 << lane
                row += 1
            if state[ACTIVE, 0] == 0 or (state[ACTIVE, 0] != ALL and not is_last):
                break
        converged, ended = proceed(problem, ending, room, state[ACTIVE, 0], like)
        if ended == 0:
            continue
        for lane in range(LANES):
            if (ended >> lane) & 1 == 0:
                continue
            state[SPENT, lane] += steps_of(room, lane, LANES)
            s = state[START, lane]
            if (converged >> lane) & 1 != 0:
                _hand_in(room, n, lane, CONVERGED, state, answers, ends)
            elif s >= state[LAST, lane]:
                _hand_in(room, n, lane, GIVEN_UP, state, answers, ends)
            elif state[SPENT, lane] + s >= budget:
                _hand_in(room, n, lane, OUT_OF_STEPS, state, answers, ends)
            else:
                state[START, lane] = s + 1
                put_start(room, lane, LANES, problem, s + 1, origin)
    return int(row)


@jit
def memory_rows(n: int, K: int) -> int:
    """Return how many rows of lane memory :func:`advance` takes."""
    return rows_of_room(n, K)
