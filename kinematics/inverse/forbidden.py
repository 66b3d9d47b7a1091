"""What forbids a target that is not reached, by how much, and on each branch which joint."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from kinematics.chain import Chain, chain_of
from kinematics.deadline import checkpoint
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.result import Tolerance
from kinematics.inverse.solutions import IKSolution, IKSolutions
from kinematics.inverse.starts import starts
from kinematics.inverse.task_error import columns, residual, task_chain, workspace
from kinematics.task import Task
from robots.robot import FloatArray, Robot

STARTS = 5
STEPS = 80
LONGEST = 0.4
"""Largest step of a joint, rad or parts of the robot's span."""
DAMPING, YIELDING = 1e-8, 1e-2
"""Of the steps, squared, in parts of the largest singular value: towards the goal that is reached,
and towards the one that gives way."""
MOST_BRANCHES = 16
"""Branches that are listed, the least beyond the limits first."""


class Forbids(StrEnum):
    """What of a target is out of reach: the first that is."""

    POSITION = "position"
    ORIENTATION = "orientation"
    LIMITS = "limits"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class JointBeyond:
    """A joint beyond its limit.

    Attributes:
        joint: Its name.
        value: rad or m.
        limit: The limit that it passes.
        excess: By how much, above 0.
        is_revolute: Whether these are angles.
    """

    joint: str
    value: float
    limit: float
    excess: float
    is_revolute: bool


@dataclass(frozen=True, eq=False)
class BranchBeyond:
    """A solution that the limits forbid.

    Attributes:
        posture: Names of its branch; empty where there are none.
        q: Shape (dof,), rad and m.
        joints: Those beyond their limits, the farthest first.
    """

    posture: tuple[str, ...]
    q: FloatArray
    joints: tuple[JointBeyond, ...]


@dataclass(frozen=True)
class Forbidden:
    """What forbids a target.

    Attributes:
        by: What does.
        proven: Whether it is proved that the target is out of reach, else a search did not reach
            it. It says nothing of the misses.
        position_miss: m. Where the position forbids it: the distance that is proved to be missed
            at the least by an arm that is too short, else the smallest that a search found. Where
            the orientation does: the smallest at which a search found the orientation reached.
        orientation_miss: rad. The angle that is proved to be missed at the least where the axes
            cannot turn the frame so, wherever it is; else the smallest that a search found while
            the position is reached, within the limits, which is no bound.
        branches: The branches that limits forbid; each at the solution that is least beyond them.
    """

    by: Forbids
    proven: bool
    position_miss: float | None = None
    orientation_miss: float | None = None
    branches: tuple[BranchBeyond, ...] = ()


def branches_beyond(robot: Robot, found: IKSolutions) -> tuple[BranchBeyond, ...]:
    """Return the solutions of each branch that are least beyond the limits, the nearest first.

    Where branches have no names, each solution is one.

    Args:
        robot: The robot.
        found: Solutions, all of them beyond the limits.
    """
    least: dict[object, IKSolution] = {}
    for number, one in enumerate(found.solutions):
        key: object = one.posture or number
        if key not in least or _excess(robot, one.q) < _excess(robot, least[key].q):
            least[key] = one
    ordered = sorted(least.values(), key=lambda one: _excess(robot, one.q))
    return tuple(
        BranchBeyond(one.posture, one.q, _beyond(robot, one.q)) for one in ordered[:MOST_BRANCHES]
    )


def _excess(robot: Robot, q: FloatArray) -> float:
    return float(np.maximum(np.maximum(robot.lower - q, q - robot.upper), 0.0).max())


def _beyond(robot: Robot, q: FloatArray) -> tuple[JointBeyond, ...]:
    over = np.maximum(np.maximum(robot.lower - q, q - robot.upper), 0.0)
    return tuple(
        JointBeyond(
            robot.joints[k].name,
            float(q[k]),
            float(robot.lower[k] if q[k] < robot.lower[k] else robot.upper[k]),
            float(over[k]),
            bool(robot.is_revolute[k]),
        )
        for k in np.argsort(-over)
        if over[k] > 0.0
    )


