"""Meshes that people upload with their robots: what is known of each, and its convex hull."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import as_data, from_data

MEDIA_TYPE: Final = "model/gltf-binary"
"""Of every mesh that is kept, whatever it was read from."""
_PACKAGE: Final = "package://"

Floats: TypeAlias = NDArray[np.float64]
Triple: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Hull:
    """A convex solid that contains a mesh.

    Attributes:
        vertices: Its corners in the mesh's axes, m before the URDF's scale; shape (n, 3).
        triangles: Its surface, outward; numbers of vertices, shape (m, 3). Empty for a flat mesh.
        excess: Bound of how far it reaches beyond the convex hull, in the mesh's units; 0 where it
            is the hull.
    """

    vertices: Floats
    triangles: NDArray[np.int64]
    excess: float


@dataclass(frozen=True, eq=False)
class UploadedMesh:
    """A mesh that was read, checked and written anew.

    Attributes:
        name: How the URDF names it, without ``package://``.
        format: What it was read from: stl, obj, ply, gltf, glb or dae.
        digest: SHA-256 of the file that is kept, hexadecimal.
        size: Its bytes.
        vertices: Vertices of what was uploaded, equal ones counted once.
        triangles: Its triangles.
        shown_triangles: Triangles that are kept.
        watertight: Whether every edge has two triangles, so that it bounds a solid.
        lower: Least coordinates, in the mesh's axes and units.
        upper: Greatest ones.
        hull: A convex solid about it.
        warnings: What is doubtful or was left out.
    """

    name: str
    format: str
    digest: str
    size: int
    vertices: int
    triangles: int
    shown_triangles: int
    watertight: bool
    lower: Triple
    upper: Triple
    hull: Hull
    warnings: tuple[str, ...] = ()

    def named(self, name: str) -> UploadedMesh:
        """Return the same mesh under another name."""
        return replace(self, name=name)


def mesh_name(filename: str) -> str:
    """Return the name of a mesh from its file name in a URDF: without ``package://``."""
    return filename.removeprefix(_PACKAGE)


def mesh_as_data(mesh: UploadedMesh) -> dict[str, Any]:
    """Return what is known of a mesh as plain data that JSON holds; see :func:`mesh_from_data`."""
    plain = {
        key: getattr(mesh, key)
        for key in UploadedMesh.__dataclass_fields__
        if key not in ("hull", "warnings")
    }
    hull = {
        "vertices": _packed(mesh.hull.vertices, "<f8"),
        "triangles": _packed(mesh.hull.triangles, "<u4"),
        "excess": mesh.hull.excess,
    }
    return plain | {"hull": hull, "warnings": [as_data(one) for one in mesh.warnings]}


def mesh_from_data(data: Mapping[str, Any]) -> UploadedMesh:
    """Return what :func:`mesh_as_data` has written.

    Raises:
        LookupError: It is not of this form.
        TypeError: It is not of this form.
        ValueError: It is not of this form.
    """
    hull = data["hull"]
    lower, upper = (tuple(float(x) for x in data[key]) for key in ("lower", "upper"))
    if len(lower) != 3 or len(upper) != 3:
        raise ValueError(f"bounds: {lower}, {upper}")
    vertices = _unpacked(hull["vertices"], "<f8").astype(np.float64)
    triangles = _unpacked(hull["triangles"], "<u4").astype(np.int64)
    if not np.isfinite(vertices).all() or (triangles.size and triangles.max() >= len(vertices)):
        raise ValueError(f"hull: {len(vertices)}")
    return UploadedMesh(
        name=str(data["name"]),
        format=str(data["format"]),
        digest=str(data["digest"]),
        size=int(data["size"]),
        vertices=int(data["vertices"]),
        triangles=int(data["triangles"]),
        shown_triangles=int(data["shown_triangles"]),
        watertight=bool(data["watertight"]),
        lower=lower,
        upper=upper,
        hull=Hull(vertices, triangles, float(hull["excess"])),
        warnings=tuple(from_data(one) for one in data["warnings"]),
    )


def _packed(array: NDArray[Any], kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype=kind).tobytes()).decode()


def _unpacked(text: str, kind: str) -> NDArray[Any]:
    return np.frombuffer(base64.b64decode(text, validate=True), dtype=kind).reshape(-1, 3)
