"""Relation of two axes and their common normal.

The denominator is ``|u1 x u2|²``: ``1 - (u1 . u2)²`` cancels where axes are nearly parallel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from dh_to_urdf.extraction.axes import AxisLine
from dh_to_urdf.poses import Matrix

ROUNDING = 1e-14
"""Angle (rad) and length (relative to the robot) that differ from zero by rounding only."""


class Case(StrEnum):
    """Relation of two directed lines; opposite directions are parallel too."""

    SKEW = "skew"
    INTERSECTING = "intersecting"
    PARALLEL = "parallel"
    COINCIDENT = "coincident"

    @property
    def is_parallel(self) -> bool:
        """Return True where the common normal is not unique."""
        return self in (Case.PARALLEL, Case.COINCIDENT)


@dataclass(frozen=True)
class CommonNormal:
    """The common normal of two axes.

    Attributes:
        case: Relation of the axes.
        direction: Unit vector from the first axis to the second; for intersecting axes along
            ``u1 x u2``; None for coincident ones, whose normal is any.
        foot: Its foot on the first axis, m; for parallel axes the first axis' own point.
        length: Distance of the axes, m.
        tilt: Angle between the axes, taken as lines, rad, 0 to π/2.
    """

    case: Case
    direction: Matrix | None
    foot: Matrix
    length: float
    tilt: float


def cross(a: Matrix, b: Matrix) -> Matrix:
    """Return the cross product of two vectors, shape (3,), faster than ``np.cross``."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def tilt_of(first: Matrix, second: Matrix) -> float:
    """Return the angle between two unit vectors as undirected lines, rad, 0 to π/2."""
    sine = float(np.linalg.norm(cross(first, second)))
    return math.atan2(sine, abs(float(first @ second)))


def common_normal(first: AxisLine, second: AxisLine, size: float) -> CommonNormal:
    """Return the common normal from one axis to another.

    Args:
        first: The first axis.
        second: The second axis.
        size: Length of the robot, m: what lengths are compared with.
    """
    u, v = first.direction, second.direction
    between = second.point - first.point
    tilt = tilt_of(u, v)
    if tilt <= ROUNDING:
        across = between - (between @ u) * u
        across -= (across @ u) * u
        length = float(np.linalg.norm(across))
        if length <= ROUNDING * size:
            return CommonNormal(Case.COINCIDENT, None, first.point, 0.0, 0.0)
        return CommonNormal(Case.PARALLEL, across / length, first.point, length, 0.0)
    product = cross(u, v)
    square = float(product @ product)
    along = float(cross(between, v) @ product) / square
    normal = product / math.sqrt(square)
    # The product of nearly parallel vectors is rounded in every direction, along u too.
    normal -= (normal @ u) * u
    normal /= np.linalg.norm(normal)
    foot = first.point + along * u
    distance = float(between @ normal)
    if abs(distance) <= ROUNDING * size:
        return CommonNormal(Case.INTERSECTING, normal, foot, 0.0, tilt)
    return CommonNormal(Case.SKEW, math.copysign(1, distance) * normal, foot, abs(distance), tilt)