def least_misses(
    robot: Robot,
    target: FloatArray,
    frame: str,
    task: Task,
    seed: FloatArray | None,
    tolerance: Tolerance,
    known: tuple[FloatArray, ...] = (),
) -> tuple[float | None, float | None]:
    """Return the smallest misses that were found: of position, m, and of orientation, rad.

    Each within the limits while the other is reached, by steps that let the one give way to the
    other, from several starts; None where the other is not reached either.

    Args:
        robot: The robot.
        target: Pose of the frame in base axes, 4x4.
        frame: Frame name.
        task: The task space.
        seed: The first start, shape (dof,); None: mid-range.
        tolerance: With which the other counts as reached.
        known: Further starts, shape (dof,).
    """
    if not task.positions or not task.rotations:
        return None, None
    chain = chain_of(robot, frame)
    bounds = JointBounds.of(robot)
    low, high = bounds.ranges(chain.reach if np.isfinite(chain.reach) else 1.0)
    offset, ratio, lowest, span = starts(0, low[chain.columns], high[chain.columns])
    first = bounds.inside(bounds.middle() if seed is None else seed)[chain.columns]
    near = [first, *(one[chain.columns] for one in known)]
    rows = np.array(
        [*near, *(lowest + (offset + n * ratio) % 1.0 * span for n in range(1, STARTS))]
    )
    search = _Search(chain, task, np.ascontiguousarray(target, dtype=np.float64).reshape(16))
    positions = [search.settled(q, POSITION, ROTATION, tolerance.position) for q in rows]
    rotations = [search.settled(q, ROTATION, POSITION, tolerance.orientation) for q in rows]
    missed = [one for one in rotations if one is not None]
    turned = [one for one in positions if one is not None]
    return min(missed, default=None), min(turned, default=None)


POSITION, ROTATION = slice(0, 3), slice(3, 6)


@dataclass(frozen=True, eq=False)
class _Search:
    chain: Chain
    task: Task
    target: FloatArray

    def settled(self, q: FloatArray, first: slice, second: slice, within: float) -> float | None:
        """Return the rest of the second error where the first is brought to 0; None: it is not."""
        chain, constants = self.chain, task_chain(self.chain, self.task)
        scale = np.where(chain.is_angle, 1.0, max(1e-3, min(chain.reach, 1e3)))
        n, best = len(q), np.inf
        for _ in range(STEPS):
            checkpoint()
            W = workspace(chain.length)
            residual(constants, self.target, q, W)
            error = W[chain.length + 1, :6].copy()
            columns(constants, W)
            J = W[:n, 6:12].T * scale
            if float(np.linalg.norm(error[first])) <= within:
                best = min(best, float(np.linalg.norm(error[second])))
            step = self._step(J, error, q, scale, (first, second))
            if float(np.abs(step).max(initial=0.0)) < 1e-7:
                break
            q = np.clip(q + scale * step, chain.lower, chain.upper)
        return best if np.isfinite(best) else None

    def _step(
        self,
        J: FloatArray,
        error: FloatArray,
        q: FloatArray,
        scale: FloatArray,
        order: tuple[slice, slice],
    ) -> FloatArray:
        """Return a step in which joints that are at their limits and would pass them stay."""
        free = np.ones(len(q), dtype=np.bool_)
        while free.any():
            step = np.zeros(len(q))
            step[free] = _in_order(J[:, free], error, *order)
            step *= min(1.0, LONGEST / max(float(np.abs(step).max()), 1e-300))
            there, low, high = q + scale * step, self.chain.lower, self.chain.upper
            stuck = ((q <= low) & (there < q)) | ((q >= high) & (there > q))
            if not (stuck & free).any():
                return step
            free &= ~stuck
        return np.zeros(len(q))


def _in_order(J: FloatArray, error: FloatArray, first: slice, second: slice) -> FloatArray:
    """Return the step towards the first goal and, as far as that leaves it open, the second.

    B. Siciliano and J.-J. Slotine, A general framework for managing multiple tasks in highly
    redundant robotic systems, International Conference on Advanced Robotics, 1991.
    """
    pseudo = _inverse(J[first])
    step = pseudo @ error[first]
    rest = J[second] @ (np.eye(J.shape[1]) - pseudo @ J[first])
    return np.asarray(step + _inverse(rest, YIELDING) @ (error[second] - J[second] @ step))


def _inverse(J: FloatArray, damping: float = DAMPING) -> FloatArray:
    U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
    if sigma.max(initial=0.0) < 1e-9:
        return np.zeros((J.shape[1], J.shape[0]))
    damped = sigma / (sigma**2 + damping * sigma[0] ** 2)
    return np.asarray(Vt.T @ (damped[:, None] * U.T))
