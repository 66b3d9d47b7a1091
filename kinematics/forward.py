"""Forward kinematics: poses of frames in the axes of the robot's base frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from dh_to_urdf.poses import rows_to_rpy
from kinematics.chain import chain_of
from kinematics.compiled import writable
from kinematics.configuration import configuration
from kinematics.deadline import checkpoint
from kinematics.lanes.batches import forward_many
from kinematics.orientation import DEGENERATE
from robots.robot import FloatArray, Robot


def fk(robot: Robot, q: FloatArray, frames: Sequence[str] | None = None) -> dict[str, FloatArray]:
    """Return the poses of frames at one q or a batch.

    One q goes through Pinocchio, a batch through compiled code for eight at once, which agrees
    with it to rounding.

    Args:
        robot: The robot.
        q: Shape (dof,) or (n, dof), rad and m.
        frames: Frame names; default the tip.

    Returns:
        For each frame its pose in the base frame's axes, shape (4, 4) or (n, 4, 4).

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    ids = _frame_ids(robot, frames)
    q = configuration(robot, q)
    if q.ndim == 1:
        return _matrices(robot, q, ids)
    return {name: _many(robot, q, name) for name in ids}


def peak_bytes(dof: int, frames: int) -> int:
    """Return the bytes for each q of a batch: its values, twice, and the poses of frames."""
    return 8 * (2 * dof + 16 * frames)


class Pose(NamedTuple):
    """One pose in plain numbers.

    Attributes:
        matrix: The four rows of the homogeneous matrix.
        position: x, y, z.
        quaternion_xyzw: Unit quaternion with w ≥ 0.
        rpy: URDF's roll, pitch, yaw, rad.
        is_locked: Whether only roll ± yaw is determined; yaw is 0 then.
    """

    matrix: list[list[float]]
    position: tuple[float, ...]
    quaternion_xyzw: tuple[float, ...]
    rpy: tuple[float, ...]
    is_locked: bool


def poses(robot: Robot, q: FloatArray, frames: Sequence[str] | None = None) -> dict[str, Pose]:
    """Return the poses of frames at one q as plain numbers, without the cost of small arrays.

    Args:
        robot: The robot.
        q: Shape (dof,), as :func:`kinematics.configuration.configuration` gave it.
        frames: Frame names; default the tip.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    found = _placements(robot, q, _frame_ids(robot, frames))
    return {name: _pose(placement) for name, placement in found.items()}


def _pose(placement: Any) -> Pose:
    rows = placement.homogeneous.tolist()
    numbers = pin.SE3ToXYZQUATtuple(placement)
    quaternion = numbers[3:]
    if quaternion[3] < 0.0:
        quaternion = tuple(-value for value in quaternion)
    is_locked = math.hypot(rows[0][0], rows[1][0]) < DEGENERATE
    return Pose(rows, numbers[:3], quaternion, rows_to_rpy(rows, DEGENERATE), is_locked)


def _frame_ids(robot: Robot, frames: Sequence[str] | None) -> dict[str, int]:
    names = (robot.tip_frame,) if frames is None else frames
    return {name: robot.frame_id(name, "frames", (k,)) for k, name in enumerate(names)}


def _placements(robot: Robot, q: FloatArray, ids: dict[str, int]) -> dict[str, Any]:
    data = robot.data()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(q))
    frames = data.oMf
    if robot.base_is_fixed:
        return {name: frames[number] for name, number in ids.items()}
    base = frames[robot.frame_id(robot.base_frame)]
    return {name: base.actInv(frames[number]) for name, number in ids.items()}


def _matrices(robot: Robot, q: FloatArray, ids: dict[str, int]) -> dict[str, FloatArray]:
    found = _placements(robot, q, ids)
    return {name: placement.homogeneous for name, placement in found.items()}


def _many(robot: Robot, q: FloatArray, name: str) -> FloatArray:
    checkpoint()
    chain = chain_of(robot, name)
    out = np.empty((len(q), 16))
    columns = chain.columns
    if chain.is_coupled:
        q, columns = chain.values(q[:, columns]), np.arange(chain.length)
    forward_many(chain.links, columns, writable(q), out)
    return out.reshape(-1, 4, 4)
