"""Curves over a common axis, as in a textbook."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.pictures.canvas import GRID, INK, Canvas
from app.pictures.curves import Curve, Level, range_of
from app.pictures.legend import Legend, legend_of
from app.pictures.lettering import fitted, width_of
from robots.robot import FloatArray

Box = tuple[float, float, float, float]
LEFT, ABOVE, RIGHT, BELOW = 52.0, 22.0, 10.0, 32.0
"""Room for numbers, title and the first row of the legend, pixels."""


@dataclass(frozen=True, eq=False)
class Chart:
    """What is drawn.

    Attributes:
        curves: The curves.
        title: Of the chart.
        x_label: Of the axis.
        log: Whether the axis up is logarithmic.
        levels: Horizontal lines.
    """

    curves: Sequence[Curve]
    title: str
    x_label: str
    log: bool = False
    levels: Sequence[Level] = ()

    def height(self, width: float, least: float) -> float:
        """Return the height of a chart of a width, pixels: the least one, and its legend."""
        return least + self.legend(width).height

    def legend(self, width: float) -> Legend:
        """Return the legend of a chart of a width, pixels."""
        row = width - LEFT - RIGHT
        # The first row shares its line with the label of the axis.
        taken = width_of(self.x_label, 10) + 12
        return legend_of(self.curves, self.levels, row, taken, log=self.log)


def ticks(low: float, high: float, most: int = 6) -> list[float]:
    """Round numbers from low to high, at most ``most`` of them."""
    span = high - low
    if not span > 0:
        return [low]
    raw = span / max(1, most - 1)
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= raw * (1 - 1e-12))
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, last + 1)]


def draw_chart(canvas: Canvas, box: Box, chart: Chart) -> None:
    """Draws a chart into a box (x, y, width, height), its legend below the axis."""
    legend, log = chart.legend(box[2]), chart.log
    left, top, width = box[0] + LEFT, box[1] + ABOVE, box[2] - LEFT - RIGHT
    height = box[3] - ABOVE - BELOW - legend.height
    title = fitted(chart.title, width, 12, bold=True)
    canvas.text((left, box[1] + 14), title, 12, bold=True)
    data = [curve.shown(log) for curve in chart.curves]
    levels = [level.shown(log) for level in chart.levels]
    x_low, x_high = range_of(np.concatenate([x for x, _ in data] or [np.zeros(1)]), 0.0)
    y_low, y_high = range_of(np.concatenate([*(y for _, y in data), np.array(levels)]), 0.06)

    def place(x: FloatArray, y: FloatArray) -> FloatArray:
        return np.column_stack(
            (
                left + (x - x_low) / (x_high - x_low) * width,
                top + height - (y - y_low) / (y_high - y_low) * height,
            )
        )

    for value in ticks(x_low, x_high):
        x = place(np.array([value]), np.array([y_low]))[0]
        canvas.line([x, (x[0], top)], GRID, 0.6)
        canvas.text((x[0], x[1] + 14), f"{value:.6g}", 10, anchor="middle")
    for value in _y_ticks(y_low, y_high, log):
        y = place(np.array([x_low]), np.array([value]))[0]
        canvas.line([y, (left + width, y[1])], GRID, 0.6)
        label = f"1e{value:.0f}" if log else f"{value + 0.0:.6g}"
        canvas.text((left - 5, y[1] + 3.5), label, 10, anchor="end")
    corners = [(left, top), (left + width, top), (left + width, top + height), (left, top + height)]
    canvas.line(corners, INK, 0.8, closed=True)
    for value, style in zip(levels, legend.levels, strict=True):
        ends = place(np.array([x_low, x_high]), np.full(2, value))
        canvas.line(ends, style.color, 0.9, dash=style.dash)
    for (x, y), style in zip(data, legend.styles, strict=True):
        if len(x):
            canvas.line(place(x, y), style.color, 1.5, dash=style.dash, offset=style.offset)
    canvas.text((left + width, top + height + 28), chart.x_label, 10, anchor="end")
    legend.draw(canvas, left, top + height + 25)


def _y_ticks(low: float, high: float, log: bool) -> list[float]:
    if not log:
        return ticks(low, high, 5)
    whole = [float(k) for k in range(math.ceil(low), math.floor(high) + 1)]
    return whole[:: max(1, math.ceil(len(whole) / 6))]
