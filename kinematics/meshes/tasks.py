"""What the process that reads meshes is asked, and what it answers."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

FORMATS = ("stl", "obj", "ply", "gltf", "glb", "dae")
"""What is read."""


@dataclass(frozen=True)
class ListTask:
    """List an archive, with the texts of its URDFs.

    Attributes:
        archive: The zip.
        most_text: Largest URDF that is unpacked, bytes.
    """

    archive: bytes
    most_text: int


@dataclass(frozen=True)
class MeshTask:
    """Read meshes, one after the other: an answer for each, in this order.

    Attributes:
        content: A mesh file; or an archive, where ``members`` are given.
        members: Names in the archive; empty for a mesh file.
        name: Name of the mesh file.
        most: Largest file that is unpacked, bytes.
        shown: Most triangles that are written.
    """

    content: bytes
    members: tuple[str, ...]
    name: str
    most: int
    shown: int


def joined(head: Mapping[str, Any], content: bytes = b"") -> bytes:
    """Return an answer: the length of its head, the head as JSON, and bytes."""
    text = json.dumps(head).encode()
    return struct.pack("<I", len(text)) + text + content


def parted(answer: bytes) -> tuple[dict[str, Any], bytes]:
    """Return head and bytes of an answer."""
    (length,) = struct.unpack_from("<I", answer)
    head: dict[str, Any] = json.loads(answer[4 : 4 + length])
    return head, answer[4 + length :]
