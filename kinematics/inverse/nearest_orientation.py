"""Orientations nearest to a wished one, of q within limits that keep the position exactly.

``tr(R_targetᵀ R) = 1 + 2 cos`` of the angle that is missed, and ``z_target · z = cos`` of that of
the tool's axis, are largest where the angle is least, and smooth everywhere. Starts all over the
joints' ranges are brought onto the position; from those with the best orientation, sequential
quadratic programming leads to the largest value nearby within position and limits, with exact
second derivatives of the Lagrangian (Nocedal and Wright, *Numerical
Optimization*, 2006, ch. 18). The poses of all starts are computed together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import daqp
import numpy as np

from kinematics.deadline import checkpoint
from kinematics.inverse.held_position import EXACT, LONGEST, Held, Rows
from kinematics.inverse.motion_of_many import ManyPoses
from kinematics.inverse.starts import starts
from robots.robot import FloatArray

SAMPLES = 96
CHOSEN = 16
"""Starts from which optima are looked for."""
STEPS = 60
TO_POSITION = 30
SHORTEST = 1e-9
"""Step at which an optimum is reached, rad or parts of the arm's reach."""
EQUALITY = 5
"""Sense of an equation in daqp."""
FLOOR = 1e-6
"""Smallest curvature that a step counts on."""
RANK = 1e-9
DISTINCT = 1e-4
"""Joint difference, rad or m, from which optima are two."""


class Objective(Protocol):
    """What is to be as large as it can be."""

    def value(self, poses: ManyPoses) -> FloatArray:
        """Return it, shape (N,)."""

    def gradient(self, poses: ManyPoses) -> FloatArray:
        """Return its derivative by q, shape (N, n)."""

    def second(self, poses: ManyPoses, along: FloatArray) -> FloatArray:
        """Return its second derivative and that of ``along · p`` together, shape (N, n, n)."""


@dataclass(frozen=True, eq=False)
class Turned:
    """The orientation: ``tr(Bᵀ R)``.

    Attributes:
        B: The target's rotation, or for the tool's axis alone its z axis in the third column;
            shape (3, 3).
    """

    B: FloatArray

    def value(self, poses: ManyPoses) -> FloatArray:
        """Return the trace."""
        return poses.trace(self.B)

    def gradient(self, poses: ManyPoses) -> FloatArray:
        """Return its derivative by q."""
        return poses.trace_gradient(self.B)

    def second(self, poses: ManyPoses, along: FloatArray) -> FloatArray:
        """Return its second derivative."""
        return poses.second_derivative(self.B, along)


@dataclass(frozen=True, eq=False)
class Near:
    """Nearness to a position: minus half the distance squared, in parts of a length.

    Attributes:
        held: The position.
    """

    held: Held

    def value(self, poses: ManyPoses) -> FloatArray:
        """Return the nearness."""
        e = self.held.missed(poses) / self.held.reach
        return np.asarray(-0.5 * np.sum(e * e, axis=1))

    def gradient(self, poses: ManyPoses) -> FloatArray:
        """Return its derivative by q."""
        e = self.held.missed(poses) / self.held.reach**2
        return np.asarray(np.einsum("nki,nk->ni", poses.jacobian()[:, self.held.rows], e))

    def second(self, poses: ManyPoses, along: FloatArray) -> FloatArray:
        """Return its second derivative."""
        J = poses.jacobian()[:, self.held.rows]
        e = along.copy()
        e[:, self.held.rows] += self.held.missed(poses) / self.held.reach**2
        curved = poses.second_derivative(np.zeros((3, 3)), e)
        return np.asarray(curved - np.swapaxes(J, 1, 2) @ J / self.held.reach**2)


def samples(held: Held, low: FloatArray, high: FloatArray, known: FloatArray) -> FloatArray:
    """Return q all over the ranges, brought onto the position as far as they can be.

    Args:
        held: What is kept.
        low: Ends of the ranges of q, shape (n,).
        high: Likewise.
        known: Further starts, shape (m, n).

    Returns:
        Shape (N, n).
    """
    offset, ratio, lowest, span = starts(0, low, high)
    numbers = np.arange(1, SAMPLES + 1)[:, None]
    spread = lowest + (offset + numbers * ratio) % 1.0 * span
    q, _ = held.on_position(held.clipped(np.vstack((known, spread))), TO_POSITION)
    checkpoint()
    return q


def best_orientations(held: Held, B: FloatArray, q: FloatArray) -> FloatArray:
    """Return the q on the position at which ``tr(Bᵀ R)`` is largest nearby, the best first.

    Args:
        held: What is kept.
        B: See :class:`Turned`.
        q: Starts, shape (m, n); those that are not on the position do not count.

    Returns:
        Shape (N, n).
    """
    objective = Turned(B)
    found = _climbed(held, objective, _chosen(held, objective, held.among(q)))
    return _distinct(held, objective, held.among(found))


