"""A URDF on the user's machine with the mesh files that it names, as a zip: for ``denavit push``.

Only files are taken whose endings are those of meshes, and the buffers of glTF files.
"""

from __future__ import annotations

import io
import json
import os
import re
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import unquote
from xml.etree import ElementTree as ET

MESHES = (".stl", ".obj", ".ply", ".gltf", ".glb", ".dae")
"""Endings of mesh files."""
_PACKAGE = re.compile(r"(?:package|model):/+([^/]+)/(.+)")
_DECLARED = re.compile(r"<name>\s*([^<\s]+)\s*</name>")


def bundled(path: Path, urdf: bytes, packages: Sequence[Path] = ()) -> bytes | None:
    """Return a zip of a URDF and its meshes; None where none of them is there.

    Args:
        path: Where the URDF, or the xacro file that it was made from, lies.
        urdf: Its text.
        packages: Folders in whose packages meshes are looked for, besides those around the URDF.
    """
    around = path.resolve().parent
    found: dict[Path, None] = {}
    for filename in _named(urdf):
        mesh = _on_disk(filename, around, packages)
        if mesh is not None and mesh.suffix.lower() in MESHES:
            found[mesh] = None
            found.update(dict.fromkeys(_buffers(mesh)))
    if not found:
        return None
    root = Path(os.path.commonpath([around, *(mesh.parent for mesh in found)]))
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        inside = (around / path.name).relative_to(root)
        archive.writestr(inside.with_name(f"{path.name.split('.')[0]}.urdf").as_posix(), urdf)
        for mesh in found:
            archive.write(mesh, mesh.relative_to(root).as_posix())
    return packed.getvalue()


def _named(urdf: bytes) -> Iterator[str]:
    """Yield the names of meshes in a URDF; of one that is no XML, which is refused later, none."""
    try:
        root = ET.fromstring(urdf)
    except ET.ParseError:
        return
    yield from dict.fromkeys(mesh.get("filename", "") for mesh in root.iter("mesh"))


def _on_disk(filename: str, around: Path, packages: Sequence[Path]) -> Path | None:
    package = _PACKAGE.fullmatch(filename)
    if package is None:
        path = Path(unquote(filename.removeprefix("file://")))
        candidates = [path if path.is_absolute() else around / path]
    else:
        name, inside = package.groups()
        candidates = [folder / inside for folder in _packages(name, around, packages)]
    return next((one.resolve() for one in candidates if one.is_file()), None)


def _packages(name: str, around: Path, packages: Sequence[Path]) -> Iterator[Path]:
    """Yield the folders that may be a package: around the URDF, beside its own, and those given."""
    for folder in (around, *around.parents):
        if folder.name == name or _declared(folder) == name:
            yield folder
        yield folder / name
    for folder in packages:
        yield folder / name
        if folder.name == name:
            yield folder


def _declared(folder: Path) -> str | None:
    manifest = folder / "package.xml"
    try:
        found = _DECLARED.search(manifest.read_text("utf-8", "replace"))
    except OSError:
        return None
    return found[1] if found else None


def _buffers(mesh: Path) -> Iterator[Path]:
    """Yield the files that a glTF file names beside it."""
    if mesh.suffix.lower() != ".gltf":
        return
    try:
        buffers = json.loads(mesh.read_bytes()).get("buffers", [])
    except (ValueError, AttributeError):
        return
    for one in buffers:
        uri = one.get("uri", "") if isinstance(one, dict) else ""
        beside = (mesh.parent / unquote(uri)).resolve()
        if uri.endswith(".bin") and beside.is_file():
            yield beside
