"""The mesh files of shipped robots.

Only files that the robot's own URDF names and that are installed with the library; an upload has
none.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache
from pathlib import Path, PurePosixPath
from xml.etree import ElementTree as ET

from robots.errors import MeshNotFound
from robots.shipped import is_shipped, shipped_file, shipped_robot, urdf_path

MEDIA_TYPES = {".dae": "model/vnd.collada+xml", ".stl": "model/stl", ".obj": "model/obj"}
_PACKAGE = "package://"


@dataclass(frozen=True, slots=True)
class Mesh:
    """A mesh file.

    Attributes:
        filename: How the URDF names it.
        name: Its path below example-robot-data's ``robots`` folder.
        path: Where it lies.
        size: Bytes.
        media_type: Of the file.
    """

    filename: str
    name: str
    path: Path
    size: int
    media_type: str


@cache
def meshes_of(robot_id: str) -> dict[str, Mesh]:
    """Return the installed visual meshes of a shipped robot by name; empty for any other robot."""
    if not is_shipped(robot_id) or shipped_file(robot_id).urdf is None:
        return {}
    found = {}
    root = ET.fromstring(shipped_robot(robot_id).urdf)
    for element in root.iterfind("./link/visual/geometry/mesh"):
        mesh = _installed(element.get("filename", ""))
        if mesh is not None:
            found[mesh.name] = mesh
    return found


def mesh_of(robot_id: str, name: str) -> Mesh:
    """Return one mesh of a shipped robot.

    Raises:
        MeshNotFound: The robot has no such mesh.
    """
    meshes = meshes_of(robot_id)
    if name not in meshes:
        raise MeshNotFound(robot_id, name, tuple(meshes))
    return meshes[name]


@cache
def digest_of(mesh: Mesh) -> str:
    """Return the SHA-256 of a mesh file, hexadecimal."""
    return hashlib.sha256(mesh.path.read_bytes()).hexdigest()


def _installed(filename: str) -> Mesh | None:
    """Find ``package://example-robot-data/robots/x/meshes/link.dae`` as x/meshes/link.dae."""
    if not filename.startswith(_PACKAGE):
        return None
    parts = PurePosixPath(filename.removeprefix(_PACKAGE).lstrip("/")).parts
    if ".." in parts or parts[:2] != ("example-robot-data", "robots"):
        return None
    name = "/".join(parts[2:])
    path = urdf_path(name)
    media_type = MEDIA_TYPES.get(path.suffix.lower())
    if media_type is None or not path.is_file():
        return None
    return Mesh(filename, name, path, path.stat().st_size, media_type)
