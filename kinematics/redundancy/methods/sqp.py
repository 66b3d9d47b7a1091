"""The nonlinear program of each sample: ``min ½ ‖θ − θ_prev‖² + w Σ φ(d)``.

Subject to ``f(θ) = P``, limits, speeds and ``d ≥ d_safe + margin``, by SciPy's SLSQP with analytic
gradients (Kraft 1988; the formulation of the ICM'15 paper on hyper-redundant planar arms). φ is the
repulsion of :func:`~kinematics.redundancy.steps.gradients.obstacle_potential`. What SLSQP says
of itself is not believed: error and clearance are measured, and where they do not hold, see
:mod:`kinematics.redundancy.steps.best_effort`.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize

from kinematics.compiled import jit
from kinematics.deadline import checkpoint
from kinematics.inverse.task_error import TaskChain, columns, residual
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import Pairs, Scene, listed_pairs, near_pairs
from kinematics.redundancy.kernel import (
    ArmConstants,
    exact_error_columns,
    task_rows,
    workspace,
)
from kinematics.redundancy.methods.qp import advance
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.steps.gradients import Repulsion, obstacle_potential
from kinematics.redundancy.steps.linearised import MOST_PAIRS, Linearised, Way, place_on_way
from kinematics.redundancy.stop import Stop
from robots.robot import FloatArray

ACCURACY = 1e-11
"""SLSQP's ftol: on the objective and on the sum of violations."""
EXACT = 1e-8
"""Largest task error, m and rad, and missing clearance of a sample that counts as solved."""
ITERATIONS = 60


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """Follow a path; see :class:`kinematics.redundancy.methods.Method`."""
    program = _Program(problem, options)
    model = Linearised(problem, options)
    previous = departure(problem, options)
    for i in range(1, len(Q)):
        Q[i] = advance(model, previous, problem.path.targets[i], program.solve)
        previous = Q[i]
        yield i + 1
    return None


class ProgramArrays(NamedTuple):
    """What the program of a sample is at one q, filled by :func:`look`.

    Attributes:
        e: Task error, m and rad, shape (m,).
        J: Minus its derivative, shape (m, K).
        d: Clearances at P parts of the way, m, shape (P, count).
        g: Their gradients with respect to q, shape (P, count, K).
        whose: Link and obstacle of each pair, shape (count or more, 2).
        phi: Gradient of the repulsion, shape (K,).
    """

    e: Array
    J: Array
    d: Array
    g: Array
    whose: Array
    phi: Array


