"""Joint tree of a robot as constants: each joint a placement, then a motion along or about z.

The constants are read from the Pinocchio model; Pinocchio is the oracle in the tests.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from robots.robot import FloatArray, Robot


@dataclass(frozen=True)
class TreeJoint:
    """One moving joint.

    Attributes:
        column: Its number among the joints that move; its entry of q where all are free.
        parent: Location of the preceding moving joint in the tree, -1 for the root.
        placement: Placement of the joint, its z along the axis, in the parent's joint, 4x4.
        is_revolute: True for an angle.
    """

    column: int
    parent: int
    placement: FloatArray
    is_revolute: bool


@dataclass(frozen=True)
class Tree:
    """The moving joints of a robot, parents first, and the placement of each frame.

    Attributes:
        joints: The joints.
        frames: For each frame name the joint that carries it (-1: the root) and its placement
            in that joint, 4x4.
    """

    joints: tuple[TreeJoint, ...]
    frames: dict[str, tuple[int, FloatArray]]

    def path(self, frame: str) -> tuple[int, ...]:
        """Return the indices of the joints between the root and a frame, root first."""
        index, found = self.frames[frame][0], []
        while index >= 0:
            found.append(index)
            index = self.joints[index].parent
        return tuple(reversed(found))


_TREES: WeakKeyDictionary[Robot, Tree] = WeakKeyDictionary()


def tree_of(robot: Robot) -> Tree:
    """Return the tree of a robot; it is kept as long as the robot."""
    tree = _TREES.get(robot)
    if tree is None:
        tree = _TREES[robot] = build_tree(robot)
    return tree


def build_tree(robot: Robot) -> Tree:
    """Return the constants of a robot's tree, read from its Pinocchio model."""
    model = robot.model
    column_of = {int(model.getJointId(joint.name)): k for k, joint in enumerate(robot.moving)}
    joints: list[TreeJoint] = []
    alignments: list[FloatArray] = [np.eye(4)]
    for joint_id in range(1, model.njoints):
        column = column_of[joint_id]
        # The data of one joint: those of the model grow with the cube of its joints.
        motion = model.joints[joint_id].createData()
        model.joints[joint_id].calc(motion, np.zeros(1))
        subspace = motion.S.reshape(6)
        is_revolute = robot.moving[column].type.is_revolute
        alignment = _z_onto(subspace[3:] if is_revolute else subspace[:3])
        parent = int(model.parents[joint_id])
        placement = alignments[parent].T @ model.jointPlacements[joint_id].homogeneous @ alignment
        joints.append(TreeJoint(column, parent - 1, placement, is_revolute))
        alignments.append(alignment)
    frames = {}
    for name in dict.fromkeys((*robot.frames, robot.base_frame)):
        frame = model.frames[robot.frame_id(name)]
        joint_id = int(frame.parentJoint)
        frames[name] = (joint_id - 1, alignments[joint_id].T @ frame.placement.homogeneous)
    return Tree(tuple(joints), frames)


def _z_onto(axis: FloatArray) -> FloatArray:
    """Return a rotation (4x4) that turns z onto a unit axis; exact for ±x, ±y, ±z."""
    z = axis / np.linalg.norm(axis)
    helper = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(helper, z)
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2] = x, np.cross(z, x), z
    return T
