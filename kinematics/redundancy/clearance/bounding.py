"""Bounding capsules of shapes: the shape itself where it is one, else that of least volume."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.directions import directions
from robots.robot import FloatArray
from robots.shapes import Shape
from robots.uploaded_mesh import Hull

DIRECTIONS = 1000
"""Directions in which a capsule about a hull is compared with it."""
ROUNDING = 1e-12
"""Part of a radius that covers rounding."""
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
    """Return the capsule about a shape, its segment along an axis of the shape.

    A segment of half length h along an axis on which the shape has half length c reaches a rim of
    radius ρ with the radius ``√(ρ² + (c − h)²)``; of all h, and of a box's three axes, the least
    volume is taken. A mesh has a hull; its axes are those of its extent and its own.

    Raises:
        TypeError: It is a mesh without a hull.
    """
    if shape.kind == "mesh":
        if shape.hull is None:
            raise TypeError("a mesh without a hull has no capsule")
        return _about_hull(shape, shape.hull)
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


def _about_hull(shape: Shape, hull: Hull) -> BoundingCapsule:
    """Return the capsule of least volume about a hull, among those along a few axes.

    Of an axis through the middle of the hull, a corner at height t and distance ρ lies in a capsule
    of radius R where its segment comes as near as ``√(R² − ρ²)`` to t.
    """
    points = hull.vertices
    _, _, principal = np.linalg.svd(points - points.mean(axis=0), full_matrices=True)
    found = [_along(points, axis) for axis in (*principal, *np.eye(3))]
    start, end, radius = min(found, key=_volume)
    excess = _largest_gap(points, hull, start, end, radius) + hull.excess
    R, p = shape.placement[:3, :3], shape.placement[:3, 3]
    return BoundingCapsule(R @ start + p, R @ end + p, radius, excess)


def _along(points: FloatArray, axis: FloatArray) -> tuple[FloatArray, FloatArray, float]:
    """Return start, end and radius of the capsule of least volume about points along an axis."""
    center = _center(points - np.outer(points @ axis, axis))
    center = center - (center @ axis) * axis
    t, across = points @ axis, points - np.outer(points @ axis, axis) - center
    rim = np.linalg.norm(across, axis=1)
    least, length = float(rim.max()), float(np.ptp(t))
    best: tuple[FloatArray, FloatArray, float] | None = None
    for radius in np.linspace(least, float(np.hypot(least, length / 2)), LENGTHS):
        reach = np.sqrt(np.maximum(radius * radius - rim * rim, 0.0))
        low, high = float((t + reach).min()), float((t - reach).max())
        if low > high:  # a ball holds it
            low = high = (low + high) / 2
        one = (center + low * axis, center + high * axis, radius * (1 + ROUNDING))
        best = one if best is None else min(best, one, key=_volume)
    assert best is not None
    return best


def _center(points: FloatArray) -> FloatArray:
    """Return about the centre of the least ball about points (Badoiu and Clarkson 2003)."""
    center = points.mean(axis=0)
    for k in range(1, LENGTHS):
        farthest = points[int(np.linalg.norm(points - center, axis=1).argmax())]
        center = center + (farthest - center) / (k + 2)
    return np.asarray(center)


def _volume(capsule: tuple[FloatArray, FloatArray, float]) -> float:
    start, end, R = capsule
    return float(np.pi * R * R * (np.linalg.norm(end - start) + 4 / 3 * R))


def _largest_gap(
    points: FloatArray, hull: Hull, start: FloatArray, end: FloatArray, radius: float
) -> float:
    """Return the largest distance of a capsule's surface from the hull inside it.

    It is the largest difference of their extents over all directions, which is at the normals of
    the hull's faces or of its flat sides, or about halfway between; many are tried.
    """
    A, B, C = (points[hull.triangles[:, k]] for k in range(3))
    normals = np.cross(B - A, C - A)
    sizes = np.linalg.norm(normals, axis=1)
    normals = normals[sizes > 0] / sizes[sizes > 0, None]
    tried = np.vstack((directions(DIRECTIONS), normals))
    extents = np.maximum(tried @ start, tried @ end) + radius
    return float((extents - (tried @ points.T).max(axis=1)).max())


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
