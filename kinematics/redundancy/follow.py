"""Following of a path by any method, sample by sample, with measurement and verdict."""

from __future__ import annotations

import time
from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from kinematics.deadline import Deadline, current, under
from kinematics.errors import OutOfTime
from kinematics.redundancy.judging.verdict import Verdict, judge
from kinematics.redundancy.measure import Measures, measure
from kinematics.redundancy.methods import Method
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.redundancy.stop import Stop, StopReason
from robots.robot import FloatArray


@dataclass(frozen=True, eq=False)
class PathResult:
    """A followed path; n of N samples, all N unless the method stopped.

    Attributes:
        problem: The path problem.
        method: Name of the method.
        q: Configurations of all joints, shape (n, dof), rad and m.
        velocity: Of the chain's joints, by differences: central, at the ends one-sided of
            second order; rad/s or m/s, shape (n, dof).
        acceleration: Likewise, second differences.
        measures: Errors, clearances and steps.
        verdict: Whether the path was followed.
        elapsed: Time of the method without measuring, s.
    """

    problem: PathProblem
    method: str
    q: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    measures: Measures
    verdict: Verdict
    elapsed: float

    @property
    def drift(self) -> FloatArray | None:
        """Q at the end minus q at the start, where the path is closed and complete; else None."""
        if not self.problem.path.closed or len(self.q) < self.problem.path.samples:
            return None
        return np.asarray(self.q[-1] - self.q[0])


@dataclass(frozen=True)
class Progress:
    """Samples ``first`` to ``last - 1`` are done.

    Attributes:
        first: The first new sample.
        last: The one after the last new one.
        q: Chain's joints of all samples so far, shape (last, K).
    """

    first: int
    last: int
    q: FloatArray


def result_bytes(dof: int) -> int:
    """Return the bytes of each sample of a result: joint values, their rates, and measures."""
    return 8 * (4 * dof + 30)


def working_bytes(dof: int) -> int:
    """Return the bytes of each sample that one result takes while it is made and measured."""
    return 8 * (3 * dof + 60)


def follow(
    problem: PathProblem, method: Method, options: PathOptions
) -> Generator[Progress, None, PathResult]:
    """Follow a path; yield progress, and return the result.

    The work stops where the generator is closed.
    """
    Q = np.empty((problem.path.samples, problem.arm.K))
    Q[0] = problem.first
    work = method.follow(problem, options, Q)
    told, done, elapsed = 0, 1, 0.0
    stop: Stop | None = None
    whole = current()
    while True:
        started = time.perf_counter()
        try:
            with under(Deadline(options.seconds - elapsed, of=whole)):
                done = next(work)
        except StopIteration as end:
            stop = end.value
            break
        except OutOfTime:
            stop = Stop(StopReason.TIME, done)
            break
        finally:
            elapsed += time.perf_counter() - started
        if done > told:
            yield Progress(told, done, Q[:done])
        told = done
        if elapsed > options.seconds and done < len(Q):
            stop = Stop(StopReason.TIME, done)
            break
    if stop is not None:
        done = stop.sample
    if done > told:
        yield Progress(told, done, Q[:done])
    # The samples that are done are measured, also when the time is up.
    with under(Deadline(of=whole)):
        return _result(problem, method, Q[:done], stop, elapsed)


def followed(problem: PathProblem, method: Method, options: PathOptions) -> PathResult:
    """Return the result of :func:`follow`."""
    work = follow(problem, method, options)
    while True:
        try:
            next(work)
        except StopIteration as end:
            result: PathResult = end.value
            return result


def _result(
    problem: PathProblem,
    method: Method,
    Q: FloatArray,
    stop: Stop | None,
    elapsed: float,
) -> PathResult:
    measures = measure(problem, Q)
    verdict = judge(problem, Q, measures, stop, method.constrained)
    q = problem.arm.expanded(Q, problem.start)
    velocity, acceleration = rates(q, problem.path.dt)
    return PathResult(problem, method.name, q, velocity, acceleration, measures, verdict, elapsed)


def rates(q: FloatArray, dt: float) -> tuple[FloatArray, FloatArray]:
    """Return velocities and accelerations of samples, shape (n, dof), by differences."""
    n = len(q)
    if n < 3:
        steps = np.diff(q, axis=0) / dt
        v = np.repeat(steps, n, axis=0) if n == 2 else np.zeros_like(q)
        return v, np.zeros_like(q)
    v = np.gradient(q, dt, axis=0, edge_order=2)
    a = np.empty_like(q)
    a[1:-1] = (q[2:] - 2 * q[1:-1] + q[:-2]) / dt**2
    a[0], a[-1] = (2 * a[1] - a[2], 2 * a[-2] - a[-3]) if n > 3 else (a[1], a[1])
    return v, a
