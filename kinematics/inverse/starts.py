"""Starts of a solver after the first."""

from __future__ import annotations

import numpy as np

from robots.robot import FloatArray


def starts(random_seed: int, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the additive recurrence of Roberts (2018) in K dimensions, scaled to joint ranges.

    Point s is ``low + frac(offset + s * ratio) * (high - low)``, with ratios powers of the
    positive root of ``x**(K+1) = x + 1``: low discrepancy, and reproducible by its number alone.

    Returns:
        Rows offset, ratio, low and span; shape (4, K).
    """
    K = len(low)
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (K + 1))
    ratio = (1.0 / root) ** np.arange(1, K + 1)
    offset = np.full(K, (0.5 + random_seed * 0.6180339887498949) % 1.0)
    return np.array([offset, ratio % 1.0, low, high - low])
