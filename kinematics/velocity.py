"""Differential kinematics: twist of joint velocities, and joint velocities for a twist."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.configuration import configuration
from kinematics.deadline import checked, svd
from kinematics.jacobian import ReferenceFrame, jacobian, task_jacobian
from kinematics.jacobian import peak_bytes as jacobian_bytes
from kinematics.singularity import RANK_TOLERANCE, check_tolerance, rank_of, signed
from kinematics.spatial_vectors import check_same_length, spatial_vector
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

DAMPING = Bounds(1e-12, 1e6)
"""Bounds of λ, in the units of the Jacobian; 0, the pseudo-inverse, is accepted as well."""


@dataclass(frozen=True, eq=False)
class JointVelocities:
    """Joint velocities for a twist; every field has a leading axis n for a batch.

    Attributes:
        qd: Joint velocities, rad/s and m/s, shape (dof,) or (n, dof).
        residual: Error on the model, ``J qd - twist``, m/s and rad/s, shape (m,) or (n, m).
        rank: Rank of the task Jacobian.
        determined: True where the rank is the number m of task rows, so that every twist is
            possible.
        null_motions: Unit joint velocities that add nothing to the twist, shape (dof - rank, dof);
            for a batch a list of such arrays.
        within_velocity_limits: Whether no joint exceeds its speed limit.
    """

    qd: FloatArray
    residual: FloatArray
    rank: NDArray[np.intp]
    determined: NDArray[np.bool_]
    null_motions: list[FloatArray]
    within_velocity_limits: NDArray[np.bool_]


def twist_of(
    robot: Robot,
    q: FloatArray,
    qd: FloatArray,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
) -> FloatArray:
    """Return the twist of a frame against the base, ``[v; ω] = J(q) qd``.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        qd: Joint velocities, shape (dof,) or (n, dof), rad/s and m/s.
        frame: Frame name; default the tip.
        reference_frame: Where and in which axes the twist is taken.

    Returns:
        Shape (6,), or (n, 6) where q or qd is a batch; m/s and rad/s.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q or qd has a wrong shape or is not finite.
        WrongVector: Batches of unequal length.
    """
    J = jacobian(robot, q, frame, reference_frame)
    qd = configuration(robot, qd, "qd")
    check_same_length(np.asarray(q), qd, "qd")
    return np.asarray((J @ qd[..., None])[..., 0])


def joint_velocities_bytes(dof: int) -> int:
    """Return the bytes for each q of a batch: decomposed Jacobians, and copies of null motions."""
    return jacobian_bytes(dof) + 8 * (dof**2 + 8 * dof + 64) + 200


def joint_velocities(
    robot: Robot,
    q: FloatArray,
    twist: FloatArray,
    task: Task = POSE,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
    *,
    damping: float = 0.0,
    tolerance: float = RANK_TOLERANCE,
) -> JointVelocities:
    """Return the joint velocities of least norm for a twist: ``qd = J† twist``, or damped.

    Without damping, singular values that do not count for the rank are left out: where the rank
    is that of the task ``J qd = twist``, elsewhere ``qd`` is the least-squares solution of least
    norm. With damping λ, ``qd = Jᵀ (J Jᵀ + λ² I)⁻¹ twist`` (Nakamura and Hanafusa, 1986; Wampler,
    1986), which stays below ``|twist| / (2 λ)`` everywhere. Least squares and damping weight m/s
    and rad/s equally, and so does the least norm of arms with revolute and prismatic joints.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        twist: One entry a task row, shape (m,) or (n, m), m/s and rad/s.
        task: Rows of the twist that count, in the axes of the reference frame.
        frame: Frame name; default the tip.
        reference_frame: Where and in which axes the twist is taken.
        damping: λ, 0 (none), or 1e-12 to 1e6.
        tolerance: A singular value below ``tolerance * max(1, largest)`` counts as zero.

    Returns:
        The joint velocities, with the residual measured on the model.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
        WrongVector: twist has a wrong shape or is not finite.
        InvalidOption: damping or tolerance out of range.
    """
    check_options(damping, tolerance)
    J = task_jacobian(robot, q, task, frame, reference_frame)
    twist = spatial_vector(twist, task.row_names, "twist")
    check_same_length(np.asarray(q), twist, "twist")
    U, sigma, Vt = svd(J)
    r = sigma.shape[-1]
    rank = rank_of(sigma, tolerance)
    if damping:
        gain = sigma / (sigma**2 + damping**2)
    else:
        counts = np.arange(r) < rank[..., None]
        gain = np.where(counts, 1.0 / np.where(counts, sigma, 1.0), 0.0)
    along = np.swapaxes(U[..., :r], -1, -2) @ twist[..., None]
    qd = (np.swapaxes(Vt[..., :r, :], -1, -2) @ (gain[..., None] * along))[..., 0]
    ranks = rank.reshape(-1)
    bases = Vt.reshape(-1, robot.dof, robot.dof)
    limits = np.array([np.inf if j.velocity is None else j.velocity for j in robot.joints])
    return JointVelocities(
        qd=qd,
        residual=(J @ qd[..., None])[..., 0] - twist,
        rank=rank,
        determined=rank == len(task.rows),
        null_motions=[signed(V[k:]) for V, k in checked(zip(bases, ranks, strict=True))],
        within_velocity_limits=np.all(np.abs(qd) <= limits, axis=-1),
    )


def check_options(damping: float, tolerance: float) -> None:
    """Refuse a damping or a tolerance out of range.

    Raises:
        InvalidOption: damping is neither 0 nor in 1e-12 … 1e6, or tolerance not in 0 … 1.
    """
    if damping != 0 and damping not in DAMPING:
        raise DAMPING.refusal(
            say(
                "damping is {damping:g}; give 0, or 1e-12 up to 1e6, such as 0.01", damping=damping
            ),
            damping,
            "damping",
        )
    check_tolerance(tolerance)
