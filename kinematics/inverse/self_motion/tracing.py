"""Follow a self-motion from one of its points along the null space to its ends, or around.

Predictor and corrector: a step along the direction that the task does not see, then the nearest
joint values that reach the target. Nothing is divided by the change of a joint, so that a joint may
turn back. A step halves where the direction changes much, or the correction is large for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from kinematics.chain import Chain
from kinematics.deadline import checkpoint
from kinematics.inverse.continuation.settling import settle, task_columns
from kinematics.inverse.self_motion.curve import Curve, Stop
from kinematics.inverse.task_error import TaskChain, task_chain
from kinematics.inverse.windings import on_circle
from kinematics.task import Task
from robots.robot import FloatArray

LONGEST, SHORTEST = 0.15, 1e-6
"""Lengths of a step, rad, or sizes of the chain."""
BEND = 0.97
"""Least cosine of the angle between the directions of successive nodes."""
ASIDE = 0.15
"""Largest correction of a step, in parts of its length."""
MOST_NODES = 2000
SECOND = 12
"""Node at which a curve is seen to come around too, beside its start."""
FAR = 20.0
"""Slides beyond this many sizes of the chain are taken to move on for ever."""
SAME = 1e-6
"""Largest difference, rad or m, of a point from a curve that it is on."""
RANK = 1e-9
"""Part of the largest singular value below which the task's Jacobian has lost rank."""
LOOKED_AT = 4
"""Nodes of a curve, the nearest first, from which it is looked for a point."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A chain with one joint more than its task has rows, and a target.

    Attributes:
        chain: Its joints are all free.
        task: The task.
        target: Pose of the frame in base axes, shape (4, 4), m.
    """

    chain: Chain
    task: Task
    target: FloatArray

    @cached_property
    def constants(self) -> TaskChain:
        """What compiled functions know of it."""
        return task_chain(self.chain, self.task)

    @cached_property
    def weights(self) -> FloatArray:
        """1 for an angle, one over the size of the chain for a slide; shape (K,)."""
        lengths = np.linalg.norm(self.chain.placements[:, [3, 7, 11]], axis=1)
        return np.where(self.chain.is_revolute, 1.0, 1.0 / (float(lengths.max()) or 1.0))

    def settled(self, q: FloatArray) -> FloatArray | None:
        """Return joint values near q that reach the target, shape (K,); None: there are none."""
        found = np.array(q, dtype=np.float64)
        return found if settle(self.constants, self.target, found, np.empty(2)) else None

    def direction(self, q: FloatArray) -> FloatArray | None:
        """Return the direction that the task does not see, of length 1 in weighted joint values.

        None where there are several: where the Jacobian has lost rank.
        """
        J = np.empty((self.chain.length, 6))
        task_columns(self.constants, q, J)
        directions, sigma, _ = np.linalg.svd(J)
        rank = self.chain.length - 1
        if rank > 0 and not sigma[rank - 1] > RANK * sigma[0]:
            return None
        null = directions[:, -1]
        return np.asarray(null / np.linalg.norm(null * self.weights))

    def apart(self, q: FloatArray, other: FloatArray) -> FloatArray:
        """Return q - other, (…, K), angles by the shorter way."""
        return on_circle(q - other, self.chain.is_revolute)

    def length(self, difference: FloatArray) -> float:
        """Return the length of a difference of joint values, weighted."""
        return float(np.linalg.norm(difference * self.weights))


def trace(motion: Motion, start: FloatArray) -> Curve | None:
    """Return the curve through a point, without regard to limits.

    Args:
        motion: The chain and its target.
        start: Joint values that reach the target, shape (K,).

    Returns:
        None where the curve has no direction there: where the Jacobian has lost rank.
    """
    direction = motion.direction(start)
    if direction is None:
        return None
    nodes, stop = _walked(motion, start, direction)
    if stop is None:
        return _curve(motion, nodes, closed=True, stops=(Stop.SINGULARITY, Stop.SINGULARITY))
    back, stop_back = _walked(motion, start, -direction)
    if stop_back is None:
        return _curve(motion, back, closed=True, stops=(Stop.SINGULARITY, Stop.SINGULARITY))
    joined = np.vstack((back[:0:-1], nodes))
    if len(joined) < 2:
        return None
    return _curve(motion, joined, closed=False, stops=(stop_back, stop))


def is_on(motion: Motion, curve: Curve, q: FloatArray, within: float = SAME) -> bool:
    """Return whether joint values, turns aside, are on a curve.

    Args:
        motion: The chain and its target.
        curve: A curve of it.
        q: Joint values that reach the target, shape (K,).
        within: Largest difference of a joint, rad or m.
    """
    difference = motion.apart(q, curve.q) * motion.weights
    distance = np.square(difference).sum(axis=1)
    for node in np.argsort(distance)[:LOOKED_AT]:
        if distance[node] > (3.0 * LONGEST) ** 2:
            return False
        if _meets(motion, curve.q[node], q, within):
            return True
    return False


