"""A serial chain as its joint axes, as URDF files and drawings give it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import JointType, Limits, Mimic


@dataclass(frozen=True)
class AxisLine:
    """The axis of one joint at q = 0, as a directed line in base axes.

    Attributes:
        name: Name of the joint.
        type: How it moves; ``fixed`` for a line that only leads to the next one.
        point: A point of the line, m, shape (3,). Meaningless for a prismatic joint.
        direction: Unit vector that a positive q turns about or slides along, shape (3,).
        limits: Bounds on q.
    """

    name: str
    type: JointType
    point: Matrix
    direction: Matrix
    limits: Limits = field(default_factory=Limits)


@dataclass(frozen=True)
class ChainJoint:
    """One moving joint of a chain, fixed joints before it folded into its placement.

    Attributes:
        name: Its name.
        type: revolute, prismatic or continuous.
        placement: Placement of the joint in the one before it (first: in the base), 4x4.
        axis: Unit axis in the joint's own axes, shape (3,).
        limits: Bounds on q.
        mimic: What the joint follows; None where it is free.
        coupling: Other joints of the chain that move this one too, and coefficients.
    """

    name: str
    type: JointType
    placement: Matrix
    axis: Matrix
    limits: Limits = field(default_factory=Limits)
    mimic: Mimic | None = None
    coupling: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class SerialChain:
    """A serial chain from a base frame to a tip frame.

    Attributes:
        name: Name of the robot.
        base: Name of the base frame.
        tip: Name of the tip frame.
        joints: The moving joints, base first.
        tip_placement: Placement of the tip in the last joint, 4x4.
        warnings: Assumptions of the reader, as sentences.
    """

    name: str
    base: str
    tip: str
    joints: tuple[ChainJoint, ...]
    tip_placement: Matrix
    warnings: tuple[str, ...] = ()

    def poses(self, q: ArrayLike) -> Matrix:
        """Return the poses of the tip in base axes: the product of placements and motions.

        Args:
            q: Values of all joints, shape (..., n), rad and m.

        Returns:
            Shape (..., 4, 4).
        """
        q = np.asarray(q, dtype=np.float64)
        T = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
        for k, joint in enumerate(self.joints):
            T = T @ joint.placement @ motion(joint, q[..., k])
        return np.asarray(T @ self.tip_placement)

    def lines(self) -> tuple[AxisLine, ...]:
        """Return the axes at q = 0, in base axes."""
        T = np.eye(4)
        found = []
        for joint in self.joints:
            T = T @ joint.placement
            direction = T[:3, :3] @ joint.axis
            direction = direction / np.linalg.norm(direction)
            found.append(AxisLine(joint.name, joint.type, T[:3, 3], direction, joint.limits))
        return tuple(found)

    @property
    def size(self) -> float:
        """Return the length that rounding is compared with, m: the sum of joint distances."""
        parts = [joint.placement for joint in self.joints] + [self.tip_placement]
        return float(sum(np.linalg.norm(T[:3, 3]) for T in parts)) or 1.0


def chain_from_lines(
    name: str, lines: Sequence[AxisLine], tip: Matrix, warnings: tuple[str, ...] = ()
) -> SerialChain:
    """Return the chain of axes as measured on a drawing.

    Args:
        name: Name of the robot.
        lines: The axes at q = 0, in base axes.
        tip: Pose of the tip at q = 0 in base axes, 4x4.
        warnings: What had to be assumed.
    """
    joints = []
    before = np.zeros(3)
    for line in lines:
        placement = np.eye(4)
        placement[:3, 3] = line.point - before
        joints.append(ChainJoint(line.name, line.type, placement, line.direction, line.limits))
        before = line.point
    in_last = tip.copy()
    in_last[:3, 3] -= before
    return SerialChain(name, "base", "tip", tuple(joints), in_last, warnings)


def motion(joint: ChainJoint, q: Matrix) -> Matrix:
    """Return the motion along or about the axis (Rodrigues); q of shape (...), rad or m."""
    M = np.zeros((*q.shape, 4, 4))
    M[...] = np.eye(4)
    if joint.type is JointType.PRISMATIC:
        M[..., :3, 3] = q[..., None] * joint.axis
        return M
    x, y, z = joint.axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    half = np.sin(q / 2)[..., None, None]
    M[..., :3, :3] += np.sin(q)[..., None, None] * K + 2 * half**2 * (K @ K)
    return M
