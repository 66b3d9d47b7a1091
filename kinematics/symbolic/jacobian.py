"""The geometric Jacobian as polynomials: at any frame's origin, in any frame's axes."""

from __future__ import annotations

from typing import TypeAlias

from kinematics.symbolic.chain import Axis, Chain
from kinematics.symbolic.polynomial import ZERO, Polynomial
from kinematics.symbolic.steps import NOWHERE, Pose, Vector, added, cross, negated

Column: TypeAlias = tuple[Polynomial, ...]
"""vx, vy, vz, wx, wy, wz."""


def column(axis: Axis, poses: list[Pose], point: Vector) -> Column:
    """One joint's twist per unit of its speed.

    Args:
        axis: The joint.
        poses: All frames of the chain in the wanted axes.
        point: Where the linear velocity is taken, in these axes.

    Returns:
        ``[z x (p - o); z]`` for a revolute joint, ``[z; 0]`` for a prismatic one (Siciliano et
        al., *Robotics*, eq. 3.30), times the joint's sign.
    """
    pose = poses[axis.node]
    z = pose.axes[2] if axis.sign > 0 else negated(pose.axes[2])
    if not axis.turns:
        return (*z, *NOWHERE)
    return (*cross(z, added(point, negated(pose.origin))), *z)


def jacobian_columns(chain: Chain, dof: int, axes: int, point: int) -> list[Column]:
    """All columns, in the order of q; zeros for joints that are not on the chain.

    Args:
        chain: The chain.
        dof: Length of q.
        axes: Index of the frame in whose axes to write.
        point: Index of the frame at whose origin the linear velocity is taken.
    """
    poses = chain.poses(axes)
    columns: list[Column] = [(ZERO,) * 6] * dof
    for axis in chain.axes:
        columns[axis.joint - 1] = column(axis, poses, poses[point].origin)
    return columns
