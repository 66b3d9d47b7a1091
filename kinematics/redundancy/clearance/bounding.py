"""Bounding capsules of shapes: the shape itself where it is one, else that of least volume."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots.robot import FloatArray
from robots.shapes import Shape

LENGTHS = 257
"""Lengths that are tried; each bounds the shape, only the choice of the least is approximate."""


@dataclass(frozen=True, eq=False)
class BoundingCapsule:
    """A capsule that contains a shape.

    Attributes:
        start: One end of its segment, in the link's axes, shape (3,), m.
        end: The other.
        radius: m.
        excess: Largest distance of its surface from the shape, m; 0 where it is the shape.
    """

    start: FloatArray
    end: FloatArray
    radius: float
    excess: float


def bounding_capsule(shape: Shape) -> BoundingCapsule:
    """Return the capsule about a shape that is no mesh, its segment along an axis of the shape.

    A segment of half length h along an axis on which the shape has half length c reaches a rim of
    radius ρ with the radius ``√(ρ² + (c − h)²)``; of all h, and of a box's three axes, the least
    volume is taken.
    """
    if shape.kind == "sphere":
        return _placed(shape, 2, 0.0, shape.size[0], 0.0)
    if shape.kind == "capsule":
        return _placed(shape, 2, shape.size[1] / 2, shape.size[0], 0.0)
    if shape.kind == "cylinder":
        radius, length = shape.size
        h, R, _ = _least(radius, length / 2)
        return _placed(shape, 2, h, R, R - min(radius, length / 2 - h))
    half = np.array(shape.size) / 2
    found = [
        (_least(float(np.linalg.norm(np.delete(half, k))), float(half[k])), k) for k in range(3)
    ]
    (h, R, _), axis = min(found, key=lambda one: (one[0][2], one[1]))
    return _placed(shape, axis, h, R, R - min(*np.delete(half, axis), half[axis] - h))


def _least(rim: float, c: float) -> tuple[float, float, float]:
    """Return half length and radius of the capsule of least volume, m, and the volume, m³."""
    h = np.linspace(0.0, c, LENGTHS)
    R = np.hypot(rim, c - h)
    volume = np.pi * R * R * (2 * h + 4 / 3 * R)
    best = int(np.argmin(volume))
    return float(h[best]), float(R[best]), float(volume[best])


def _placed(shape: Shape, axis: int, h: float, radius: float, excess: float) -> BoundingCapsule:
    center, along = shape.placement[:3, 3], h * shape.placement[:3, axis]
    return BoundingCapsule(center - along, center + along, radius, float(excess))
