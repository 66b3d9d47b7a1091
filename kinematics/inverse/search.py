"""Search solutions of a target from many starts of the numeric solver.

What is left where nothing proves that there are no others.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dh_to_urdf.messages import say
from kinematics.chain import Chain
from kinematics.deadline import checked
from kinematics.inverse.api import solve_ik
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.result import IKOptions, IKStatus, Tolerance
from kinematics.inverse.self_motion.result import SelfMotion
from kinematics.inverse.solutions import IKSolution, IKSolutions
from kinematics.inverse.starts import starts
from kinematics.inverse.windings import apart, turned
from kinematics.jacobian import task_jacobian
from kinematics.task import Task
from robots.robot import FloatArray, Robot

SEARCH_STARTS = 64
TIGHT = 1e-9
"""Tolerance of the search, m and rad: solutions are to be told apart."""
SAME = 1e-4
"""Largest joint difference, rad or m, of two answers that count as one."""
FREE = 1e-9
"""Motion of the task by a joint that counts as none, m/rad or rad/rad."""
DOUBLE = 1e-3
"""Joint difference up to which answers beside a singular one count as it."""


def search(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    frame: str,
    task: Task,
    start: FloatArray,
    options: IKOptions,
) -> IKSolutions:
    """Find solutions from many starts of the numeric solver, within the limits.

    Args:
        robot: The robot.
        chain: Its chain to the frame.
        target: Pose of the frame in the base frame's axes, 4x4.
        frame: Frame name.
        task: The task space.
        start: The first start, and the reference for turns and free joints; shape (dof,).
        options: Of the numeric solver.
    """
    bounds = JointBounds.of(robot)
    low, high = bounds.ranges(chain.reach if np.isfinite(chain.reach) else 1.0)
    offset, ratio, lowest, span = starts(
        options.random_seed, low[chain.columns], high[chain.columns]
    )
    tight = Tolerance(
        min(options.tolerance.position, TIGHT), min(options.tolerance.orientation, TIGHT)
    )
    once = replace(options, max_restarts=0, tolerance=tight)
    collected: list[IKSolution] = []
    families = False
    dimension = 0
    own = solve_ik(robot, target, frame=frame, task=task, seed=start, options=options)
    for number in checked(range(-1, SEARCH_STARTS), 1):
        q = own.q if number < 0 else start.copy()
        if number > 0:
            q[chain.columns] = lowest + (offset + number * ratio) % 1.0 * span
        result = solve_ik(robot, target, frame=frame, task=task, seed=q, options=once)
        if number < 0 and result.status is not IKStatus.CONVERGED:
            result = own
        if result.status is not IKStatus.CONVERGED:
            continue
        answer = turned(robot, result.q, start, chain)
        J = task_jacobian(robot, answer, task, frame)[:, chain.columns]
        idle = np.linalg.norm(J, axis=0) <= FREE
        answer[chain.columns[idle]] = start[chain.columns[idle]]
        sigma = np.linalg.svd(J[:, ~idle], compute_uv=False)
        families = families or int(np.count_nonzero(~idle)) > len(task.rows)
        dimension = max(dimension, J.shape[1] - int(np.count_nonzero(sigma > FREE)))
        near = DOUBLE if sigma.min(initial=np.inf) <= DOUBLE * sigma.max(initial=0.0) else SAME
        if any(apart(robot, answer, other.q) < near for other in collected):
            continue
        errors = result.position_error, result.orientation_error
        free = tuple(robot.joints[int(k)].name for k in chain.columns[idle])
        collected.append(IKSolution(answer, (), True, *errors, free))
    description = say(
        "{search_starts} starts of the numeric solver; there may be others",
        search_starts=SEARCH_STARTS,
    )
    if families:
        description += say(
            "; the arm has more joints than the task needs: each is one of infinitely many"
        )
    motion = SelfMotion(dimension, None, False, 0, ()) if dimension > 1 else None
    return IKSolutions("search", False, description, start, tuple(collected), motion)
