"""The real solutions of a target, from the complex ones of a general target."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.compiled import writable
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
from kinematics.inverse.continuation.meeting import DOUBLE, RealSolution, put, real_solution
from kinematics.inverse.continuation.settling import settle, settle_all
from kinematics.inverse.continuation.valley import Valley, valley_through
from kinematics.inverse.elimination.solving import Elimination, elimination_of
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


@dataclass(frozen=True, eq=False)
class RealSolutions:
    """What was found for a target.

    Attributes:
        solutions: The real solutions.
        degree: Number of complex solutions of a general target.
        is_complete: Whether each of them was found: all of them at once, each checked; or each
            followed to its end, and the ends are as they must be: no two the same where none
            meet, and the conjugate of each among them.
        added: Number of joints that were added to make the equations square.
        was_followed: Whether they were followed, not found at once.
        is_doubtful: Whether solutions nearly meet, of an arm that is special but for rounding.
    """

    solutions: tuple[RealSolution, ...]
    degree: int
    is_complete: bool
    added: int
    was_followed: bool
    is_doubtful: bool


@lru_cache(maxsize=256)
def chain_elimination(chain: Chain, task: Task) -> Elimination | None:
    """Return the elimination of a chain, from memory if asked for before; None: there is none."""
    system = square_system(chain, task)
    return None if system is None else elimination_of(system)


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


def square_solutions(
    chain: Chain, task: Task, target: FloatArray, seed: FloatArray
) -> RealSolutions | None:
    """Find all real solutions of a target, at once where that can be, else by continuation.

    Args:
        chain: Its joints must all be free.
        task: The task.
        target: Pose of the frame in base axes, shape (4, 4), m.
        seed: Where a family of solutions is shown; shape (K,).

    Returns:
        None where the task leaves joints free, or no target is general.
    """
    elimination = chain_elimination(chain, task)
    if elimination is not None:
        found = _at_once(elimination, chain, task, target)
        if found is not None:
            return found
    fibre = chain_fibre(chain, task)
    return None if fibre is None else real_solutions(fibre, chain, task, target, seed)


def _at_once(
    elimination: Elimination, chain: Chain, task: Task, target: FloatArray
) -> RealSolutions | None:
    """Return the real ones of the solutions that elimination finds; None where it does not."""
    values = elimination.solutions(target)
    if values is None:
        return None
    q = values.real[(values.imag == 0.0).all(axis=1)]
    errors, reached = np.empty((len(q), 2)), np.empty(len(q), dtype=np.bool_)
    settle_all(task_chain(chain, task), writable(target), q, errors, reached)
    if not reached.all():
        return None
    none = np.zeros(chain.length, dtype=np.bool_)
    solutions = tuple(
        RealSolution(one, 1, position, orientation, none, False)
        for one, (position, orientation) in zip(
            on_circle(q, chain.is_revolute), errors.tolist(), strict=True
        )
    )
    return RealSolutions(solutions, len(values), True, 0, False, False)


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
    constants, pose = task_chain(chain, task), writable(target)
    found: list[RealSolution] = []
    valleys: list[Valley] = []
    is_near = False
    for values, end in zip(q, ends, strict=True):
        if end in (FAR, LOST) or not _may_be_real(system, values, int(end)):
            continue
        guess = values.real[: system.joints].copy()
        guess[~chain.is_revolute] *= system.size
        meets = bool(end == BESIDE or (np.abs(values.imag) > REAL).any())
        starts = [guess]
        if len(guess) == system.rows and not any(
            v.holds(guess, chain.is_revolute) for v in valleys
        ):
            valley = valley_through(constants, pose, guess)
            if valley is not None:
                valleys.append(valley)
                starts += valley.zeros
        is_near |= meets
        for start in starts:
            there, errors = start.copy(), np.empty(2)
            if not settle(constants, pose, there, errors):
                continue
            if end == ARRIVED and np.abs(there - start).max() > DOUBLE * max(1.0, system.size):
                continue
            put(chain, found, real_solution(chain, task, target, there, errors, seed, meets))
    # Of an arm that is special but for rounding, some solutions of a general target are so far
    # away that they were not found; they come near where others meet.
    doubtful = system.is_nearly_special and (is_near or bool(valleys))
    return RealSolutions(
        tuple(found), fibre.degree, sound and not doubtful, system.added, True, doubtful
    )


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