def _meets(motion: Motion, q: FloatArray, wanted: FloatArray, within: float) -> bool:
    """Return whether a curve comes to joint values, walking from one of its points nearby."""
    for _ in range(40):
        away = motion.apart(wanted, q)
        if float(np.abs(away).max()) < within:
            return True
        direction = motion.direction(q)
        if direction is None:
            return False
        step = float((away * motion.weights**2) @ direction)
        if abs(step) < 1e-12:
            return False
        there = motion.settled(q + min(max(step, -LONGEST), LONGEST) * direction)
        if there is None or motion.length(there - q) > 2.0 * LONGEST:
            return False
        q = there
    return False


def _walked(
    motion: Motion, start: FloatArray, direction: FloatArray
) -> tuple[FloatArray, Stop | None]:
    """Walk from a point in a direction; return the nodes and why it ended, None: it came around."""
    nodes, q, h = [start], start, 0.3 * LONGEST
    # A curve is not sure to come back with the direction that it has where others cross it.
    anchors = [(0, direction)]
    square = motion.weights**2
    for number in range(MOST_NODES):
        if number % 64 == 0:
            checkpoint()
        found = _step(motion, q, direction, h)
        while found is None:
            h *= 0.5
            if h < SHORTEST:
                return np.array(nodes), Stop.SINGULARITY
            found = _step(motion, q, direction, h)
        there, onward, aside = found
        for first, way in anchors:
            ahead = motion.apart(nodes[first], q)
            if (
                number > first + 1
                and motion.length(ahead) < 1.5 * h
                and float((ahead * square) @ direction) > 0.0
                and float((motion.apart(there, nodes[first]) * square) @ onward) >= 0.0
                and float((onward * square) @ way) > BEND
                and _is_one_step(motion, q, q + ahead)
            ):
                return np.array([*nodes[first:], q + ahead]), None
        nodes.append(there)
        q, direction = there, onward
        if number == SECOND:
            anchors.append((len(nodes) - 1, onward))
        if (np.abs(q * motion.weights)[~motion.chain.is_revolute] > FAR).any():
            return np.array(nodes), Stop.UNBOUNDED
        if aside < 0.2 * ASIDE * h:
            h = min(2.0 * h, LONGEST)
    return np.array(nodes), Stop.UNBOUNDED


def _step(
    motion: Motion, q: FloatArray, direction: FloatArray, h: float
) -> tuple[FloatArray, FloatArray, float] | None:
    """Take a step; return where it leads, the direction there and the correction's length."""
    guess = q + h * direction
    there = motion.settled(guess)
    if there is None:
        return None
    aside = motion.length(there - guess)
    if aside > ASIDE * h:
        return None
    onward = motion.direction(there)
    if onward is None:
        # A curve goes straight through a point where others cross it.
        return (there, direction, aside) if h > 10.0 * SHORTEST else None
    cosine = float((onward * motion.weights**2) @ direction)
    if abs(cosine) < BEND:
        return None
    return there, (onward if cosine > 0.0 else -onward), aside


def _is_one_step(motion: Motion, q: FloatArray, end: FloatArray) -> bool:
    """Return whether the curve from a point leads to another one nearby."""
    middle = motion.settled(0.5 * (q + end))
    gap = motion.length(end - q)
    return middle is not None and motion.length(middle - 0.5 * (q + end)) <= ASIDE * gap + 1e-12


def _curve(motion: Motion, nodes: FloatArray, *, closed: bool, stops: tuple[Stop, Stop]) -> Curve:
    directions = np.empty_like(nodes)
    square = motion.weights**2
    for k, q in enumerate(nodes):
        chord = nodes[min(k + 1, len(nodes) - 1)] - nodes[max(k - 1, 0)]
        found = motion.direction(q)
        if found is None:
            found = chord / max(motion.length(chord), 1e-300)
        directions[k] = found if float((found * square) @ chord) >= 0.0 else -found

    def between(u: float) -> FloatArray:
        k = min(int(u), len(nodes) - 2)
        s, chord = u - k, nodes[k + 1] - nodes[k]
        h = motion.length(chord)
        guess = nodes[k] + s * s * (3.0 - 2.0 * s) * chord
        guess += h * s * (1.0 - s) * ((1.0 - s) * directions[k] - s * directions[k + 1])
        found = motion.settled(guess)
        return guess if found is None else found

    return Curve(nodes, closed, between, stops)
