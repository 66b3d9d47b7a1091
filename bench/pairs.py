"""Two things measured in turns, so that a busy moment hits both."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One line of a report; ``ratio`` is ours over the other."""

    what: str
    ours: str
    other: str
    ratio: float


def seconds(call: Callable[[], object], repeat: int) -> float:
    started = time.perf_counter()
    for _ in range(repeat):
        call()
    return (time.perf_counter() - started) / repeat


def paired(
    what: str,
    ours: Callable[[], object],
    other: Callable[[], object],
    *,
    per: int = 1,
    rounds: int = 15,
    repeat: int = 1,
) -> Row:
    """Median time of each, divided by ``per``, and the median of the ratios of the rounds."""
    ours(), other()
    times = [(seconds(ours, repeat), seconds(other, repeat)) for _ in range(rounds)]
    ratio = statistics.median(a / b for a, b in times)
    mine = statistics.median(a for a, _ in times) / per
    theirs = statistics.median(b for _, b in times) / per
    return Row(what, f"{mine * 1e6:.2f} µs", f"{theirs * 1e6:.2f} µs", ratio)
