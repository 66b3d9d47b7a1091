"""Constants of the chain between base and frame, in the form that compiled solvers take.

The pose of the frame in the base's axes is ``C_0 M(q_1) C_1 M(q_2) … M(q_K) C_K``: constant
placements, and motions about or along z. Joints between the root and the base count backwards,
so a chain may run from one branch of a tree to another.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from kinematics.tree import Tree, tree_of
from robots.robot import FloatArray, Robot

_FLIP = np.diag([1.0, -1.0, -1.0, 1.0])


@dataclass(frozen=True, eq=False)
class Chain:
    """Constants of one chain of K joints.

    Attributes:
        placements: C_0 … C_K, each the upper three rows of a 4x4 matrix, row by row; shape
            (K + 1, 12).
        is_revolute: True for an angle, False for a length; shape (K,).
        columns: Entry of q of each joint; shape (K,).
        lower: Lower limits, -inf where none; shape (K,).
        upper: Upper limits, inf where none; shape (K,).
    """

    placements: FloatArray
    is_revolute: NDArray[np.bool_]
    columns: NDArray[np.intp]
    lower: FloatArray
    upper: FloatArray

    @property
    def length(self) -> int:
        """Number of joints, K."""
        return len(self.columns)

    @cached_property
    def reach(self) -> float:
        """Radius of a sphere about the first joint that the frame never leaves, m.

        Sum of the distances between successive joints and the extents of prismatic joints;
        infinite where a prismatic joint has no limit.
        """
        links = np.linalg.norm(self.placements[1:, [3, 7, 11]], axis=1).sum()
        extents = np.maximum(np.abs(self.lower), np.abs(self.upper))[~self.is_revolute].sum()
        return float(links + extents)


def chain_of(robot: Robot, frame: str) -> Chain:
    """Return the chain from a robot's base frame to a frame.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    chains = _CHAINS.get(robot)
    if chains is None:
        chains = _CHAINS[robot] = {}
    if frame not in chains:
        robot.frame_id(frame)
        chains[frame] = _build(robot, tree_of(robot), frame)
    return chains[frame]


_CHAINS: WeakKeyDictionary[Robot, dict[str, Chain]] = WeakKeyDictionary()


def _build(robot: Robot, tree: Tree, frame: str) -> Chain:
    base_path, frame_path = tree.path(robot.base_frame), tree.path(frame)
    shared = sum(1 for a, b in zip(base_path, frame_path, strict=False) if a == b)
    constant = _inverse(tree.frames[robot.base_frame][1])
    placements: list[FloatArray] = []
    indices: list[int] = []
    for index in reversed(base_path[shared:]):
        # The inverse of placement * M(q) is M(-q) * inverse; a flip about x turns M(-q) to M(q).
        placements.append(constant @ _FLIP)
        indices.append(index)
        constant = _FLIP @ _inverse(tree.joints[index].placement)
    for index in frame_path[shared:]:
        placements.append(constant @ tree.joints[index].placement)
        indices.append(index)
        constant = np.eye(4)
    placements.append(constant @ tree.frames[frame][1])
    columns = np.array([tree.joints[index].column for index in indices], dtype=np.intp)
    return Chain(
        placements=np.array([T[:3].reshape(12) for T in placements]),
        is_revolute=np.array([tree.joints[index].is_revolute for index in indices], dtype=bool),
        columns=columns,
        lower=robot.lower[columns],
        upper=robot.upper[columns],
    )


def _inverse(T: FloatArray) -> FloatArray:
    result = np.eye(4)
    result[:3, :3] = T[:3, :3].T
    result[:3, 3] = -T[:3, :3].T @ T[:3, 3]
    return result
