"""Inverse kinematics: ``solve_ik(robot, target, …) -> IKResult``."""

from kinematics.inverse.result import IKBatch, IKOptions, IKResult, IKStatus, Tolerance
from kinematics.inverse.solve import solve_ik, solve_ik_batch

__all__ = [
    "IKBatch",
    "IKOptions",
    "IKResult",
    "IKStatus",
    "Tolerance",
    "solve_ik",
    "solve_ik_batch",
]
