"""Inverse kinematics of a target of a path, independent of the path."""

from __future__ import annotations

import numpy as np

from kinematics.inverse import IKOptions, IKResult, Tolerance, solve_ik
from kinematics.redundancy.problem import PathProblem
from robots.robot import FloatArray


def reach(
    problem: PathProblem, sample: int, seed: FloatArray, *, restarts: int, seconds: float
) -> IKResult:
    """Solve for the target of a sample, within the limits and without obstacles.

    Args:
        problem: The path problem.
        sample: Number of the target; -1 for the end.
        seed: Joint values of the robot to start from, shape (dof,), rad and m.
        restarts: Largest number of random starts.
        seconds: Time limit, s.
    """
    arm = problem.arm
    pose = np.eye(4)
    pose[:3] = problem.path.targets[sample].reshape(3, 4)
    tolerance = Tolerance(problem.tolerance.position, problem.tolerance.orientation)
    options = IKOptions(tolerance, restarts, 100, 0, seconds)
    return solve_ik(arm.robot, pose, frame=arm.frame, task=arm.task, seed=seed, options=options)
