"""Compiled: the starts of one target, the first alone, later ones in lanes."""

from __future__ import annotations

import numpy as np

from kinematics.compiled import inner
from kinematics.inverse.criteria import Criteria
from kinematics.inverse.lanes.descent import (
    proceed,
    put_start,
    put_target,
    room_at,
    rows_of_room,
    steps_of,
)
from kinematics.inverse.lanes.problem import Problem
from kinematics.lanes.memory import Pointer, lane_memory, start_of
from kinematics.lanes.vector import LANES, eight_lanes, one_lane


@inner
def first_start(
    problem: Problem, criteria: Criteria, G: Pointer, seed: Pointer, best: Pointer
) -> tuple[int, bool]:
    """Work at the seed until it converges, stalls or is out of steps.

    Args:
        problem: The chain and the task.
        criteria: When it ends.
        G: Target, 12 numbers or more.
        seed: Shape (n,).
        best: Filled: the best q, its energy and its squared errors; shape (n + 3,).

    Returns:
        Steps, and whether it has converged.
    """
    n, K = problem.n, problem.K
    memory = np.empty(rows_of_room(n, K))
    room = room_at(start_of(memory), n, K, 1)
    put_target(room, 0, 1, G, seed, n)
    put_start(room, 0, 1, problem, 0, seed)
    converged = ended = 0
    while ended == 0:
        converged, ended = proceed(problem, criteria, room, 1, one_lane())
    for k in range(n + 3):
        best[k] = room.best[k]
    steps = steps_of(room, 0, 1)
    memory[0] = 0.0  # the memory is in use until here
    return steps, converged != 0


@inner
def later_starts(
    problem: Problem,
    criteria: Criteria,
    G: Pointer,
    seed: Pointer,
    first: int,
    last: int,
    budget: int,
    best: Pointer,
) -> tuple[int, int, bool]:
    """Work at starts first … last, eight at once, until one converges or the budget is spent.

    The first one in their order that converges is the answer, as if they were tried one after the
    other: a later one that is quicker waits for those before it.

    Args:
        problem: The chain and the task.
        criteria: When a start ends.
        G: Target, 12 numbers or more.
        seed: Shape (n,).
        first: Above 0.
        last: The last start that may be tried.
        budget: Steps after which no new start is begun.
        best: The best of the starts before; kept up to date.

    Returns:
        Steps of the starts up to the one that counts, its number, and whether it has converged.
    """
    n, K = problem.n, problem.K
    memory = lane_memory(rows_of_room(n, K), LANES)
    room = room_at(start_of(memory), n, K, LANES)
    for lane in range(LANES):
        put_target(room, lane, LANES, G, seed, n)
        put_start(room, lane, LANES, problem, 0, seed)
    numbers = np.zeros(LANES, np.int64)
    used = np.zeros(last - first + 1, np.int64)
    begun, spent, found, active = first, 0, -1, 0
    while True:
        for lane in range(LANES):
            if begun > last or spent + begun - first >= budget:
                break
            if (active >> lane) & 1 == 0:
                put_start(room, lane, LANES, problem, begun, seed)
                numbers[lane] = begun
                active |= 1 << lane
                begun += 1
        if active == 0:
            break
        converged, ended = proceed(problem, criteria, room, active, eight_lanes())
        for lane in range(LANES):
            if (ended >> lane) & 1 == 0 or numbers[lane] > last:
                continue
            steps = steps_of(room, lane, LANES)
            used[numbers[lane] - first] = steps
            spent += steps
            active &= ~(1 << lane)
            if (converged >> lane) & 1 != 0:
                found = numbers[lane]
                last = found - 1
                for k in range(n + 3):
                    best[k] = room.best[k * LANES + lane]
                for other in range(LANES):
                    if numbers[other] > last:
                        active &= ~(1 << other)
    steps = spent
    if found >= 0:
        steps = int(used[: found - first + 1].sum())
    for lane in range(LANES if found < 0 else 0):
        if room.best[n * LANES + lane] < best[n]:
            for k in range(n + 3):
                best[k] = room.best[k * LANES + lane]
    memory[0, 0] = 0.0  # the memory is in use until here
    return steps, int(found) if found >= 0 else begun - 1, found >= 0
