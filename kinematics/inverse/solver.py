"""Solvers by chain and task: the compiled kernel, prepared once, called with a target at a time.

Where Numba is not installed, :mod:`kinematics.inverse.numeric` does the same on Pinocchio.
"""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from kinematics.chain import Chain, chain_of
from kinematics.inverse import kernel
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.closed_form import closed_form_of
from kinematics.inverse.closed_solver import ClosedSolver
from kinematics.inverse.result import IKBatch, IKOptions, IKResult, IKStatus
from kinematics.inverse.starts import starts
from kinematics.kernels import Array
from kinematics.task import Task
from robots.robot import FloatArray, Robot

SLICE = 256
"""Steps between two looks at the clock: a quarter of a millisecond."""
STEP_SECONDS = 0.5e-6
"""Less than a step takes; turns the time budget of a batch's target into steps."""
PART = 128
"""Targets that one thread works on between two looks at the clock."""

DOUBTS = 20
"""Starts of the numeric solver before a closed form without solution is taken at its word."""
MAX_SEEDS = 8
"""Random seeds whose starts are kept."""

_STATUSES = tuple(IKStatus)
_OF_CODE = {
    kernel.CONVERGED: IKStatus.CONVERGED,
    kernel.GIVEN_UP: IKStatus.NOT_CONVERGED,
    kernel.UNREACHABLE: IKStatus.UNREACHABLE,
    kernel.OUT_OF_STEPS: IKStatus.TIMEOUT,
}


