"""The shapes of a robot's links, from its canonical URDF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin
from lxml import etree

from robots.robot import FloatArray, Robot
from robots.uploaded_mesh import Hull, UploadedMesh, mesh_name

ShapeKind: TypeAlias = Literal["box", "cylinder", "sphere", "capsule", "mesh"]


@dataclass(frozen=True, eq=False)
class Shape:
    """One shape of a link.

    Attributes:
        link: Name of the link.
        kind: What it is; a cylinder and a capsule lie along z.
        size: Of a box its three edges; of a sphere the radius; of a cylinder and a capsule radius
            and length (of a capsule without its caps), m. Empty for a mesh.
        placement: In the link's axes, 4x4.
        hull: Of a mesh that was uploaded a convex solid about it, in the axes of ``placement``, m;
            None for any other.
    """

    link: str
    kind: ShapeKind
    size: tuple[float, ...]
    placement: FloatArray
    hull: Hull | None = None


@dataclass(frozen=True, slots=True)
class MeshUse:
    """How a URDF uses a mesh.

    Attributes:
        filename: How it names it.
        links: The links that it is a part of, in order.
    """

    filename: str
    links: tuple[str, ...]


def link_shapes(robot: Robot) -> tuple[Shape, ...]:
    """Return the collision shapes of each link; the visual ones of a link that has none.

    A D-H table has no shapes: its URDF shows drawn axes.
    """
    if robot.kind == "dh":
        return ()
    shapes = _SHAPES.get(robot)
    if shapes is None:
        shapes = _SHAPES[robot] = _read(robot)
    return shapes


_SHAPES: WeakKeyDictionary[Robot, tuple[Shape, ...]] = WeakKeyDictionary()


def mesh_users(robot: Robot) -> dict[str, MeshUse]:
    """Return how the URDF uses each mesh that it names, by name, in its order."""
    users: dict[str, tuple[str, dict[str, None]]] = {}
    if robot.kind == "urdf":
        root = etree.fromstring(robot.urdf.encode())
        for link in root.findall("link"):
            for mesh in link.iterfind("./*/geometry/mesh"):
                filename = mesh.get("filename", "")
                _, links = users.setdefault(mesh_name(filename), (filename, {}))
                links[link.get("name", "")] = None
    return {name: MeshUse(filename, tuple(links)) for name, (filename, links) in users.items()}


def scales_of(robot: Robot, name: str) -> tuple[tuple[float, float, float], ...]:
    """Return the scales with which the URDF uses a mesh."""
    root = etree.fromstring(robot.urdf.encode())
    found = [
        _scale(mesh)
        for mesh in root.iterfind("./link/*/geometry/mesh")
        if mesh_name(mesh.get("filename", "")) == name
    ]
    return tuple(dict.fromkeys(found))


def _scale(mesh: etree._Element) -> tuple[float, float, float]:
    x, y, z = (float(word) for word in mesh.get("scale", "1 1 1").split())
    return x, y, z


def _hull(meshes: dict[str, UploadedMesh], form: etree._Element) -> Hull | None:
    """Return the solid about an uploaded mesh, scaled as the URDF says."""
    mesh = meshes.get(mesh_name(form.get("filename", "")))
    if mesh is None:
        return None
    scale = np.array(_scale(form))
    triangles = mesh.hull.triangles if scale.prod() > 0 else mesh.hull.triangles[:, ::-1]
    excess = mesh.hull.excess * float(np.abs(scale).max())
    return Hull(mesh.hull.vertices * scale, triangles, excess)


def _read(robot: Robot) -> tuple[Shape, ...]:
    meshes = {one.name: one for one in robot.meshes}
    root = etree.fromstring(robot.urdf.encode())
    shapes: list[Shape] = []
    for link in root.findall("link"):
        for element in link.findall("collision") or link.findall("visual"):
            geometry = element.find("geometry")
            assert geometry is not None
            form = geometry[0]
            values = (
                [form.get("size")]
                if form.tag == "box"
                else [form.get("radius"), form.get("length")]
            )
            size = tuple(float(word) for value in values if value for word in value.split())
            kind, hull = _kind(str(form.tag)), _hull(meshes, form)
            shapes.append(Shape(link.get("name", ""), kind, size, _origin(element), hull))
    return tuple(shapes)


def _kind(tag: str) -> ShapeKind:
    assert tag in ("box", "cylinder", "sphere", "capsule", "mesh")
    return tag  # type: ignore[return-value]


def _origin(element: etree._Element) -> FloatArray:
    T = np.eye(4)
    origin = element.find("origin")
    if origin is not None:
        T[:3, 3] = [float(word) for word in origin.get("xyz", "0 0 0").split()]
        rpy = np.array([float(word) for word in origin.get("rpy", "0 0 0").split()])
        T[:3, :3] = pin.rpy.rpyToMatrix(rpy)
    return T
