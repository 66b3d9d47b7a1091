"""Meshes and zips with something wrong; case k of a seed is the same in every run."""

from __future__ import annotations

import io
import math
import stat
import struct
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from random import Random

import numpy as np

from tests.torture.mesh_files import (
    BOX,
    FACES,
    WRITERS,
    dae,
    glb,
    gltf,
    obj,
    ply,
    stl,
    stl_text,
    urdf,
    zipped,
)

CANARY = "outside/canary.stl"
"""A file beside, not in, each archive: below the folder of the campaign."""


@dataclass(frozen=True)
class Case:
    """An upload.

    Attributes:
        kind: The mutation, for figures.
        name: Of a mesh; empty for an archive.
        content: The body.
    """

    kind: str
    name: str
    content: bytes


def case(seed: int, number: int, outside: str) -> Case:
    """A mutated upload; ``outside`` is the absolute path of the canary."""
    rng = Random(f"meshes {seed} {number}")
    make = MUTATIONS[number % len(MUTATIONS)]
    return make(rng, outside)


def _mesh(rng: Random) -> tuple[str, bytes]:
    name = rng.choice(sorted(WRITERS))
    return name, WRITERS[name]()


def _cut(rng: Random, _: str) -> Case:
    name, content = _mesh(rng)
    return Case("cut off", name, content[: rng.randrange(len(content))])


def _flipped(rng: Random, _: str) -> Case:
    name, content = _mesh(rng)
    changed = bytearray(content)
    for _k in range(rng.choice((1, 3, 30))):
        changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return Case("bits flipped", name, bytes(changed))


def _spliced(rng: Random, _: str) -> Case:
    (name, one), (_name, other) = _mesh(rng), _mesh(rng)
    return Case(
        "spliced", name, one[: rng.randrange(len(one))] + other[rng.randrange(len(other)) :]
    )


def _not_finite(rng: Random, _: str) -> Case:
    vertices = BOX.copy()
    wrong = rng.choice((math.nan, math.inf, -math.inf, 1e300, 3e38))
    vertices[rng.randrange(8), rng.randrange(3)] = wrong
    writers = {
        "a.stl": stl,
        "b.stl": stl_text,
        "a.obj": obj,
        "a.ply": ply,
        "a.glb": glb,
        "a.dae": dae,
    }
    name = rng.choice(sorted(writers))
    with np.errstate(over="ignore"):
        try:
            content = writers[name](vertices)
        except OverflowError:
            content = writers["b.stl"](vertices)
            name = "b.stl"
    return Case("not finite", name, content)


def _bad_index(rng: Random, _: str) -> Case:
    faces = FACES.copy()
    faces[rng.randrange(12), rng.randrange(3)] = rng.choice((8, 1000, 2**31 - 1, -1, -(2**31)))
    if rng.random() < 0.3:
        return Case("index out of range", "a.glb", glb(faces=faces % 2**32))
    writers = {"a.obj": obj, "a.ply": ply, "a.dae": dae}
    name = rng.choice(sorted(writers))
    return Case("index out of range", name, writers[name](faces=faces))


def _huge_count(rng: Random, _: str) -> Case:
    huge = rng.choice((2**31 - 1, 2**32 - 1, 10**9, 2**62))
    which = rng.randrange(5)
    if which == 0:
        return Case("huge count", "a.stl", stl(count=huge % 2**32))
    if which == 1:
        return Case("huge count", "a.ply", ply(counts=(huge, rng.choice((12, huge)))))
    if which == 2:
        return Case("huge count", "a.dae", dae(count=huge))
    if which == 3:
        head = ply(counts=(huge % 2**31, 12)).replace(b"ascii", b"binary_little_endian")
        return Case("huge count", "a.ply", head)
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": huge, "type": "VEC3"},
        {"bufferView": 1, "componentType": 5125, "count": 36, "type": "SCALAR"},
    ]
    if rng.random() < 0.5:
        accessors[0].pop("bufferView")  # without one, zeros are meant
    return Case("huge count", "a.glb", glb(accessors=accessors))


def _many_instances(rng: Random, _: str) -> Case:
    count = rng.choice((1_000, 100_000, 400_000))
    if rng.random() < 0.5:
        return Case("many instances", "a.dae", dae(nodes=count))
    nodes = [{"mesh": 0}] * count
    return Case("many instances", "a.glb", glb(nodes=nodes, scenes=[{"nodes": list(range(count))}]))


def _cyclic(rng: Random, _: str) -> Case:
    nodes = [{"mesh": 0, "children": [1]}, {"mesh": 0, "children": [rng.choice((0, 1))]}]
    return Case("cyclic nodes", "a.glb", glb(nodes=nodes))


def _entities(rng: Random, outside: str) -> Case:
    bomb = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 12))
    heads = (
        f'<!DOCTYPE COLLADA [<!ENTITY x SYSTEM "file://{outside}">]>',
        f'<!DOCTYPE COLLADA [<!ENTITY e0 "x">{bomb}]>',
        f'<!DOCTYPE COLLADA SYSTEM "file://{outside}">',
    )
    return Case("entities", "a.dae", dae(head=rng.choice(heads)))


def _reference(rng: Random, outside: str) -> Case:
    uri = rng.choice(
        (outside, f"file://{outside}", "../" * 9 + outside, "http://127.0.0.1:9/b.bin")
    )
    if rng.random() < 0.5:
        return Case("foreign reference", "a.gltf", gltf(uri=uri)[0])
    return Case("foreign reference", "a.obj", obj(head=f"mtllib {uri}\nusemtl x\n"))


