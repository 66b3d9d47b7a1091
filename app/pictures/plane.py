"""A pair of axes with a grid, on which points of a plane are drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.pictures.canvas import GRID, INK, Canvas
from app.pictures.chart import Box, ticks
from robots.robot import FloatArray

LEFT, TOP, RIGHT, BELOW = 40.0, 4.0, 6.0, 26.0


@dataclass(frozen=True, eq=False)
class Plane:
    """Where points of a plane stand on a picture.

    Attributes:
        box: x, y, width and height of the drawn area, pixels.
        low: Coordinates at its lower left corner, shape (2,).
        high: Coordinates at its upper right corner, shape (2,).
    """

    box: Box
    low: FloatArray
    high: FloatArray

    @property
    def scale(self) -> float:
        """Pixels a unit across."""
        return float(self.box[2] / (self.high[0] - self.low[0]))

    @property
    def corners(self) -> FloatArray:
        """Of the area, in pixels, shape (4, 2)."""
        x, y, width, height = self.box
        return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])

    def place(self, points: FloatArray) -> FloatArray:
        """Coordinates, shape (..., 2) -> pixels, y down."""
        part = (np.asarray(points) - self.low) / (self.high - self.low)
        x, y, width, height = self.box
        return np.stack((x + part[..., 0] * width, y + height - part[..., 1] * height), axis=-1)


def equal_plane(box: Box, low: FloatArray, high: FloatArray) -> Plane:
    """A plane with the same scale on both axes that shows at least low to high."""
    area = (box[0] + LEFT, box[1] + TOP, box[2] - LEFT - RIGHT, box[3] - TOP - BELOW)
    scale = min(area[2] / (high[0] - low[0]), area[3] / (high[1] - low[1]))
    middle, half = (low + high) / 2, np.array(area[2:]) / (2 * scale)
    return Plane(area, middle - half, middle + half)


def stretched_plane(box: Box, low: FloatArray, high: FloatArray) -> Plane:
    """A plane that shows low to high exactly."""
    area = (box[0] + LEFT, box[1] + TOP, box[2] - LEFT - RIGHT, box[3] - TOP - BELOW)
    return Plane(area, np.asarray(low), np.asarray(high))


def draw_axes(canvas: Canvas, plane: Plane, x_label: str, y_label: str) -> None:
    """Grid, numbers and names of the axes."""
    left, top, width, height = plane.box
    for value in ticks(float(plane.low[0]), float(plane.high[0])):
        x = plane.place(np.array([value, plane.low[1]]))[0]
        canvas.line([(x, top), (x, top + height)], GRID, 0.6)
        canvas.text((x, top + height + 13), f"{value + 0.0:.6g}", 10, anchor="middle")
    for value in ticks(float(plane.low[1]), float(plane.high[1])):
        y = plane.place(np.array([plane.low[0], value]))[1]
        canvas.line([(left, y), (left + width, y)], GRID, 0.6)
        canvas.text((left - 4, y + 3.5), f"{value + 0.0:.6g}", 10, anchor="end")
    canvas.text((left + width / 2, top + height + 26), x_label, 10, anchor="middle")
    canvas.text((left - 28, top + height / 2), y_label, 10, anchor="middle", turned=True)


def draw_border(canvas: Canvas, plane: Plane) -> None:
    """The edge of the area, over what was drawn in it."""
    canvas.line(plane.corners, INK, 0.8, closed=True)
