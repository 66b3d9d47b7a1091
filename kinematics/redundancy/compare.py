"""Comparison of several methods on one problem."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace

from kinematics.errors import InvalidOption, MethodUnavailable
from kinematics.redundancy.follow import PathResult, followed
from kinematics.redundancy.methods import Method
from kinematics.redundancy.problem import PathOptions, PathProblem


def compared(
    problem: PathProblem, entries: Sequence[tuple[Method, PathOptions]], seconds: float
) -> Iterator[PathResult | InvalidOption | MethodUnavailable]:
    """Yield the result of each method with its options, one after the other.

    A method that cannot begin gives what it says: it needs an option that the request does not
    have, such as the second task of task_priority, or a package.

    Args:
        problem: The path problem.
        entries: Methods and their options.
        seconds: Time limit of all together, s; a method that starts later stops at once.
    """
    deadline = time.perf_counter() + seconds
    for method, options in entries:
        left = max(0.0, deadline - time.perf_counter())
        try:
            yield followed(problem, method, replace(options, seconds=left))
        except (InvalidOption, MethodUnavailable) as error:
            yield error
