"""Inverse kinematics of one target and of many: ``solve_ik`` and ``solve_ik_batch``."""

from __future__ import annotations

import time

import numpy as np

from kinematics.inverse.prepared_solver import solver_of
from kinematics.inverse.result import IKBatch, IKOptions, IKResult
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

_DEFAULT = IKOptions()


def solve_ik(
    robot: Robot,
    target: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    options: IKOptions = _DEFAULT,
) -> IKResult:
    """Find a q within the limits that brings a frame to a target.

    Only the joints between the base and the frame move; the others stay at the seed.

    Args:
        robot: The robot.
        target: Pose of the frame in the base frame's axes, 4x4; rows outside the task do not
            count.
        frame: Frame name; default the tip.
        task: The task space, in base axes. The rotation error is the rotation vector of
            ``R_target Rᵀ``.
        seed: First start, shape (dof,), rad and m; default mid-range. Beyond a limit it is
            brought inside.
        options: Tolerance, restarts, time; see :class:`IKOptions`.

    Returns:
        The result; ``status`` is ``converged`` only where the measured error says so.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    name = robot.tip_frame if frame is None else frame
    return solver_of(robot, name, task).solve(target, seed, options)


def batch_bytes(dof: int) -> int:
    """Return the bytes for each target of a batch: its pose, its q, and its figures."""
    return 8 * (4 * 16 + 2 * dof + 8) + 200


def solve_ik_batch(
    robot: Robot,
    targets: FloatArray,
    *,
    frame: str | None = None,
    task: Task = POSE,
    seed: FloatArray | None = None,
    options: IKOptions = _DEFAULT,
    threads: int = 1,
    seconds: float = np.inf,
) -> IKBatch:
    """Solve many targets, over threads that do not hold the GIL.

    Args:
        robot: The robot.
        targets: Shape (n, 4, 4).
        frame: Frame name; default the tip.
        task: The task space.
        seed: First start of each, shape (dof,).
        options: Tolerance, restarts, time for each target.
        threads: How many targets to work on at once.
        seconds: Time for all; what is not solved by then is a ``timeout``.

    Returns:
        The results, in the order of the targets.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    name = robot.tip_frame if frame is None else frame
    deadline = time.perf_counter() + seconds
    solver = solver_of(robot, name, task)
    return solver.solve_batch(targets, seed, options, threads, deadline)
