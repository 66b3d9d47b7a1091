"""Triangles, cleaned and fewer, for drawing."""

from __future__ import annotations

from collections.abc import Sequence

import fast_simplification
import numpy as np
import trimesh

from kinematics.meshes.glb import Surface

MAX_COLORS = 32
"""Surfaces of a mesh; of one with more colours, the smaller ones take a common colour."""


def cleaned(surface: Surface) -> Surface:
    """Return a surface with equal vertices joined, and without triangles that have no area."""
    mesh = trimesh.Trimesh(surface.vertices, surface.triangles, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    A, B, C = (np.asarray(mesh.vertices)[np.asarray(mesh.faces)[:, k]] for k in range(3))
    mesh.update_faces(np.cross(B - A, C - A).any(axis=1))
    mesh.update_faces(mesh.unique_faces())
    mesh.remove_unreferenced_vertices()
    return Surface(
        np.array(mesh.vertices, dtype=float), np.array(mesh.faces, dtype=np.int64), surface.color
    )


def watertight(surfaces: Sequence[Surface]) -> bool:
    """Return whether the triangles of all surfaces together bound a solid."""
    starts = np.cumsum([0, *(len(one.vertices) for one in surfaces[:-1])])
    faces = [one.triangles + start for one, start in zip(surfaces, starts, strict=True)]
    whole = trimesh.Trimesh(
        np.concatenate([one.vertices for one in surfaces]), np.concatenate(faces), process=False
    )
    whole.merge_vertices()
    return bool(whole.is_watertight)


def simplified(surfaces: Sequence[Surface], most: int) -> list[Surface]:
    """Return surfaces with at most so many triangles together, or a few each where those are less.

    By quadric errors (Garland and Heckbert 1997); a surface that comes out empty stays as it was.
    """
    surfaces = _fewer_colors(surfaces)
    count = sum(len(one.triangles) for one in surfaces)
    if count <= most:
        return list(surfaces)
    found = []
    for one in surfaces:
        wanted = max(4, int(len(one.triangles) * most / count))
        if wanted >= len(one.triangles):
            found.append(one)
            continue
        scale = float(np.abs(one.vertices).max()) or 1.0
        points, faces = fast_simplification.simplify(
            np.ascontiguousarray(one.vertices / scale, dtype=np.float32),
            np.ascontiguousarray(one.triangles, dtype=np.int32),
            target_count=wanted,
        )
        good = len(faces) and bool(np.isfinite(points).all())
        found.append(
            Surface(points.astype(float) * scale, faces.astype(np.int64), one.color)
            if good
            else one
        )
    return found


def _fewer_colors(surfaces: Sequence[Surface]) -> Sequence[Surface]:
    if len(surfaces) <= MAX_COLORS:
        return surfaces
    ordered = sorted(surfaces, key=lambda one: len(one.triangles), reverse=True)
    rest = ordered[MAX_COLORS - 1 :]
    starts = np.cumsum([0, *(len(one.vertices) for one in rest[:-1])])
    faces = [one.triangles + start for one, start in zip(rest, starts, strict=True)]
    joined = Surface(
        np.concatenate([one.vertices for one in rest]), np.concatenate(faces), rest[0].color
    )
    return [*ordered[: MAX_COLORS - 1], joined]
