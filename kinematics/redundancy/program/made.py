"""The program of a whole path, made from its problem."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.redundancy.clearance import obstacles
from kinematics.redundancy.clearance.link_points import OFFSET, RADIUS, WHOLE
from kinematics.redundancy.clearance.sweep import RESOLUTION
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.program.data import (
    BOX,
    CAPSULE,
    CIRCLE,
    HALF_SPACE,
    SPHERE,
    ProgramData,
    Segment,
    Solid,
)
from robots.robot import FloatArray

KINDS = {
    obstacles.SPHERE: SPHERE,
    obstacles.CIRCLE: CIRCLE,
    obstacles.CAPSULE: CAPSULE,
    obstacles.HALF_SPACE: HALF_SPACE,
    obstacles.BOX: BOX,
}


def program_data(
    problem: PathProblem,
    options: PathOptions,
    between: Sequence[tuple[int, float]] = (),
) -> ProgramData:
    """Return what the program of a problem is made from.

    Args:
        problem: The path problem.
        options: Its options.
        between: Places k + s between samples k and k + 1 at which clearances are kept too.
    """
    arm, chain = problem.arm, problem.arm.chain
    return ProgramData(
        first=departure(problem, options),
        targets=problem.path.targets[1:],
        placements=chain.placements,
        is_revolute=tuple(bool(one) for one in chain.is_revolute),
        coupling=chain.coupling if chain.is_coupled else None,
        offset=chain.offset,
        rows=_rows_moved(problem),
        own_axes=arm.task.own_axes,
        segments=tuple(_segment(row) for row in problem.links.rows),
        solids=tuple(Solid(KINDS[row[0]], row) for row in problem.obstacles),
        need=problem.d_safe + max(options.margin, 2 * RESOLUTION),
        need_between=problem.d_safe + 0.25 * options.margin + 2 * RESOLUTION,
        between=tuple(between),
        most_per_step=problem.most_per_step,
        lower=chain.lower,
        upper=chain.upper,
    )


def _segment(row: FloatArray) -> Segment:
    offsets = row[OFFSET : OFFSET + 6].reshape(2, 3).copy()
    return Segment((int(row[0]), int(row[1])), offsets, float(row[RADIUS]), bool(row[WHOLE]))


def _rows_moved(problem: PathProblem) -> tuple[int, ...]:
    """Return the rows of the task that the arm can move: others have no gradient."""
    arm = problem.arm
    k = np.arange(arm.K)
    moved = np.zeros(arm.m)
    for phase in (1.0, 2.0):
        q = problem.first + 0.3 * np.sin(phase + 2.0 * k)
        _, J, _ = arm.task_at(q, problem.path.targets[0])
        moved = np.maximum(moved, np.abs(J).max(axis=1))
    return tuple(row for row, m in zip(arm.task.rows, moved, strict=True) if m > 1e-12)
