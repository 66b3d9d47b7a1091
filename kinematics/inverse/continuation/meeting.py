"""Real solutions where several meet, or which a family of solutions goes through."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.inverse.closed_form.candidates import SAME
from kinematics.inverse.continuation.settling import settle, task_columns
from kinematics.inverse.task_error import task_chain
from kinematics.inverse.windings import on_circle
from kinematics.task import Task
from robots.robot import FloatArray

DOUBLE = 1e-3
"""Difference of answers beside a singular one that count as it."""
SINGULAR = 1e-6
"""Part of the largest singular value below which the Jacobian has lost rank."""
ALONG = 1e-2
"""Step along a direction that the task does not see, for seeing whether it goes on, rad or m."""


@dataclass(frozen=True, eq=False)
class RealSolution:
    """One real solution, checked on the chain.

    Attributes:
        q: Joint values, angles in (-pi, pi], shape (K,).
        multiplicity: How many complex solutions end there.
        position_error: Measured, m.
        orientation_error: Measured, rad.
        free: True for joints that move along a family of solutions which this is one of;
            shape (K,).
        is_singular: Whether it is where solutions meet.
    """

    q: FloatArray
    multiplicity: int
    position_error: float
    orientation_error: float
    free: NDArray[np.bool_]
    is_singular: bool


def real_solution(
    chain: Chain,
    task: Task,
    target: FloatArray,
    q: FloatArray,
    errors: FloatArray,
    seed: FloatArray,
    is_singular: bool,
) -> RealSolution:
    """Return the solution at a settled q; of a family, its member that is nearest to a seed."""
    free = np.zeros(chain.length, dtype=np.bool_)
    if is_singular:
        null = _unseen(chain, task, q)
        if null is not None and _goes_on(chain, task, target, q, null):
            q, errors = _nearest(chain, task, target, q, seed, errors)
            null = _unseen(chain, task, q)
            if null is not None:
                free = np.abs(null).max(axis=1) > SINGULAR
    q = on_circle(q, chain.is_revolute)
    return RealSolution(q, 1, float(errors[0]), float(errors[1]), free, is_singular)


def _unseen(chain: Chain, task: Task, q: FloatArray) -> FloatArray | None:
    """Return directions of q that the task does not see, shape (K, r); None: there are none."""
    columns = np.empty((chain.length, 6))
    task_columns(task_chain(chain, task), q, columns)
    directions, sigma, _ = np.linalg.svd(columns)
    rank = int(np.count_nonzero(sigma > SINGULAR * sigma.max(initial=0.0)))
    return np.asarray(directions[:, rank:]) if rank < chain.length else None


def _goes_on(chain: Chain, task: Task, target: FloatArray, q: FloatArray, null: FloatArray) -> bool:
    """Return whether solutions go on in a direction that the task does not see."""
    for direction in null.T:
        there, errors = q + ALONG * direction, np.empty(2)
        reached = settle(task_chain(chain, task), target, there, errors)
        if reached and np.abs(there - q).max() > 0.3 * ALONG * np.abs(direction).max():
            return True
    return False


def _nearest(
    chain: Chain,
    task: Task,
    target: FloatArray,
    q: FloatArray,
    seed: FloatArray,
    errors: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the member of a family of solutions that is nearest to a seed, and its errors."""
    constants = task_chain(chain, task)
    for _ in range(50):
        null = _unseen(chain, task, q)
        if null is None:
            break
        step = null @ (null.T @ on_circle(seed - q, chain.is_revolute))
        there, found = q + step * min(1.0, 0.5 / max(1e-12, float(np.abs(step).max()))), np.empty(2)
        if float(np.abs(step).max()) < SAME or not settle(constants, target, there, found):
            break
        q, errors = there, found
    return q, errors


def put(chain: Chain, found: list[RealSolution], one: RealSolution) -> None:
    """Add a solution, or count it where it is known already."""
    for k, other in enumerate(found):
        difference = on_circle(one.q - other.q, chain.is_revolute)
        radius = DOUBLE if one.is_singular or other.is_singular else SAME
        if float(np.abs(difference).max()) < radius:
            better = min(one, other, key=lambda x: x.position_error + x.orientation_error)
            found[k] = RealSolution(
                better.q,
                other.multiplicity + one.multiplicity,
                better.position_error,
                better.orientation_error,
                other.free | one.free,
                other.is_singular or one.is_singular,
            )
            return
    found.append(one)
