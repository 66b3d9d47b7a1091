"""Solvers of a chain and a task: constants of the compiled kernel, prepared once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from kinematics.chain import Chain, chain_of
from kinematics.compiled import writable
from kinematics.deadline import current
from kinematics.inverse import criteria as kernel
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.closed_form import closed_form_of
from kinematics.inverse.closed_solve import KINDS
from kinematics.inverse.compiled_solve import solve_at_once, solve_one
from kinematics.inverse.many_targets import Targets
from kinematics.inverse.result import IKBatch, IKOptions, IKResult, IKStatus
from kinematics.inverse.solver_constants import NUMERIC, SolverConstants, packed
from kinematics.inverse.starts import starts
from kinematics.inverse.task_error import task_chain
from kinematics.kernels import Array
from kinematics.task import Task
from robots.robot import FloatArray, Robot

SLICE = 1024
"""Steps between two looks at the clock: a quarter of a millisecond."""
STEP_SECONDS = 0.5e-6
"""Less than a step takes; turns the time budget of a batch's target into steps."""
_FLOATS = np.dtype(np.float64)

KEPT = 512
"""Solvers that are kept."""
MAX_SEEDS = 8
"""Random seeds whose starts are kept."""

_OF_CODE = {
    kernel.CONVERGED: IKStatus.CONVERGED,
    kernel.GIVEN_UP: IKStatus.NOT_CONVERGED,
    kernel.UNREACHABLE: IKStatus.UNREACHABLE,
    kernel.OUT_OF_STEPS: IKStatus.TIMEOUT,
}
_STATUS_OF_CODE = np.array([tuple(IKStatus).index(_OF_CODE[code]) for code in range(len(_OF_CODE))])


_new, _empty = tuple.__new__, np.empty


class _Asked(NamedTuple):
    """What a solve of one target begins with.

    Attributes:
        options: What was asked.
        P: What :func:`~.compiled_solve.solve_at_once` takes.
        K: Number of the chain's unknowns.
        whole: Whether they are all of q, in its order.
        middle: The default seed.
    """

    options: IKOptions | None
    P: Array
    K: int
    whole: bool
    middle: FloatArray


