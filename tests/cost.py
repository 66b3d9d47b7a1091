"""Bounds on processor time that hold on slow machines and on loaded ones."""

from __future__ import annotations

import time

ORDINARY = 0.01
"""Seconds of :func:`_piece` on the machine for which bounds are written."""
ROUNDS = 5


def within(seconds: float, bound: float) -> bool:
    """Whether so much processor time is at most a bound, written for an ordinary machine.

    What takes longer is compared with a fixed piece of work, done here and now.
    """
    return seconds <= bound or seconds <= bound * _piece() / ORDINARY


def _piece() -> float:
    """Seconds of a piece of plain Python, at its quickest."""
    best = float("inf")
    for _ in range(ROUNDS):
        started = time.thread_time()
        table = {str(number): float(number) for number in range(40_000)}
        assert len(table) == 40_000
        best = min(best, time.thread_time() - started)
    return best
