"""Joint limits for solvers: wrapping, midpoints, ranges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.inverse.damped_step import TURN, inside_all
from robots.robot import FloatArray, Robot


@dataclass(frozen=True)
class JointBounds:
    """Limits of q, rad and m.

    Attributes:
        lower: Lower limits, -inf where none; shape (dof,).
        upper: Upper limits, inf where none.
        wraps: True where an angle's range spans a whole turn, so that every direction is within
            the limits and a step beyond one re-enters a turn away.
        is_revolute: True where an entry is an angle.
    """

    lower: FloatArray
    upper: FloatArray
    wraps: NDArray[np.bool_]
    is_revolute: NDArray[np.bool_]

    @classmethod
    def of(cls, robot: Robot) -> JointBounds:
        """Return the limits of a robot."""
        span = robot.upper - robot.lower
        wraps = robot.is_periodic & (span >= TURN - 1e-9)
        return cls(robot.lower, robot.upper, wraps, robot.is_revolute)

    def middle(self) -> FloatArray:
        """Return mid-range, 0 where there is no limit; shape (dof,), rad and m."""
        finite = np.isfinite(self.lower) & np.isfinite(self.upper)
        low, high = np.where(finite, self.lower, 0.0), np.where(finite, self.upper, 0.0)
        return np.clip((low + high) / 2, self.lower, self.upper)

    def inside(self, q: FloatArray) -> FloatArray:
        """Bring q within the limits: by whole turns where that works, else to the nearest."""
        inside = np.empty(len(q))
        inside_all(np.array(q, dtype=np.float64), self.lower, self.upper, self.wraps, inside)
        return inside

    def nearest(self, q: FloatArray, reference: FloatArray) -> FloatArray:
        """Turn wrapping joints by whole turns towards a reference, within the limits."""
        whole_turns = np.round((reference - q) / TURN) * TURN
        candidate = q + np.where(self.wraps, whole_turns, 0.0)
        candidate = np.where(candidate > self.upper, candidate - TURN, candidate)
        candidate = np.where(candidate < self.lower, candidate + TURN, candidate)
        within = (candidate >= self.lower) & (candidate <= self.upper)
        return np.where(self.wraps & within, candidate, q)

    def ranges(self, reach: float) -> tuple[FloatArray, FloatArray]:
        """Return the ends of the ranges from which starts are taken, each of shape (dof,).

        These are the limits; where there is none, a turn about the other one or 0, or ±reach (m)
        for a length. An angle that is another after a turn, as its followers are, gets two.
        """
        half = np.where(self.wraps, np.pi, np.where(self.is_revolute, TURN, reach))
        open_below, open_above = np.isinf(self.lower), np.isinf(self.upper)
        low = np.where(open_below, np.where(open_above, -half, self.upper - 2 * half), self.lower)
        high = np.where(open_above, np.where(open_below, half, self.lower + 2 * half), self.upper)
        return low, high
