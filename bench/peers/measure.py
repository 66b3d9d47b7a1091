"""Solvers measured in turns: a block of targets each, in an order that rotates."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, field

from bench.peers.arms import Arm
from bench.peers.peer import Peer, Solve
from robots.robot import FloatArray

BLOCK = 50
"""Targets of a turn: enough for warm caches, few enough that a busy moment hits all."""


@dataclass
class Score:
    """What a peer did on an arm.

    Attributes:
        peer: Who.
        skipped: Why it was not measured, if it was not.
        times: Seconds of each solve.
        solved: How many answers passed the check.
    """

    peer: Peer
    skipped: str | None = None
    times: list[float] = field(default_factory=list)
    solved: int = 0

    @property
    def median(self) -> float:
        return statistics.median(self.times)

    def ratio(self, ours: Score) -> float:
        """The median over turns of this solver's median against ours in the same turn."""
        turns = range(0, len(self.times), BLOCK)
        return statistics.median(
            statistics.median(self.times[k : k + BLOCK])
            / statistics.median(ours.times[k : k + BLOCK])
            for k in turns
        )

    @property
    def success(self) -> float:
        return self.solved / len(self.times)


def measure(arm: Arm, peers: list[Peer], count: int, seconds: float) -> list[Score]:
    """All peers on one arm; one that has used up its seconds stops at the targets it has done."""
    scores = [Score(peer) for peer in peers]
    warm_up, targets = arm.targets(2, 999), arm.targets(count, 0)
    running: list[tuple[Score, Solve]] = []
    for score in scores:
        try:
            solve = score.peer.make(arm)
            for target in warm_up:
                solve(target)
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # a panic of a Rust extension is no Exception
            score.skipped = " ".join(f"{type(error).__name__}: {error}".split())[:160]
        else:
            running.append((score, solve))
    for turn, first in enumerate(range(0, count, BLOCK)):
        shift = turn % max(len(running), 1)
        for score, solve in running[shift:] + running[:shift]:
            if sum(score.times) < seconds:
                _block(arm, score, solve, targets[first : first + BLOCK])
    return scores


def _block(arm: Arm, score: Score, solve: Solve, targets: FloatArray) -> None:
    answers: list[FloatArray | None] = []
    for target in targets:
        started = time.perf_counter()
        try:
            q = solve(target)
        except Exception:  # an error is a target not solved
            q = None
        score.times.append(time.perf_counter() - started)
        answers.append(q)
    score.solved += sum(arm.solved(q, target) for q, target in zip(answers, targets, strict=True))
