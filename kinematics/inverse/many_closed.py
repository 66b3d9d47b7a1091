"""Compiled: many targets by their closed form, eight at once where all is plain."""

from __future__ import annotations

import math

from kinematics.compiled import inner, jit
from kinematics.inverse.closed_form import parallel_axes, planar
from kinematics.inverse.closed_form.candidates import ACCEPTED, DAMPING, ENOUGH, STEPS
from kinematics.inverse.closed_form.lanes.nearest import Chosen, Joints
from kinematics.inverse.closed_form.lanes.parallel_axes import parallel_forms
from kinematics.inverse.closed_form.lanes.planar import planar_forms
from kinematics.inverse.closed_form.lanes.wrist import ARM, ARMS, wrist_forms
from kinematics.inverse.closed_form.regional import COLUMN, ELBOW, SHOULDER, VARIANT
from kinematics.inverse.closed_solve import (
    PARALLEL_AXES,
    PLANAR,
    SPHERICAL_WRIST,
    nearest_closed,
)
from kinematics.inverse.criteria import CONVERGED, Criteria, criteria_from
from kinematics.inverse.lanes.descent import Room, measure, room_at, rows_of_room
from kinematics.inverse.lanes.problem import Problem, problem_of
from kinematics.inverse.lanes.step import counted, step
from kinematics.inverse.lanes.targets import PENDING
from kinematics.inverse.solver_constants import NUMERIC, layout_of, unpacked
from kinematics.kernels import Array
from kinematics.lanes.memory import Pointer, lane_memory, load, past, start_of, store
from kinematics.lanes.vector import (
    LANES,
    Vector,
    bits,
    eight_lanes,
    mask_of,
    select,
    splat,
    square_root,
)
from kinematics.lanes.walk import columns

LEAST_SHARP = 1e-3
"""How sharp a solution has to be, lest rounding move it by more than 1e-12."""


@inner
def _are_in_lanes(kind: int, numbers: Pointer) -> bool:
    """Return whether the closed form of an arm is one of those in lanes."""
    if kind == SPHERICAL_WRIST:
        variant = numbers[VARIANT]
        return bool(variant in (ELBOW, SHOULDER, COLUMN))
    if kind == PARALLEL_AXES:
        return bool(numbers[parallel_axes.MEETS] == 1.0)
    return bool(kind == PLANAR and numbers[planar.PAIR] == planar.TURN_TURN)


@inner
def _solve_lanes(
    kind: int,
    numbers: Pointer,
    problem: Problem,
    joints: Joints,
    criteria: Criteria,
    room: Room,
    arms: Pointer,
    like: Vector,
) -> int:
    """Solve the targets in a room.

    Returns:
        As bits, those of which the nearest solution is certain and reaches the target: its q is
        then in ``room.q``, its errors in the first rows of the progress. The others are for scalar
        code.
    """
    chosen = Chosen(splat(math.inf, like), splat(0.0, like), like < 0.0)
    if kind == SPHERICAL_WRIST:
        chosen = wrist_forms(joints, numbers, room.target, arms, chosen, like)
    elif kind == PARALLEL_AXES:
        chosen = parallel_forms(joints, numbers, room.target, chosen, like)
    else:
        chosen = planar_forms(joints, numbers, room.target, chosen, like)
    certain = (chosen.distance < math.inf) & ~chosen.unsure & (chosen.sharp > LEAST_SHARP)
    position, rotation = _improve(problem, room, bits(certain), like)
    store(room.progress, 0, position)
    store(room.progress, 1, rotation)
    good = certain & (position + rotation <= ACCEPTED)
    good = good & (position * position <= criteria.position)
    return int(bits(good & (rotation * rotation <= criteria.rotation)))


