"""Curves over a common axis, as in a textbook."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.pictures.canvas import GRID, INK, Canvas
from robots.robot import FloatArray

FLOOR = 1e-16
"""Where a logarithmic axis ends; nothing is measured more exactly."""
Box = tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class Curve:
    """One curve; values that are not finite are left out.

    Attributes:
        label: For the legend; empty for none.
        x: Shape (n,).
        y: Shape (n,).
        color: Of the line.
    """

    label: str
    x: FloatArray
    y: FloatArray
    color: str


@dataclass(frozen=True)
class Level:
    """A dashed horizontal line, such as a limit."""

    value: float
    label: str


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


def chart(
    canvas: Canvas,
    box: Box,
    curves: Sequence[Curve],
    title: str,
    x_label: str,
    *,
    log: bool = False,
    levels: Sequence[Level] = (),
) -> None:
    """Draws curves into a box (x, y, width, height)."""
    left, top, width, height = box[0] + 52, box[1] + 22, box[2] - 62, box[3] - 54
    canvas.text((box[0] + 52, box[1] + 14), title, 12, bold=True)
    data = [(c, *_finite(c, log)) for c in curves]
    x_all = np.concatenate([x for _, x, _ in data] or [np.zeros(1)])
    y_all = np.concatenate(
        [y for _, _, y in data] + [np.array([_on(v.value, log) for v in levels])]
    )
    x_low, x_high = _range(x_all, 0.0)
    y_low, y_high = _range(y_all, 0.06)

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
    for k, level in enumerate(levels):
        ends = place(np.array([x_low, x_high]), np.full(2, _on(level.value, log)))
        canvas.line(ends, INK, 0.9, dash="5 3")
        beside = -3 if k % 2 == 0 else 10
        canvas.text((ends[1, 0] - 4, ends[1, 1] + beside), level.label, 9, anchor="end")
    for curve, x, y in data:
        if len(x):
            canvas.line(place(x, y), curve.color, 1.5)
    canvas.text((left + width, top + height + 28), x_label, 10, anchor="end")
    _legend(canvas, left, top + height + 25, [c for c, _, _ in data if c.label])


def _legend(canvas: Canvas, x: float, y: float, curves: Sequence[Curve]) -> None:
    for curve in curves:
        canvas.line([(x, y), (x + 10, y)], curve.color, 2)
        canvas.text((x + 13, y + 3), curve.label, 9)
        x += 22 + 5.0 * len(curve.label)


def _on(value: float, log: bool) -> float:
    return math.log10(max(value, FLOOR)) if log else value


def _finite(curve: Curve, log: bool) -> tuple[FloatArray, FloatArray]:
    kept = np.isfinite(curve.y)
    y = curve.y[kept]
    return curve.x[kept], np.log10(np.maximum(y, FLOOR)) if log else y


def _range(values: FloatArray, margin: float) -> tuple[float, float]:
    low, high = float(values.min(initial=np.inf)), float(values.max(initial=-np.inf))
    if not low <= high:
        return 0.0, 1.0
    if high - low < 1e-12 * max(1.0, abs(low)):
        return low - 0.5, high + 0.5
    return low - margin * (high - low), high + margin * (high - low)


def _y_ticks(low: float, high: float, log: bool) -> list[float]:
    if not log:
        return ticks(low, high, 5)
    whole = [float(k) for k in range(math.ceil(low), math.floor(high) + 1)]
    return whole[:: max(1, math.ceil(len(whole) / 6))]
