"""Directions all round."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def directions(count: int) -> NDArray[np.float64]:
    """Return unit vectors all round, evenly spread (a Fibonacci spiral); shape (count, 3)."""
    k = np.arange(count) + 0.5
    z, angle = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    across = np.sqrt(1 - z * z)
    return np.column_stack((across * np.cos(angle), across * np.sin(angle), z))
