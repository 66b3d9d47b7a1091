"""Time laws: covered part of a path, its rate and its acceleration."""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from robots.robot import FloatArray

BLEND = 0.25
"""Part of the time in which the trapezoidal law accelerates, and again decelerates."""


class TimeLaw(StrEnum):
    """r(s) from 0 to 1 while s = t / tf goes from 0 to 1.

    ``linear``: r = s. ``cubic``: r = 3 s² − 2 s³, at rest at both ends. ``quintic``:
    r = 10 s³ − 15 s⁴ + 6 s⁵, with zero acceleration there. ``trapezoidal``: acceleration for a
    quarter of the time, constant speed for half, deceleration for a quarter.
    """

    LINEAR = "linear"
    CUBIC = "cubic"
    QUINTIC = "quintic"
    TRAPEZOIDAL = "trapezoidal"

    def at(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return r, dr/ds, d²r/ds², each of the shape of s (Siciliano et al., *Robotics*, 4.2)."""
        s = np.asarray(s, dtype=np.float64)
        if self is TimeLaw.LINEAR:
            return s, np.ones_like(s), np.zeros_like(s)
        if self is TimeLaw.CUBIC:
            return s * s * (3 - 2 * s), 6 * s * (1 - s), 6 - 12 * s
        if self is TimeLaw.QUINTIC:
            r = s**3 * (10 - 15 * s + 6 * s * s)
            return r, 30 * (s * (1 - s)) ** 2, 60 * s * (1 - s) * (1 - 2 * s)
        top = 1 / (1 - BLEND)
        rate, left = top / BLEND, 1 - s
        first, last = s < BLEND, s > 1 - BLEND
        r = np.select(
            [first, last], [rate * s * s / 2, 1 - rate * left * left / 2], top * (s - BLEND / 2)
        )
        return (
            r,
            np.select([first, last], [rate * s, rate * left], top),
            np.select([first, last], [rate, -rate], 0.0),
        )
