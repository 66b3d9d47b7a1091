"""One or two quadratic programs a sample: the least motion among all that keep the constraints.

``min ½ ‖θ + δ − θ_prev‖²`` with ``J δ = ΔX``, joint limits and speeds as bounds, and the clearance
of every near pair of link and obstacle linearised, ``∇d δ ≥ d_safe + margin − d``; linearised
anew until path and clearance are reached as measured. Where the path leaves no room for the margin,
it is given up. Solved by DAQP (Arnström, Bemporad and Axehill, IEEE Trans. Automatic Control 67(8),
2022). Where nothing is feasible, see :mod:`kinematics.redundancy.steps.best_effort`.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TypeAlias

import daqp
import numpy as np

from kinematics.redundancy.measure import nearest_part
from kinematics.redundancy.problem import PathOptions, PathProblem, departure
from kinematics.redundancy.steps.best_effort import best_effort, merit
from kinematics.redundancy.steps.linearised import Linearised
from kinematics.redundancy.stop import Stop
from robots.robot import FloatArray

EXACT = 1e-9
"""Error, and missing clearance, at which a sample is done, m and rad."""
PROGRAMS = 12
"""Most programs in a sample before the best effort is taken."""
WATCH = 3
"""Programs in a row that may lead away from path or clearance before they are given up."""
NEARLY = 1e-3
"""Error, m and rad, from which on the best effort is taken for a way to the path."""
MOST_BETWEEN = 5
"""Places between two samples at which clearances are kept as well, at most."""
ASIDE = 0.05
"""Distance from the path half way to a sample, relative to the arm's length, of another branch."""
BLOCK = 8

Solve: TypeAlias = Callable[[Linearised, FloatArray, FloatArray, float], FloatArray | None]


def follow(
    problem: PathProblem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """Follow a path; see :class:`kinematics.redundancy.methods.Method`."""
    model = Linearised(problem, options)
    previous = departure(problem, options)
    for i in range(1, len(Q)):
        Q[i] = advance(model, previous, problem.path.targets[i], step)
        previous = Q[i]
        if i % BLOCK == 0:
            yield i + 1
    yield len(Q)
    return None


def follow_from(problem: PathProblem, options: PathOptions, Q: FloatArray, first: int) -> None:
    """Fill the samples from ``first`` on, after those that are given."""
    model = Linearised(problem, options)
    for i in range(first, len(Q)):
        Q[i] = advance(model, Q[i - 1], problem.path.targets[i], step)


def advance(
    model: Linearised, previous: FloatArray, target: FloatArray, solve: Solve
) -> FloatArray:
    """Return the next sample: solved, with the margin if there is room, else the best effort.

    Where the arm is swept too near on its way, the clearance is kept there as well, and the sample
    is solved again.

    Args:
        model: The linear model.
        previous: The sample before, shape (K,).
        target: Pose, 12 numbers.
        solve: ``(model, previous, target, need) -> q``, or None where it is not feasible.
    """
    problem = model.problem
    model.bound(previous, problem.near_step)
    q, reached = _clear(model, previous, target, solve)
    if reached or (np.abs(q - previous) < problem.near_step).all():
        return q
    # A longer step held it back: it is taken where the frame stays by the path on the way.
    model.bound(previous, problem.longest_step)
    longer, reached = _clear(model, previous, target, solve)
    return longer if reached and _stays(model, previous, longer, target) else q


def _clear(
    model: Linearised, previous: FloatArray, target: FloatArray, solve: Solve
) -> tuple[FloatArray, bool]:
    """The next sample within the bounds, and whether it is on the path and swept clear."""
    need, d_safe = model.need, model.problem.d_safe
    between: list[float] = []
    while True:
        q, reached = _sample(model, previous, target, solve, need)
        if not reached and need > model.least:
            close, reached = _sample(model, previous, target, solve, model.least)
            if reached:
                q, need = close, model.least
        if not len(model.problem.obstacles):
            return q, reached
        # A sample before that is too near itself cannot be helped.
        if model.swept(previous, q) >= min(d_safe, model.clearance(previous)):
            return q, reached
        if len(between) == MOST_BETWEEN:
            return q, False
        between.append(nearest_part(model.problem, previous, q))
        if need != model.least:
            need = max(need, model.in_between)
        model.look_between(between)


def _stays(model: Linearised, previous: FloatArray, q: FloatArray, target: FloatArray) -> bool:
    """Whether the frame stays by the path half way to a sample, as it does in one branch."""
    problem = model.problem
    model.at((previous + q) / 2, target, model.least)
    most = problem.largest_increment + ASIDE * problem.scale
    return model.error <= most * most


def _sample(
    model: Linearised, previous: FloatArray, target: FloatArray, solve: Solve, need: float
) -> tuple[FloatArray, bool]:
    """Return the next sample, and whether it is on the path.

    Where it is not solved it is the best effort; from there the path, where it is near after all.
    """
    found = solve(model, previous, target, need)
    if found is not None:
        return found, True
    q = best_effort(model, previous, target, need)
    model.at(q, target, need)
    if model.error > NEARLY * NEARLY:
        return q, False
    found = _from(model, previous, target, need, q)
    return (q, False) if found is None else (found, True)


def step(
    model: Linearised, previous: FloatArray, target: FloatArray, need: float
) -> FloatArray | None:
    """Return the nearest configuration on the path, by repeated linearisation; None: not found."""
    return _from(model, previous, target, need, previous)


def _from(
    model: Linearised, previous: FloatArray, target: FloatArray, need: float, q: FloatArray
) -> FloatArray | None:
    start = q
    eye = np.eye(len(q))
    best, since = np.inf, 0
    for _ in range(PROGRAMS):
        model.at(q, target, need)
        reached = model.error <= EXACT * EXACT
        if reached and model.missing <= EXACT and q is not start:
            return q
        now = merit(model)
        best, since = (now, 0) if now < best else (best, since + 1)
        if since > WATCH:
            return None
        A, upper, lower, sense = model.rows(task=True)
        delta, _, flag, _ = daqp.solve(eye, q - previous, A, upper, lower, sense)
        if flag <= 0:
            return None
        q = np.clip(q + delta, model.region.low, model.region.high)
    return None
