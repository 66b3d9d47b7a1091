"""Compiled linear model of task and clearances about a configuration, as rows of a QP."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kinematics.compiled import jit
from kinematics.deadline import checkpoint
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import near_pairs
from kinematics.redundancy.clearance.sweep import RESOLUTION, swept_clearance
from kinematics.redundancy.kernel import task_at, workspace
from kinematics.redundancy.measure import clearances_at
from kinematics.redundancy.problem import PathOptions, PathProblem
from robots.robot import FloatArray

MOST_PAIRS = 256
"""Largest number of pairs of link and obstacle in one QP; the nearest are taken."""
TRUST = 0.3
"""Largest motion of a joint in one QP, rad or m."""
VISITS = 2000
"""Largest number of configurations evaluated between two samples."""
EQUAL, SOFT = 5, 8
FREE = 1e30


@jit
def assemble(
    C: Array,
    is_revolute: Array,
    mask: Array,
    rows: Array,
    own: bool,
    target: Array,
    q: Array,
    low: Array,
    high: Array,
    previous: Array,
    parts: Array,
    obstacles: Array,
    S: Array,
    near: float,
    need: Array,
    longest: float,
    W: Array,
    e: Array,
    J: Array,
    d: Array,
    g: Array,
    whose: Array,
    A: Array,
    upper: Array,
    lower: Array,
    sense: Array,
) -> tuple[int, int, float, float, float]:
    """Compute rows ``J δ = e`` and ``∇d δ ≥ need − d`` of pairs nearer than ``near``, bounds first.

    Clearances are evaluated at parts s of the way from ``previous`` to q, s = 1 first; there the
    gradient with respect to q is s times that of the clearance. An error longer than ``longest``
    (m, and rad) is shortened to it. A task row that the arm cannot move and need not move is
    left out.

    Returns:
        Task rows, pairs, squared position and rotation error, and the largest missing clearance,
        m (0 for none).
    """
    K, m = len(q), len(rows)
    position, rotation = task_at(C, is_revolute, mask, rows, own, target, q, W, e, J)
    size = math.sqrt(max(position, rotation))
    cut = longest / size if size > longest else 1.0
    for j in range(K):
        lower[j] = max(low[j] - q[j], -TRUST)
        upper[j] = min(high[j] - q[j], TRUST)
    used = 0
    for i in range(m):
        largest = abs(e[i])
        for j in range(K):
            largest = max(largest, abs(J[i, j]))
        if largest < 1e-12:
            continue
        for j in range(K):
            A[used, j] = J[i, j]
        upper[K + used] = lower[K + used] = cut * e[i]
        sense[K + used] = EQUAL
        used += 1
    count, missing = 0, 0.0
    if len(obstacles) > 0:
        x, room = np.empty(K), len(d) // len(parts)
        for p in range(len(parts)):
            part, wanted = parts[p], need[p]
            for j in range(K):
                x[j] = q[j] if p == 0 else previous[j] + part * (q[j] - previous[j])
            end = count + room
            found, least = near_pairs(
                C,
                is_revolute,
                x,
                obstacles,
                S,
                near,
                W,
                d[count:end],
                g[count:end],
                whose[count:end],
            )
            missing = max(missing, wanted - least)
            for i in range(count, count + found):
                for j in range(K):
                    A[used + i, j] = part * g[i, j]
                lower[K + used + i] = wanted - d[i]
                upper[K + used + i] = FREE
                sense[K + used + i] = 0
            count += found
    return used, count, position, rotation, missing


class Linearised:
    """The linear model of one problem, in memory reused at every configuration.

    Attributes:
        low: Bounds of q in the present sample, shape (K,).
        high: Likewise.
        e: Task error at the last configuration, shape (m,).
        J: Task Jacobian, shape (m, K).
        need: Clearance to keep at a sample, with the margin, m.
        in_between: Clearance to keep between samples, m.
        least: Clearance to keep where the path leaves no room for the margin, m.
        parts: Parts of the way from the sample before at which clearances are kept, 1 at first.
        used: Task rows of the QP.
        count: Near pairs.
        position: Squared position error.
        rotation: Squared rotation error.
        missing: Largest missing clearance at one of the parts, m; 0 for none.
    """

    def __init__(self, problem: PathProblem, options: PathOptions) -> None:
        arm = problem.arm
        K, m = arm.K, arm.m
        pairs = min(MOST_PAIRS, len(problem.links) * len(problem.obstacles))
        self.problem = problem
        self.need = problem.d_safe + options.margin
        self.near = self.need + 0.2 * problem.scale
        self.longest = 0.1 * problem.scale
        self.low, self.high = np.empty(K), np.empty(K)
        self._W = workspace(K, len(problem.links))
        self.e, self.J = np.empty(m), np.empty((m, K))
        self.in_between = problem.d_safe + 0.25 * options.margin + 2 * RESOLUTION
        self.least = problem.d_safe + 2 * RESOLUTION
        self._pairs = pairs
        self._memory(1)
        self.parts = np.ones(1)
        self.previous = np.empty(K)
        self.used = self.count = 0
        self.position = self.rotation = self.missing = 0.0

    def _memory(self, parts: int) -> None:
        """Allocate memory for the pairs at a number of parts."""
        K, pairs = self.problem.arm.K, parts * self._pairs
        rows = self.problem.arm.m + pairs
        self._d, self._g = np.empty(pairs), np.empty((pairs, K))
        self._whose = np.empty((pairs, 2), dtype=np.int64)
        self._A = np.empty((rows, K))
        self._upper, self._lower = np.empty(K + rows), np.empty(K + rows)
        self._sense = np.zeros(K + rows, dtype=np.int32)

    def bound(self, previous: FloatArray) -> None:
        """Set the bounds by limits and speeds for the sample after a configuration."""
        chain, most = self.problem.arm.chain, self.problem.most_per_step
        np.maximum(chain.lower, previous - most, out=self.low)
        np.minimum(chain.upper, previous + most, out=self.high)
        self.previous[:] = previous
        self.look_between(np.empty(0))

    def look_between(self, parts: FloatArray) -> None:
        """Set the parts of the way from the sample before at which clearances are kept as well."""
        if len(parts) + 1 != len(self.parts):
            self._memory(len(parts) + 1)
        self.parts = np.r_[1.0, parts]

    def needs(self, need: float) -> FloatArray:
        """Return the clearance to keep at each part, m: at most ``need``, at the sample itself."""
        wanted = np.full(len(self.parts), min(self.in_between, need))
        wanted[0] = need
        return wanted

    def at(self, q: FloatArray, target: FloatArray, need: float) -> None:
        """Linearise at q."""
        checkpoint()
        problem = self.problem
        self.used, self.count, self.position, self.rotation, self.missing = assemble(
            *problem.arm.constants, target, q, self.low, self.high, self.previous, self.parts,
            problem.obstacles, problem.links.rows, self.near, self.needs(need), self.longest,
            self._W, self.e, self.J, self._d, self._g, self._whose, self._A, self._upper,
            self._lower, self._sense,
        )  # fmt: skip

    @property
    def error(self) -> float:
        """Squared task error at the last configuration, m² + rad²."""
        return self.position + self.rotation

    def rows(self, task: bool) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.int32]]:
        """Return A, upper, lower (bounds first), sense of a QP in δ, with or without the task."""
        K, used, count = len(self.low), self.used, self.count
        total = K + used + count
        if task:
            parts = self._A[: used + count], self._upper[:total], self._lower[:total]
            return *parts, self._sense[:total]
        keep = np.r_[0:K, K + used : total]
        parts = self._A[used : used + count], self._upper[keep], self._lower[keep]
        return *parts, self._sense[keep]

    def swept(self, a: FloatArray, b: FloatArray) -> float:
        """Return a lower bound of the clearance between two configurations, m, where it matters."""
        problem = self.problem
        C, is_revolute, *_ = problem.arm.constants
        return float(
            swept_clearance(
                C, is_revolute, a, b, problem.obstacles, problem.links.rows, problem.d_safe,
                RESOLUTION, self._W, VISITS,
            )
        )  # fmt: skip

    def clearance(self, q: FloatArray) -> float:
        """Return the least clearance at q less the resolution of a swept one, m."""
        found, _ = clearances_at(self.problem, q[None])
        return float(found[0]) - RESOLUTION