@inner
def _improve(problem: Problem, room: Room, lanes: int, like: Vector) -> tuple[Vector, Vector]:
    """Bring every q in a room closer to its target where it can be, and measure it.

    The lanes of :func:`kinematics.inverse.closed_form.candidates.improve`.

    Args:
        problem: The chain and the task.
        room: The lanes; its q is changed in place.
        lanes: Those that count, as bits.
        like: A vector of the width.

    Returns:
        Norms of the position error, m, and of the rotation error, rad.
    """
    K, going = problem.K, lanes
    best = position = rotation = splat(math.inf, like)
    for attempt in range(STEPS + 1):
        pose, e, positions, rotations = measure(problem, room, like)
        first, second = square_root(positions), square_root(rotations)
        error = first + second
        better = bits(error < best) & going
        if better != going:  # a step that was none
            back = mask_of(going & ~better, like)
            for k in range(K):
                store(room.q, k, select(back, load(room.best, k, like), load(room.q, k, like)))
        chosen = mask_of(better, like)
        going = better & ~bits((error <= ENOUGH) | (error > 0.5 * best))
        best = select(chosen, error, best)
        position, rotation = select(chosen, first, position), select(chosen, second, rotation)
        if going == 0 or attempt == STEPS:
            break
        for k in range(K):
            store(room.best, k, load(room.q, k, like))
        columns(problem.links, K, room.axes, pose, like)
        counted(problem, room.axes, pose, room.sums, like)
        total = splat(1e-300, like)
        for i in range(6 * K):
            total = total + load(room.axes, i, like) * load(room.axes, i, like)
        step(problem, room.axes, e, DAMPING * total, going, room.q, room.moves, like)
    return position, rotation


@jit
def solve_closed(
    P: Array, targets: Array, seed: Array, criteria: Array, answers: Array, ends: Array
) -> None:
    """Solve those of many targets that have a solution in closed form; mark the others.

    The answer to a target depends neither on its lane nor on the targets beside it.

    Args:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        targets: Poses of the frame in base axes, shape (n, 4, 4).
        seed: Of all, shape (K,).
        criteria: Squared tolerances, most steps of a start, most restarts; shape (4,).
        answers: Filled as ``answer`` of :func:`~.compiled_solve.solve_one`; shape (n, 2 K + 5).
        ends: Filled: steps, last start, code, which is ``PENDING`` of the others; shape (n, 3).
    """
    constants, problem, ending = unpacked(P), problem_of(P), criteria_from(criteria)
    at, like, n, K = layout_of(P), eight_lanes(), len(targets), problem.K
    asked = constants.kind != NUMERIC and ending.steps > 0.0
    numbers, rows = past(start_of(P), at.form), rows_of_room(K, K)
    memory = lane_memory(rows + ARMS * ARM, LANES)
    memory[:] = 0.0
    room = room_at(start_of(memory), K, K, LANES)
    arms = past(start_of(memory), rows * LANES)
    turns = past(start_of(P), at.turns)
    joints = Joints(K, problem.limits, turns, start_of(seed), room.moves, room.q)
    in_lanes = asked and _are_in_lanes(constants.kind, numbers)
    for i in range(0, n, LANES):
        done = 0
        if in_lanes:
            for lane in range(LANES):
                G = past(start_of(targets), 16 * min(i + lane, n - 1))
                for k in range(12):
                    room.target[k * LANES + lane] = G[k]
            done = _solve_lanes(constants.kind, numbers, problem, joints, ending, room, arms, like)
        for lane in range(min(LANES, n - i)):
            row = i + lane
            ends[row, 0] = ends[row, 1] = 0
            if (done >> lane) & 1 != 0:
                for k in range(K):
                    answers[row, k] = room.q[k * LANES + lane]
                answers[row, K] = room.progress[lane]
                answers[row, K + 1] = room.progress[LANES + lane]
                found = True
            else:
                found = asked and nearest_closed(
                    constants, ending, targets[row], seed, answers[row]
                )
            ends[row, 2] = CONVERGED if found else PENDING
    memory[0, 0] = 0.0  # the memory is in use until here
