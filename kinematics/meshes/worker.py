"""Meshes in a process of their own: archives are listed, meshes read, simplified and hulled."""

from __future__ import annotations

import hashlib
import importlib
import io
import logging
import os
import posixpath
import resource
import sys
import warnings
import zipfile
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING
from urllib.parse import unquote

from kinematics.meshes.tasks import ListTask, MeshTask, joined, parted

if TYPE_CHECKING:
    from kinematics.meshes.archive import Archive

UNWANTED = (
    "PIL",
    "httpx",
    "jsonschema",
    "networkx",
    "requests",
    "scipy.cluster",
    "scipy.integrate",
    "scipy.interpolate",
    "scipy.io",
    "scipy.ndimage",
    "scipy.signal",
    "scipy.sparse.csgraph",
    "scipy.stats",
    "shapely",
    "sympy",
)
"""What trimesh uses where it is there, and positions and triangles do not need: pictures, plane
figures, the network. Without it, a file is read alike in every installation."""
FIRST_DESCRIPTOR = 4
"""Beside standard input, output and errors a process has that of its answers."""
SAMPLES = {"stl": "a.stl", "stl_ascii": "a.stl", "obj": "a.obj", "ply": "a.ply", "glb": "a.glb"}
SAMPLES |= {"dae": "a.dae"}
"""Names of files that are read before the first task, by what writes them."""
SAMPLE_BYTES = 100_000


def prepare() -> Callable[[ListTask | MeshTask], Iterator[bytes]]:
    """Import what tasks need, and return what does them."""
    for name in UNWANTED:
        sys.modules[name] = None  # type: ignore[assignment]
    warnings.simplefilter("ignore")
    logging.disable(logging.CRITICAL)
    importlib.import_module("collada")
    _rehearse()
    os.nice(5)
    return _work


def _work(task: ListTask | MeshTask) -> Iterator[bytes]:
    # Nothing is opened from here on: no file, no address, whatever a mesh names.
    resource.setrlimit(resource.RLIMIT_NOFILE, (FIRST_DESCRIPTOR, FIRST_DESCRIPTOR))
    return _listed(task) if isinstance(task, ListTask) else _meshes(task)


def _rehearse() -> None:
    """Read a solid in every format, so that no module is left to be imported.

    Raises:
        RuntimeError: A library is missing, or does not read what it has written.
    """
    import trimesh

    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    solid = trimesh.Trimesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).subdivide()
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for kind, name in SAMPLES.items():
            written = solid.export(file_type=kind)
            archive.writestr(
                f"{kind}/{name}", written if isinstance(written, str) else bytes(written)
            )
    content, members = packed.getvalue(), tuple(f"{kind}/{name}" for kind, name in SAMPLES.items())
    tuple(_listed(ListTask(content, SAMPLE_BYTES)))
    for member, answer in zip(
        members, _meshes(MeshTask(content, members, "", SAMPLE_BYTES, 8)), strict=True
    ):
        head, _ = parted(answer)
        if "mesh" not in head:
            raise RuntimeError(f"{member}: {head}")


def _listed(task: ListTask) -> Iterator[bytes]:
    from dh_to_urdf.messages import as_data
    from kinematics.meshes.archive import Archive
    from kinematics.meshes.refusals import MeshRefused

    try:
        archive = Archive.of(task.archive)
        names = list(archive.names)
        urdfs = [name for name in names if name.lower().endswith(".urdf")] or [
            name
            for name in names
            if name.lower().endswith(".xml") and _is_robot(archive, name, task.most_text)
        ]
    except MeshRefused as refused:
        yield joined({"refused": as_data(refused.args[0])})
        return
    head = {"names": names, "urdfs": urdfs, "notes": [as_data(note) for note in archive.notes]}
    yield joined(head)


def _is_robot(archive: Archive, name: str, most: int) -> bool:
    info = archive.names[name]
    return info.file_size <= most and b"<robot" in archive.read(name, most)[:4096]


def _meshes(task: MeshTask) -> Iterator[bytes]:
    from kinematics.meshes.archive import Archive

    if not task.members:
        yield _answer(task, None, task.name, lambda: task.content)
        return
    archive = Archive.of(task.content)
    for member in task.members:
        yield _answer(task, archive, member, partial(archive.read, member, task.most))


def _answer(task: MeshTask, archive: Archive | None, name: str, read: Callable[[], bytes]) -> bytes:
    from dh_to_urdf.messages import as_data
    from kinematics.meshes.refusals import MeshRefused

    try:
        content = read()
        if name.lower().endswith((".urdf", ".xml")):
            return joined({}, content)
        return _prepared(
            content, name, task.shown, lambda other: _beside(archive, name, other, task)
        )
    except MeshRefused as refused:
        return joined({"refused": as_data(refused.args[0])})


def _beside(archive: Archive | None, name: str, other: str, task: MeshTask) -> bytes:
    """Return a file that a mesh names, from its archive."""
    from dh_to_urdf.messages import say
    from kinematics.meshes.refusals import MeshRefused, shown_name

    path = posixpath.normpath(posixpath.join(posixpath.dirname(name), unquote(other)))
    if archive is None or path not in archive.names:
        raise MeshRefused(
            say(
                "it needs the file {name!r}, which is not there: pack both in a zip with the URDF,"
                " or export a .glb",
                name=shown_name(other),
            )
        )
    return archive.read(path, task.most)


def _prepared(content: bytes, name: str, most: int, beside: Callable[[str], bytes]) -> bytes:
    import numpy as np

    from dh_to_urdf.messages import say
    from kinematics.meshes.glb import glb
    from kinematics.meshes.hulls import hull_of
    from kinematics.meshes.refusals import MeshRefused
    from kinematics.meshes.simplifying import cleaned, simplified, watertight
    from kinematics.meshes.surfaces import axis_note, external_files, format_of, surfaces_of
    from robots.uploaded_mesh import UploadedMesh, mesh_as_data

    kind = format_of(name, content)
    for other in external_files(kind, content):
        beside(other)
    surfaces = [cleaned(one) for one in surfaces_of(kind, content, beside)]
    surfaces = [one for one in surfaces if len(one.triangles)]
    notes = [axis_note(kind, content)]
    if not surfaces:
        raise MeshRefused(say("all its triangles are without area"))
    points = np.concatenate([one.vertices for one in surfaces])
    is_closed = watertight(surfaces)
    if not is_closed:
        notes.append(say("it is not watertight: it has edges with one triangle, or with over two"))
    shown = simplified(surfaces, most)
    file = glb(shown)
    hull = hull_of(points)
    lower, upper = points.min(axis=0), points.max(axis=0)
    mesh = UploadedMesh(
        name=name,
        format=kind,
        digest=hashlib.sha256(file).hexdigest(),
        size=len(file),
        vertices=len(points),
        triangles=sum(len(one.triangles) for one in surfaces),
        shown_triangles=sum(len(one.triangles) for one in shown),
        watertight=is_closed,
        lower=(float(lower[0]), float(lower[1]), float(lower[2])),
        upper=(float(upper[0]), float(upper[1]), float(upper[2])),
        hull=hull,
        warnings=tuple(note for note in notes if note is not None),
    )
    return joined({"mesh": mesh_as_data(mesh)}, file)
