"""The angle unit of a request: joint values of turning joints and Euler angles, both ways."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.robot import FloatArray, Robot


@dataclass(frozen=True, slots=True)
class Units:
    """Units of one request and its answer; lengths are always metres.

    Attributes:
        degrees: True for ``?angle=deg``.
        orientation: A further way to write orientations of the answer, ``?orientation=kuka_abc``;
            empty for none.
    """

    degrees: bool = False
    orientation: str = ""

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

    def angle_in(self, angle: float) -> float:
        """Return one angle of a request in rad."""
        return math.radians(angle) if self.degrees else angle

    def angle_out(self, angle: float) -> float:
        """Return one angle for the answer, from rad."""
        return math.degrees(angle) if self.degrees else angle

    @property
    def named_rates(self) -> dict[str, str]:
        """What an answer with rates says."""
        return {**self.named, "time": "s"}

    def rows_in(self, angular: NDArray[np.bool_], values: FloatArray) -> FloatArray:
        """Values of a request, shape (..., m), with rad in the angular entries."""
        return np.asarray(np.where(angular, np.deg2rad(values), values)) if self.degrees else values

    def rows_out(self, angular: NDArray[np.bool_], values: FloatArray) -> FloatArray:
        """Values for the answer, from rad in the angular entries."""
        return np.asarray(np.where(angular, np.rad2deg(values), values)) if self.degrees else values

    def directions_out(self, angular: NDArray[np.bool_], vectors: FloatArray) -> FloatArray:
        """Unit vectors for the answer, shape (k, m): unit ones in its units."""
        turned = self.rows_out(angular, vectors)
        return turned / np.linalg.norm(turned, axis=-1, keepdims=True) if self.degrees else vectors

    def joints_in(self, robot: Robot, q: FloatArray) -> FloatArray:
        """Joint values of a request, shape (..., dof), in rad and m."""
        return self.rows_in(robot.is_revolute, q)

    def joints_out(self, robot: Robot, q: FloatArray) -> FloatArray:
        """Joint values for the answer, from rad and m."""
        return self.rows_out(robot.is_revolute, q)
