"""Inverse kinematics of a sequence of targets on one continuous branch.

Between two targets the frame goes along a straight line and turns by SLERP. The joint values are
followed along that way in steps: a step counts where two half steps lead to the same place and pass
near its middle, else it is halved. So no step leads over to another branch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from kinematics.chain import Chain, chain_of
from kinematics.deadline import checkpoint
from kinematics.inverse.all_solutions import all_solutions, exact_solutions
from kinematics.inverse.api import solve_ik
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.continuation.settling import settle, task_columns
from kinematics.inverse.forbidden import branches_beyond
from kinematics.inverse.result import IKOptions, IKStatus
from kinematics.inverse.task_error import TaskChain, columns, residual, task_chain, workspace
from kinematics.inverse.windings import TOUCH, task_errors
from kinematics.task import Task
from robots.robot import FloatArray, Robot

LARGEST = 0.3
"""Change of a joint in one step, rad or parts of the robot's reach, at most."""
ALIKE = 0.05
"""Difference of two half steps from a whole one, in parts of it."""
BENT = 0.2
"""Distance of the middle of a step from the straight line, in parts of the step."""
SHORTEST = 2.0**-16
"""Part of the way between two targets below which steps are not halved."""
SMALL = 1e-7
"""Differences that rounding may make, rad or m."""
SINGULAR = 1e-3
"""Part of the largest singular value below which the Jacobian is near a loss of rank."""
MOST_BRANCHES = 64
SEARCH_SECONDS = 0.05
"""Time for finding whether a target is within reach at all."""
AHEAD = 1e-3
"""Part of a way behind its end at which it is seen whether the way goes on."""
EXACT = 1e-9
STEPS = 40

Reason = Literal["limit", "singularity", "unreachable", "jump"]


@dataclass(frozen=True, eq=False)
class BranchEnd:
    """Where and why a branch ends.

    Attributes:
        start: Its q at the first target, shape (dof,).
        posture: Names of the branch at the first target; empty where there are none.
        index: The first target that it does not reach; None: it reaches all.
        reason: ``limit`` of a joint, ``singularity`` where branches meet, ``unreachable`` where the
            target is out of reach, ``jump`` where the way between the targets is.
        joint: The joint that would pass its limit.
        limit: Which one.
    """

    start: FloatArray
    posture: tuple[str, ...]
    index: int | None
    reason: Reason | None = None
    joint: str | None = None
    limit: Literal["lower", "upper"] | None = None


@dataclass(frozen=True, eq=False)
class OneBranch:
    """A sequence of q on one branch.

    Attributes:
        q: One a target, the last that was reached from where the branch ends; shape (n, dof).
        reached: How many targets are reached, from the first.
        position_error: Measured, m, shape (n,).
        orientation_error: Measured, rad, shape (n,).
        seed: The q that the first is near to, shape (dof,).
        branches: Those that were tried, the nearest to the seed first; the last is the one that
            is given where it reaches all targets, else the one that gets farthest is.
    """

    q: FloatArray
    reached: int
    position_error: FloatArray
    orientation_error: FloatArray
    seed: FloatArray
    branches: tuple[BranchEnd, ...]