class _Program:
    """The program of one sample, with values and gradients computed together."""

    def __init__(self, problem: PathProblem, options: PathOptions) -> None:
        K, m = problem.arm.K, problem.arm.m
        self.problem = problem
        self.weight = float(options.obstacle_weight) if len(problem.obstacles) else 0.0
        influence = options.reach_of_obstacles(problem)
        self.repulsion = Repulsion(float(problem.d_safe), float(influence))
        room = min(MOST_PAIRS, len(problem.links) * len(problem.obstacles))
        whose = np.empty((room, 2), dtype=np.int64)
        self.near = Pairs(np.empty(room), np.empty((room, K)), whose)
        self.e, self.J, self.phi = np.empty(m), np.empty((m, K)), np.empty(K)
        self.way, self.arrays = Way(np.empty(K), np.ones(1)), self._arrays(1, 0)
        self.W = workspace(problem.arm.chain.length, len(problem.links))
        self.seen = np.full(K, np.nan)
        self.value = 0.0

    def _arrays(self, parts: int, count: int) -> ProgramArrays:
        """Return room for so many pairs at so many parts of the way."""
        d, g = np.empty((parts, count)), np.empty((parts, count, self.problem.arm.K))
        return ProgramArrays(self.e, self.J, d, g, self.near.whose, self.phi)

    def solve(
        self, model: Linearised, previous: FloatArray, target: FloatArray, need: float
    ) -> FloatArray | None:
        """Return the sample after ``previous``; None where it was not solved, as measured."""
        problem, count, K = self.problem, 0, len(previous)
        low, high, near, _ = model.region
        if len(problem.obstacles):
            chain = problem.arm.constants.chain
            count, _ = near_pairs(chain, previous, problem.scene, near, self.W, self.near)
        self.way = Way(previous, model.way.parts)
        self.arrays = self._arrays(len(self.way.parts), count)
        d, g, needs = self.arrays.d, self.arrays.g, model.needs(need)[:, None]
        self.seen[:] = np.nan
        start = np.clip(previous, low, high)
        self._look(start, target)
        # Rows that the arm cannot move and need not move would make the equations singular.
        rows = (np.abs(self.J).max(axis=1) > 1e-12) | (np.abs(self.e) > 1e-12)

        def objective(q: FloatArray) -> tuple[float, FloatArray]:
            self._look(q, target)
            away = q - previous
            value = 0.5 * float(away @ away) + self.weight * self.value
            return value, away + self.weight * self.phi

        def on_path(q: FloatArray) -> FloatArray:
            self._look(q, target)
            return np.asarray(-self.e[rows])

        def on_path_slope(q: FloatArray) -> FloatArray:
            self._look(q, target)
            return np.asarray(self.J[rows])

        def apart(q: FloatArray) -> FloatArray:
            self._look(q, target)
            return np.asarray((d - needs).reshape(-1))

        def apart_slope(q: FloatArray) -> FloatArray:
            self._look(q, target)
            return g.reshape(-1, K).copy()

        constraints: Any = [{"type": "eq", "fun": on_path, "jac": on_path_slope}]
        if count:
            constraints.append({"type": "ineq", "fun": apart, "jac": apart_slope})
        program: Any = minimize
        found = program(
            objective,
            start,
            jac=True,
            bounds=np.column_stack((low, high)),
            constraints=constraints,
            method="SLSQP",
            options={"ftol": ACCURACY, "maxiter": ITERATIONS},
        )
        if not np.isfinite(found.x).all():
            return None
        q = np.clip(found.x, low, high)
        model.at(q, target, need)
        solved = model.error <= EXACT * EXACT and model.missing <= EXACT
        return q if solved else None

    def _look(self, q: FloatArray, target: FloatArray) -> None:
        if (q == self.seen).all():
            return
        checkpoint()
        self.seen[:] = q
        arm, scene = self.problem.arm.constants, self.problem.scene
        self.value = look(
            arm,
            scene,
            self.repulsion,
            self.weight,
            self.way,
            target,
            self.seen,
            self.W,
            self.arrays,
        )


@jit
def look(
    arm: ArmConstants,
    scene: Scene,
    repulsion: Repulsion,
    weight: float,
    way: Way,
    target: Array,
    q: Array,
    W: Array,
    out: ProgramArrays,
) -> float:
    """Compute everything of the program at q: error, its derivative, clearances, repulsion.

    Clearances and their gradients with respect to q are those where the parts of the way to q are
    done. With ``own`` axes the derivative is that of the linear model, exact on the path.

    Args:
        arm: Constants of the arm.
        scene: Links and obstacles.
        repulsion: How obstacles repel.
        weight: Of the repulsion; 0: it is not computed.
        way: The way to q.
        target: Pose in base axes, 12 numbers.
        q: Joint values, rad and m, shape (K,).
        W: Workspace.
        out: Filled.

    Returns:
        The potential of the repulsion.
    """
    chain = arm.chain
    if arm.own:
        residual(chain, target, q, W)
        columns(chain, W)
    else:
        ones = np.ones(7)
        ones[6] = 0.0
        every = TaskChain(chain.C, chain.is_revolute, ones, chain.coupling, chain.offset)
        residual(every, target, q, W)
        columns(every, W)
        exact_error_columns(chain, W)
    task_rows(arm, W, out.e, out.J)
    parts, count, K = way.parts, out.d.shape[1], len(q)
    if count > 0:
        x = np.empty(K)
        for p in range(len(parts)):
            place_on_way(way, p, q, x)
            g = out.g[p]
            listed_pairs(chain, x, scene, W, Pairs(out.d[p], g, out.whose))
            for i in range(count):
                for j in range(K):
                    g[i, j] *= parts[p]
    out.phi[:] = 0.0
    if weight > 0.0:
        return obstacle_potential(chain, q, scene, repulsion, W, out.phi)
    return 0.0
