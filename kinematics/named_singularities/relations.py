"""Relative placement of the axes of a short chain, found once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.inverse.closed_form.geometry import axis_lines
from robots.robot import FloatArray

MOST_JOINTS = 7


@dataclass(frozen=True, eq=False)
class Relations:
    """Relations of up to seven axes, within the tolerances of :mod:`geometry`.

    Relations of neighbouring axes hold at every q; points are those at q = 0.

    Attributes:
        is_revolute: True for revolute joints, shape (K,).
        parallel: Whether axes i and j are parallel at q = 0, shape (K, K).
        size: Length that distances are compared with, m.
        meeting: Where axes 1 and 2 meet, base axes, if both joints are revolute.
        shoulder: Where axes 1, 2 and 3 meet, base axes.
        wrist: Where the last three axes meet, in the frame.
        last_two: Where the last two axes meet, in the frame.
        on_last: A point of the last axis, in the frame.
    """

    is_revolute: NDArray[np.bool_]
    parallel: NDArray[np.bool_]
    size: float
    meeting: FloatArray | None
    shoulder: FloatArray | None
    wrist: FloatArray | None
    last_two: FloatArray | None
    on_last: FloatArray


@lru_cache(maxsize=512)
def relations_of(chain: Chain) -> Relations | None:
    """Return the relations of a chain; None where it has no joint or more than seven."""
    K = chain.length
    if not 1 <= K <= MOST_JOINTS:
        return None
    lines = axis_lines(chain)

    def in_frame(point: FloatArray | None) -> FloatArray | None:
        return None if point is None else lines.point_in_tip(point)

    turning = bool(lines.is_revolute[:2].all()) and K > 1
    return Relations(
        is_revolute=lines.is_revolute,
        parallel=np.array([[lines.parallel(i, j) for j in range(K)] for i in range(K)]),
        size=lines.size,
        meeting=lines.meeting_point(0, 1) if turning else None,
        shoulder=lines.centre(0) if K > 2 else None,
        wrist=in_frame(lines.centre(K - 3)) if K > 2 else None,
        last_two=in_frame(lines.meeting_point(K - 2, K - 1)) if K > 1 else None,
        on_last=lines.point_in_tip(lines.points[-1]),
    )
