"""Skeleton of a robot: placement of its frames, links and joint axes at a q."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf import Convention, DHTable
from dh_to_urdf.table import DHRow
from kinematics.configuration import configuration
from kinematics.forward import fk
from kinematics.tree import tree_of
from robots.robot import FloatArray, Robot


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Frames, links and joint axes of a robot at one q, in base axes.

    Attributes:
        frames: Pose of each frame by name, 4x4.
        bones: A polyline a link, each of shape (k, 3), m. Between the frames of a D-H table it
            goes along the common normal and along the axis, as ``a`` and ``d`` are measured.
        origins: A point on the axis of each of the m joints that move, shape (m, 3), m.
        axes: Unit vectors of the joint axes, shape (m, 3).
        is_revolute: True for an angle, shape (m,).
    """

    frames: dict[str, FloatArray]
    bones: tuple[FloatArray, ...]
    origins: FloatArray
    axes: FloatArray
    is_revolute: NDArray[np.bool_]

    @property
    def points(self) -> FloatArray:
        """All points that a picture shows, shape (n, 3), m."""
        return np.concatenate((*self.bones, self.origins))


def skeleton_of(robot: Robot, q: FloatArray) -> Skeleton:
    """Return the skeleton at one q.

    Args:
        robot: The robot.
        q: Shape (dof,), rad and m.

    Returns:
        The skeleton.

    Raises:
        WrongConfiguration: q has a wrong shape or is not finite.
    """
    q = configuration(robot, q)
    frames = fk(robot, q, robot.frames)
    # A tool is on the frame that is computed for; the links end where they do without it.
    bare = frames if robot.bare is robot else fk(robot.bare, q, robot.frames)
    table = robot.table
    bones = _bones_of_table(table, bare) if table else _bones_of_links(robot.bare, bare)
    if bare is not frames:
        bones = (*bones, _straight(bare[robot.tip_frame], frames[robot.tip_frame]))
    origins, axes = _joints(robot, q)
    turns = np.array([joint.type.is_revolute for joint in robot.moving])
    return Skeleton(frames, bones, origins, axes, turns)


def _bones_of_table(table: DHTable, frames: dict[str, FloatArray]) -> tuple[FloatArray, ...]:
    bones = [_straight(frames["base_link"], frames["frame_0"])]
    for k, row in enumerate(table.rows, start=1):
        before, after = frames[f"frame_{row.parent}"], frames[f"frame_{k}"]
        bones.append(row_corners(row, table.convention, before, after))
    bones.append(_straight(frames[f"frame_{table.tip_row}"], frames["tool"]))
    return tuple(bones)


def row_corners(
    row: DHRow, convention: Convention, before: FloatArray, after: FloatArray
) -> FloatArray:
    """Return the corners of the way that a row goes from its parent's frame to its own.

    Standard: along z by d, then along x by a. Modified: along x by a, then along z by d. Khalil:
    along z by b, along x (turned by gamma) by d, along z by r.

    Args:
        row: The row.
        convention: What it means.
        before: Pose of its parent's frame at a q, 4x4.
        after: Pose of its own frame at that q, 4x4.

    Returns:
        Shape (3, 3), m; for Khalil's rows with b, shape (4, 3).
    """
    p, end = before[:3, 3], after[:3, 3]
    x, z = before[:3, 0], before[:3, 2]
    if convention is Convention.STANDARD:
        return np.array([p, p + z * float(z @ (end - p)), end])
    x = np.cos(row.gamma) * x + np.sin(row.gamma) * before[:3, 1]
    first = [p, p + row.b * z] if row.b else [p]
    return np.array([*first, first[-1] + row.a * x, end])


def _bones_of_links(robot: Robot, frames: dict[str, FloatArray]) -> tuple[FloatArray, ...]:
    model = robot.model
    parents = {name: int(model.frames[robot.frame_id(name)].parentFrame) for name in robot.frames}
    return tuple(
        _straight(frames[model.frames[parent].name], frames[name])
        for name, parent in parents.items()
        if parent
    )


def _straight(before: FloatArray, after: FloatArray) -> FloatArray:
    return np.array([before[:3, 3], after[:3, 3]])


def _joints(robot: Robot, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    tree, q = tree_of(robot), robot.joint_values(q)
    index, placement = tree.frames[robot.base_frame]
    poses: list[FloatArray] = []
    for joint in tree.joints:
        parent = poses[joint.parent] if joint.parent >= 0 else np.eye(4)
        poses.append(parent @ joint.placement @ _motion(joint.is_revolute, float(q[joint.column])))
    base = (poses[index] if index >= 0 else np.eye(4)) @ placement
    inverse = np.linalg.inv(base)
    origins, axes = np.empty((len(q), 3)), np.empty((len(q), 3))
    for joint, pose in zip(tree.joints, poses, strict=True):
        seen = inverse @ pose
        origins[joint.column], axes[joint.column] = seen[:3, 3], seen[:3, 2]
    return origins, axes


def _motion(is_revolute: bool, value: float) -> FloatArray:
    T = np.eye(4)
    if is_revolute:
        c, s = np.cos(value), np.sin(value)
        T[:2, :2] = [[c, -s], [s, c]]
    else:
        T[2, 3] = value
    return T
