"""Singularity report: rank, lost directions and null motions at a q, in a task space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.jacobian import task_jacobian
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

RANK_TOLERANCE = 1e-10
TOLERANCE = Bounds(0.0, 1.0, upper_included=False)
"""Relative tolerance of a rank."""
SMALLEST = 1e-100
"""Singular values below count as zero at any tolerance, so that inverses stay finite."""


@dataclass(frozen=True)
class SingularityReport:
    """Singular value decomposition of the task Jacobian, interpreted.

    Attributes:
        task: The task space.
        rank: Number of singular values above ``tolerance`` times the largest (or 1 if smaller).
        singular_values: Descending, min(rows, dof) of them.
        condition_number: Largest over smallest; None where singular (it is infinite).
        manipulability: Yoshikawa's ``w = sqrt(det(J Jᵀ))``, the product of the singular values.
        lost_directions: Unit vectors of the task space that no joint motion yields; shape
            (rows - rank, rows). With fewer joints than rows, some are lost everywhere.
        null_motions: Unit joint motions that do not move the task; shape (dof - rank, dof).
        singular: True where the rank is below min(rows, dof).
        tolerance: The relative tolerance of the rank.
        warnings: Limits of the measures.
    """

    task: Task
    rank: int
    singular_values: FloatArray
    condition_number: float | None
    manipulability: float
    lost_directions: FloatArray
    null_motions: FloatArray
    singular: bool
    tolerance: float
    warnings: tuple[str, ...]


def singularity_report(
    robot: Robot,
    q: FloatArray,
    task: Task = POSE,
    frame: str | None = None,
    tolerance: float = RANK_TOLERANCE,
) -> SingularityReport:
    """Return the singularity report at one q.

    Args:
        robot: The robot.
        q: Shape (dof,), rad and m.
        task: The task space, in base axes.
        frame: Frame name; default the tip.
        tolerance: A singular value below ``tolerance * max(1, largest)`` counts as zero.

    Returns:
        The report.

    Raises:
        InvalidOption: The tolerance is not in 0 … 1, or 1.
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    return report_on(task_jacobian(robot, q, task, frame), robot, task, tolerance)


def peak_bytes(dof: int) -> int:
    """Return the bytes of the report at one q: its decomposition, and copies of null motions."""
    return 8 * (2 * dof**2 + 64) + 2_500


def report_on(
    J: FloatArray, robot: Robot, task: Task, tolerance: float = RANK_TOLERANCE
) -> SingularityReport:
    """Return the report on a task Jacobian, shape (rows, dof); see :func:`singularity_report`."""
    check_tolerance(tolerance)
    U, sigma, Vt = np.linalg.svd(J)
    rank = int(rank_of(sigma, tolerance))
    singular = rank < len(sigma)
    return SingularityReport(
        task=task,
        rank=rank,
        singular_values=sigma,
        condition_number=None if singular else float(sigma[0] / sigma[-1]),
        manipulability=float(np.prod(sigma)),
        lost_directions=signed(U[:, rank:].T),
        null_motions=signed(Vt[rank:]),
        singular=singular,
        tolerance=tolerance,
        warnings=unit_warnings(robot, task),
    )


def check_tolerance(tolerance: float) -> None:
    """Refuse a tolerance of a rank that is out of range.

    Raises:
        InvalidOption: It is not in 0 … 1, or 1.
    """
    if tolerance not in TOLERANCE:
        raise TOLERANCE.refusal(
            say("tolerance is {tolerance:g}; give 0 up to below 1", tolerance=tolerance),
            tolerance,
            "tolerance",
        )


def rank_of(sigma: FloatArray, tolerance: float = RANK_TOLERANCE) -> NDArray[np.intp]:
    """Return the number of singular values above ``tolerance * max(1, largest)``; shape (...)."""
    threshold = np.maximum(tolerance * np.maximum(1.0, sigma[..., :1]), SMALLEST)
    return np.asarray(np.count_nonzero(sigma > threshold, axis=-1))


def signed(vectors: FloatArray) -> FloatArray:
    """Return each vector with its first significant entry positive, so that signs are stable."""
    vectors = np.where(np.abs(vectors) < 1e-14, 0.0, vectors)
    for vector in vectors:
        significant = np.flatnonzero(np.abs(vector) > 1e-9)
        if significant.size and vector[significant[0]] < 0:
            vector *= -1.0
    return vectors + 0.0


def unit_warnings(robot: Robot, task: Task) -> tuple[str, ...]:
    """Return warnings about mixed units of the measures of a robot in a task."""
    found = []
    mixed = bool(task.positions) and bool(task.rotations)
    if mixed or (robot.is_revolute.any() and not robot.is_revolute.all()):
        found.append(
            say(
                "manipulability and condition number mix metres and radians; compare"
                " them only on the same robot and task, or choose a task such as"
                " position"
            )
        )
    if robot.dof < len(task.rows):
        found.append(
            say(
                "the robot has {dof} joints for {count} task rows: some directions are"
                " lost everywhere and its singularities stay hidden; choose a smaller"
                " task such as xy, position or xy_phi",
                dof=robot.dof,
                count=len(task.rows),
            )
        )
    return tuple(found)
