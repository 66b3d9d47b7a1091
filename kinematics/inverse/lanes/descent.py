"""Compiled: one step of a start in every lane, its progress, and the best that each has found."""

from __future__ import annotations

import math
from typing import NamedTuple

from kinematics.compiled import inner
from kinematics.inverse.criteria import DAMPING, FLOOR, STALL_RATIO, STALLS, Criteria
from kinematics.inverse.lanes.error import Error, task_error
from kinematics.inverse.lanes.problem import Problem
from kinematics.inverse.lanes.step import counted, step
from kinematics.lanes.memory import Pointer, load, past, store
from kinematics.lanes.vector import Vector, bits, mask_of, one_lane, select, smaller, splat
from kinematics.lanes.walk import Pose, columns, trigonometry_of, walk

# Rows of progress.
LOWEST = 0
"""The lowest energy of a start."""
STALLED = 1
"""Steps without a better one."""
STEPS = 2
"""Steps."""


class Room(NamedTuple):
    """Lane memory for n unknowns of a chain of K joints, by addresses.

    Attributes:
        q: Unknowns, n rows.
        moves: Their steps, n rows.
        values: Joint values of a coupled chain, K rows.
        axes: Axes of the joints, then Jacobian columns, 6 K rows.
        sums: Columns of a coupled chain, 6 n rows.
        target: 12 rows.
        progress: 3 rows.
        best: The best q of all starts, its energy ``½ eᵀe`` and its squared errors, n + 3 rows.
    """

    q: Pointer
    moves: Pointer
    values: Pointer
    axes: Pointer
    sums: Pointer
    target: Pointer
    progress: Pointer
    best: Pointer


@inner
def rows_of_room(n: int, K: int) -> int:
    """Return how many rows of lane memory a room takes."""
    return 9 * n + 7 * K + 18


@inner
def room_at(start: Pointer, n: int, K: int, width: int) -> Room:
    """Return a room in lane memory of so many rows."""
    values = 2 * n
    axes, sums = values + K, values + 7 * K
    target = sums + 6 * n
    progress, best = target + 12, target + 15
    return Room(
        start,
        past(start, n * width),
        past(start, values * width),
        past(start, axes * width),
        past(start, sums * width),
        past(start, target * width),
        past(start, progress * width),
        past(start, best * width),
    )


@inner
def put_target(room: Room, lane: int, width: int, G: Pointer, seed: Pointer, n: int) -> None:
    """Let a lane work at a target, 12 numbers or more: nothing is found yet."""
    for i in range(12):
        room.target[i * width + lane] = G[i]
    for k in range(n):
        room.best[k * width + lane] = seed[k]
    room.best[n * width + lane] = math.inf


@inner
def put_start(room: Room, lane: int, width: int, problem: Problem, s: int, seed: Pointer) -> None:
    """Let a lane begin start s: the seed, or the s-th point of the sequence."""
    starts, n = problem.starts, problem.n
    for k in range(n):
        if s == 0:
            room.q[k * width + lane] = seed[k]
        else:
            u = starts[k] + s * starts[n + k]
            room.q[k * width + lane] = starts[2 * n + k] + (u - math.floor(u)) * starts[3 * n + k]
    room.progress[LOWEST * width + lane] = math.inf
    room.progress[STALLED * width + lane] = 0.0
    room.progress[STEPS * width + lane] = 0.0


@inner
def steps_of(room: Room, lane: int, width: int) -> int:
    """Return the steps that the start in a lane has taken."""
    return int(room.progress[STEPS * width + lane])


@inner
def _joint_values(problem: Problem, q: Pointer, values: Pointer, like: Vector) -> None:
    for k in range(problem.K):
        value = splat(problem.offset[k], like)
        for j in range(problem.n):
            value = value + load(q, j, like) * problem.coupling[k * problem.n + j]
        store(values, k, value)


