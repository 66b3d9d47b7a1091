"""Joint bounds as a solver sees them: wrapping, midpoints, ranges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinematics.inverse.damped_step import inside_all
from robots.robot import FloatArray, Robot

TURN = 2 * np.pi


@dataclass(frozen=True)
class JointBounds:
    """Bounds of q.

    Attributes:
        lower: Lower limits, -inf where none; shape (dof,).
        upper: Upper limits, inf where none.
        wraps: True where an angle's range spans a whole turn, so that every direction is within
            the limits and a step beyond one re-enters a turn away.
    """

    lower: FloatArray
    upper: FloatArray
    wraps: NDArray[np.bool_]

    @classmethod
    def of(cls, robot: Robot) -> JointBounds:
        """The bounds of a robot."""
        span = robot.upper - robot.lower
        return cls(robot.lower, robot.upper, robot.is_revolute & (span >= TURN - 1e-9))

    def middle(self) -> FloatArray:
        """Mid-range; 0 where there is no limit."""
        finite = np.isfinite(self.lower) & np.isfinite(self.upper)
        low, high = np.where(finite, self.lower, 0.0), np.where(finite, self.upper, 0.0)
        return np.clip((low + high) / 2, self.lower, self.upper)

    def inside(self, q: FloatArray) -> FloatArray:
        """Brings q within the limits: by whole turns where that works, else to the nearest."""
        inside = np.empty(len(q))
        inside_all(np.array(q, dtype=np.float64), self.lower, self.upper, self.wraps, inside)
        return inside

    def nearest(self, q: FloatArray, reference: FloatArray) -> FloatArray:
        """Turns wrapping joints by whole turns towards a reference, within the limits."""
        whole_turns = np.round((reference - q) / TURN) * TURN
        candidate = q + np.where(self.wraps, whole_turns, 0.0)
        candidate = np.where(candidate > self.upper, candidate - TURN, candidate)
        candidate = np.where(candidate < self.lower, candidate + TURN, candidate)
        within = (candidate >= self.lower) & (candidate <= self.upper)
        return np.where(self.wraps & within, candidate, q)

    def ranges(self, reach: float) -> tuple[FloatArray, FloatArray]:
        """Where starts are taken from: the limits; a turn, or ±reach, where there is none."""
        half = np.where(self.wraps, np.pi, reach)
        open_below, open_above = np.isinf(self.lower), np.isinf(self.upper)
        low = np.where(open_below, np.where(open_above, -half, self.upper - 2 * half), self.lower)
        high = np.where(open_above, np.where(open_below, half, self.lower + 2 * half), self.upper)
        return low, high
