"""Triangles -> glTF 2.0 in its binary form: positions, indices and one colour a part."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robots.uploaded_mesh import Floats

_FLOAT, _UINT16, _UINT32 = 5126, 5123, 5125
_POSITIONS, _INDICES = 34962, 34963
_MAGIC, _JSON, _BINARY = 0x46546C67, 0x4E4F534A, 0x004E4942


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles of one colour.

    Attributes:
        vertices: Shape (n, 3).
        triangles: Numbers of vertices, shape (m, 3).
        color: Red, green, blue and opacity, 0 to 1; None where the file gives none.
    """

    vertices: Floats
    triangles: NDArray[np.int64]
    color: tuple[float, float, float, float] | None


def glb(surfaces: Sequence[Surface]) -> bytes:
    """Write surfaces as one mesh, a primitive each; coordinates as they are, float32."""
    chunks: list[bytes] = []
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []
    materials: list[dict[str, Any]] = []
    primitives: list[dict[str, Any]] = []

    def stored(array: NDArray[Any], target: int, accessor: dict[str, Any]) -> int:
        content = array.tobytes()
        offset = sum(map(len, chunks))
        chunks.append(content + b"\0" * (-len(content) % 4))
        views.append(
            {"buffer": 0, "byteOffset": offset, "byteLength": len(content), "target": target}
        )
        accessors.append({"bufferView": len(views) - 1, **accessor})
        return len(accessors) - 1

    for surface in surfaces:
        positions = surface.vertices.astype("<f4")
        small = len(positions) < 65_535
        indices = surface.triangles.astype("<u2" if small else "<u4").ravel()
        bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
        of_positions = {"componentType": _FLOAT, "count": len(positions), "type": "VEC3", **bounds}
        kind = _UINT16 if small else _UINT32
        of_indices = {"componentType": kind, "count": len(indices), "type": "SCALAR"}
        primitive: dict[str, Any] = {
            "attributes": {"POSITION": stored(positions, _POSITIONS, of_positions)},
            "indices": stored(indices, _INDICES, of_indices),
        }
        if surface.color is not None:
            primitive["material"] = len(materials)
            materials.append(_material(surface.color))
        primitives.append(primitive)
    binary = b"".join(chunks)
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "denavit"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": primitives}],
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    if materials:
        document["materials"] = materials
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(binary)
    return b"".join(
        (
            struct.pack("<III", _MAGIC, 2, size),
            struct.pack("<II", len(text), _JSON),
            text,
            struct.pack("<II", len(binary), _BINARY),
            binary,
        )
    )


def _material(color: tuple[float, float, float, float]) -> dict[str, Any]:
    material: dict[str, Any] = {
        "pbrMetallicRoughness": {
            "baseColorFactor": [*(_linear(part) for part in color[:3]), color[3]],
            "metallicFactor": 0,
        },
        "doubleSided": True,
    }
    return material | ({"alphaMode": "BLEND"} if color[3] < 1 else {})


def _linear(part: float) -> float:
    """Return an sRGB component as glTF has it, linear."""
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4
