"""Forward kinematics: poses of frames in the axes of the robot's base frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from kinematics.configuration import configuration
from kinematics.tree import CHUNK, frame_pose, joint_poses, relative, tree_of
from robots.robot import FloatArray, Robot


def fk(robot: Robot, q: FloatArray, frames: Sequence[str] | None = None) -> dict[str, FloatArray]:
    """Poses of frames at one q or a batch.

    One q goes through Pinocchio, a batch through the vectorised tree, which agrees with it to
    rounding.

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
    results = {name: np.empty((len(q), 4, 4)) for name in names}
    for start in range(0, len(q), CHUNK):
        part = slice(start, start + CHUNK)
        for name, pose in _many(robot, q[part], names).items():
            results[name][part] = pose
    return results


def _one(robot: Robot, q: FloatArray, names: tuple[str, ...]) -> dict[str, FloatArray]:
    data = robot.data()
    pin.framesForwardKinematics(robot.model, data, robot.configuration(q))
    base = data.oMf[robot.frame_id(robot.base_frame)]
    if base.isIdentity(0.0):
        return {name: data.oMf[robot.frame_id(name)].homogeneous for name in names}
    return {name: base.actInv(data.oMf[robot.frame_id(name)]).homogeneous for name in names}


def _many(robot: Robot, q: FloatArray, names: tuple[str, ...]) -> dict[str, FloatArray]:
    tree, n = tree_of(robot), len(q)
    needed = [tree.frames[name][0] for name in (*names, robot.base_frame)]
    poses = joint_poses(tree, q, needed)
    base = frame_pose(tree, robot.base_frame, poses, n)
    return {name: relative(base, frame_pose(tree, name, poses, n)) for name in names}
