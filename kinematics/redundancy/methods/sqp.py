"""The nonlinear program of each sample: ``min ½ ‖θ − θ_prev‖² + w Σ φ(d)``.

Subject to ``f(θ) = P``, limits, speeds and ``d ≥ d_safe + margin``, by SciPy's SLSQP with analytic
gradients (Kraft 1988; the formulation of the ICM'15 paper on hyper-redundant planar arms). φ is the
repulsion of :func:`~kinematics.redundancy.steps.gradients.obstacle_potential`. What SLSQP says
of itself is not believed: error and clearance are measured, and where they do not hold, see
:mod:`kinematics.redundancy.steps.best_effort`.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
from scipy.optimize import minimize

from kinematics.compiled import jit
from kinematics.deadline import checkpoint
from kinematics.inverse.damped_least_squares import columns, residual
from kinematics.kernels import Array
from kinematics.redundancy.clearance.distances import listed_pairs, near_pairs
from kinematics.redundancy.kernel import exact_error_columns, task_rows, workspace
from kinematics.redundancy.methods.qp import advance
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.steps.gradients import obstacle_potential
from kinematics.redundancy.steps.linearised import MOST_PAIRS, Linearised
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
    """See :class:`kinematics.redundancy.methods.Method`."""
    program = _Program(problem, options)
    model = Linearised(problem, options)
    previous = departure(problem, options)
    for i in range(1, len(Q)):
        Q[i] = advance(model, previous, problem.path.targets[i], program.solve)
        previous = Q[i]
        yield i + 1
    return None


class _Program:
    """The program of one sample, with values and gradients computed together."""

    def __init__(self, problem: PathProblem, options: PathOptions) -> None:
        arm = problem.arm
        self.problem = problem
        self.weight = options.obstacle_weight if len(problem.obstacles) else 0.0
        self.influence = options.reach_of_obstacles(problem)
        pairs = min(MOST_PAIRS, len(problem.links) * len(problem.obstacles))
        self._d, self._g = np.empty(pairs), np.empty((pairs, arm.K))
        self.whose = np.empty((pairs, 2), dtype=np.int64)
        self.count = 0
        self.parts, self.previous = np.ones(1), np.empty(arm.K)
        self.d, self.g = np.empty((1, 0)), np.empty((1, 0, arm.K))
        self.e, self.J = np.empty(arm.m), np.empty((arm.m, arm.K))
        self.phi = np.empty(arm.K)
        self.W = workspace(arm.K, len(problem.links))
        self.seen = np.full(arm.K, np.nan)
        self.value = 0.0

    def solve(
        self, model: Linearised, previous: FloatArray, target: FloatArray, need: float
    ) -> FloatArray | None:
        """The sample after ``previous``; None where the program was not solved, as measured."""
        problem, count, K = self.problem, 0, len(previous)
        if len(problem.obstacles):
            C, is_revolute, *_ = problem.arm.constants
            count, _ = near_pairs(
                C, is_revolute, previous, problem.obstacles, problem.links.rows, model.near, self.W,
                self._d, self._g, self.whose,
            )  # fmt: skip
        self.count, self.parts, self.previous = count, model.parts, previous
        self.d, self.g = np.empty((len(self.parts), count)), np.empty((len(self.parts), count, K))
        needs = model.needs(need)[:, None]
        self.seen[:] = np.nan
        start = np.clip(previous, model.low, model.high)
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
            return np.asarray((self.d - needs).reshape(-1))

        def apart_slope(q: FloatArray) -> FloatArray:
            self._look(q, target)
            return self.g.reshape(-1, K).copy()

        constraints: Any = [{"type": "eq", "fun": on_path, "jac": on_path_slope}]
        if count:
            constraints.append({"type": "ineq", "fun": apart, "jac": apart_slope})
        program: Any = minimize
        found = program(
            objective,
            start,
            jac=True,
            bounds=np.column_stack((model.low, model.high)),
            constraints=constraints,
            method="SLSQP",
            options={"ftol": ACCURACY, "maxiter": ITERATIONS},
        )
        if not np.isfinite(found.x).all():
            return None
        q = np.clip(found.x, model.low, model.high)
        model.at(q, target, need)
        solved = model.error <= EXACT * EXACT and model.missing <= EXACT
        return q if solved else None

    def _look(self, q: FloatArray, target: FloatArray) -> None:
        if np.array_equal(q, self.seen):
            return
        checkpoint()
        self.seen[:] = q
        problem = self.problem
        self.value = look(
            *problem.arm.constants, target, self.seen, self.previous, self.parts,
            problem.obstacles, problem.links.rows, problem.d_safe, self.influence, self.weight,
            self.whose, self.count, self.W, self.e, self.J, self.d, self.g, self.phi,
        )  # fmt: skip


@jit
def look(
    C: Array,
    is_revolute: Array,
    mask: Array,
    rows: Array,
    own: bool,
    target: Array,
    q: Array,
    previous: Array,
    parts: Array,
    obstacles: Array,
    S: Array,
    safe: float,
    influence: float,
    weight: float,
    whose: Array,
    count: int,
    W: Array,
    e: Array,
    J: Array,
    d: Array,
    g: Array,
    phi: Array,
) -> float:
    """Everything of the program at q: error, its exact derivative, clearances, repulsion.

    Clearances d, shape (P, count), and their gradients with respect to q, shape (P, count, K), are
    those where the parts of the way from ``previous`` to q are done.

    With ``own`` axes the derivative is that of the linear model, exact on the path.
    """
    K = len(q)
    if own:
        residual(C, is_revolute, mask, target, q, W)
        columns(is_revolute, mask, K, W)
    else:
        every = np.ones(7)
        every[6] = 0.0
        residual(C, is_revolute, every, target, q, W)
        columns(is_revolute, every, K, W)
        exact_error_columns(mask, K, W)
    task_rows(rows, own, K, W, e, J)
    if count > 0:
        x = np.empty(K)
        for p in range(len(parts)):
            for j in range(K):
                x[j] = q[j] if p == 0 else previous[j] + parts[p] * (q[j] - previous[j])
            listed_pairs(C, is_revolute, x, obstacles, S, whose, count, W, d[p], g[p])
            for i in range(count):
                for j in range(K):
                    g[p, i, j] *= parts[p]
    phi[:] = 0.0
    if weight > 0.0:
        return obstacle_potential(C, is_revolute, q, obstacles, S, safe, influence, W, phi)
    return 0.0
