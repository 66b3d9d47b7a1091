"""``Δθ = J† ΔX``: the least step that the linear model asks for.

Open loop, ΔX is the path's own increment: errors of linearisation add up (drift). Closed loop, ΔX
leads from where the arm is to the path, which takes the drift away, and diverges where the path
leaves the workspace: it ends before a step that leads to another branch. No limit or obstacle is
looked at.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from kinematics.compiled import jit
from kinematics.kernels import Array
from kinematics.redundancy.kernel import (
    ArmConstants,
    increment,
    least_step,
    orthonormal_rows,
    task_at,
    task_rows,
    workspace,
)
from kinematics.redundancy.methods.blocks import (
    Course,
    course_of,
    in_blocks,
    leaps,
    sample_before,
)
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.redundancy.stop import Stop
from robots.robot import FloatArray


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """Follow a path; see :class:`kinematics.redundancy.methods.Method`."""
    arm = problem.arm.constants
    course, W = course_of(problem, options, Q), workspace(problem.arm.chain.length)

    def solve(first: int, last: int) -> tuple[int, int]:
        return _follow(arm, course, first, last, options.closed_loop, W)

    return (yield from in_blocks(problem, course, solve))


@jit
def _follow(
    arm: ArmConstants, course: Course, first: int, last: int, closed: bool, W: Array
) -> tuple[int, int]:
    """Fill samples from ``first`` up to before ``last``; see :func:`~.blocks.in_blocks`."""
    G, Q = course.targets, course.Q
    K, m = Q.shape[1], len(arm.rows)
    e, y, step = np.empty(m), np.empty(m), np.empty(K)
    J, B, L = np.empty((m, K)), np.empty((m, K)), np.empty((m, m))
    unused, order = np.empty((m, K)), np.empty(m, dtype=np.int64)
    for i in range(first, last):
        q = sample_before(course, i)
        task_at(arm, G[i], q, W, e, J)
        if not closed:
            increment(arm.chain, G[i - 1], G[i], W)
            task_rows(arm, W, e, unused)
        rank = orthonormal_rows(J, B, L, order)
        if rank < m:
            return i, rank
        least_step(B, L, order, e, y, step)
        for k in range(K):
            Q[i, k] = q[k] + step[k]
        if leaps(course, i):
            return i, rank
    return last, m