@dataclass(frozen=True, eq=False)
class Solver:
    """The solver of one chain and task; immutable, for any number of threads.

    Attributes:
        robot: The robot.
        chain: The joints that move.
        task: The task space.
    """

    robot: Robot
    chain: Chain
    task: Task

    @cached_property
    def bounds(self) -> JointBounds:
        """Bounds of all joints."""
        return JointBounds.of(self.robot)

    @cached_property
    def middle(self) -> FloatArray:
        """The default seed, shape (dof,)."""
        return self.bounds.inside(self.bounds.middle())

    @cached_property
    def _whole(self) -> bool:
        """True where the chain's joints are all of q, in its order."""
        return bool(np.array_equal(self.chain.columns, np.arange(self.robot.dof)))

    @cached_property
    def _known(self) -> dict[int, tuple[Array, Array]]:
        return {}

    def constants(self, random_seed: int) -> tuple[Array, Array]:
        """What the kernel takes; see :func:`kinematics.inverse.kernel.packed`."""
        known = self._known.get(random_seed)
        if known is not None:
            return known
        chain = self.chain
        low, high = self.bounds.ranges(chain.reach if np.isfinite(chain.reach) else 1.0)
        sequence = starts(random_seed, low[chain.columns], high[chain.columns])
        limits = np.array([chain.lower, chain.upper])
        wraps = self.bounds.wraps[chain.columns]
        rows = np.array(self.task.rows)
        reach = chain.reach if chain.length else np.inf
        made = kernel.packed(chain.placements, limits, sequence, reach, chain.turns, wraps, rows)
        if len(self._known) < MAX_SEEDS:
            self._known[random_seed] = made
        return made

    @cached_property
    def _closed(self) -> ClosedSolver | None:
        """The closed form of the chain, where it has one that is complete for the task."""
        form = closed_form_of(self.chain)
        if form is None or not ClosedSolver.covers(form) or self.task.name not in form.tasks:
            return None
        return ClosedSolver(form)

    def _embedded(self, values: FloatArray, start: FloatArray) -> FloatArray:
        """The chain's values in a whole q."""
        if self._whole:
            return values
        q = start.copy()
        q[self.chain.columns] = values
        return q

    def solve(self, target: FloatArray, seed: FloatArray | None, options: IKOptions) -> IKResult:
        """One target, shape (4, 4); see :func:`kinematics.inverse.solve_ik`."""
        started = time.perf_counter()
        target = np.ascontiguousarray(target, dtype=np.float64)
        start = self.middle if seed is None else self.bounds.inside(seed)
        origin = start if self._whole else start[self.chain.columns]
        K = len(origin)
        P, N = self.constants(options.random_seed)
        limits, answer = options.limits, np.empty(K + 5)
        proven = False
        if self._closed is not None and options.time_budget > 0:
            if self._closed.nearest(P, N, target, origin, limits, answer):
                q = self._embedded(answer[:K], start)
                position, rotation = answer[K : K + 2].tolist()
                elapsed = time.perf_counter() - started
                return IKResult(IKStatus.CONVERGED, q, start, position, rotation, 0, 0, elapsed)
            proven = self._closed.proves(options)
            if proven:
                limits = limits.copy()
                limits[3] = min(limits[3], DOUBTS)
        goal, W = target[:3].reshape(12), kernel.workspace(K)
        following = kernel.proceed(P, N, goal, origin, 0, SLICE, limits, answer, W)
        if following > 0:
            deadline = started + options.time_budget
            while following > 0 and time.perf_counter() < deadline:
                following = kernel.proceed(P, N, goal, origin, following, SLICE, limits, answer, W)
        *_, position, rotation, steps, last, code = answer[K:].tolist()
        status = _OF_CODE[code]
        if proven and status is IKStatus.NOT_CONVERGED:
            status = IKStatus.UNREACHABLE
        if status is IKStatus.NOT_CONVERGED and options.time_budget <= 0:
            status = IKStatus.TIMEOUT
        q = self._embedded(answer[:K], start)
        elapsed = time.perf_counter() - started
        return IKResult(status, q, start, position, rotation, int(steps), int(last), elapsed)

    def solve_batch(
        self,
        targets: FloatArray,
        seed: FloatArray | None,
        options: IKOptions,
        threads: int,
        deadline: float,
    ) -> IKBatch:
        """Many targets, shape (n, 4, 4), over threads; see ``solve_ik_batch``."""
        n, columns = len(targets), self.chain.columns
        K = len(columns)
        start = self.middle if seed is None else self.bounds.inside(seed)
        goals = np.ascontiguousarray(targets[:, :3], dtype=np.float64).reshape(n, 12)
        answers, elapsed, origin = np.empty((n, K + 5)), np.zeros(n), start[columns]
        P, N = self.constants(options.random_seed)
        steps = int(min(max(options.time_budget / STEP_SECONDS, 1), 2**40))
        none_left = options.within(0.0).limits

        def work(first: int) -> None:
            part = slice(first, first + PART)
            began = time.perf_counter()
            limits = options.limits if began < deadline else none_left
            W = kernel.workspace(K)
            kernel.proceed_many(P, N, goals[part], origin, steps, limits, answers[part], W)
            if limits is none_left:
                answers[part, K + 4][answers[part, K + 4] == kernel.GIVEN_UP] = kernel.OUT_OF_STEPS
            elapsed[part] = (time.perf_counter() - began) / len(goals[part])

        parts = range(0, n, PART)
        if threads > 1 and len(parts) > 1:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(work, parts))
        else:
            for first in parts:
                work(first)
        q = np.repeat(start[None], n, axis=0)
        q[:, columns] = answers[:, :K]
        codes = np.empty(n, dtype=np.int64)
        for code, status in _OF_CODE.items():
            codes[answers[:, K + 4] == code] = _STATUSES.index(status)
        counts = answers[:, K + 2 : K + 4].astype(np.int64)
        position, rotation = answers[:, K], answers[:, K + 1]
        return IKBatch(codes, q, start, position, rotation, counts[:, 0], counts[:, 1], elapsed)


_SOLVERS: WeakKeyDictionary[Robot, dict[tuple[str, tuple[int, ...]], Solver]] = WeakKeyDictionary()


def solver_of(robot: Robot, frame: str, task: Task) -> Solver:
    """The solver of a frame and task, kept as long as the robot is.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    solvers = _SOLVERS.get(robot)
    if solvers is None:
        solvers = _SOLVERS[robot] = {}
    key = (frame, task.rows)
    found = solvers.get(key)
    if found is None:
        found = solvers[key] = Solver(robot, chain_of(robot, frame), task)
    return found
