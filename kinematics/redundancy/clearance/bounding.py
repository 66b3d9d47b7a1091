"""Capsules about shapes: the shape itself where it is one, else the least of volume about it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robots.robot import FloatArray
from robots.shapes import Shape

LENGTHS = 257
"""Lengths that are tried; every one of them bounds the shape, the choice alone is approximate."""


@dataclass(frozen=True, eq=False)
class BoundingCapsule:
    """A capsule that holds a shape.

    Attributes:
        start: One end of its segment, in the link's axes, shape (3,), m.
        end: The other.
        radius: m.
        excess: How far it sticks out of the shape at most, m; 0 where it is the shape.
    """

    start: FloatArray
    end: FloatArray
    radius: float
    excess: float


def bounding_capsule(shape: Shape) -> BoundingCapsule:
    """The capsule about a shape other than a mesh, its segment along an axis of the shape.

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
    """Half length and radius of the least volume, and the volume."""
    h = np.linspace(0.0, c, LENGTHS)
    R = np.hypot(rim, c - h)
    volume = np.pi * R * R * (2 * h + 4 / 3 * R)
    best = int(np.argmin(volume))
    return float(h[best]), float(R[best]), float(volume[best])


def _placed(shape: Shape, axis: int, h: float, radius: float, excess: float) -> BoundingCapsule:
    center, along = shape.placement[:3, 3], h * shape.placement[:3, axis]
    return BoundingCapsule(center - along, center + along, radius, float(excess))
