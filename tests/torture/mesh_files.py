"""Mesh files written by the tests themselves, and zips of a URDF with them."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from collections.abc import Mapping

import numpy as np

BOX = np.array([[x, y, z] for x in (0.0, 0.2) for y in (0.0, 0.3) for z in (0.0, 0.4)])
"""Corners of a box of 0.2 by 0.3 by 0.4 m."""
FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip


def stl(vertices=BOX, faces=FACES, count=None) -> bytes:
    """Binary STL; ``count`` is what its head says."""
    body = b"".join(
        struct.pack("<12fH", 0, 0, 0, *np.asarray(vertices)[list(face)].ravel(), 0)
        for face in faces
    )
    return b"binary".ljust(80) + struct.pack("<I", len(faces) if count is None else count) + body


def stl_text(vertices=BOX, faces=FACES) -> bytes:
    lines = ["solid box"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(map(repr, map(float, vertices[k]))) for k in face]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid box", ""]).encode()


def obj(vertices=BOX, faces=FACES, head="mtllib /etc/hostname\n") -> bytes:
    lines = ["v " + " ".join(map(repr, map(float, v))) for v in vertices]
    lines += ["f " + " ".join(str(int(k) + 1) for k in face) for face in faces]
    return (head + "\n".join(lines) + "\n").encode()


def ply(vertices=BOX, faces=FACES, counts=None) -> bytes:
    n, m = counts or (len(vertices), len(faces))
    head = (
        f"ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\n"
        f"property float z\nelement face {m}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = [" ".join(map(repr, map(float, v))) for v in vertices]
    rows += ["3 " + " ".join(str(int(k)) for k in face) for face in faces]
    return (head + "\n".join(rows) + "\n").encode()


def gltf(vertices=BOX, faces=FACES, uri=None, **changed) -> tuple[bytes, bytes]:
    """A glTF document and its buffer; ``uri`` names it, None for the one of a .glb."""
    positions, indices = vertices.astype("<f4").tobytes(), faces.astype("<u4").tobytes()
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [
            {"byteLength": len(positions + indices)} | ({} if uri is None else {"uri": uri})
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": faces.size, "type": "SCALAR"},
        ],
    } | changed
    return json.dumps(document).encode(), positions + indices


def glb(vertices=BOX, faces=FACES, **changed) -> bytes:
    text, binary = gltf(vertices, faces, **changed)
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(binary), 0x004E4942) + binary
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def dae(vertices=BOX, faces=FACES, unit="1", up="Z_UP", head="", nodes=1, count=None) -> bytes:
    values = " ".join(map(repr, map(float, np.asarray(vertices).ravel())))
    indices = " ".join(map(str, map(int, np.asarray(faces).ravel())))
    size = 3 * len(vertices) if count is None else count
    node = '<node><instance_geometry url="#g"/></node>'
    return (
        f'<?xml version="1.0"?>{head}<COLLADA version="1.4.1"'
        ' xmlns="http://www.collada.org/2005/11/COLLADASchema"><asset>'
        "<created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified>"
        f'<unit meter="{unit}" name="u"/><up_axis>{up}</up_axis></asset>'
        '<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a"'
        f' count="{size}">{values}</float_array><technique_common><accessor source="#a"'
        f' count="{size // 3}" stride="3"><param name="X" type="float"/><param name="Y"'
        ' type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
        '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>'
        f'<triangles count="{len(faces)}"><input semantic="VERTEX" source="#v" offset="0"/>'
        f"<p>{indices}</p></triangles></mesh></geometry></library_geometries>"
        f'<library_visual_scenes><visual_scene id="s">{node * nodes}</visual_scene>'
        '</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>'
    ).encode()


WRITERS = {
    "box.stl": stl,
    "text.stl": stl_text,
    "box.obj": obj,
    "box.ply": ply,
    "box.glb": glb,
    "box.dae": dae,
}
"""A right file of each format by name."""


def urdf(*filenames: str, scale: str = "", name: str = "meshy") -> str:
    """An arm of two links of 0.5 m; the meshes are parts of the second."""
    parts = "".join(
        f'<{kind}><geometry><mesh filename="{one}"{scale}/></geometry></{kind}>'
        for one in filenames
        for kind in ("visual", "collision")
    )
    return (
        f'<robot name="{name}"><link name="base"/><link name="arm">{parts}</link><link name="tip"/>'
        '<joint name="j1" type="revolute"><parent link="base"/><child link="arm"/>'
        '<origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>'
        '<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>'
        '<joint name="end" type="fixed"><parent link="arm"/><child link="tip"/>'
        '<origin xyz="0.5 0 0"/></joint></robot>'
    )


def zipped(files: Mapping[str, bytes | str]) -> bytes:
    """A zip with these files."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return packed.getvalue()
