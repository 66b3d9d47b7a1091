"""Statics: joint torques of a wrench, τ = Jᵀ w, and the wrench of joint torques.

No gravity: the wrench is the force and moment that the frame exerts on its surroundings at rest,
taken at the same point and in the same axes as the twist of that reference frame, so that
``w · twist = τ · qd``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.configuration import configuration
from kinematics.deadline import checked, svd
from kinematics.jacobian import ReferenceFrame, jacobian, task_jacobian
from kinematics.jacobian import peak_bytes as jacobian_bytes
from kinematics.singularity import RANK_TOLERANCE, rank_of, signed
from kinematics.spatial_vectors import WRENCH_ROWS, check_same_length, spatial_vector
from kinematics.task import POSE, Task
from kinematics.velocity import check_options
from robots.robot import FloatArray, Robot


@dataclass(frozen=True, eq=False)
class Wrench:
    """The wrench that joint torques hold; every field has a leading axis n for a batch.

    Attributes:
        wrench: One entry per task row, N and N m, shape (m,) or (n, m); the others are taken as
            zero. Of wrenches that differ by ``lost_directions``, that of least norm.
        residual: Torques that no wrench of the task balances, ``Jᵀ w - τ``, shape (dof,) or
            (n, dof), N m and N; they would move the arm.
        rank: Rank of the task Jacobian.
        determined: True where the rank is the number m of task rows: the wrench is unique.
        lost_directions: Unit wrenches that the structure carries without torques, shape
            (m - rank, m); for a batch a list of such arrays.
    """

    wrench: FloatArray
    residual: FloatArray
    rank: NDArray[np.intp]
    determined: NDArray[np.bool_]
    lost_directions: list[FloatArray]


def joint_torques(
    robot: Robot,
    q: FloatArray,
    wrench: FloatArray,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
) -> FloatArray:
    """Return the joint torques (forces of prismatic joints) of a wrench, ``τ = J(q)ᵀ w``.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        wrench: Force then moment, shape (6,) or (n, 6), N and N m.
        frame: Frame name; default the tip.
        reference_frame: Where and in which axes the wrench is taken: ``world`` means moments
            about the base's origin, the others about the frame's origin.

    Returns:
        Shape (dof,), or (n, dof) where q or wrench is a batch; N m and N.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
        WrongVector: wrench has a wrong shape or is not finite.
    """
    J = jacobian(robot, q, frame, reference_frame)
    wrench = spatial_vector(wrench, WRENCH_ROWS, "wrench")
    check_same_length(np.asarray(q), wrench, "wrench")
    return np.asarray((np.swapaxes(J, -1, -2) @ wrench[..., None])[..., 0])


def wrench_bytes(dof: int) -> int:
    """Return the bytes for each q of a batch: decomposed Jacobians, and lost directions."""
    return jacobian_bytes(dof) + 8 * (2 * dof**2 + 8 * dof + 50)


def wrench_of(
    robot: Robot,
    q: FloatArray,
    tau: FloatArray,
    task: Task = POSE,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
    *,
    tolerance: float = RANK_TOLERANCE,
) -> Wrench:
    """Return the wrench that given joint torques hold at a frame, ``w = (Jᵀ)† τ``.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        tau: Joint torques and forces, shape (dof,) or (n, dof), N m and N.
        task: Rows in which there is a wrench, in the axes of the reference frame.
        frame: Frame name; default the tip.
        reference_frame: Where and in which axes the wrench is taken.
        tolerance: A singular value below ``tolerance * max(1, largest)`` counts as zero.

    Returns:
        The wrench, with the residual measured on the model.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q or tau has a wrong shape or is not finite.
        WrongVector: Batches of unequal length.
        InvalidOption: tolerance out of range.
    """
    check_options(0.0, tolerance)
    J = task_jacobian(robot, q, task, frame, reference_frame)
    tau = configuration(robot, tau, "tau")
    check_same_length(np.asarray(q), tau, "tau")
    U, sigma, Vt = svd(J)
    r = sigma.shape[-1]
    rank = rank_of(sigma, tolerance)
    counts = np.arange(r) < rank[..., None]
    gain = np.where(counts, 1.0 / np.where(counts, sigma, 1.0), 0.0)
    wrench = (U[..., :r] @ (gain[..., None] * (Vt[..., :r, :] @ tau[..., None])))[..., 0]
    m = len(task.rows)
    return Wrench(
        wrench=wrench,
        residual=(np.swapaxes(J, -1, -2) @ wrench[..., None])[..., 0] - tau,
        rank=rank,
        determined=rank == m,
        lost_directions=[
            signed(u[:, k:].T)
            for u, k in checked(zip(U.reshape(-1, m, m), rank.reshape(-1), strict=True))
        ],
    )
