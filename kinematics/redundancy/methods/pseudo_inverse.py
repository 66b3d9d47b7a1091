"""``Δθ = J† ΔX``: the least step that the linear model asks for.

Open loop, ΔX is the path's own increment: errors of linearisation add up (drift). Closed loop, ΔX
leads from where the arm is to the path, which takes the drift away, and diverges where the path
leaves the workspace. No limit or obstacle is looked at.
"""

from __future__ import annotations

import math
from collections.abc import Generator

import numpy as np

from kinematics.compiled import inner, jit
from kinematics.kernels import Array
from kinematics.redundancy.kernel import (
    increment,
    least_step,
    orthonormal_rows,
    task_at,
    task_rows,
    workspace,
)
from kinematics.redundancy.methods.blocks import in_blocks
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.stop import Stop
from robots.robot import FloatArray

HUGE = 1e6
"""A joint value beyond this has diverged."""


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """See :class:`kinematics.redundancy.methods.Method`."""
    arm, G = problem.arm, problem.path.targets
    leaving, W = departure(problem, options), workspace(arm.K)

    def solve(first: int, last: int) -> tuple[int, int]:
        return _follow(*arm.constants, G, Q, leaving, first, last, options.closed_loop, W)

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
    closed: bool,
    W: Array,
) -> tuple[int, int]:
    K, m = len(is_revolute), len(rows)
    e, y, step = np.empty(m), np.empty(m), np.empty(K)
    J, B, L = np.empty((m, K)), np.empty((m, K)), np.empty((m, m))
    order = np.empty(m, dtype=np.int64)
    for i in range(first, last):
        q = leaving if i == 1 else Q[i - 1]
        task_at(C, is_revolute, mask, rows, own, G[i], q, W, e, J)
        if not closed:
            increment(G[i - 1], G[i], mask, W, K)
            _only_error(rows, own, K, W, e)
        rank = orthonormal_rows(J, B, L, order)
        if rank < m:
            return i, rank
        least_step(B, L, order, e, y, step)
        for k in range(K):
            Q[i, k] = q[k] + step[k]
            if not math.fabs(Q[i, k]) < HUGE:
                return i, rank
    return last, m


@inner
def _only_error(rows: Array, own: bool, K: int, W: Array, e: Array) -> None:
    task_rows(rows, own, K, W, e, np.empty((len(rows), K)))
