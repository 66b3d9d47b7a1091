"""Compiled linear model of task and clearances about a configuration, as rows of a QP."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kinematics.compiled import inner, jit
from kinematics.deadline import checkpoint
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import Pairs, Scene, clearances, near_pairs
from kinematics.redundancy.clearance.sweep import RESOLUTION, swept_clearance
from kinematics.redundancy.kernel import ArmConstants, task_at, workspace
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


class Way(NamedTuple):
    """The way from one sample to the next, and where on it clearances are kept.

    Attributes:
        previous: The sample before, rad and m, shape (K,).
        parts: Parts of the way that are done there, 1 first, the others below 1; shape (P,).
    """

    previous: Array
    parts: Array


class Region(NamedTuple):
    """Where a linear model is taken to hold.

    Attributes:
        low: Lower bounds of q, rad and m, shape (K,).
        high: Upper bounds.
        near: Clearance within which a pair of link and obstacle counts, m.
        longest: Longest error that is aimed at in one step, m; rad alike.
    """

    low: Array
    high: Array
    near: float
    longest: float


class ModelArrays(NamedTuple):
    """Memory of a linear model with m task rows and room for P pairs, filled by :func:`assemble`.

    Attributes:
        e: Task error, m and rad, shape (m,).
        J: Task Jacobian, shape (m, K).
        pairs: Near pairs of link and obstacle.
        A: Rows of the constraints, task first; shape (m + P, K).
        upper: Upper bounds of the step, then of the rows; shape (K + m + P,).
        lower: Lower bounds likewise.
        sense: Kind of each, as DAQP codes it; shape (K + m + P,).
    """

    e: Array
    J: Array
    pairs: Pairs
    A: Array
    upper: Array
    lower: Array
    sense: Array


@inner
def place_on_way(way: Way, p: int, q: Array, x: Array) -> None:
    """Fill x with the configuration where part p of the way to q is done, shape (K,)."""
    part = way.parts[p]
    for j in range(len(q)):
        x[j] = q[j] if p == 0 else way.previous[j] + part * (q[j] - way.previous[j])


@jit
def assemble(
    arm: ArmConstants,
    scene: Scene,
    region: Region,
    way: Way,
    need: Array,
    target: Array,
    q: Array,
    W: Array,
    out: ModelArrays,
) -> tuple[int, int, float, float, float]:
    """Assemble rows ``J δ = e`` and ``∇d δ ≥ need − d`` of near pairs; bounds of δ first.

    Clearances are evaluated where parts s of the way to q are done; there the gradient with
    respect to q is s times that of the clearance. A task row that the arm cannot move and need not
    move is left out.

    Args:
        arm: Constants of the arm.
        scene: Links and obstacles.
        region: Where the model is taken to hold.
        way: The way to q.
        need: Clearance to keep at each part of it, m, shape (P,).
        target: Pose in base axes, 12 numbers.
        q: Where to linearise, rad and m, shape (K,).
        W: Workspace.
        out: Filled.

    Returns:
        Task rows, pairs, squared position error, m², squared rotation error, rad², and the
        largest missing clearance, m (0 for none).
    """
    e, J, d, g = out.e, out.J, out.pairs.d, out.pairs.g
    A, upper, lower, sense = out.A, out.upper, out.lower, out.sense
    K, m = len(q), len(e)
    position, rotation = task_at(arm, target, q, W, e, J)
    size = math.sqrt(max(position, rotation))
    cut = region.longest / size if size > region.longest else 1.0
    for j in range(K):
        lower[j] = max(region.low[j] - q[j], -TRUST)
        upper[j] = min(region.high[j] - q[j], TRUST)
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
    if len(scene.obstacles) > 0:
        x, room = np.empty(K), len(d) // len(way.parts)
        for p in range(len(way.parts)):
            part, wanted = way.parts[p], need[p]
            place_on_way(way, p, q, x)
            end = count + room
            pairs = Pairs(d[count:end], g[count:end], out.pairs.whose[count:end])
            found, least = near_pairs(arm.chain, x, scene, region.near, W, pairs)
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
        region: Bounds of q in the present sample, and what the model looks at.
        way: The way from the sample before, and where on it clearances are kept.
        arrays: Error, Jacobian and pairs at the last configuration, and rows of the QP.
        need: Clearance to keep at a sample, with the margin, m.
        in_between: Clearance to keep between samples, m.
        least: Clearance to keep, m, where the path leaves no room for the margin.
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
        near, longest = self.need + 0.2 * problem.scale, 0.1 * problem.scale
        self.region = Region(np.empty(K), np.empty(K), near, longest)
        self._W = workspace(arm.chain.length, len(problem.links))
        self._e, self._J = np.empty(m), np.empty((m, K))
        self.in_between = problem.d_safe + 0.25 * options.margin + 2 * RESOLUTION
        self.least = problem.d_safe + 2 * RESOLUTION
        self._pairs = pairs
        self.way = Way(np.empty(K), np.ones(1))
        self._needs = np.empty(1)
        self.arrays = self._memory(1)
        self.used = self.count = 0
        self.position = self.rotation = self.missing = 0.0

    def _memory(self, parts: int) -> ModelArrays:
        """Return memory for the pairs at a number of parts of the way."""
        K, count = self.problem.arm.K, parts * self._pairs
        rows = self.problem.arm.m + count
        pairs = Pairs(np.empty(count), np.empty((count, K)), np.empty((count, 2), dtype=np.int64))
        A, upper, lower = np.empty((rows, K)), np.empty(K + rows), np.empty(K + rows)
        sense = np.zeros(K + rows, dtype=np.int32)
        return ModelArrays(self._e, self._J, pairs, A, upper, lower, sense)

    def bound(self, previous: FloatArray, longest: FloatArray) -> None:
        """Set the bounds by limits, speeds and a longest step for the sample after one, (K,)."""
        chain, most = self.problem.arm.chain, np.minimum(self.problem.most_per_step, longest)
        np.maximum(chain.lower, previous - most, out=self.region.low)
        np.minimum(chain.upper, previous + most, out=self.region.high)
        self.way.previous[:] = previous
        self.look_between(())

    def look_between(self, parts: Sequence[float]) -> None:
        """Set the parts of the way from the sample before at which clearances are kept as well."""
        count = len(parts) + 1
        if count != len(self.way.parts):
            self.arrays, self._needs = self._memory(count), np.empty(count)
            self.way = Way(self.way.previous, np.empty(count))
        self.way.parts[:] = (1.0, *parts)

    def needs(self, need: float) -> FloatArray:
        """Return the clearance to keep at each part of the way, m; ``need`` at the sample."""
        self._fill_needs(need)
        return self._needs.copy()

    def _fill_needs(self, need: float) -> None:
        self._needs[:] = min(self.in_between, need)
        self._needs[0] = need

    def at(self, q: FloatArray, target: FloatArray, need: float) -> None:
        """Linearise at q, shape (K,), for a target of 12 numbers and a clearance, m."""
        checkpoint()
        self._fill_needs(need)
        self.used, self.count, self.position, self.rotation, self.missing = assemble(
            self.problem.arm.constants,
            self.problem.scene,
            self.region,
            self.way,
            self._needs,
            target,
            q,
            self._W,
            self.arrays,
        )

    @property
    def error(self) -> float:
        """Squared task error at the last configuration, m² + rad²."""
        return self.position + self.rotation

    def rows(self, task: bool) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.int32]]:
        """Return A, upper, lower, sense of a QP in δ, with the task's rows or without.

        Bounds of δ come first in all but A.
        """
        _, _, _, A, upper, lower, sense = self.arrays
        K, used, count = A.shape[1], self.used, self.count
        total = K + used + count
        if task:
            return A[: used + count], upper[:total], lower[:total], sense[:total]
        keep = np.r_[0:K, K + used : total]
        return A[used : used + count], upper[keep], lower[keep], sense[keep]

    def swept(self, a: FloatArray, b: FloatArray) -> float:
        """Return a lower bound of the clearance between two configurations, up to d_safe, m."""
        problem = self.problem
        chain, enough = problem.arm.constants.chain, float(problem.d_safe)
        return float(swept_clearance(chain, a, b, problem.scene, enough, self._W, VISITS))

    def clearance(self, q: FloatArray) -> float:
        """Return the least clearance at q less the resolution of a swept one, m."""
        chain, found, whose = self.problem.arm.constants.chain, np.empty(1), np.empty((1, 2), int)
        clearances(chain, q[None], self.problem.scene, self._W, found, whose)
        return found.item() - RESOLUTION
