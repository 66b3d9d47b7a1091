"""Damped least squares: ``Δθ = Jᵀ (J Jᵀ + λ² I)⁻¹ ΔX``, repeated in a sample until it is reached.

The damping grows where a step would lead away (Levenberg-Marquardt), so that the arm stops at the
border of its workspace and does not swing about it. No limit or obstacle is looked at.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from kinematics.compiled import jit
from kinematics.inverse.damped_least_squares import columns, damped, residual
from kinematics.kernels import Array
from kinematics.redundancy.kernel import workspace
from kinematics.redundancy.methods.blocks import in_blocks
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.stop import Stop
from robots.robot import FloatArray

EXACT = 1e-10
"""Error at which a sample is done, m and rad."""


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """See :class:`kinematics.redundancy.methods.Method`."""
    arm = problem.arm
    leaving, W = departure(problem, options), workspace(arm.K)
    C, is_revolute, mask, _, _ = arm.constants

    def solve(first: int, last: int) -> tuple[int, int]:
        _follow(
            C, is_revolute, mask, problem.path.targets, Q, leaving, first, last,
            options.damping, options.iterations, W,
        )  # fmt: skip
        return last, arm.m

    return (yield from in_blocks(problem, len(Q), solve))


@jit
def _follow(
    C: Array,
    is_revolute: Array,
    mask: Array,
    G: Array,
    Q: Array,
    leaving: Array,
    first: int,
    last: int,
    damping: float,
    iterations: int,
    W: Array,
) -> None:
    K = len(is_revolute)
    y, trial, floor = np.empty(6), np.empty(K), damping * damping
    for i in range(first, last):
        q, strength = Q[i], floor
        for k in range(K):
            q[k] = leaving[k] if i == 1 else Q[i - 1, k]
        position, rotation = residual(C, is_revolute, mask, G[i], q, W)
        for _ in range(iterations):
            if position <= EXACT * EXACT and rotation <= EXACT * EXACT:
                break
            columns(is_revolute, mask, K, W)
            damped(W[0:K, 6:12], K, strength, W[K + 1, 0:6], y)
            moved = 0.0
            for k in range(K):
                d = 0.0
                for r in range(6):
                    d += W[k, 6 + r] * y[r]
                trial[k] = q[k] + d
                moved = max(moved, abs(d))
            if moved < 1e-15:
                break
            p, r2 = residual(C, is_revolute, mask, G[i], trial, W)
            if p + r2 < position + rotation:
                for k in range(K):
                    q[k] = trial[k]
                position, rotation = p, r2
                strength = max(floor, 0.2 * strength)
            else:
                strength *= 8.0
                residual(C, is_revolute, mask, G[i], q, W)
