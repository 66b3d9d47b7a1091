"""Compiled methods work in blocks of samples: between two of them others get a turn."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import NamedTuple

from kinematics.compiled import inner
from kinematics.kernels import Array
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.stop import Stop, StopReason
from robots.robot import FloatArray

BLOCK = 64
"""Samples computed in one call."""


class Course(NamedTuple):
    """A path that is being followed, N samples.

    Attributes:
        targets: Poses in base axes, shape (N, 12).
        leaving: Where the arm sets out from for sample 1, rad and m, shape (K,).
        longest: Largest motion of each joint to the next sample, rad and m, shape (K,).
        Q: Samples; sample 0 is given, the others are filled; rad and m, shape (N, K).
    """

    targets: Array
    leaving: Array
    longest: Array
    Q: Array


def course_of(problem: PathProblem, options: PathOptions, Q: FloatArray) -> Course:
    """Return the course of a problem, whose samples are written to Q, shape (N, K)."""
    return Course(problem.path.targets, departure(problem, options), problem.longest_step, Q)


@inner
def sample_before(course: Course, i: int) -> Array:
    """Return the configuration from which sample i > 0 is to be reached, shape (K,)."""
    return course.leaving if i == 1 else course.Q[i - 1]


@inner
def leaps(course: Course, i: int) -> bool:
    """Return whether a joint would move to sample i > 0 by more than it may."""
    before = sample_before(course, i)
    within = True
    for k in range(len(before)):
        within = within and abs(course.Q[i, k] - before[k]) <= course.longest[k]
    return not within


def in_blocks(
    problem: PathProblem, course: Course, solve: Callable[[int, int], tuple[int, int]]
) -> Generator[int, None, Stop | None]:
    """Solve samples 1 to the last, block by block, and give how many are done.

    Args:
        problem: What is followed.
        course: The path and its samples.
        solve: From the first sample of a block and the one after its last to the sample that was
            not reached (the one after its last, if all were) and the rank of the task's Jacobian
            before it.

    Returns:
        Why it stopped, None at the end.
    """
    samples = len(course.Q)
    for first in range(1, samples, BLOCK):
        last = min(first + BLOCK, samples)
        done, rank = solve(first, last)
        if done < last:
            if rank < problem.arm.m:
                return Stop(StopReason.RANK, done, rank)
            before = course.leaving if done == 1 else course.Q[done - 1]
            return Stop.diverged(done, rank, course.Q[done] - before)
        yield done
    return None
