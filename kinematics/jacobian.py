"""Jacobians of a frame: geometric in three reference frames, and analytic."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

import numpy as np
import pinocchio as pin

from kinematics.chain import Chain, chain_of
from kinematics.compiled import writable
from kinematics.configuration import configuration
from kinematics.deadline import checkpoint
from kinematics.forward import fk
from kinematics.lanes.batches import jacobian_many
from kinematics.orientation import analytic_map
from kinematics.task import Task
from robots.robot import FloatArray, Robot


class ReferenceFrame(StrEnum):
    """Point and axes in which a twist is given.

    ``local_world_aligned``: at the frame's origin, in base axes; the textbooks' geometric
    Jacobian. ``world``: of the body point at the base's origin, in base axes (spatial twist).
    ``local``: at the frame's origin, in the frame's own axes (body twist).
    """

    LOCAL_WORLD_ALIGNED = "local_world_aligned"
    WORLD = "world"
    LOCAL = "local"


def jacobian(
    robot: Robot,
    q: FloatArray,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
) -> FloatArray:
    """Return the geometric Jacobian of a frame against the base: ``[v; ω] = J dq/dt``.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        frame: Frame name; default the tip.
        reference_frame: Where and in which axes the twist is taken.

    Returns:
        Shape (6, dof) or (n, 6, dof); linear rows first, columns in the order of q.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    frame = frame or robot.tip_frame
    robot.frame_id(frame)
    q = configuration(robot, q)
    if q.ndim == 1:
        if robot.is_large:
            return np.asarray(_many(robot, q[None], frame, reference_frame)[0])
        return _one(robot, q, frame, reference_frame)
    return _many(robot, q, frame, reference_frame)


def peak_bytes(dof: int, copies: int = 2) -> int:
    """Return the bytes for each q of a batch: its values, twice, its pose, and its Jacobian.

    Args:
        dof: Columns.
        copies: Arrays of the size of the Jacobian, 2 where axes or rows are changed.
    """
    return 8 * (2 * dof + 16 + 6 * dof * copies)


def analytic_jacobian(
    robot: Robot, q: FloatArray, sequence: str, frame: str | None = None
) -> FloatArray:
    """Return the analytic Jacobian ``[v; φ̇, θ̇, ψ̇] = J_a dq/dt`` of the first Euler triple.

    ``J_a = diag(I, inv(E)) J`` with ``ω = E [φ̇, θ̇, ψ̇]`` (Siciliano et al., *Robotics*, 3.6).

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        sequence: Euler sequence such as ``ZXZ``.
        frame: Frame name; default the tip.

    Returns:
        Shape (6, dof) or (n, 6, dof); v in base axes.

    Raises:
        RepresentationSingularity: The Euler angles have no rates at an orientation.
        UnknownSequence: Not a sequence.
    """
    frame = frame or robot.tip_frame
    J = jacobian(robot, q, frame)
    R = fk(robot, q, [frame])[frame][..., :3, :3]
    J[..., 3:, :] = analytic_map(R, sequence) @ J[..., 3:, :]
    return J