def nearest_positions(held: Held, q: FloatArray) -> FloatArray:
    """Return the q at which the frame is nearest to the position, the best first; shape (N, n).

    Args:
        held: The position.
        q: Starts, shape (m, n).
    """
    objective = Near(held)
    free = replace(held, rows=held.rows[:0])
    found = _climbed(free, objective, _chosen(held, objective, q))
    return _distinct(held, objective, found)


def _chosen(held: Held, objective: Objective, q: FloatArray) -> FloatArray:
    value = objective.value(ManyPoses.at(held.chain, q))
    return np.asarray(q[_diverse(held, q, value)])


def _distinct(held: Held, objective: Objective, q: FloatArray) -> FloatArray:
    q = q[np.argsort(-objective.value(ManyPoses.at(held.chain, q)), kind="stable")]
    kept: list[FloatArray] = []
    for one in q:
        if all(_apart(held, one, other) > DISTINCT for other in kept):
            kept.append(one)
    return np.array(kept).reshape(-1, q.shape[1])


def _apart(held: Held, q: FloatArray, other: FloatArray) -> float:
    difference = q - other
    turns = 2.0 * np.pi * np.round(difference / (2.0 * np.pi))
    return float(np.abs(np.where(held.chain.is_periodic, difference - turns, difference)).max())


def _diverse(held: Held, q: FloatArray, value: FloatArray) -> Rows:
    """Return which points to start from: the best, and those that are far from better ones."""
    order = np.argsort(-value)
    chosen: list[int] = []
    for radius in (0.6, 0.3, 0.1, 0.0):
        chosen = []
        for k in order:
            if all(_apart(held, q[k], q[other]) > radius for other in chosen):
                chosen.append(int(k))
            if len(chosen) == CHOSEN:
                break
        if len(chosen) == CHOSEN:
            break
    return np.array(chosen, dtype=np.int64)


def _climbed(held: Held, objective: Objective, q: FloatArray) -> FloatArray:
    """Follow steps on the position, within the limits, to the largest value nearby.

    A step that is no gain is halved; one that is is doubled, up to the longest.
    """
    q, count = q.copy(), len(q)
    if not count:
        return q
    longest, moving = np.full(count, LONGEST), np.ones(count, dtype=np.bool_)
    for _ in range(STEPS):
        checkpoint()
        now = np.flatnonzero(moving)
        poses = ManyPoses.at(held.chain, q[now])
        step = _steps(held, objective, q[now], poses, longest[now])
        there, away = held.on_position(held.clipped(q[now] + step), 8)
        gain = objective.value(ManyPoses.at(held.chain, there)) - objective.value(poses)
        good = (gain > 0.0) & (away <= 1e2 * EXACT * held.reach)
        q[now[good]] = there[good]
        longest[now] = np.where(good, np.minimum(2.0 * longest[now], LONGEST), 0.25 * longest[now])
        size = np.abs(step / held.scale).max(axis=1, initial=0.0)
        moving[now] = (size > SHORTEST) & (longest[now] > SHORTEST)
        if not moving.any():
            break
    return q


def _steps(
    held: Held, objective: Objective, q: FloatArray, poses: ManyPoses, longest: FloatArray
) -> FloatArray:
    """Return the steps of sequential quadratic programming, shape (N, n).

    The second derivative of the Lagrangian along the position, made positive definite; what it is
    across the position does not count.
    """
    scale, n = held.scale, q.shape[1]
    gradient = objective.gradient(poses) * scale
    J = poses.jacobian()[:, held.rows] * scale
    U, sigma, Vt = np.linalg.svd(J, full_matrices=False)
    kept = sigma > RANK * np.maximum(sigma[:, :1], 1e-300)
    inverse = np.where(kept, 1.0 / np.where(kept, sigma, 1.0), 0.0)
    across = np.swapaxes(Vt, 1, 2) @ (kept[:, :, None] * Vt)
    multipliers = (U @ (inverse * (Vt @ gradient[:, :, None])[:, :, 0])[:, :, None])[:, :, 0]
    along = np.zeros((len(q), 3))
    along[:, held.rows] = -multipliers
    H = -objective.second(poses, along) * scale[:, None] * scale
    P = np.eye(n) - across
    values, vectors = np.linalg.eigh(P @ H @ P)
    bent = (vectors * np.maximum(np.abs(values), FLOOR)[:, None, :]) @ np.swapaxes(vectors, 1, 2)
    bent = bent + across
    # Rows that are independent: those of the right singular vectors that count.
    step = np.zeros_like(q)
    upper = np.minimum((held.upper - q) / scale, longest[:, None])
    lower = np.maximum((held.lower - q) / scale, -longest[:, None])
    for k in range(len(q)):
        A = np.ascontiguousarray(Vt[k][kept[k]])
        none = np.zeros(len(A))
        bounds = np.concatenate((upper[k], none)), np.concatenate((lower[k], none))
        sense = np.concatenate((np.zeros(n, np.int32), np.full(len(A), EQUALITY, np.int32)))
        found, _, flag, _ = daqp.solve(
            np.ascontiguousarray(bent[k]), -gradient[k], A, *bounds, sense
        )
        if flag > 0:
            step[k] = found
    return step * scale
