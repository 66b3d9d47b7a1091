"""``Δθ = J† ΔX + (I − J†J) Z`` with Z down the potentials of :mod:`..gradients`.

Closed loop, and corrected in the sample until the path is reached: what the null-space motion
shifts the frame (it is tangential to the self-motion, not on it) does not stay. The potentials are
wishes: nothing guarantees a limit or a clearance.
"""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.inverse.damped_least_squares import residual
from kinematics.kernels import Array
from kinematics.redundancy.kernel import (
    least_step,
    orthonormal_rows,
    project_null,
    task_at,
    workspace,
)
from kinematics.redundancy.methods.blocks import in_blocks
from kinematics.redundancy.methods.damped import EXACT
from kinematics.redundancy.methods.pseudo_inverse import HUGE
from kinematics.redundancy.problem import Gains, PathOptions, PathProblem, departure
from kinematics.redundancy.steps.gradients import (
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
    """See :class:`kinematics.redundancy.methods.Method`."""
    arm, chain = problem.arm, problem.arm.chain
    leaving, W = departure(problem, options), workspace(arm.K, len(problem.links))
    chosen = options.gains or GAINS
    gains = np.array([chosen.limits, chosen.manipulability, chosen.obstacles, chosen.posture])
    wanted = problem.first if options.posture_q is None else options.posture_q
    world = problem.obstacles, problem.links.rows, problem.d_safe
    influence = options.reach_of_obstacles(problem)

    def solve(first: int, last: int) -> tuple[int, int]:
        return _follow(
            *arm.constants, problem.path.targets, Q, leaving, first, last, chain.lower,
            chain.upper, wanted, *world, influence, gains, options.iterations, W,
        )  # fmt: skip

    return (yield from in_blocks(problem, len(Q), solve))


@jit
def _follow(
    C: Array,
    is_revolute: Array,
    mask: Array,
    rows: Array,
    own: bool,
    G: Array,
    Q: Array,
    leaving: Array,
    first: int,
    last: int,
    lower: Array,
    upper: Array,
    wanted: Array,
    obstacles: Array,
    S: Array,
    safe: float,
    influence: float,
    gains: Array,
    iterations: int,
    W: Array,
) -> tuple[int, int]:
    K, m = len(is_revolute), len(rows)
    e, y, step, z = np.empty(m), np.empty(m), np.empty(K), np.empty(K)
    J, B, L = np.empty((m, K)), np.empty((m, K)), np.empty((m, m))
    order = np.empty(m, dtype=np.int64)
    part = 1.0 / (len(G) - 1)
    for i in range(first, last):
        q = Q[i]
        for k in range(K):
            q[k] = leaving[k] if i == 1 else Q[i - 1, k]
        for iteration in range(iterations):
            position, rotation = task_at(C, is_revolute, mask, rows, own, G[i], q, W, e, J)
            if iteration > 0 and position <= EXACT * EXACT and rotation <= EXACT * EXACT:
                break
            rank = orthonormal_rows(J, B, L, order)
            if rank < m:
                return i, rank
            least_step(B, L, order, e, y, step)
            if iteration == 0:
                downhill(
                    C, is_revolute, mask, rows, own, G[i], q, lower, upper, wanted, obstacles, S,
                    safe, influence, gains, part, W, z,
                )  # fmt: skip
                project_null(B, z)
                most = 0.0
                for k in range(K):
                    most = max(most, abs(z[k]))
                cut = min(1.0, LARGEST / most) if most > 0.0 else 0.0
                for k in range(K):
                    step[k] += cut * z[k]
            for k in range(K):
                q[k] += step[k]
                if not math.fabs(q[k]) < HUGE:
                    return i, m
    return last, m


@inner
def downhill(
    C: Array,
    is_revolute: Array,
    mask: Array,
    rows: Array,
    own: bool,
    target: Array,
    q: Array,
    lower: Array,
    upper: Array,
    wanted: Array,
    obstacles: Array,
    S: Array,
    safe: float,
    influence: float,
    gains: Array,
    part: float,
    W: Array,
    z: Array,
) -> None:
    """Z: minus the gradients times gains and the part of the path, into z of shape (K,).

    No potential is stepped over: its step stays below half of what its curvature allows.
    """
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
        residual(C, is_revolute, mask, target, q, W)
        manipulability_potential(is_revolute, rows, own, K, W, g)
        for k in range(K):
            z[k] -= gains[1] * part * g[k]
    if gains[2] > 0.0 and len(obstacles) > 0:
        obstacle_potential(C, is_revolute, q, obstacles, S, safe, influence, W, g)
        for k in range(K):
            z[k] -= gains[2] * part * g[k]
    if gains[3] > 0.0:
        posture_potential(q, wanted, g)
        scale = min(gains[3] * part, 0.5)
        for k in range(K):
            z[k] -= scale * g[k]