def task_jacobian(
    robot: Robot,
    q: FloatArray,
    task: Task,
    frame: str | None = None,
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED,
) -> FloatArray:
    """Return the rows of the geometric Jacobian that a task counts.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        task: The task space.
        frame: Frame name; default the tip.
        reference_frame: Where and in which axes the twist is taken; rows of rotation about the
            frame's own axes stay those.

    Returns:
        Shape (rows, dof) or (n, rows, dof).

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    frame = frame or robot.tip_frame
    J = jacobian(robot, q, frame, reference_frame)
    if not task.own_axes or reference_frame is ReferenceFrame.LOCAL:
        return np.asarray(J[..., list(task.rows), :])
    return task.of(J, fk(robot, q, [frame])[frame][..., :3, :3])


def _one(robot: Robot, q: FloatArray, frame: str, reference_frame: ReferenceFrame) -> FloatArray:
    model, data = robot.model, robot.data()
    pin.computeJointJacobians(model, data, robot.configuration(q))
    pin.updateFramePlacements(model, data)
    tip_id = robot.frame_id(frame)
    J, tip = _by_column(robot, data, tip_id), data.oMf[tip_id]
    if not robot.base_is_fixed:
        base_id = robot.frame_id(robot.base_frame)
        base, J_base = data.oMf[base_id], _by_column(robot, data, base_id)
        J = J - J_base
        J[:3] -= np.cross(J_base[3:], tip.translation - base.translation, axis=0)
        J = np.concatenate((base.rotation.T @ J[:3], base.rotation.T @ J[3:]))
        tip = base.actInv(tip)
    if reference_frame is ReferenceFrame.LOCAL_WORLD_ALIGNED:
        return J
    return np.asarray(_expressed(J[None], tip.homogeneous[None], reference_frame)[0])


def _by_column(robot: Robot, data: Any, frame_id: int) -> FloatArray:
    """Return the Jacobian of a frame in the axes of the root by the entries of q, (6, dof)."""
    J = pin.getFrameJacobian(robot.model, data, frame_id, pin.LOCAL_WORLD_ALIGNED)
    J = J.reshape(6, -1)[:, robot.velocity_columns]
    return np.asarray(J if robot.coupled is None else J @ robot.coupled.matrix)


def _many(robot: Robot, q: FloatArray, frame: str, reference_frame: ReferenceFrame) -> FloatArray:
    checkpoint()
    chain = chain_of(robot, frame)
    if chain.is_coupled:
        J = np.zeros((len(q), 6, robot.dof))
        J[:, :, chain.columns] = chain.in_q(_by_joint(chain, q, reference_frame))
        return J
    poses, J = np.empty((len(q), 16)), np.zeros((len(q), 6 * robot.dof))
    jacobian_many(chain.links, chain.columns, writable(q), poses, J)
    return _expressed(J.reshape(-1, 6, robot.dof), poses.reshape(-1, 4, 4), reference_frame)


def _by_joint(chain: Chain, q: FloatArray, reference_frame: ReferenceFrame) -> FloatArray:
    K = chain.length
    poses, J = np.empty((len(q), 16)), np.zeros((len(q), 6 * K))
    values = writable(chain.values(q[:, chain.columns]))
    jacobian_many(chain.links, np.arange(K), values, poses, J)
    return _expressed(J.reshape(-1, 6, K), poses.reshape(-1, 4, 4), reference_frame)


def jacobian_by_joint(
    robot: Robot, q: FloatArray, frame: str, reference_frame: ReferenceFrame
) -> FloatArray:
    """Return the columns of the joints of a chain, before those of one leader are added up.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        frame: Frame name.
        reference_frame: Where and in which axes the twist is taken.

    Returns:
        Shape (6, K) or (n, 6, K), in the order of the chain.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    chain = chain_of(robot, frame)
    if not chain.is_coupled:
        return np.asarray(jacobian(robot, q, frame, reference_frame)[..., chain.columns])
    q = configuration(robot, q)
    found = _by_joint(chain, np.atleast_2d(q), reference_frame)
    return found if q.ndim == 2 else np.asarray(found[0])


def _expressed(J: FloatArray, tip: FloatArray, reference_frame: ReferenceFrame) -> FloatArray:
    """Convert from local_world_aligned to a reference frame; shapes (n, 6, dof), (n, 4, 4)."""
    if reference_frame is ReferenceFrame.LOCAL:
        Rt = np.swapaxes(tip[:, :3, :3], -1, -2)
        return np.concatenate((Rt @ J[:, :3], Rt @ J[:, 3:]), axis=1)
    if reference_frame is ReferenceFrame.WORLD:
        v = J[:, :3] - np.cross(J[:, 3:], tip[:, :3, 3, None], axis=1)
        return np.concatenate((v, J[:, 3:]), axis=1)
    return J
