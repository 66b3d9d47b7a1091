"""A question that an answer is checked against."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from kinematics.jacobian import ReferenceFrame
from kinematics.task import Task
from robots.robot import FloatArray, Robot

TOLERANCE = 1e-3


class Quantity(StrEnum):
    """What is asked.

    ``T``: the pose of the frame, or a part of it. ``T0``: the pose at q = 0, or the products 0A_k
    at q. ``A``: the link matrices. ``jacobian`` and ``det_jacobian``: at the frame. ``euler``:
    angles of the frame's orientation. ``ik``: joint values that reach a target. ``delta_q``: the
    differential step. ``table``: the D-H table.
    """

    T = "T"
    T0 = "T0"
    A = "A"
    JACOBIAN = "jacobian"
    DET_JACOBIAN = "det_jacobian"
    EULER = "euler"
    IK = "ik"
    DELTA_Q = "delta_q"
    TABLE = "table"


@dataclass(frozen=True, eq=False)
class Question:
    """What is asked, of which robot, where.

    Attributes:
        quantity: The quantity.
        robot: The robot.
        q: Joint values, shape (dof,), rad and m; None where a formula holds at every q.
        frame: Frame name; None: the tip.
        reference_frame: Of Jacobians.
        task: Rows of Jacobians, or what of a target counts; None: by the form of the answer.
        euler: Euler sequence; None: ZXZ for angles, and the geometric Jacobian.
        index: Number of one link matrix or product, from 1.
        target: Pose to reach, shape (4, 4); None: that at q.
        delta_x: Wanted motion, one value a task row, m and rad.
        z: Wanted joint motion, shape (dof,), rad and m.
        damping: Of the step.
        symbols: Other names of lengths.
        every: Whether all solutions of inverse kinematics are asked; None: where a list of them
            is given.
        tolerance: Largest error of an answer that counts as right.
        angle: Unit of angles in the answer, rad.
        length: Unit of lengths in the answer, m.
    """

    quantity: Quantity
    robot: Robot
    q: FloatArray | None = None
    frame: str | None = None
    reference_frame: ReferenceFrame = ReferenceFrame.LOCAL_WORLD_ALIGNED
    task: Task | None = None
    euler: str | None = None
    index: int | None = None
    target: FloatArray | None = None
    delta_x: FloatArray | None = None
    z: FloatArray | None = None
    damping: float = 0.0
    symbols: Mapping[str, str] = field(default_factory=dict)
    every: bool | None = None
    tolerance: float = TOLERANCE
    angle: float = 1.0
    length: float = 1.0
