"""One or two quadratic programs a sample: the least motion among all that keep the constraints.

``min ½ ‖θ + δ − θ_prev‖²`` with ``J δ = ΔX``, joint limits and speeds as bounds, and the clearance
of every near pair of link and obstacle linearised, ``∇d δ ≥ d_safe + margin − d``; linearised
anew until path and clearance are reached as measured. Solved by DAQP (Arnström, Bemporad and
Axehill, IEEE Trans. Automatic Control 67(8), 2022). Where nothing is feasible, see
:mod:`kinematics.redundancy.best_effort`.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TypeAlias

import daqp
import numpy as np

from kinematics.redundancy.best_effort import best_effort, merit
from kinematics.redundancy.linearised import Linearised
from kinematics.redundancy.methods.stop import Stop
from kinematics.redundancy.problem import PathOptions, Problem, departure
from robots.robot import FloatArray

EXACT = 1e-9
"""Error, and missing clearance, at which a sample is done, m and rad."""
PROGRAMS = 12
"""Most programs in a sample before the best effort is taken."""
NEARLY = 1e-3
"""Error, m and rad, from which on the best effort is taken for a way to the path."""
WIDER = 4
"""Times a sample is solved again with more margin, where the arm comes too near in between."""
BLOCK = 8

Solve: TypeAlias = Callable[[Linearised, FloatArray, FloatArray, float], FloatArray | None]


def follow(
    problem: Problem, options: PathOptions, Q: FloatArray
) -> Generator[int, None, Stop | None]:
    """See :class:`kinematics.redundancy.methods.Method`."""
    model = Linearised(problem, options)
    previous = departure(problem, options)
    for i in range(1, len(Q)):
        Q[i] = advance(model, previous, problem.path.targets[i], step)
        previous = Q[i]
        if i % BLOCK == 0:
            yield i + 1
    yield len(Q)
    return None


def advance(
    model: Linearised, previous: FloatArray, target: FloatArray, solve: Solve
) -> FloatArray:
    """The next sample: solved, else the best effort; with more margin where it is swept too near.

    Args:
        model: The linear model.
        previous: The sample before, shape (K,).
        target: Pose, 12 numbers.
        solve: ``(model, previous, target, need) -> q``, or None where it is not feasible.
    """
    model.bound(previous)
    need, d_safe = model.need, model.problem.d_safe
    for attempt in range(WIDER + 1):
        found = solve(model, previous, target, need)
        q = _otherwise(model, previous, target, need) if found is None else found
        if not len(model.problem.obstacles):
            break
        near = model.swept(previous, q)
        if near >= d_safe or attempt == WIDER:
            break
        need += 1.5 * (d_safe - near) + 1e-5
    return q


def _otherwise(
    model: Linearised, previous: FloatArray, target: FloatArray, need: float
) -> FloatArray:
    """The best effort; from there the path, where it is near after all."""
    q = best_effort(model, previous, target, need)
    model.at(q, target, need)
    if model.error > NEARLY * NEARLY:
        return q
    found = _from(model, previous, target, need, q)
    return q if found is None else found


def step(
    model: Linearised, previous: FloatArray, target: FloatArray, need: float
) -> FloatArray | None:
    """The nearest configuration on the path, by linearising again and again; None: not found."""
    return _from(model, previous, target, need, previous)


def _from(
    model: Linearised, previous: FloatArray, target: FloatArray, need: float, q: FloatArray
) -> FloatArray | None:
    start = q
    eye = np.eye(len(q))
    value = np.inf
    for _ in range(PROGRAMS):
        model.at(q, target, need)
        reached = model.error <= EXACT * EXACT
        if reached and model.least >= need - EXACT and q is not start:
            return q
        now = merit(model, need)
        if now > 4 * value:
            return None
        value = min(value, now)
        A, upper, lower, sense = model.rows(task=True)
        delta, _, flag, _ = daqp.solve(eye, q - previous, A, upper, lower, sense)
        if flag <= 0:
            return None
        q = np.clip(q + delta, model.low, model.high)
    return None
