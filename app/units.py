"""The angle unit of a request: joint values of turning joints and Euler angles, both ways."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots.robot import FloatArray, Robot


@dataclass(frozen=True, slots=True)
class Units:
    """Units of one request and its answer; lengths are always metres.

    Attributes:
        degrees: True for ``?angle=deg``.
    """

    degrees: bool = False

    @property
    def named(self) -> dict[str, str]:
        """What the answer says."""
        return {"angle": "deg" if self.degrees else "rad", "length": "m"}

    def angles_in(self, angles: FloatArray) -> FloatArray:
        """Angles of a request in rad."""
        return np.asarray(np.deg2rad(angles)) if self.degrees else angles

    def angles_out(self, angles: FloatArray) -> FloatArray:
        """Angles for the answer, from rad."""
        return np.asarray(np.rad2deg(angles)) if self.degrees else angles

    def joints_in(self, robot: Robot, q: FloatArray) -> FloatArray:
        """Joint values of a request, shape (..., dof), in rad and m."""
        return np.asarray(np.where(robot.turns, np.deg2rad(q), q)) if self.degrees else q

    def joints_out(self, robot: Robot, q: FloatArray) -> FloatArray:
        """Joint values for the answer, from rad and m."""
        return np.asarray(np.where(robot.turns, np.rad2deg(q), q)) if self.degrees else q
