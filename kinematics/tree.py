"""Vectorised kinematics of a joint tree: many configurations at once, without a Python loop.

Every moving joint is a constant placement followed by a motion along or about z, so that one
update of a batch of poses is one matrix product and two rows. The constants are read from the
Pinocchio model; Pinocchio is the oracle in the tests.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from robots.robot import FloatArray, Robot

CHUNK = 2048
"""Configurations that are worked on at once: their poses stay in the processor's cache."""


@dataclass(frozen=True)
class TreeJoint:
    """One moving joint.

    Attributes:
        column: Its entry of q.
        parent: Index of the preceding moving joint in the tree, -1 for the root.
        placement: Placement of the joint, its z along the axis, in the parent's joint, 4x4.
        turns: True for an angle.
    """

    column: int
    parent: int
    placement: FloatArray
    turns: bool


@dataclass(frozen=True)
class Tree:
    """The moving joints of a robot, parents first, and where each frame stands.

    Attributes:
        joints: The joints.
        frames: For each frame name the joint that carries it (-1: the root) and its placement
            in that joint, 4x4.
    """

    joints: tuple[TreeJoint, ...]
    frames: dict[str, tuple[int, FloatArray]]

    def path(self, frame: str) -> tuple[int, ...]:
        """Indices of the joints between the root and a frame, root first."""
        index, found = self.frames[frame][0], []
        while index >= 0:
            found.append(index)
            index = self.joints[index].parent
        return tuple(reversed(found))


_TREES: WeakKeyDictionary[Robot, Tree] = WeakKeyDictionary()


def tree_of(robot: Robot) -> Tree:
    """The tree of a robot, kept as long as the robot is."""
    tree = _TREES.get(robot)
    if tree is None:
        tree = _TREES[robot] = build_tree(robot)
    return tree


def build_tree(robot: Robot) -> Tree:
    """Reads the constants of a robot's tree from its Pinocchio model."""
    model, data = robot.model, robot.model.createData()
    neutral = pin.neutral(model)
    column_of = {int(model.getJointId(joint.name)): k for k, joint in enumerate(robot.joints)}
    joints: list[TreeJoint] = []
    alignments: list[FloatArray] = [np.eye(4)]
    for joint_id in range(1, model.njoints):
        column = column_of[joint_id]
        motion = pin.computeJointJacobian(model, data, neutral, joint_id).reshape(6, -1)
        subspace = motion[:, model.joints[joint_id].idx_v]
        turns = bool(robot.turns[column])
        alignment = _z_onto(subspace[3:] if turns else subspace[:3])
        parent = int(model.parents[joint_id])
        placement = alignments[parent].T @ model.jointPlacements[joint_id].homogeneous @ alignment
        joints.append(TreeJoint(column, parent - 1, placement, turns))
        alignments.append(alignment)
    frames = {}
    for name in robot.frames:
        frame = model.frames[robot.frame_id(name)]
        joint_id = int(frame.parentJoint)
        frames[name] = (joint_id - 1, alignments[joint_id].T @ frame.placement.homogeneous)
    return Tree(tuple(joints), frames)


def _z_onto(axis: FloatArray) -> FloatArray:
    """A rotation (4x4) that turns z onto a unit axis; exact for ±x, ±y, ±z."""
    z = axis / np.linalg.norm(axis)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2] = x, np.cross(z, x), z
    return T


def joint_poses(tree: Tree, q: FloatArray, needed: Sequence[int]) -> dict[int, FloatArray]:
    """Poses of joints after their motion, in the root link's axes.

    Args:
        tree: The tree.
        q: Shape (n, dof).
        needed: Indices of the joints wanted; their ancestors are computed too.

    Returns:
        For each joint shape (n, 3, 4): rotation and translation.
    """
    wanted: set[int] = set()
    for index in needed:
        current = index
        while current >= 0 and current not in wanted:
            wanted.add(current)
            current = tree.joints[current].parent
    poses: dict[int, FloatArray] = {}
    n = len(q)
    for index in sorted(wanted):
        joint = tree.joints[index]
        if joint.parent < 0:
            before = np.broadcast_to(joint.placement[:3], (n, 3, 4))
        else:
            before = (poses[joint.parent].reshape(-1, 4) @ joint.placement).reshape(n, 3, 4)
        value = q[:, joint.column, None]
        pose = np.empty((n, 3, 4))
        if joint.turns:
            cos, sin = np.cos(value), np.sin(value)
            pose[..., 0] = cos * before[..., 0] + sin * before[..., 1]
            pose[..., 1] = cos * before[..., 1] - sin * before[..., 0]
            pose[..., 2:] = before[..., 2:]
        else:
            pose[..., :3] = before[..., :3]
            pose[..., 3] = before[..., 3] + value * before[..., 2]
        poses[index] = pose
    return poses


def frame_pose(tree: Tree, frame: str, poses: dict[int, FloatArray], n: int) -> FloatArray:
    """Pose of a frame in the root link's axes, shape (n, 4, 4)."""
    index, placement = tree.frames[frame]
    T = np.empty((n, 4, 4))
    T[:, 3] = (0.0, 0.0, 0.0, 1.0)
    if index < 0:
        T[:, :3] = placement[:3]
    else:
        T[:, :3] = (poses[index].reshape(-1, 4) @ placement).reshape(n, 3, 4)
    return T


def relative(base: FloatArray, T: FloatArray) -> FloatArray:
    """``inv(base) @ T`` of rigid placements, shapes (n, 4, 4)."""
    Rt = np.swapaxes(base[..., :3, :3], -1, -2)
    result = np.empty(np.broadcast_shapes(base.shape, T.shape))
    result[..., 3, :] = (0.0, 0.0, 0.0, 1.0)
    result[..., :3, :3] = Rt @ T[..., :3, :3]
    result[..., :3, 3] = np.einsum("...ij,...j->...i", Rt, T[..., :3, 3] - base[..., :3, 3])
    return result


def path_signs(robot: Robot, frame: str) -> tuple[NDArray[np.intp], FloatArray]:
    """Joints that move a frame against the base: tree indices, and +1 or -1 each.

    A joint between the root and the frame counts +1, one between the root and the base -1, and
    one on both paths moves both alike and drops out.
    """
    tree = tree_of(robot)
    down, up = set(tree.path(frame)), set(tree.path(robot.base_frame))
    indices = sorted(down ^ up)
    return np.array(indices, dtype=np.intp), np.array([1.0 if i in down else -1.0 for i in indices])
