"""Points of space -> points of a picture, seen from far away (orthographic)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.robot import FloatArray

ISO_AZIMUTH, ISO_ELEVATION = np.deg2rad(-55.0), np.deg2rad(22.0)
VIEWS = ("auto", "iso", "xy", "xz", "yz")


@dataclass(frozen=True, eq=False)
class Camera:
    """A view that fits given points into a box.

    Attributes:
        rows: Unit vectors to the right, upwards and towards the viewer, shape (3, 3).
        centre: The point in the middle of the box, m, shape (3,).
        scale: Pixels a metre.
        middle: Middle of the box on the picture, pixels.
    """

    rows: FloatArray
    centre: FloatArray
    scale: float
    middle: FloatArray

    def place(self, points: FloatArray) -> FloatArray:
        """Shape (..., 3), m -> (..., 2), pixels, y down."""
        seen = (np.asarray(points) - self.centre) @ self.rows[:2].T * self.scale
        return np.asarray(self.middle + seen * (1.0, -1.0))

    def depth(self, points: FloatArray) -> FloatArray:
        """Greater is nearer to the viewer; shape (..., 3) -> (...)."""
        return np.asarray(points @ self.rows[2])


def view_of(axes: FloatArray, is_revolute: NDArray[np.bool_]) -> str:
    """The plane in which an arm moves whose joints have these axes; iso if it does in none.

    Args:
        axes: Unit vectors of the joint axes, shape (n, 3).
        is_revolute: True where the joint is an angle, shape (n,).
    """
    for column, plane in ((2, "xy"), (1, "xz"), (0, "yz")):
        along = np.abs(axes[:, column])
        if np.all(np.where(is_revolute, along > 1 - 1e-9, along < 1e-9)):
            return plane
    return "iso"


def camera_for(
    view: str, points: FloatArray, box: tuple[float, float, float, float], least: float = 1e-7
) -> Camera:
    """A camera that shows all points.

    Args:
        view: iso, xy, xz or yz.
        points: Shape (n, 3), m.
        box: x, y, width and height on the picture, pixels.
        least: Extent shown at least, m.
    """
    rows = _rows(view)
    seen = points @ rows.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    extent = np.maximum((high - low)[:2], least)
    scale = float(min(box[2] / extent[0], box[3] / extent[1]))
    middle = np.array([box[0] + box[2] / 2, box[1] + box[3] / 2])
    return Camera(rows, rows.T @ ((low + high) / 2), scale, middle)


def _rows(view: str) -> FloatArray:
    if view == "xy":
        return np.eye(3)
    if view == "xz":
        return np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    if view == "yz":
        return np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    a, e = ISO_AZIMUTH, ISO_ELEVATION
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    return np.array([right, np.cross(towards, right), towards])
