"""Convex solids about meshes: the hull, or where that has many corners a simpler one about it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from kinematics.directions import directions
from robots.uploaded_mesh import Floats, Hull

MAX_CORNERS = 1000
"""Corners of a hull that is kept as it is."""
DIRECTIONS = 500
"""Faces of the solid that stands for a hull with more; it has some twice as many corners."""
STEPS = 20
"""Steps of the bound of how far such a solid reaches beyond the hull."""
_FLAT = 1e-9
"""Part of its length below which a mesh has no thickness."""


def hull_of(points: Floats) -> Hull:
    """Return a convex solid that contains points, shape (n, 3).

    Of a flat or straight mesh it is the polygon or segment, without triangles.
    """
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    size = float(np.ptp(points, axis=0).max())
    if size == 0.0:
        return Hull(points[:1].copy(), np.empty((0, 3), dtype=np.int64), 0.0)
    own = (points - center) / size
    axes, rank = _axes(own)
    if rank < 3:
        return Hull(_flat(own, axes, rank) * size + center, np.empty((0, 3), dtype=np.int64), 0.0)
    try:
        vertices, triangles = _solid(own)
    except QhullError:
        # Thinner than rounding: its box is a solid about it.
        vertices, triangles = _solid(_box(own))
    excess = 0.0
    if len(vertices) > MAX_CORNERS:
        vertices, triangles, excess = _simpler(vertices)
    return Hull(vertices * size + center, triangles, excess * size)


def _axes(points: Floats) -> tuple[Floats, int]:
    """Return the principal axes of points, as rows, and in how many of them they extend."""
    _, values, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    values = values / max(values[0], 1e-300)
    full = np.vstack((axes, np.zeros((3 - len(axes), 3))))
    return full, int((values > _FLAT).sum())


def _flat(points: Floats, axes: Floats, rank: int) -> Floats:
    """Return the corners of a flat set of points."""
    inside = points @ axes[:rank].T
    if rank == 1:
        return points[[int(inside[:, 0].argmin()), int(inside[:, 0].argmax())]]
    return points[ConvexHull(inside).vertices]


def _solid(points: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Return corners and outward triangles of the hull of points.

    Raises:
        QhullError: They are flat.
    """
    hull = ConvexHull(points)
    number = np.full(len(points), -1)
    number[hull.vertices] = np.arange(len(hull.vertices))
    vertices, triangles = points[hull.vertices], number[hull.simplices].astype(np.int64)
    A, B, C = (vertices[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(B - A, C - A), hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, ::-1]
    return vertices, triangles


def _box(points: Floats) -> Floats:
    lower, upper = points.min(axis=0), np.maximum(points.max(axis=0), points.min(axis=0) + 1e-9)
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T
    return np.asarray(lower + corners * (upper - lower))


def _simpler(vertices: Floats) -> tuple[Floats, NDArray[np.int64], float]:
    """Return a solid about a hull, cut by planes that touch it, and how far it reaches beyond."""
    normals = np.vstack((np.eye(3), -np.eye(3), directions(DIRECTIONS)))
    support = (normals @ vertices.T).max(axis=1)
    inside = vertices.mean(axis=0)
    cut = HalfspaceIntersection(np.column_stack((normals, -support)), inside)
    # Rounding of the cut must not leave the mesh outside.
    corners = inside + (cut.intersections - inside) * (1 + 1e-9)
    solid, triangles = _solid(corners)
    return solid, triangles, _beyond(solid, vertices)


def _beyond(corners: Floats, vertices: Floats) -> float:
    """Return a bound of the largest distance of corners from the convex hull of vertices.

    For each corner a point of the hull comes nearer by steps towards its vertex that lies farthest
    in the corner's direction (Frank and Wolfe 1956); each such point gives an upper bound.
    """
    x = vertices[(corners @ vertices.T).argmax(axis=1)]
    for _ in range(STEPS):
        d = vertices[((corners - x) @ vertices.T).argmax(axis=1)] - x
        along = np.einsum("ij,ij->i", corners - x, d) / np.maximum(
            np.einsum("ij,ij->i", d, d), 1e-300
        )
        x = x + np.clip(along, 0.0, 1.0)[:, None] * d
    return float(np.linalg.norm(corners - x, axis=1).max())
