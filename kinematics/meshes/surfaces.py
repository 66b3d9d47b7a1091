"""Mesh files -> triangles in the file's own axes and in metres, by trimesh; in the process only."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import trimesh
from trimesh.exchange.dae import load_collada
from trimesh.resolvers import Resolver

from dh_to_urdf.messages import say
from kinematics.meshes.glb import Surface
from kinematics.meshes.refusals import MeshRefused, shown_name
from kinematics.meshes.tasks import FORMATS

MAX_TRIANGLES = 2_000_000
MAX_COORDINATE = 1e6
"""Largest coordinate, in the units of the file."""
_POSITIONS = re.compile(
    rb"<input\b(?=[^>]*semantic\s*=\s*[\"']POSITION[\"'])[^>]*\bsource\s*=\s*(?:\"([^\"]*)\"|'([^']*)')"
)
_SOURCES = re.compile(
    rb"<source\b[^>]*\bid\s*=\s*[\"']([^\"']*)[\"'][^>]*>\s*<float_array\b[^>]*>([^<]*)"
)
_TEXT_STL = re.compile(rb"solid\b[^\n]*\n\s*facet\s+normal\b")
_NO_OBJ = re.compile(rb"\0|^\s*(?:solid|facet)\b", re.MULTILINE)
_VERTEX = re.compile(rb"^[ \t]*v[ \t]+[-+.\d]", re.MULTILINE)
_HEAD = 65_536
"""Bytes in which a text shows its format."""
_Color = tuple[float, float, float, float]


class Beside(Resolver):
    """Files beside a mesh, within its archive only.

    Args:
        read: Returns a file by its name as the mesh gives it.
    """

    def __init__(self, read: Callable[[str], bytes]) -> None:
        self._read = read

    def get(self, name: str) -> bytes:
        """Return a file."""
        return self._read(name)

    def write(self, name: str, data: bytes) -> None:
        """Write nothing."""
        raise NotImplementedError

    def namespaced(self, namespace: str) -> Resolver:  # noqa: ARG002
        """Return the same: names are those that the mesh gives."""
        return self

    def keys(self) -> list[str]:
        """Return nothing: a mesh names what it needs."""
        return []


def format_of(name: str, content: bytes) -> str:
    """Return the format of a mesh file: by its first bytes, where they say it, else by its name.

    Raises:
        MeshRefused: It is of no known format.
    """
    start = content[:512].lstrip(b"\xef\xbb\xbf \t\r\n")
    if content[:4] == b"glTF":
        return "glb"
    if content[:4] in (b"ply\n", b"ply\r"):
        return "ply"
    if start[:1] == b"{":
        return "gltf"
    if start[:1] == b"<" and (b"<COLLADA" in content[:4096]):
        return "dae"
    suffix = name.rpartition(".")[2].lower()
    if suffix == "obj" and (_is_binary_stl(content) or _TEXT_STL.match(start)):
        return "stl"
    if suffix == "stl" and not _is_binary_stl(content) and _is_obj(content):
        return "obj"
    if suffix in ("stl", "obj"):
        return suffix
    if suffix in FORMATS:
        raise MeshRefused(say("it is no {format} file, though its name says so", format=suffix))
    raise MeshRefused(
        say("its format is not known by the name; {formats} are read", formats=", ".join(FORMATS))
    )


def surfaces_of(kind: str, content: bytes, beside: Callable[[str], bytes]) -> list[Surface]:
    """Return the triangles of a mesh file, those of one colour together.

    Raises:
        MeshRefused: It holds no triangles, or something that is no number or no vertex.
    """
    if kind == "dae" and (b"<!DOCTYPE" in content or b"<!ENTITY" in content):
        raise MeshRefused(say("it declares a document type or entities; leave them out"))
    if kind == "obj" or (kind == "stl" and not _is_binary_stl(content)):
        content = _as_utf8(content)
    unit = _unit(content) if kind == "dae" else 1.0
    try:
        scene = _loaded(kind, content, Beside(beside))
        nodes = [scene.graph[node] for node in scene.graph.nodes_geometry]
    except (MemoryError, MeshRefused):
        raise
    # Libraries raise whatever their code comes to on a file that is broken.
    except Exception:
        raise MeshRefused(
            say("it cannot be read as {format}: the file is damaged or cut off", format=kind)
        ) from None
    parts = [
        (T, scene.geometry[name])
        for T, name in nodes
        if isinstance(scene.geometry[name], trimesh.Trimesh) and len(scene.geometry[name].faces)
    ]
    if not parts:
        raise MeshRefused(say("it holds no triangles; it is empty, damaged or cut off"))
    if kind == "ply":
        _check_counts(content, parts[0][1])
    count = sum(len(part.faces) for _, part in parts)
    if count > MAX_TRIANGLES:
        raise MeshRefused(
            say(
                "it has {count} triangles; at most {most} are read: simplify it",
                count=count,
                most=MAX_TRIANGLES,
            )
        )
    found: dict[_Color | None, list[tuple[Any, Any]]] = {}
    for T, part in parts:
        vertices, faces = _checked(np.asarray(T, dtype=float), part)
        found.setdefault(_color(part), []).append((vertices * unit, faces))
    return [_joined(pieces, color) for color, pieces in found.items()]


def axis_note(kind: str, content: bytes) -> str | None:
    """Return a warning where a file says that another axis than z is up."""
    axis = re.search(rb"<up_axis>\s*([XY])_UP\s*</up_axis>", content) if kind == "dae" else None
    if axis is None:
        return None
    return say(
        "the file says that {axis} is up; its axes are taken as they are, as RViz does",
        axis=axis[1].decode().lower(),
    )


def _loaded(kind: str, content: bytes, beside: Beside) -> trimesh.Scene:
    """Return the scene of a file, with all vertices that it has, also those that are no numbers."""
    if kind != "dae":
        return trimesh.load_scene(
            io.BytesIO(content), file_type=kind, resolver=beside, process=False
        )
    _check_positions(content)
    load: Any = load_collada
    loaded = load(io.BytesIO(content), resolver=beside)
    for part in loaded["geometry"].values():
        part["process"] = False
    return trimesh.load_scene(loaded)


def _check_positions(content: bytes) -> None:
    """Refuse positions of a COLLADA file that are no numbers: its library reads them as 0."""
    used = _POSITIONS.findall(content)
    sources = {one.lstrip(b"#") for pair in used for one in pair if one}
    for name, numbers in _SOURCES.findall(content):
        if name in sources and b"nan" in numbers.lower():
            raise MeshRefused(say("a vertex has a coordinate that is no finite number"))


def _check_counts(content: bytes, part: trimesh.Trimesh) -> None:
    """Refuse a PLY file that has less than its head says: it is cut off."""
    for element, found in (("vertex", len(part.vertices)), ("face", len(part.faces))):
        said = re.search(rb"^element %s (\d{1,20})\s*$" % element.encode(), content, re.MULTILINE)
        if said is not None and found < int(said[1]):
            raise MeshRefused(
                say(
                    "its head says that it has {said} of {element}, and {found} are there: it is"
                    " cut off",
                    said=int(said[1]),
                    element=element,
                    found=found,
                )
            )


def _is_obj(content: bytes) -> bool:
    head = content[:_HEAD]
    return _NO_OBJ.search(head) is None and _VERTEX.search(head) is not None


def _is_binary_stl(content: bytes) -> bool:
    return len(content) >= 84 and len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")


def _as_utf8(content: bytes) -> bytes:
    """Return a text in UTF-8; one that is not is taken for Latin-1, as only its names are not."""
    try:
        content.decode()
    except UnicodeDecodeError:
        return content.decode("latin-1").encode()
    return content


def _unit(content: bytes) -> float:
    """Return the unit of a COLLADA file, m."""
    found = re.search(rb"<unit\b[^>]*?\bmeter\s*=\s*[\"']([^\"']{0,40})", content)
    try:
        unit = float(found[1]) if found else 1.0
    except ValueError:
        unit = 0.0
    if not 1e-6 <= unit <= 1e6:
        raise MeshRefused(say('its <unit meter> is no length; write meter="1"'))
    return unit


def _checked(T: Any, part: trimesh.Trimesh) -> tuple[Any, Any]:
    """Return vertices and triangles of a part, placed."""
    vertices, faces = np.asarray(part.vertices, dtype=float), np.asarray(part.faces, dtype=np.int64)
    if T.shape != (4, 4) or not np.isfinite(T).all():
        raise MeshRefused(say("a placement in it has an entry that is no finite number"))
    if len(vertices) == 0 or faces.min() < 0 or faces.max() >= len(vertices):
        raise MeshRefused(
            say(
                "a triangle names vertex {index}, and there are {count}",
                index=int(faces.max()),
                count=len(vertices),
            )
        )
    with np.errstate(all="ignore"):
        vertices = vertices @ T[:3, :3].T + T[:3, 3]
    bad = np.flatnonzero(~(np.abs(vertices) <= MAX_COORDINATE).all(axis=1))
    if len(bad):
        raise MeshRefused(
            say(
                "vertex {index} has a coordinate that is no finite number or beyond {most:.0e}",
                index=int(bad[0]),
                most=MAX_COORDINATE,
            )
        )
    if np.linalg.det(T[:3, :3]) < 0:
        faces = faces[:, ::-1]
    return vertices, faces


def _joined(pieces: list[tuple[Any, Any]], color: _Color | None) -> Surface:
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in pieces[:-1])])
    vertices = np.concatenate([vertices for vertices, _ in pieces])
    faces = [faces + start for (_, faces), start in zip(pieces, starts, strict=True)]
    return Surface(vertices, np.concatenate(faces), color)


def _color(part: trimesh.Trimesh) -> _Color | None:
    """Return the one colour of a part, 0 to 1; None where its file gives none."""
    visual: Any = part.visual
    if not getattr(visual, "defined", False):
        return None
    source = visual.material if visual.kind == "texture" else visual
    found = np.asarray(getattr(source, "main_color", ()), dtype=float).ravel() / 255.0
    if len(found) not in (3, 4) or not np.isfinite(found).all():
        return None
    r, g, b = (float(x) for x in np.clip(found[:3], 0, 1))
    return r, g, b, float(np.clip(found[3], 0, 1)) if len(found) == 4 else 1.0


def external_files(kind: str, content: bytes) -> tuple[str, ...]:
    """Return the buffers that a glTF file names besides itself, in order."""
    if kind != "gltf":
        return ()
    try:
        tree = json.loads(content)
        uris = [one.get("uri") for one in tree.get("buffers", [])]
    except (ValueError, AttributeError, TypeError, RecursionError):
        raise MeshRefused(
            say("it cannot be read as {format}: the file is damaged or cut off", format=kind)
        ) from None
    named = (uri for uri in uris if isinstance(uri, str) and not uri.startswith("data:"))
    return tuple(map(shown_name, named))