@inner
def measure(problem: Problem, room: Room, like: Vector) -> tuple[Pose, Error, Vector, Vector]:
    """Return pose and task error of every lane at its q, and the squares of both errors."""
    values = room.q
    if problem.is_coupled:
        _joint_values(problem, room.q, room.values, like)
        values = room.values
    return _measured(
        problem, room, walk(problem.links, problem.K, values, None, room.axes, like), like
    )


@inner
def measure_alone(
    problem: Problem, room: Room, trig: Pointer, memory: Pointer
) -> tuple[Pose, Error, Vector, Vector]:
    """Do what :func:`measure` does, with the same results, in the one lane of a room.

    Args:
        problem: The chain and the task.
        room: Of width 1.
        trig: 2 K numbers.
        memory: 32 numbers.
    """
    like, values = one_lane(), room.q
    if problem.is_coupled:
        _joint_values(problem, room.q, room.values, like)
        values = room.values
    trigonometry_of(problem.links, problem.K, values, memory, trig)
    pose = walk(problem.links, problem.K, values, trig, room.axes, like)
    return _measured(problem, room, pose, like)


@inner
def _measured(
    problem: Problem, room: Room, pose: Pose, like: Vector
) -> tuple[Pose, Error, Vector, Vector]:
    e = task_error(pose, room.target, problem.mask, like)
    position = e[0] * e[0] + e[1] * e[1] + e[2] * e[2]
    rotation = e[3] * e[3] + e[4] * e[4] + e[5] * e[5]
    return pose, e, position, rotation


@inner
def move(
    problem: Problem, room: Room, pose: Pose, e: Error, damping: Vector, going: int, like: Vector
) -> None:
    """Take a damped step from what :func:`measure` returned, in the lanes that go on."""
    columns(problem.links, problem.K, room.axes, pose, like)
    counted(problem, room.axes, pose, room.sums, like)
    step(problem, room.axes, e, damping, going, room.q, room.moves, like)


@inner
def proceed(
    problem: Problem, criteria: Criteria, room: Room, active: int, like: Vector
) -> tuple[int, int]:
    """Measure every lane at its q, then take a step in those that go on.

    A start ends where it has converged, stalled, or is out of steps. What a lane does depends on
    nothing in the other lanes.

    Args:
        problem: The chain and the task.
        criteria: When a start ends.
        room: The lanes.
        active: The lanes that work, as bits.
        like: A vector of the width.

    Returns:
        As bits: the lanes that have converged, and those whose start has ended.
    """
    n = problem.n
    pose, e, position, rotation = measure(problem, room, like)
    energy = 0.5 * (position + rotation)
    reached = (position <= criteria.position) & (rotation <= criteria.rotation)
    converged = bits(reached) & active
    better = (bits(energy < load(room.best, n, like)) | converged) & active
    if better != 0:
        chosen = mask_of(better, like)
        for k in range(n):
            kept = load(room.best, k, like)
            store(room.best, k, select(chosen, load(room.q, k, like), kept))
        store(room.best, n, select(chosen, energy, load(room.best, n, like)))
        store(room.best, n + 1, select(chosen, position, load(room.best, n + 1, like)))
        store(room.best, n + 2, select(chosen, rotation, load(room.best, n + 2, like)))
    lowest, taken = load(room.progress, LOWEST, like), load(room.progress, STEPS, like)
    stalled = load(room.progress, STALLED, like) + 1.0
    stalled = select(energy < STALL_RATIO * lowest, 0.0, stalled)
    ended = (bits((stalled >= STALLS) | (taken >= criteria.steps)) | converged) & active
    going = active & ~ended
    if going != 0:
        move(problem, room, pose, e, DAMPING * energy + FLOOR, going, like)
        store(room.progress, LOWEST, smaller(energy, lowest))
        store(room.progress, STALLED, stalled)
        moved = mask_of(going, like)
        store(room.progress, STEPS, select(moved, taken + 1.0, taken))
    return converged, ended
