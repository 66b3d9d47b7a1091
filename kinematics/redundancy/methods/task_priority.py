"""Strict priorities: the path first, then every other task as far as those before leave it free.

Closed loop: the path's whole error, and of a secondary one the part that its gain says, in every
correction of a sample; see :func:`kinematics.redundancy.priority.prioritized_step`.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from dh_to_urdf.messages import say
from kinematics.errors import InvalidOption
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.methods.damped import EXACT
from kinematics.redundancy.priority import prioritized_step
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.stop import Stop, StopReason
from kinematics.singularity import rank_of
from robots.robot import FloatArray

LARGEST = 0.05
"""Largest motion of a joint in one sample for the secondary tasks, rad or m."""


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """Follow a path; see :class:`kinematics.redundancy.methods.Method`."""
    if not options.secondary:
        raise InvalidOption(
            say("task_priority needs a second task; give secondary: [{{frame, task, target}}]"),
            argument="secondary",
        )
    arm = problem.arm
    place = _places(arm, options)
    previous = departure(problem, options)
    for i in range(1, len(Q)):
        q = previous.copy()
        for iteration in range(options.iterations):
            e, J, _ = arm.task_at(q, problem.path.targets[i])
            if iteration > 0 and np.abs(e).max() <= EXACT:
                break
            sigma = np.asarray(np.linalg.svd(J, compute_uv=False), np.float64)
            rank = int(rank_of(sigma))
            if rank < arm.m:
                return Stop(StopReason.RANK, i, rank)
            first, free = prioritized_step([(J, e)], arm.K)
            if iteration == 0:
                first = first + _others(problem, options, place, q, first, free)
            q = q + first
            if not (np.abs(q - previous) <= problem.longest_step).all():
                return Stop.diverged(i, rank, q - previous)
        Q[i] = previous = q
        yield i + 1
    return None


def _others(
    problem: PathProblem,
    options: PathOptions,
    places: list[FloatArray],
    q: FloatArray,
    first: FloatArray,
    free: FloatArray,
) -> FloatArray:
    """Return what the secondary tasks add, in the null space of the first, shape (K,)."""
    whole = problem.arm.expanded(q[None], problem.start)[0]
    tasks = []
    for one, place in zip(options.secondary, places, strict=True):
        e, J, _ = one.arm.task_at(one.arm.reduced(whole), one.target)
        J = J @ place
        tasks.append((J @ free, one.gain * e - J @ first))
    y, _ = prioritized_step(tasks, free.shape[1])
    added = free @ y
    most = float(np.abs(added).max(initial=0.0))
    return np.asarray(added * min(1.0, LARGEST / most) if most > 0 else added)


def _places(arm: Arm, options: PathOptions) -> list[FloatArray]:
    """Return where the joints of each secondary chain are in the first, as 0-1 matrices."""
    columns = arm.chain.columns
    return [
        np.array(one.arm.chain.columns[:, None] == columns[None], dtype=np.float64)
        for one in options.secondary
    ]
