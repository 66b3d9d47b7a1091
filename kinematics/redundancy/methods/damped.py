"""Damped least squares: ``Δθ = Jᵀ (J Jᵀ + λ² I)⁻¹ ΔX``, repeated in a sample until it is reached.

The damping grows where a step would lead away (Levenberg-Marquardt), so that the arm stops at the
border of its workspace and does not swing about it. Steps are bounded, so that it stays in its
branch. No limit or obstacle is looked at.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from kinematics.compiled import jit
from kinematics.inverse.damped_step import damped
from kinematics.inverse.task_error import TaskChain, columns, residual
from kinematics.kernels import Array
from kinematics.redundancy.kernel import workspace
from kinematics.redundancy.methods.blocks import Course, course_of, in_blocks, sample_before
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.redundancy.stop import Stop
from robots.robot import FloatArray

EXACT = 1e-10
"""Error at which a sample is done, m and rad."""


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """Follow a path; see :class:`kinematics.redundancy.methods.Method`."""
    chain, m = problem.arm.constants.chain, problem.arm.m
    course, W = course_of(problem, options, Q), workspace(problem.arm.chain.length)

    def solve(first: int, last: int) -> tuple[int, int]:
        _follow(chain, course, first, last, options.damping, options.iterations, W)
        return last, m

    return (yield from in_blocks(problem, course, solve))


@jit
def _follow(
    chain: TaskChain,
    course: Course,
    first: int,
    last: int,
    damping: float,
    iterations: int,
    W: Array,
) -> None:
    """Fill samples from ``first`` up to before ``last``."""
    G, K, joints = course.targets, course.Q.shape[1], len(chain.is_revolute)
    trial, floor = np.empty(K), damping * damping
    for i in range(first, last):
        q, before, strength = course.Q[i], sample_before(course, i), floor
        for k in range(K):
            q[k] = before[k]
        position, rotation = residual(chain, G[i], q, W)
        for _ in range(iterations):
            if position <= EXACT * EXACT and rotation <= EXACT * EXACT:
                break
            columns(chain, W)
            damped(W, K, joints, strength)
            moved = 0.0
            for k in range(K):
                d = 0.0
                for r in range(6, 12):
                    d += W[k, r] * W[joints + 1, r]
                low, high = before[k] - course.longest[k], before[k] + course.longest[k]
                trial[k] = min(max(q[k] + d, low), high)
                moved = max(moved, abs(trial[k] - q[k]))
            if moved < 1e-15:
                break
            p, r2 = residual(chain, G[i], trial, W)
            if p + r2 < position + rotation:
                for k in range(K):
                    q[k] = trial[k]
                position, rotation = p, r2
                strength = max(floor, 0.2 * strength)
            else:
                strength *= 8.0
                residual(chain, G[i], q, W)
