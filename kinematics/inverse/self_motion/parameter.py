"""The joint that parametrises the self-motions of an arm, and points on them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from kinematics.chain import Chain
from kinematics.inverse.continuation.fibre import LARGE_STEP, SAFE_STEP, Fibre
from kinematics.inverse.continuation.following import FAR, LOST
from kinematics.inverse.continuation.real import chain_fibre
from kinematics.inverse.self_motion.pieces import TURN, Limits
from kinematics.inverse.self_motion.tracing import Motion
from kinematics.task import Task
from robots.robot import FloatArray

SAMPLES = 64
"""Random joint values at which it is seen how much each joint moves in a self-motion."""
LEAST = 0.4
"""Mean motion of a joint, in parts of the largest, below which it is no parameter."""
MOST_TRIED = 4
ENOUGH = 8
"""Number of complex solutions, beside which other joints are not tried."""
SLICES = 8
"""Values of the parameter at which all solutions are found."""


@lru_cache(maxsize=256)
def parameter_of(chain: Chain, task: Task) -> tuple[int, Fibre] | None:
    """Return the joint that parametrises the self-motions, and all solutions once it is given.

    Of the joints that move most in them, over random joint values, the one that leaves the fewest
    solutions.

    Args:
        chain: Its joints are all free.
        task: The task.

    Returns:
        None where the chain has not one joint more than the task has rows, or no joint can be
        given so that the others reach general targets.
    """
    if chain.is_coupled or chain.length != len(task.rows) + 1 or chain.length < 2:
        return None
    motion = Motion(chain, task, np.eye(4))
    random = np.random.default_rng(0)
    moved = np.zeros(chain.length)
    for _ in range(SAMPLES):
        q = random.uniform(-np.pi, np.pi, chain.length)
        q = np.where(chain.is_revolute, q, q / np.pi / motion.weights)
        direction = motion.direction(q)
        if direction is not None:
            moved += np.abs(direction * motion.weights)
    best: tuple[int, Fibre] | None = None
    order = np.argsort(-moved)
    for k in order[moved[order] > LEAST * moved.max()][:MOST_TRIED]:
        fibre = chain_fibre(chain, task, (int(k),))
        if fibre is not None and (best is None or fibre.degree < best[1].degree):
            best = int(k), fibre
        if best is not None and best[1].degree <= ENOUGH:
            break
    return best


def slice_values(motion: Motion, joint: int, limits: Limits, seed: float) -> FloatArray:
    """Return values of a joint at which self-motions are cut, the seed's first.

    Args:
        motion: The chain and its target.
        joint: Its number.
        limits: Of the chain's joints.
        seed: Its value in the seed, rad or m.
    """
    low, high = float(limits.lower[joint]), float(limits.upper[joint])
    if motion.chain.is_revolute[joint] and not (high - low < TURN):
        return np.asarray(seed + np.arange(SLICES) * (TURN / SLICES))
    size = 1.0 / float(motion.weights[joint])
    low = low if np.isfinite(low) else (high if np.isfinite(high) else 0.0) - 2.0 * size
    high = high if np.isfinite(high) else low + 4.0 * size
    spread = low + (np.arange(SLICES) + 0.5) * ((high - low) / SLICES)
    return np.append(min(max(seed, low), high), spread)


def points(
    motion: Motion,
    joint: int,
    fibre: Fibre,
    values: FloatArray,
    nearby: tuple[FloatArray | None, ...],
) -> Iterator[FloatArray]:
    """Give points on the self-motions: all where the joint has a value, and others beside them.

    Of complex solutions, what is real leads to points on curves that the joint's value does not
    cut but comes near to.

    Args:
        motion: The chain and its target.
        joint: Number of the joint that is given.
        fibre: All solutions of a general target where it is.
        values: The values of the joint.
        nearby: Further joint values, shape (K,), from which points are sought.
    """
    system = fibre.system
    pose = system.scaled(motion.target)
    for start in nearby:
        found = None if start is None else motion.settled(start)
        if found is not None:
            yield found
    for value in values:
        given = np.array([value if system.is_revolute[joint] else value / system.size])
        q, ends = fibre.followed(pose, given.astype(np.complex128), LARGE_STEP)
        if (ends == LOST).any():
            q, ends = fibre.followed(pose, given.astype(np.complex128), SAFE_STEP)
        near_first = np.argsort(np.abs(q.imag).max(axis=1))
        for values_there, end in zip(q[near_first], ends[near_first], strict=True):
            if end == FAR or not np.isfinite(values_there).all():
                continue
            guess = values_there.real[: system.joints].copy()
            guess[~motion.chain.is_revolute] *= system.size
            found = motion.settled(guess)
            if found is not None:
                yield found
