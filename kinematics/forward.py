"""Forward kinematics: poses of frames in the axes of the robot's base frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from kinematics.chain import chain_of
from kinematics.compiled import COMPILED, writable
from kinematics.configuration import configuration
from kinematics.deadline import checkpoint
from kinematics.kernels import forward_many
from robots.robot import FloatArray, Robot


def fk(robot: Robot, q: FloatArray, frames: Sequence[str] | None = None) -> dict[str, FloatArray]:
    """Poses of frames at one q or a batch.

    One q goes through Pinocchio, a batch through a compiled loop over the same constants, which
    agrees with it to rounding.

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
    names = (robot.tip_frame,) if frames is None else tuple(frames)
    for index, name in enumerate(names):
        robot.frame_id(name, f"/frames/{index}")
    q = configuration(robot, q)
    if q.ndim == 1:
        return _one(robot, q, names)
    if not COMPILED:
        single = [_one(robot, row, names) for row in q]
        return {name: np.array([poses[name] for poses in single]) for name in names}
    return {name: _many(robot, q, name) for name in names}


def _one(robot: Robot, q: FloatArray, names: tuple[str, ...]) -> dict[str, FloatArray]:
    data = robot.data()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(q))
    base = data.oMf[robot.frame_id(robot.base_frame)]
    if base.isIdentity(0.0):
        return {name: data.oMf[robot.frame_id(name)].homogeneous for name in names}
    return {name: base.actInv(data.oMf[robot.frame_id(name)]).homogeneous for name in names}


def _many(robot: Robot, q: FloatArray, name: str) -> FloatArray:
    checkpoint()
    chain = chain_of(robot, name)
    K = chain.length
    out = np.empty((len(q), 16))
    memory = np.empty(K), np.empty((K, 6))
    q = writable(q)
    forward_many(chain.placements, chain.turns, chain.columns, q, *memory, out)
    return out.reshape(-1, 4, 4)
