"""A chain whose frame keeps a position, within the limits: many q at once brought onto it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.inverse.motion_of_many import ManyPoses
from robots.robot import FloatArray

LONGEST = 0.35
"""Largest step of a joint, rad or parts of the arm's reach."""
AT_LIMIT = 1e-12
EXACT = 1e-11
"""Position error of a point on the position, in parts of the arm's reach."""

Rows = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Held:
    """A chain, its limits, and the position that it keeps.

    Attributes:
        chain: The chain.
        lower: Limits of its entries of q, none for angles that come back after a turn within them;
            shape (n,).
        upper: Likewise.
        position: Of the frame, in base axes, m, shape (3,).
        rows: Which of x, y, z are kept.
    """

    chain: Chain
    lower: FloatArray
    upper: FloatArray
    position: FloatArray
    rows: Rows

    @property
    def reach(self) -> float:
        """Length that distances are compared with, m: of the links where slides have no limits."""
        reach = self.chain.reach
        if not np.isfinite(reach):
            reach = float(np.linalg.norm(self.chain.placements[1:, [3, 7, 11]], axis=1).sum())
        return float(np.clip(reach, 1e-3, 1e3))

    @property
    def scale(self) -> FloatArray:
        """Unit of each entry of q, shape (n,)."""
        return np.where(self.chain.is_angle, 1.0, self.reach)

    def missed(self, poses: ManyPoses) -> FloatArray:
        """Return what is missed of the position, m, shape (N, rows)."""
        return np.asarray((self.position - poses.position)[:, self.rows])

    def beyond(self, q: FloatArray, step: FloatArray) -> NDArray[np.bool_]:
        """Return True for entries at a limit that a step would pass, shape (N, n)."""
        low = (q <= self.lower + AT_LIMIT) & (step < 0.0)
        return np.asarray(low | ((q >= self.upper - AT_LIMIT) & (step > 0.0)))

    def clipped(self, q: FloatArray) -> FloatArray:
        """Return q within the limits."""
        return np.clip(q, self.lower, self.upper)

    def on_position(self, q: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Bring q onto the position within the limits, by damped steps of least length.

        Returns:
            q, shape (N, n), and what is missed, m, shape (N,).
        """
        q, scale = q.copy(), self.scale
        away = np.full(len(q), np.inf)
        moving = np.ones(len(q), dtype=np.bool_)
        for _ in range(steps):
            poses = ManyPoses.at(self.chain, q[moving])
            e = self.missed(poses)
            away[moving] = np.linalg.norm(e, axis=1)
            J = poses.jacobian()[:, self.rows] * scale
            part = q[moving]
            step, free = np.zeros_like(part), np.ones(part.shape, dtype=np.bool_)
            size = np.sum(J * J, axis=(1, 2))
            weight = size * np.minimum(1e-3, (away[moving] / self.reach) ** 2) + 1e-14 * size
            for _ in range(part.shape[1]):
                held = J * free[:, None]
                A = held @ np.swapaxes(held, 1, 2)
                A += (weight + 1e-300)[:, None, None] * np.eye(A.shape[1])
                step = (np.swapaxes(held, 1, 2) @ np.linalg.solve(A, e[:, :, None]))[:, :, 0]
                stuck = self.beyond(part, step) & free
                if not stuck.any():
                    break
                free &= ~stuck
            largest = np.abs(step).max(axis=1, initial=0.0)
            step *= np.minimum(1.0, LONGEST / np.maximum(largest, 1e-300))[:, None]
            q[moving] = self.clipped(part + step * scale * free)
            moving[moving] = (away[moving] > EXACT * self.reach) & (largest > 1e-14)
            if not moving.any():
                break
        away = np.linalg.norm(self.missed(ManyPoses.at(self.chain, q)), axis=1)
        return q, away

    def among(self, q: FloatArray) -> FloatArray:
        """Return those q that are on the position."""
        away = np.linalg.norm(self.missed(ManyPoses.at(self.chain, q)), axis=1)
        return np.asarray(q[away <= 1e3 * EXACT * self.reach])


def held_at(
    chain: Chain, wraps: NDArray[np.bool_], position: FloatArray, rows: tuple[int, ...]
) -> Held:
    """Return a chain that keeps a position.

    Args:
        chain: The chain.
        wraps: True for an angle whose range spans a turn, shape (n,).
        position: m, shape (3,).
        rows: Which of x, y, z count.
    """
    return Held(
        chain,
        np.where(wraps, -np.inf, chain.lower),
        np.where(wraps, np.inf, chain.upper),
        np.asarray(position, dtype=np.float64),
        np.array(rows, dtype=np.int64),
    )
