"""What a chart shows: curves over a common axis, and levels across it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robots.robot import FloatArray

FLOOR = 1e-16
"""Where a logarithmic axis ends; nothing is measured more exactly."""


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

    def shown(self, log: bool) -> tuple[FloatArray, FloatArray]:
        """Return x and y of what is finite, y as its logarithm where the axis is so."""
        kept = np.isfinite(self.y)
        y = self.y[kept]
        return self.x[kept], np.log10(np.maximum(y, FLOOR)) if log else y


@dataclass(frozen=True)
class Level:
    """A dashed horizontal line, such as a limit; its label is in the legend."""

    value: float
    label: str

    def shown(self, log: bool) -> float:
        """Return the value on the axis."""
        return math.log10(max(self.value, FLOOR)) if log else self.value


def range_of(values: FloatArray, margin: float) -> tuple[float, float]:
    """Return the ends of an axis that shows all values, with a margin."""
    low, high = float(values.min(initial=np.inf)), float(values.max(initial=-np.inf))
    if not low <= high:
        return 0.0, 1.0
    if high - low < 1e-12 * max(1.0, abs(low)):
        return low - 0.5, high + 0.5
    return low - margin * (high - low), high + margin * (high - low)
