"""``Δθ = J† ΔX + (I − J†J) Z`` with Z down the potentials of :mod:`..gradients`.

Closed loop, and corrected in the sample until the path is reached: what the null-space motion
shifts the frame (it is tangential to the self-motion, not on it) does not stay. The potentials are
wishes: nothing guarantees a limit or a clearance.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import astuple
from typing import NamedTuple

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.task_error import residual
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import Scene
from kinematics.redundancy.kernel import (
    ArmConstants,
    least_step,
    orthonormal_rows,
    project_null,
    task_at,
    workspace,
)
from kinematics.redundancy.methods.blocks import (
    Course,
    course_of,
    in_blocks,
    leaps,
    sample_before,
)
from kinematics.redundancy.methods.damped import EXACT
from kinematics.redundancy.problem import Gains, PathOptions, PathProblem
from kinematics.redundancy.steps.gradients import (
    Repulsion,
    limit_potential,
    manipulability_potential,
    obstacle_potential,
    posture_potential,
)
from kinematics.redundancy.stop import Stop
from robots.robot import FloatArray

GAINS = Gains(limits=4.0, obstacles=4.0)
"""What is taken where the request gives none."""
LARGEST = 0.05
"""Largest null-space motion of a joint in one sample, rad or m."""


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """Follow a path; see :class:`kinematics.redundancy.methods.Method`."""
    arm, scene, chain = problem.arm.constants, problem.scene, problem.arm.chain
    course = course_of(problem, options, Q)
    chosen = options.gains or GAINS
    wishes = Wishes(
        chain.lower,
        chain.upper,
        problem.first if options.posture_q is None else options.posture_q,
        Repulsion(float(problem.d_safe), float(options.reach_of_obstacles(problem))),
        np.array(astuple(chosen), np.float64),
    )
    W = workspace(problem.arm.chain.length, len(problem.links))

    def solve(first: int, last: int) -> tuple[int, int]:
        return _follow(arm, scene, wishes, course, first, last, options.iterations, W)

    return (yield from in_blocks(problem, course, solve))


class Wishes(NamedTuple):
    """The potentials that the null-space motion goes down, and their gains.

    Attributes:
        lower: Lower limits, -inf where none; rad and m, shape (K,).
        upper: Upper limits, inf where none.
        posture: Wanted posture, rad and m, shape (K,).
        repulsion: How obstacles repel.
        gains: Of limits, manipulability, obstacles and posture; see
            :class:`~kinematics.redundancy.problem.Gains`; shape (4,).
    """

    lower: Array
    upper: Array
    posture: Array
    repulsion: Repulsion
    gains: Array


@jit
def _follow(
    arm: ArmConstants,
    scene: Scene,
    wishes: Wishes,
    course: Course,
    first: int,
    last: int,
    iterations: int,
    W: Array,
) -> tuple[int, int]:
    """Fill samples from ``first`` up to before ``last``; see :func:`~.blocks.in_blocks`."""
    G, K, m = course.targets, course.Q.shape[1], len(arm.rows)
    e, y, step, z = np.empty(m), np.empty(m), np.empty(K), np.empty(K)
    J, B, L = np.empty((m, K)), np.empty((m, K)), np.empty((m, m))
    order = np.empty(m, dtype=np.int64)
    part = 1.0 / (len(G) - 1)
    for i in range(first, last):
        q, before = course.Q[i], sample_before(course, i)
        for k in range(K):
            q[k] = before[k]
        for iteration in range(iterations):
            position, rotation = task_at(arm, G[i], q, W, e, J)
            if iteration > 0 and position <= EXACT * EXACT and rotation <= EXACT * EXACT:
                break
            rank = orthonormal_rows(J, B, L, order)
            if rank < m:
                return i, rank
            least_step(B, L, order, e, y, step)
            if iteration == 0:
                downhill(arm, scene, wishes, G[i], q, part, W, z)
                project_null(B, z)
                most = 0.0
                for k in range(K):
                    most = max(most, abs(z[k]))
                cut = min(1.0, LARGEST / most) if most > 0.0 else 0.0
                for k in range(K):
                    step[k] += cut * z[k]
            for k in range(K):
                q[k] += step[k]
            if leaps(course, i):
                return i, m
    return last, m


@inner
def downhill(
    arm: ArmConstants,
    scene: Scene,
    wishes: Wishes,
    target: Array,
    q: Array,
    part: float,
    W: Array,
    z: Array,
) -> None:
    """Compute Z: minus the gradients times gains and the part of the path.

    No potential is stepped over: its step stays below half of what its curvature allows.

    Args:
        arm: Constants of the arm.
        scene: Links and obstacles.
        wishes: The potentials and their gains.
        target: Pose in base axes, 12 numbers.
        q: Joint values, rad and m, shape (K,).
        part: Part of the path that a sample is.
        W: Workspace.
        z: Filled, rad and m, shape (K,).
    """
    chain, gains, lower, upper = arm.chain, wishes.gains, wishes.lower, wishes.upper
    K = len(q)
    g = np.empty(K)
    z[:] = 0.0
    if gains[0] > 0.0:
        limit_potential(q, lower, upper, g)
        steepest = 1e-300
        for k in range(K):
            half = 0.5 * (upper[k] - lower[k])
            if 0.0 < half < math.inf:
                steepest = max(steepest, 2.0 / (K * half * half))
        scale = min(gains[0] * part, 0.5 / steepest)
        for k in range(K):
            z[k] -= scale * g[k]
    if gains[1] > 0.0:
        residual(chain, target, q, W)
        manipulability_potential(arm, W, g)
        for k in range(K):
            z[k] -= gains[1] * part * g[k]
    if gains[2] > 0.0 and len(scene.obstacles) > 0:
        obstacle_potential(chain, q, scene, wishes.repulsion, W, g)
        for k in range(K):
            z[k] -= gains[2] * part * g[k]
    if gains[3] > 0.0:
        posture_potential(q, wishes.posture, g)
        scale = min(gains[3] * part, 0.5)
        for k in range(K):
            z[k] -= scale * g[k]
