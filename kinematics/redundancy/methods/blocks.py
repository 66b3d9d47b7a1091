"""Compiled methods in blocks of samples: between two of them others get a turn."""

from __future__ import annotations

from collections.abc import Callable, Generator

from kinematics.redundancy.problem import PathProblem
from kinematics.redundancy.stop import Stop, StopReason

BLOCK = 64
"""Samples computed in one call."""


def in_blocks(
    problem: PathProblem, samples: int, solve: Callable[[int, int], tuple[int, int]]
) -> Generator[int, None, Stop | None]:
    """Solves samples 1 to the last, block by block, and gives how many are done.

    Args:
        problem: What is followed.
        samples: Their number N.
        solve: From the first sample of a block and the one after its last to the sample that was
            not reached (the one after its last, if all were) and the rank of the task's Jacobian
            before it.

    Returns:
        Why it stopped, None at the end.
    """
    for first in range(1, samples, BLOCK):
        last = min(first + BLOCK, samples)
        done, rank = solve(first, last)
        if done < last:
            reason = StopReason.RANK if rank < problem.arm.m else StopReason.DIVERGED
            return Stop(reason, done, rank)
        yield done
    return None
