"""Compiled: the starts of one target, the first alone, later ones in lanes."""

from __future__ import annotations

import math

import numpy as np

from kinematics.compiled import inner
from kinematics.inverse.criteria import (
    DAMPING,
    FLOOR,
    STALL_RATIO,
    STALLS,
    Criteria,
    reached,
)
from kinematics.inverse.lanes.descent import (
    measure_alone,
    move,
    proceed,
    put_start,
    put_target,
    room_at,
    rows_of_room,
    steps_of,
)
from kinematics.inverse.lanes.problem import Problem
from kinematics.lanes.memory import STACK, Pointer, lane_memory, past, stack_memory, start_of
from kinematics.lanes.vector import FEW, first_of, four_lanes, one_lane


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
    rows = rows_of_room(problem.n, problem.K) + 2 * problem.K + 32
    if rows <= STACK:
        return _first_start(problem, criteria, G, seed, best, stack_memory())
    memory = np.empty(rows)
    steps, converged = _first_start(problem, criteria, G, seed, best, start_of(memory))
    memory[0] = 0.0  # the memory is in use until here
    return steps, converged


@inner
def _first_start(
    problem: Problem, criteria: Criteria, G: Pointer, seed: Pointer, best: Pointer, memory: Pointer
) -> tuple[int, bool]:
    """Do what :func:`~.descent.proceed` does in a lane, with floats where there is one."""
    n = problem.n
    trig = past(memory, 32)
    room = room_at(past(trig, 2 * problem.K), n, problem.K, 1)
    put_target(room, 0, 1, G, seed, n)
    for k in range(n):
        room.q[k] = best[k] = seed[k]
    best[n] = lowest = math.inf
    stalled = steps = 0
    while True:
        pose, e, positions, rotations = measure_alone(problem, room, trig, memory)
        energies = 0.5 * (positions + rotations)
        position, rotation, energy = first_of(positions), first_of(rotations), first_of(energies)
        converged = reached(criteria, position, rotation)
        if converged or energy < best[n]:
            for k in range(n):
                best[k] = room.q[k]
            best[n], best[n + 1], best[n + 2] = energy, position, rotation
        stalled = 0 if energy < STALL_RATIO * lowest else stalled + 1
        if converged or stalled >= STALLS or steps >= criteria.steps:
            return steps, converged
        move(problem, room, pose, e, DAMPING * energies + FLOOR, 1, one_lane())
        lowest = min(energy, lowest)
        steps += 1


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
    """Work at starts first … last, four at once, until one converges or the budget is spent.

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
    memory = lane_memory(rows_of_room(n, K), FEW)
    room = room_at(start_of(memory), n, K, FEW)
    for lane in range(FEW):
        put_target(room, lane, FEW, G, seed, n)
        put_start(room, lane, FEW, problem, 0, seed)
    numbers = np.zeros(FEW, np.int64)
    used = np.zeros(last - first + 1, np.int64)
    begun, spent, found, active = first, 0, -1, 0
    while True:
        for lane in range(FEW):
            if begun > last or spent + begun - first >= budget:
                break
            if (active >> lane) & 1 == 0:
                put_start(room, lane, FEW, problem, begun, seed)
                numbers[lane] = begun
                active |= 1 << lane
                begun += 1
        if active == 0:
            break
        converged, ended = proceed(problem, criteria, room, active, four_lanes())
        for lane in range(FEW):
            if (ended >> lane) & 1 == 0 or numbers[lane] > last:
                continue
            steps = steps_of(room, lane, FEW)
            used[numbers[lane] - first] = steps
            spent += steps
            active &= ~(1 << lane)
            if (converged >> lane) & 1 != 0:
                found = numbers[lane]
                last = found - 1
                for k in range(n + 3):
                    best[k] = room.best[k * FEW + lane]
                for other in range(FEW):
                    if numbers[other] > last:
                        active &= ~(1 << other)
    steps = spent
    if found >= 0:
        steps = int(used[: found - first + 1].sum())
    for lane in range(FEW if found < 0 else 0):
        if room.best[n * FEW + lane] < best[n]:
            for k in range(n + 3):
                best[k] = room.best[k * FEW + lane]
    memory[0, 0] = 0.0  # the memory is in use until here
    return steps, int(found) if found >= 0 else begun - 1, found >= 0
