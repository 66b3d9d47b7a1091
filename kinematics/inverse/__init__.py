"""Inverse kinematics: ``solve_ik(robot, target, …) -> IKResult``."""

from kinematics.inverse.api import batch_bytes, solve_ik, solve_ik_batch
from kinematics.inverse.prepared_solver import is_compiled
from kinematics.inverse.result import IKBatch, IKOptions, IKResult, IKStatus, Tolerance

__all__ = [
    "IKBatch",
    "IKOptions",
    "IKResult",
    "IKStatus",
    "Tolerance",
    "batch_bytes",
    "is_compiled",
    "solve_ik",
    "solve_ik_batch",
]