def _odd_text(rng: Random, _: str) -> Case:
    texts = (
        b"", b"{", b"[" * 100_000, b"{" + b'"a":[' * 50_000, b"solid\n" * 20_000, b"ply\n",
        b"glTF" + struct.pack("<III", 2, 2**32 - 1, 2**32 - 1), b"f 1 2 3\n" * 10_000,
        b"\0" * 5_000,
        b"v 1e999999 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", b"f -1 -2 -3\nv 0 0 0\n",
        b"<COLLADA>" + b"<a>" * 50_000,
        b'{"asset":{"version":"2.0"},"buffers":[{"byteLength":1e99}]}',
    )  # fmt: skip
    name = rng.choice(("a.stl", "a.obj", "a.ply", "a.gltf", "a.glb", "a.dae", "a.xyz", "a"))
    return Case("odd text", name, rng.choice(texts))


def _archive(rng: Random, _: str) -> Case:
    files = {"arm/arm.urdf": urdf(*(f"package://arm/{name}" for name in WRITERS))}
    files |= {f"arm/{name}": write() for name, write in WRITERS.items()}
    content = bytearray(zipped(files))
    how = rng.randrange(3)
    if how == 0:
        content = content[: rng.randrange(len(content))]
    elif how == 1:
        for _k in range(rng.choice((1, 5, 50))):
            content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    else:  # the lists at its end
        for _k in range(rng.choice((1, 5))):
            content[-rng.randrange(1, min(600, len(content)))] = rng.randrange(256)
    return Case("archive damaged", "", bytes(content))


def _path_trick(rng: Random, outside: str) -> Case:
    tricks = (
        "../",
        "../../../../",
        "/",
        "C:\\",
        "\\..\\",
        "./../",
        "a/../../",
        "..\\..\\",
        "//",
        "",
    )
    name = rng.choice(tricks) + outside.lstrip("/")
    named = rng.choice(
        (outside, f"file://{outside}", f"package://{outside}", name, "../" * 9 + outside)
    )
    files: dict[str, bytes | str] = {"arm/arm.urdf": urdf(named)}
    if rng.random() < 0.5:
        files[name] = stl(BOX * 2)
    return Case("path trick", "", zipped(files))


def _link(rng: Random, outside: str) -> Case:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("arm.urdf", urdf("meshes/a.stl"))
        entry = zipfile.ZipInfo(rng.choice(("meshes/a.stl", "meshes")))
        entry.create_system = 3
        kind = rng.choice((stat.S_IFLNK, stat.S_IFIFO, stat.S_IFCHR, stat.S_IFSOCK))
        entry.external_attr = (kind | 0o777) << 16
        archive.writestr(entry, outside)
    return Case("link or device", "", packed.getvalue())


def _bomb(rng: Random, _: str) -> Case:
    size = rng.choice((40_000_000, 400_000_000))
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("arm.urdf", urdf("a.stl") if rng.random() < 0.7 else b" " * 50_000_000)
        with archive.open(rng.choice(("a.stl", "other.stl")), "w", force_zip64=True) as stream:
            for _k in range(size // 4_000_000):
                stream.write(b"\0" * 4_000_000)
    content = packed.getvalue()
    if rng.random() < 0.5:  # it says that it is small
        content = content.replace(struct.pack("<I", size), struct.pack("<I", 700))
    return Case("bomb", "", content)


def _nested(rng: Random, _: str) -> Case:
    inner = zipped({"arm.urdf": urdf("a.stl"), "a.stl": stl()})
    for _k in range(rng.choice((1, 2, 50))):
        inner = zipped({"inner.zip": inner})
    files: dict[str, bytes | str] = {"inner.zip": inner}
    if rng.random() < 0.5:
        files |= {"arm.urdf": urdf("inner.zip/a.stl", "inner.zip")}
    return Case("nested", "", zipped(files))


def _many_entries(rng: Random, _: str) -> Case:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("arm.urdf", urdf("a.stl"))
        for k in range(rng.choice((2_000, 12_000))):
            archive.writestr(f"{'d/' * rng.randrange(3)}{k}.stl", b"")
    return Case("many entries", "", packed.getvalue())


def _odd_flags(rng: Random, _: str) -> Case:
    content = bytearray(zipped({"arm.urdf": urdf("a.stl"), "a.stl": stl()}))
    at = content.rindex(b"PK\x01\x02")
    if rng.random() < 0.5:
        content[at + 8] |= 1  # encrypted
    else:
        content[at + 10] = rng.choice((1, 6, 9, 12, 14, 93, 99))  # another method
    return Case("odd flags", "", bytes(content))


def _twice(rng: Random, _: str) -> Case:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("arm.urdf", urdf("a.stl"))
        archive.writestr("a.stl", stl())
        archive.writestr(rng.choice(("./a.stl", "b/../a.stl", "A.STL", "a.stl/")), stl(BOX * 2))
    return Case("two of a name", "", packed.getvalue())


def _several(rng: Random, _: str) -> Case:
    files = {
        f"{k}/{rng.choice('ab')}.urdf": urdf(name=f"r{k}") for k in range(rng.choice((0, 2, 9)))
    }
    return Case("several URDFs", "", zipped(files | {"readme": "x"}))


MUTATIONS: tuple[Callable[[Random, str], Case], ...] = (
    _cut,
    _flipped,
    _spliced,
    _not_finite,
    _bad_index,
    _huge_count,
    _many_instances,
    _cyclic,
    _entities,
    _reference,
    _odd_text,
    _archive,
    _archive,
    _path_trick,
    _link,
    _bomb,
    _nested,
    _many_entries,
    _odd_flags,
    _twice,
    _several,
)