@dataclass(frozen=True, eq=False)
class Solver:
    """The solver of one chain and task; immutable, usable by any number of threads.

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
        """Limits of all joints of the robot."""
        return JointBounds.of(self.robot)

    @cached_property
    def middle(self) -> FloatArray:
        """The default seed, shape (dof,); read-only."""
        middle = self.bounds.inside(self.bounds.middle())
        middle.flags.writeable = False
        return middle

    @cached_property
    def _middle_of_chain(self) -> FloatArray:
        return self.middle[self.chain.columns]

    @cached_property
    def _whole(self) -> bool:
        """Whether the chain's joints are all of q, in its order."""
        return bool(np.array_equal(self.chain.columns, np.arange(self.robot.dof)))

    @cached_property
    def _known(self) -> dict[int, Array]:
        return {}

    def constants(self, random_seed: int) -> Array:
        """Return what compiled functions take; see :func:`~.solver_constants.packed`."""
        known = self._known.get(random_seed)
        if known is not None:
            return known
        chain, columns = self.chain, self.chain.columns
        low, high = self.bounds.ranges(chain.reach if np.isfinite(chain.reach) else 1.0)
        form = None if chain.is_coupled else closed_form_of(chain)
        if form is not None and (form.kind not in KINDS or self.task.name not in form.tasks):
            form = None
        made = packed(
            SolverConstants(
                task_chain(chain, self.task),
                np.array([chain.lower, chain.upper, self.bounds.wraps[columns]]),
                starts(random_seed, low[columns], high[columns]),
                chain.reach if chain.length else np.inf,
                chain.links,
                NUMERIC if form is None else KINDS[form.kind],
                np.empty(0) if form is None else form.constants,
            )
        )
        if len(self._known) < MAX_SEEDS:
            self._known[random_seed] = made
        return made

    @cached_property
    def _latest(self) -> list[_Asked]:
        """What was solved with last: most ask the same again."""
        return [_Asked(None, np.empty(0), 0, self._whole, self.middle)]

    def _with_criteria(self, options: IKOptions) -> _Asked:
        origin = self._middle_of_chain
        P = np.concatenate((options.criteria, origin, self.constants(options.random_seed)))
        made = _Asked(options, P, len(origin), self._whole, self.middle)
        self._latest[0] = made
        return made

    def solve(self, target: FloatArray, seed: FloatArray | None, options: IKOptions) -> IKResult:
        """Solve one target, shape (4, 4); see :func:`kinematics.inverse.solve_ik`."""
        started = perf_counter()
        if target.dtype is not _FLOATS or not target.flags.carray:
            target = writable(target)
        asked, P, K, whole, start = self._latest[0]
        if asked is not options:
            _, P, K, whole, start = self._with_criteria(options)
        if seed is None:
            q = _empty(K)
        else:
            start = self.bounds.inside(seed)
            q = start.copy() if whole else start[self.chain.columns]
        steps, last, code, position, rotation = solve_at_once(P, target, q, seed is not None)
        if code != kernel.CONVERGED:
            if code == kernel.OUT_OF_STEPS:
                steps, last, code, position, rotation = self._search(target, q, options, started)
            if code == kernel.GIVEN_UP and options.time_budget <= 0:
                code = kernel.OUT_OF_STEPS
        if not whole:
            values, q = q, start.copy()
            q[self.chain.columns] = values
        elapsed = perf_counter() - started
        # Not by its constructor, which takes as long as a step.
        return _new(IKResult, (_OF_CODE[code], q, start, position, rotation, steps, last, elapsed))

    def _search(
        self, target: FloatArray, q: FloatArray, options: IKOptions, started: float
    ) -> tuple[int, int, int, float, float]:
        """Solve a target that takes long, in view of the clock; result of :func:`solve_one`.

        Args:
            target: Shape (4, 4).
            q: The seed, in the chain's order; filled with the answer; shape (K,).
            options: Tolerance, restarts, time.
            started: When, on the clock of ``perf_counter``, s.
        """
        P, criteria = self.constants(options.random_seed), options.criteria
        K = len(q)
        seed, answer = q.copy(), np.empty(2 * K + 5)
        steps, last, code, position, rotation = solve_one(
            P, target, seed, 0, SLICE, criteria, answer
        )
        while code == kernel.OUT_OF_STEPS and perf_counter() - started < options.time_budget:
            current().check_wanted()
            more, last, code, position, rotation = solve_one(
                P, target, seed, last + 1, SLICE, criteria, answer
            )
            steps += more
        q[:] = answer[:K]
        return steps, last, code, position, rotation

    def solve_batch(
        self,
        targets: FloatArray,
        seed: FloatArray | None,
        options: IKOptions,
        threads: int,
        deadline: float,
    ) -> IKBatch:
        """Solve many targets, shape (n, 4, 4), over threads; see ``solve_ik_batch``.

        Args:
            targets: Poses of the frame in the base frame's axes.
            seed: First start of each, shape (dof,), rad and m; None: mid-range.
            options: Of each target.
            threads: How many to work on at once.
            deadline: When to stop, on the clock of ``perf_counter``, s.
        """
        targets = writable(targets)
        n, columns = len(targets), self.chain.columns
        K = len(columns)
        start = self.middle if seed is None else self.bounds.inside(seed)
        answers, ends = np.empty((n, 2 * K + 5)), np.empty((n, 3), np.int64)
        asked = Targets(
            self.constants(options.random_seed),
            targets,
            start[columns],
            options.criteria,
            options.within(0.0).criteria,
            int(min(max(options.time_budget / STEP_SECONDS, 1), 2**40)),
            answers,
            ends,
            np.zeros(n),
        )
        asked.solve(threads, deadline)
        if self._whole:
            q = np.ascontiguousarray(answers[:, :K])
        else:
            q = np.repeat(start[None], n, axis=0)
            q[:, columns] = answers[:, :K]
        codes = _STATUS_OF_CODE[ends[:, 2]]
        position, rotation = answers[:, K], answers[:, K + 1]
        return IKBatch(codes, q, start, position, rotation, ends[:, 0], ends[:, 1], asked.elapsed)


def solver_of(robot: Robot, frame: str, task: Task) -> Solver:
    """Return the solver of a frame and task, from memory if it was asked for before.

    Raises:
        UnknownFrame: The robot has no such frame.
    """
    return _made(robot, frame, task.name, task.rows, task.own_axes)


def is_compiled() -> bool:
    """Return whether this process has the machine code: :func:`solve_ik` then compiles nothing."""
    compiled: Any = solve_one
    return bool(compiled.signatures)


@lru_cache(maxsize=KEPT)
def _made(robot: Robot, frame: str, name: str, rows: tuple[int, ...], own_axes: bool) -> Solver:
    solver = Solver(robot, chain_of(robot, frame), Task(name, rows, own_axes))
    if not is_compiled():
        # Compiling takes seconds, which are not to count as those of the first target.
        once = IKOptions(max_restarts=0, max_iterations=1)
        target, q = np.eye(4), solver.solve(np.eye(4), None, once).q[solver.chain.columns]
        solver._search(target, q, once, perf_counter())
    return solver
