"""The units of a request: angles of joints and of orientations, and lengths, both ways."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.robot import FloatArray, Robot

PER_METRE = 1000.0
"""Millimetres in a metre."""


def _scaled(poses: FloatArray, factor: float) -> FloatArray:
    scaled = np.array(poses, dtype=np.float64)
    scaled[..., :3, 3] *= factor
    return scaled


@dataclass(frozen=True, slots=True)
class Units:
    """Units of one request and its answer.

    Jacobians and what is made of them stay in rad and m.

    Attributes:
        degrees: True for ``?angle=deg``.
        orientation: A further way to write orientations of the answer, ``?orientation=kuka_abc``;
            empty for none.
        millimetres: True for ``?length=mm``.
    """

    degrees: bool = False
    orientation: str = ""
    millimetres: bool = False

    @property
    def named(self) -> dict[str, str]:
        """What the answer says."""
        return {"angle": "deg" if self.degrees else "rad", "length": self.length}

    @property
    def length(self) -> str:
        """Return the unit of lengths."""
        return "mm" if self.millimetres else "m"

    def length_in(self, length: float) -> float:
        """Return one length of a request in m."""
        return length / PER_METRE if self.millimetres else length

    def length_out(self, length: float) -> float:
        """Return one length for the answer, from m."""
        return length * PER_METRE if self.millimetres else length

    def lengths_out(self, lengths: FloatArray) -> FloatArray:
        """Return lengths for the answer, from m."""
        return lengths * PER_METRE if self.millimetres else lengths

    def poses_in(self, poses: FloatArray) -> FloatArray:
        """Return poses of a request, shape (..., 4, 4), in m."""
        return _scaled(poses, 1.0 / PER_METRE) if self.millimetres else poses

    def poses_out(self, poses: FloatArray) -> FloatArray:
        """Return poses for the answer, shape (..., 4, 4), from m."""
        return _scaled(poses, PER_METRE) if self.millimetres else poses

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
        """Values of a request, shape (..., m), with rad in the angular entries, m in the others."""
        if self.degrees:
            values = np.asarray(np.where(angular, np.deg2rad(values), values))
        if self.millimetres:
            values = np.asarray(np.where(angular, values, values / PER_METRE))
        return values

    def rows_out(self, angular: NDArray[np.bool_], values: FloatArray) -> FloatArray:
        """Values for the answer, from rad in the angular entries and m in the others."""
        if self.degrees:
            values = np.asarray(np.where(angular, np.rad2deg(values), values))
        if self.millimetres:
            values = np.asarray(np.where(angular, values, values * PER_METRE))
        return values

    @property
    def are_si(self) -> bool:
        """Return whether values of joints are as kinematics has them."""
        return not self.degrees and not self.millimetres

    def directions_out(self, angular: NDArray[np.bool_], vectors: FloatArray) -> FloatArray:
        """Unit vectors for the answer, shape (k, m): unit ones in its units."""
        turned = self.rows_out(angular, vectors)
        return vectors if self.are_si else turned / np.linalg.norm(turned, axis=-1, keepdims=True)

    def joints_in(self, robot: Robot, q: FloatArray) -> FloatArray:
        """Joint values of a request, shape (..., dof), in rad and m."""
        return self.rows_in(robot.is_revolute, q)

    def joints_out(self, robot: Robot, q: FloatArray) -> FloatArray:
        """Joint values for the answer, from rad and m."""
        return self.rows_out(robot.is_revolute, q)