def follow_branch(
    robot: Robot,
    targets: FloatArray,
    *,
    frame: str | None = None,
    task: Task,
    seed: FloatArray | None = None,
    options: IKOptions,
) -> OneBranch:
    """Return one q a target on the first branch that reaches all, nearest to the seed first.

    Args:
        robot: The robot.
        targets: Shape (n, 4, 4).
        frame: Frame name; default the tip.
        task: The task space.
        seed: Shape (dof,), rad and m; default mid-range.
        options: For the first target.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    name = robot.tip_frame if frame is None else frame
    chain = chain_of(robot, name)
    bounds = JointBounds.of(robot)
    start = bounds.inside(bounds.middle() if seed is None else seed)
    arm = _Arm(robot, chain, task, name, options)
    ways: list[tuple[BranchEnd, list[FloatArray]]] = []
    for q, posture in arm.starts(targets[0], start)[:MOST_BRANCHES]:
        rows, end = arm.followed(q, posture, targets)
        ways.append((end, rows))
        if end.index is None:
            break
    if not ways:
        ways = [(end, []) for end in arm.out_of_reach(targets[0], start)]
    if not any(rows for _, rows in ways):
        none = solve_ik(robot, targets[0], frame=name, task=task, seed=start, options=options).q
        best = [none]
        reached = 0
    elif ways[-1][0].index is None:
        best, reached = ways[-1][1], len(targets)
    else:
        best = max((rows for _, rows in ways), key=len)
        reached = len(best)
    q = np.array(best + [best[-1]] * (len(targets) - len(best)))
    errors = np.array(
        [
            task_errors(chain, target, task, one[chain.columns])
            for target, one in zip(targets, q, strict=True)
        ]
    )
    return OneBranch(q, reached, errors[:, 0], errors[:, 1], start, tuple(end for end, _ in ways))


@dataclass(frozen=True, eq=False)
class _Arm:
    robot: Robot
    chain: Chain
    task: Task
    frame: str
    options: IKOptions

    @property
    def constants(self) -> TaskChain:
        return task_chain(self.chain, self.task)

    def starts(
        self, target: FloatArray, seed: FloatArray
    ) -> list[tuple[FloatArray, tuple[str, ...]]]:
        """Return solutions of the first target within the limits, the nearest to the seed first."""
        found = all_solutions(
            self.robot, target, frame=self.frame, task=self.task, seed=seed, options=self.options
        )
        tolerance = self.options.tolerance
        known = [
            (one.q, one.posture)
            for one in found.solutions
            if one.within_limits
            and one.position_error <= tolerance.position
            and one.orientation_error <= tolerance.orientation
        ]
        if not known:
            own = solve_ik(
                self.robot,
                target,
                frame=self.frame,
                task=self.task,
                seed=seed,
                options=self.options,
            )
            known = [(own.q, ())] if own.status is IKStatus.CONVERGED else []
        return known

    def out_of_reach(self, target: FloatArray, seed: FloatArray) -> list[BranchEnd]:
        """Return why the first target is not reached, for each branch that is known."""
        found = exact_solutions(self.robot, target, frame=self.frame, task=self.task, seed=seed)
        beyond = () if found is None else branches_beyond(self.robot, found)
        ends = [
            BranchEnd(
                one.q,
                one.posture,
                0,
                "limit",
                one.joints[0].joint,
                "upper" if one.joints[0].value > one.joints[0].limit else "lower",
            )
            for one in beyond
            if one.joints
        ]
        return ends or [BranchEnd(seed, (), 0, "unreachable")]

    def followed(
        self, q: FloatArray, posture: tuple[str, ...], targets: FloatArray
    ) -> tuple[list[FloatArray], BranchEnd]:
        """Follow a solution of the first target; return q of each that is reached, and its end."""
        rows, here = [q], q[self.chain.columns]
        for index in range(1, len(targets)):
            checkpoint()
            way = _way(targets[index - 1], targets[index])
            there, part = self._advanced(here, way)
            if part < 1.0:
                why = self._why(there, way, part, targets[index])
                return rows, BranchEnd(q, posture, index, *why)
            here = there
            row = q.copy()
            row[self.chain.columns] = np.clip(here, self.chain.lower, self.chain.upper)
            rows.append(row)
        return rows, BranchEnd(q, posture, None)

    def _advanced(
        self, q: FloatArray, way: Callable[[float], FloatArray]
    ) -> tuple[FloatArray, float]:
        """Return where a way leads, and how much of it was gone, 1 for all."""
        s, h = 0.0, 1.0
        while s < 1.0:
            h = min(h, 1.0 - s)
            there = self._step(q, way(s + 0.5 * h), way(s + h))
            if there is not None:
                q, s, h = there, s + h, 2.0 * h
                continue
            h *= 0.5
            if h < SHORTEST:
                return q, s
        return q, 1.0

    def _step(self, q: FloatArray, middle: FloatArray, end: FloatArray) -> FloatArray | None:
        """Return the joint values at the end of a step, None where it is too long."""
        whole = self._within(q, end)
        if whole is None:
            return None
        size = float(np.abs((whole - q) * self._weights()).max(initial=0.0))
        if size > LARGEST:
            return None
        half = self._within(q, middle)
        twice = None if half is None else self._within(half, end)
        if half is None or twice is None:
            return None
        weights = self._weights()
        apart = float(np.abs((twice - whole) * weights).max(initial=0.0))
        bent = float(np.abs((half - 0.5 * (q + twice)) * weights).max(initial=0.0))
        return twice if apart <= ALIKE * size + SMALL and bent <= BENT * size + SMALL else None

    def _weights(self) -> FloatArray:
        reach = self.chain.reach
        size = reach if np.isfinite(reach) and reach > 0.0 else 1.0
        return np.where(self.chain.is_angle, 1.0, 1.0 / size)

    def _within(self, q: FloatArray, target: FloatArray) -> FloatArray | None:
        """Return joint values near q, within the limits, that reach a target, if there are some."""
        lower, upper = self.chain.lower, self.chain.upper
        found, errors = q.copy(), np.empty(2)
        if not self.chain.is_coupled and settle(self.constants, target, found, errors):
            inside = np.clip(found, lower, upper)
            if float(np.abs(inside - found).max(initial=0.0)) <= EXACT:
                return found
        return self._held(q, target)

    def _held(self, q: FloatArray, target: FloatArray) -> FloatArray | None:
        """Return the same with joints held at limits that they would pass.

        Newton steps of least length in the joints that are not held.
        """
        chain, constants = self.chain, self.constants
        lower, upper = chain.lower - TOUCH * EXACT, chain.upper + TOUCH * EXACT
        K, G = chain.length, np.ascontiguousarray(target, dtype=np.float64).reshape(16)
        free, found = np.ones(len(q), dtype=np.bool_), q.copy()
        for _ in range(STEPS):
            W = workspace(K)
            position, rotation = residual(constants, G, found, W)
            if position + rotation <= EXACT**2:
                return found
            columns(constants, W)
            J, error = W[: len(q), 6:12].T, W[K + 1, :6].copy()
            step = np.zeros(len(q))
            for _ in range(len(q)):
                step[free] = np.linalg.lstsq(J[:, free], error, rcond=1e-9)[0]
                beyond = free & ((found + step < lower) | (found + step > upper))
                if not beyond.any():
                    break
                held = np.clip(found + step, chain.lower, chain.upper)
                error = error - J[:, beyond] @ (held - found)[beyond]
                step[beyond] = (held - found)[beyond]
                free &= ~beyond
            if not free.any() or float(np.abs(step).max(initial=0.0)) < 1e-14:
                return None
            found = found + step
        return None

    def _why(
        self, q: FloatArray, way: Callable[[float], FloatArray], part: float, target: FloatArray
    ) -> tuple[Reason, str | None, Literal["lower", "upper"] | None]:
        """Return why a branch ends after a part of a way."""
        options = self.options.within(SEARCH_SECONDS)
        known = solve_ik(self.robot, target, frame=self.frame, task=self.task, options=options)
        if known.status is IKStatus.UNREACHABLE:
            return "unreachable", None, None
        ahead, errors = q.copy(), np.empty(2)
        chain = self.chain
        if not chain.is_coupled:
            for h in (4.0 * SHORTEST, 64.0 * SHORTEST):
                ahead = q.copy()
                if settle(self.constants, way(min(1.0, part + h)), ahead, errors) and (
                    float(np.abs((ahead - q) * self._weights()).max()) < LARGEST
                ):
                    over = np.maximum(chain.lower - ahead, ahead - chain.upper)
                    k = int(np.argmax(over))
                    if over[k] > 0.0:
                        name = self.robot.joints[int(chain.columns[k])].name
                        return "limit", name, "lower" if ahead[k] < chain.lower[k] else "upper"
        at_limit = (q <= chain.lower + 1e-6) | (q >= chain.upper - 1e-6)
        if at_limit.any() and not self._is_singular(q):
            k = int(np.flatnonzero(at_limit)[0])
            name = self.robot.joints[int(chain.columns[k])].name
            return "limit", name, "lower" if q[k] <= chain.lower[k] + 1e-6 else "upper"
        if known.status is not IKStatus.CONVERGED:
            return "unreachable", None, None
        ahead_of = way(min(1.0, part + AHEAD))
        near = solve_ik(self.robot, ahead_of, frame=self.frame, task=self.task, options=options)
        return ("singularity" if near.status is IKStatus.CONVERGED else "jump"), None, None

    def _is_singular(self, q: FloatArray) -> bool:
        J = np.empty((self.chain.length, 6))
        if self.chain.is_coupled:
            return False
        task_columns(self.constants, q, J)
        sigma = np.linalg.svd(J, compute_uv=False)
        rank = min(self.chain.length, len(self.task.rows))
        return bool(sigma[rank - 1] < SINGULAR * sigma[0])


def _way(start: FloatArray, end: FloatArray) -> Callable[[float], FloatArray]:
    """Return the pose at each part of the way from one target to another."""
    turn = Rotation.from_matrix(end[:3, :3] @ start[:3, :3].T).as_rotvec()

    def at(s: float) -> FloatArray:
        if s >= 1.0:
            return end
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_rotvec(s * turn).as_matrix() @ start[:3, :3]
        pose[:3, 3] = start[:3, 3] + s * (end[:3, 3] - start[:3, 3])
        return pose

    return at
