"""What a followed path is like: errors, clearances and steps, measured on the model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.compiled import jit
from kinematics.deadline import checkpoint
from kinematics.inverse.kernel import residual
from kinematics.kernels import Array
from kinematics.redundancy.distances import clearances
from kinematics.redundancy.kernel import workspace
from kinematics.redundancy.problem import Problem
from kinematics.redundancy.sweep import RESOLUTION, swept_clearances
from robots.robot import FloatArray

SWEPT = 16
"""Intervals that are swept between two checkpoints."""


@dataclass(frozen=True, eq=False)
class Measures:
    """Measures of the samples that were computed, n of N.

    Attributes:
        position_error: m, shape (n,).
        orientation_error: rad, shape (n,).
        clearance: Least signed distance of a link to an obstacle, m, shape (n,); inf where there
            are no obstacles.
        nearest: Link and obstacle of it, shape (n, 2); -1 where there are none.
        swept: A lower bound of the clearance between a sample and the next, shape (n - 1,); the
            least of all is exact to :data:`kinematics.redundancy.sweep.RESOLUTION`.
        limit_margin: Distance to the nearest limit, rad or m, negative beyond; shape (n,).
        speed_ratio: Largest |Δq| / (dt * speed limit) of a step, shape (n - 1,); 0 without limits.
        step: ‖Δq‖ of each step, shape (n - 1,).
        largest_step: Largest |Δq_j| of all.
    """

    position_error: FloatArray
    orientation_error: FloatArray
    clearance: FloatArray
    nearest: NDArray[np.int64]
    swept: FloatArray
    limit_margin: FloatArray
    speed_ratio: FloatArray
    step: FloatArray
    largest_step: float

    @property
    def min_swept(self) -> float:
        """Least clearance at samples and between, m; inf without obstacles."""
        return float(min(self.clearance.min(initial=np.inf), self.swept.min(initial=np.inf)))


def errors_at(problem: Problem, Q: FloatArray, first: int = 0) -> tuple[FloatArray, FloatArray]:
    """Position and orientation errors of samples ``first`` onwards; Q has shape (n, K)."""
    out = np.empty((len(Q), 2))
    C, turns, mask, _, _ = problem.arm.constants
    targets = problem.path.targets[first : first + len(Q)]
    _errors(C, turns, mask, np.ascontiguousarray(Q), targets, workspace(problem.arm.K), out)
    return out[:, 0], out[:, 1]


def clearances_at(problem: Problem, Q: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
    """Least clearances, and link and obstacle of each; Q has shape (n, K)."""
    found, whose = np.empty(len(Q)), np.empty((len(Q), 2), dtype=np.int64)
    C, turns, *_ = problem.arm.constants
    W = workspace(problem.arm.K)
    Q = np.ascontiguousarray(Q)
    clearances(C, turns, Q, problem.obstacles, problem.link_radius, W, found, whose)
    return found, whose


def measure(problem: Problem, Q: FloatArray) -> Measures:
    """Measures joint values of shape (n, K)."""
    arm, chain = problem.arm, problem.arm.chain
    Q = np.ascontiguousarray(Q)
    position, orientation = errors_at(problem, Q)
    clearance, nearest = clearances_at(problem, Q)
    swept = np.full(len(Q) - 1, np.inf)
    C, turns, *_ = arm.constants
    if len(problem.obstacles):
        world = problem.obstacles, problem.link_radius
        W, least = workspace(arm.K), np.inf
        for first in range(0, len(swept), SWEPT):
            checkpoint()
            last = min(first + SWEPT, len(swept))
            least = swept_clearances(C, turns, Q, *world, RESOLUTION, W, swept, first, last, least)
    steps = np.abs(np.diff(Q, axis=0))
    most = problem.most_per_step
    return Measures(
        position,
        orientation,
        clearance,
        nearest,
        swept,
        np.minimum(Q - chain.lower, chain.upper - Q).min(axis=1),
        (steps / most).max(axis=1, initial=0.0),
        np.linalg.norm(steps, axis=1),
        float(steps.max(initial=0.0)),
    )


@jit
def _errors(C: Array, turns: Array, mask: Array, Q: Array, G: Array, W: Array, out: Array) -> None:
    for i in range(len(Q)):
        position, rotation = residual(C, turns, mask, G[i], Q[i], W)
        out[i, 0], out[i, 1] = np.sqrt(position), np.sqrt(rotation)
