"""Solve many targets over threads, each with lanes of its own, in view of the clock."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from kinematics.deadline import current
from kinematics.inverse.compiled_solve import conclude_many
from kinematics.inverse.criteria import GIVEN_UP, OUT_OF_STEPS
from kinematics.inverse.lanes.targets import ACTIVE, FOUND, advance, memory_rows
from kinematics.inverse.many_closed import solve_closed
from kinematics.kernels import Array
from kinematics.lanes.vector import LANES
from robots.robot import FloatArray

PART = 1024
"""Most targets that a thread takes at once."""
PART_STEPS = 2_000_000
"""Most steps, times joints, between two looks at the clock: some hundredths of a second."""


@dataclass(frozen=True)
class Targets:
    """What is asked of many targets, and room for the answers.

    Attributes:
        P: Constants of the chain; see :func:`~.solver_constants.packed`.
        targets: Poses of the frame in base axes, writable, shape (n, 4, 4).
        origin: First start of each, in the chain's order, shape (K,).
        criteria: See :attr:`~.result.IKOptions.criteria`.
        none_left: The same where there is no time.
        budget: Steps of each.
        answers: Filled: q, its errors, and what was found on the way; shape (n, 2 K + 5).
        ends: Filled: steps, last start, code; shape (n, 3).
        elapsed: Filled: seconds, the mean of those of one thread; shape (n,).
    """

    P: Array
    targets: FloatArray
    origin: FloatArray
    criteria: FloatArray
    none_left: FloatArray
    budget: int
    answers: FloatArray
    ends: NDArray[np.int64]
    elapsed: FloatArray

    def solve(self, threads: int, deadline: float) -> None:
        """Fill answers and ends.

        Args:
            threads: How many to work with.
            deadline: When to stop, on the clock of ``perf_counter``, s.
        """
        n, K = len(self.targets), len(self.origin)
        # A target takes as many steps, at most, to settle where it is not reached.
        size = int(min(PART, max(1, PART_STEPS // (2 * int(self.criteria[2]) * max(1, K) + 1))))
        size = min(size, max(2 * LANES, -(-n // (2 * threads))))
        parts = iter([(first, min(first + size, n)) for first in range(0, n, size)])
        workers = min(threads, -(-n // size))
        made = [_Worker(self, parts) for _ in range(workers)]
        if workers > 1:
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(lambda worker: worker.work(deadline), made))
        else:
            for worker in made:
                worker.work(deadline)


class _Worker:
    """One thread: its lanes, and the parts that it has taken."""

    def __init__(self, asked: Targets, parts: Iterator[tuple[int, int]]) -> None:
        K = len(asked.origin)
        joints = int(asked.P[0])
        rows = memory_rows(K, joints)
        memory = np.empty(rows * LANES + 7)
        first = -(memory.ctypes.data >> 3) % 8
        self.asked = asked
        self.parts = parts
        self.flat = asked.targets.reshape(-1, 16)
        self.memory = memory[first : first + rows * LANES].reshape(rows, LANES)
        self.state = np.zeros((5, LANES), np.int64)
        self.passes = int(max(1, PART_STEPS // (LANES * max(1, K))))
        self.taken: list[slice] = []
        self.open: list[slice] = []
        """Parts of which some targets are not concluded."""
        self.wanted = current()

    def work(self, deadline: float) -> None:
        """Take part after part until there are none, or no time is left."""
        asked, began = self.asked, perf_counter()
        while (part := next(self.parts, None)) is not None:
            self.wanted.check_wanted()
            row, end = part
            rows = slice(row, end)
            self.taken.append(rows)
            self.open.append(rows)
            in_time = perf_counter() < deadline
            criteria = asked.criteria if in_time else asked.none_left
            solve_closed(
                asked.P,
                asked.targets[rows],
                asked.origin,
                criteria,
                asked.answers[rows],
                asked.ends[rows],
            )
            while in_time and row < end:
                row = self._advance(asked.criteria, row, end, is_last=False)
                self.wanted.check_wanted()
                in_time = perf_counter() < deadline
            if not in_time:
                self._stop(row, end)
            self._conclude(self.open[-2:-1])
        while self.state[ACTIVE, 0]:
            self._advance(asked.criteria, 0, 0, is_last=True)
            self.wanted.check_wanted()
            if perf_counter() >= deadline:
                self._stop(0, 0)
        self._conclude(self.open)
        count = sum(rows.stop - rows.start for rows in self.taken)
        seconds = (perf_counter() - began) / max(1, count)
        for rows in self.taken:
            asked.elapsed[rows] = seconds

    def _advance(
        self, criteria: FloatArray, row: int, end: int, *, is_last: bool, stop: bool = False
    ) -> int:
        asked = self.asked
        return advance(
            asked.P,
            self.flat,
            asked.origin,
            criteria,
            asked.budget,
            np.array([row, end, is_last, stop], np.int64),
            self.passes,
            self.memory,
            self.state,
            asked.answers,
            asked.ends,
        )

    def _stop(self, row: int, end: int) -> None:
        """Give up what is begun, measure the first start of the rest, and settle nothing."""
        asked = self.asked
        self._advance(asked.none_left, row, end, is_last=True, stop=True)
        while row < end or self.state[ACTIVE, 0]:
            row = self._advance(asked.none_left, row, end, is_last=True)
            self.wanted.check_wanted()
        for rows in self.open:
            waiting = asked.ends[rows, 2]
            waiting[waiting == FOUND + GIVEN_UP] = FOUND + OUT_OF_STEPS
        self._conclude(self.open)
        self.open = []

    def _conclude(self, parts: list[slice]) -> None:
        asked = self.asked
        for rows in parts:
            conclude_many(
                asked.P,
                self.flat[rows],
                asked.origin,
                asked.criteria,
                asked.answers[rows],
                asked.ends[rows],
            )
            self.wanted.check_wanted()
