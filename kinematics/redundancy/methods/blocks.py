"""Compiled methods work in blocks of samples: between two of them others get a turn."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import NamedTuple

from kinematics.compiled import inner
from kinematics.kernels import Array
from kinematics.redundancy.problem import PathProblem
from kinematics.redundancy.stop import Stop, StopReason

BLOCK = 64
"""Samples computed in one call."""


class Course(NamedTuple):
    """A path that is being followed, N samples.

    Attributes:
        targets: Poses in base axes, shape (N, 12).
        leaving: Where the arm sets out from for sample 1, rad and m, shape (K,).
        Q: Samples; sample 0 is given, the others are filled; rad and m, shape (N, K).
    """

    targets: Array
    leaving: Array
    Q: Array


@inner
def sample_before(course: Course, i: int) -> Array:
    """Return the configuration from which sample i > 0 is to be reached, shape (K,)."""
    return course.leaving if i == 1 else course.Q[i - 1]


def in_blocks(
    problem: PathProblem, samples: int, solve: Callable[[int, int], tuple[int, int]]
) -> Generator[int, None, Stop | None]:
    """Solve samples 1 to the last, block by block, and give how many are done.

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
