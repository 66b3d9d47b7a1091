"""Inverse kinematics: ``solve_ik(robot, target, …) -> IKResult``."""

from kinematics.inverse.numeric import solve_ik
from kinematics.inverse.result import IKOptions, IKResult, IKStatus, Tolerance

__all__ = ["IKOptions", "IKResult", "IKStatus", "Tolerance", "solve_ik"]
