"""The real solutions of a target, from the complex ones of a general target."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.inverse.closed_form.candidates import SAME
from kinematics.inverse.continuation.closure import SquareSystem, square_system
from kinematics.inverse.continuation.fibre import (
    LARGE_STEP,
    MIRRORED,
    SAFE_STEP,
    ComplexArray,
    Fibre,
    apart,
    fibre_of,
    moved_fibre,
)
from kinematics.inverse.continuation.following import ARRIVED, BESIDE, FAR, LOST
from kinematics.inverse.continuation.settling import settle, task_columns
from kinematics.inverse.task_error import task_chain
from kinematics.inverse.windings import on_circle
from kinematics.task import Task
from robots.robot import FloatArray

NEARLY_REAL = 1e-4
"""Imaginary part, rad or sizes, below which a solution may be one of two that meet."""
ROUGHLY = 0.1
"""Value of an added joint, rad, from which a solution beside a singular one is no solution."""
REAL = 1e-7
"""Imaginary part of a solution that is real but for rounding."""
MET = 1e-6
"""Difference of two solutions that should not be the same."""
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


@dataclass(frozen=True, eq=False)
class RealSolutions:
    """What was found for a target.

    Attributes:
        solutions: The real solutions.
        degree: Number of complex solutions of a general target.
        is_complete: Whether each of them was followed to its end, and the ends are as they must
            be: no two the same where none meet, and the conjugate of each among them.
    """

    solutions: tuple[RealSolution, ...]
    degree: int
    is_complete: bool


@lru_cache(maxsize=256)
def chain_fibre(chain: Chain, task: Task, driven: tuple[int, ...] = ()) -> Fibre | None:
    """Return the general solutions of a chain, from memory if asked for before.

    Args:
        chain: Its joints must all be free.
        task: The task.
        driven: Joints whose values are given.

    Returns:
        None where the task leaves joints free, or no target is general.
    """
    system = square_system(chain, task, driven)
    return None if system is None else fibre_of(system)


@lru_cache(maxsize=256)
def _other_fibre(fibre: Fibre, seed: int) -> Fibre:
    return moved_fibre(fibre, seed)


def real_solutions(
    fibre: Fibre,
    chain: Chain,
    task: Task,
    target: FloatArray,
    seed: FloatArray,
) -> RealSolutions:
    """Find all real solutions of a target.

    Args:
        fibre: Of the chain and the task.
        chain: The chain.
        task: The task.
        target: Pose of the frame in base axes, shape (4, 4), m.
        seed: Values of the given joints, and where a family of solutions is shown; shape (K,).

    Returns:
        The solutions.
    """
    system = fibre.system
    driven = seed.astype(np.complex128)
    driven[~chain.is_revolute] /= system.size
    q, ends, sound = _followed(fibre, system.scaled(target), driven[system.closure.driven])
    constants = task_chain(chain, task)
    found: list[RealSolution] = []
    for values, end in zip(q, ends, strict=True):
        if end in (FAR, LOST) or not _may_be_real(system, values, int(end)):
            continue
        guess = values.real[: system.joints].copy()
        guess[~chain.is_revolute] *= system.size
        before, errors = guess.copy(), np.empty(2)
        if not settle(constants, target, guess, errors):
            continue
        if end == ARRIVED and np.abs(guess - before).max() > DOUBLE * max(1.0, system.size):
            continue
        meets = bool(end == BESIDE or (np.abs(values.imag) > REAL).any())
        one = _solution(chain, task, target, guess, errors, seed, meets)
        _put(chain, found, one)
    return RealSolutions(tuple(found), fibre.degree, sound)


def _followed(
    fibre: Fibre, pose: ComplexArray, driven: ComplexArray
) -> tuple[ComplexArray, NDArray[np.int64], bool]:
    """Follow all solutions, again on other ways where the ends are not as they must be."""
    best: tuple[int, ComplexArray, NDArray[np.int64]] | None = None
    for attempt in range(4):
        start = fibre if attempt < 2 else _other_fibre(fibre, attempt)
        q, ends = start.followed(pose, driven, LARGE_STEP if attempt == 0 else SAFE_STEP)
        faults = _faults(fibre.system, q, ends)
        if faults == 0:
            return q, ends, True
        if best is None or faults < best[0]:
            best = faults, q, ends
    assert best is not None
    return best[1], best[2], False


def _faults(system: SquareSystem, q: ComplexArray, ends: NDArray[np.int64]) -> int:
    """Return how many ends are lost, the same as another, or without their conjugate."""
    arrived = q[ends == ARRIVED]
    faults = int(np.count_nonzero(ends == LOST))
    if not len(arrived):
        return faults
    among = apart(system, arrived[:, None], arrived) + np.diag(np.full(len(arrived), np.inf))
    mirrored = apart(system, arrived[:, None].conj(), arrived).min(axis=1)
    large = np.maximum(1.0, np.abs(arrived.imag).max(axis=1))
    return (
        faults
        + int(np.count_nonzero(among.min(axis=1) < MET))
        + int(np.count_nonzero(mirrored > MIRRORED * large))
    )


def _may_be_real(system: SquareSystem, q: ComplexArray, end: int) -> bool:
    added = q[system.joints :]
    turned = on_circle(added.real, system.is_revolute[system.joints :])
    off = np.abs(turned + 1j * added.imag).max(initial=0.0)
    if end == BESIDE:
        return bool(off < ROUGHLY)
    return bool(off < NEARLY_REAL and np.abs(q.imag).max() < NEARLY_REAL)


def _solution(
    chain: Chain,
    task: Task,
    target: FloatArray,
    q: FloatArray,
    errors: FloatArray,
    seed: FloatArray,
    is_singular: bool,
) -> RealSolution:
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


def _put(chain: Chain, found: list[RealSolution], one: RealSolution) -> None:
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
