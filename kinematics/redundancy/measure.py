"""Measures of a followed path on the model: errors, clearances and steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.compiled import jit
from kinematics.deadline import checkpoint, svd
from kinematics.inverse.task_error import TaskChain, residual
from kinematics.jacobian import task_jacobian
from kinematics.kernels import Array
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.distances import clearances
from kinematics.redundancy.clearance.link_points import link_ends
from kinematics.redundancy.clearance.links import Links
from kinematics.redundancy.clearance.sweep import most_visits, swept_clearances
from kinematics.redundancy.kernel import workspace
from kinematics.redundancy.problem import PathProblem, PathTolerance
from robots.robot import FloatArray

LOOKS = np.linspace(0.0, 1.0, 33)[1:-1]
"""Parts of the way between two samples at which the clearance is evaluated."""
SWEPT = 16
"""Intervals swept between two checkpoints."""


@dataclass(frozen=True, eq=False)
class Measures:
    """Measures of the samples that were computed, n of N.

    Attributes:
        position_error: m, shape (n,).
        orientation_error: rad, shape (n,).
        clearance: Least signed distance of a link to an obstacle, m, shape (n,); inf where there
            are no obstacles.
        nearest: Link and obstacle of that distance, shape (n, 2); -1 where there are none.
        swept: A lower bound of the clearance between a sample and the next, shape (n - 1,); the
            least of all is exact to :data:`kinematics.redundancy.clearance.sweep.RESOLUTION`.
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

    def off_path(self, tolerance: PathTolerance) -> NDArray[np.bool_]:
        """Which samples are beyond the tolerance, shape (n,)."""
        return np.asarray(
            (self.position_error > tolerance.position)
            | (self.orientation_error > tolerance.orientation)
        )

    @property
    def min_swept(self) -> float:
        """Least clearance at samples and between, m; inf without obstacles."""
        return float(min(self.clearance.min(initial=np.inf), self.swept.min(initial=np.inf)))


def errors_at(problem: PathProblem, Q: FloatArray, first: int = 0) -> tuple[FloatArray, FloatArray]:
    """Return position (m) and orientation errors (rad) of samples from ``first``; Q: (n, K)."""
    e = error_vectors(problem.arm, Q, problem.path.targets[first : first + len(Q)])
    return np.linalg.norm(e[:, :3], axis=1), np.linalg.norm(e[:, 3:], axis=1)


def error_vectors(arm: Arm, Q: FloatArray, targets: FloatArray) -> FloatArray:
    """Return task errors of Q, shape (n, K), to poses, shape (n, 12): m and rad, shape (n, 6)."""
    out = np.empty((len(Q), 6))
    _errors(arm.constants.chain, np.ascontiguousarray(Q), targets, workspace(arm.chain.length), out)
    return out


def clearances_at(problem: PathProblem, Q: FloatArray) -> tuple[FloatArray, NDArray[np.int64]]:
    """Return the least clearances, m, and link and obstacle of each; Q has shape (n, K)."""
    found, whose = np.empty(len(Q)), np.empty((len(Q), 2), dtype=np.int64)
    chain, W = problem.arm.constants.chain, workspace(problem.arm.chain.length, len(problem.links))
    clearances(chain, np.ascontiguousarray(Q), problem.scene, W, found, whose)
    return found, whose


def manipulability_at(problem: PathProblem, q: FloatArray) -> FloatArray:
    """Return Yoshikawa's w of the task at q of all joints, shape (n, dof); shape (n,)."""
    arm = problem.arm
    J = task_jacobian(arm.robot, q, arm.task, arm.frame)
    return np.asarray(np.prod(svd(J, compute_uv=False), axis=-1))


def nearest_part(problem: PathProblem, a: FloatArray, b: FloatArray) -> float:
    """Return the part of the way from a to b, shape (K,), where the clearance is least."""
    found, _ = clearances_at(problem, a + LOOKS[:, None] * (b - a))
    return float(LOOKS[int(np.argmin(found))])


def ends_of_links(problem: PathProblem, Q: FloatArray) -> FloatArray:
    """Return the ends of the links' segments at Q, shape (n, K); shape (n, L, 2, 3), m."""
    return segment_ends(problem.arm, problem.links, Q)


def segment_ends(arm: Arm, links: Links, Q: FloatArray) -> FloatArray:
    """Return the ends of the segments of an arm's links; see :func:`ends_of_links`."""
    rows = links.rows
    out = np.empty((len(Q), len(rows), 6))
    chain, W = arm.constants.chain, workspace(arm.chain.length, len(rows))
    link_ends(chain, np.ascontiguousarray(Q), rows, W, out)
    return out.reshape(len(Q), len(rows), 2, 3)


def swept_between(problem: PathProblem, Q: FloatArray) -> FloatArray:
    """Return the swept clearances :attr:`Measures.swept`, m; Q has shape (n, K)."""
    swept = np.full(len(Q) - 1, np.inf)
    if len(problem.obstacles):
        chain, scene = problem.arm.constants.chain, problem.scene
        W = workspace(problem.arm.chain.length, len(problem.links))
        most = most_visits(scene, len(swept))
        Q, least = np.ascontiguousarray(Q), np.inf
        for first in range(0, len(swept), SWEPT):
            checkpoint()
            last = min(first + SWEPT, len(swept))
            part, found = Q[first : last + 1], swept[first:last]
            least = swept_clearances(chain, part, scene, least, most, W, found)
    return swept


def measure(problem: PathProblem, Q: FloatArray) -> Measures:
    """Return the measures of joint values of shape (n, K)."""
    chain = problem.arm.chain
    Q = np.ascontiguousarray(Q)
    position, orientation = errors_at(problem, Q)
    clearance, nearest = clearances_at(problem, Q)
    swept = swept_between(problem, Q)
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
def _errors(chain: TaskChain, Q: Array, G: Array, W: Array, out: Array) -> None:
    """Compute the task errors of Q, shape (n, K), to poses G, shape (n, 12); out (n, 6)."""
    for i in range(len(Q)):
        residual(chain, G[i], Q[i], W)
        out[i] = W[len(chain.is_revolute) + 1, 0:6]
