"""The shapes of a robot's links, from its canonical URDF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin
from lxml import etree

from robots.robot import FloatArray, Robot

ShapeKind: TypeAlias = Literal["box", "cylinder", "sphere", "capsule", "mesh"]


@dataclass(frozen=True, eq=False)
class Shape:
    """One shape of a link.

    Attributes:
        link: Name of the link.
        kind: What it is; a cylinder and a capsule lie along z.
        size: Of a box its three edges; of a sphere the radius; of a cylinder and a capsule radius
            and length (of a capsule without its caps), m. Empty for a mesh, which is not opened.
        placement: In the link's axes, 4x4.
    """

    link: str
    kind: ShapeKind
    size: tuple[float, ...]
    placement: FloatArray


def link_shapes(robot: Robot) -> tuple[Shape, ...]:
    """Return the collision shapes of each link; the visual ones of a link that has none.

    A D-H table has no shapes: its URDF shows drawn axes.
    """
    if robot.kind == "dh":
        return ()
    shapes = _SHAPES.get(robot)
    if shapes is None:
        shapes = _SHAPES[robot] = _read(robot.urdf)
    return shapes


_SHAPES: WeakKeyDictionary[Robot, tuple[Shape, ...]] = WeakKeyDictionary()


def _read(canonical: str) -> tuple[Shape, ...]:
    root = etree.fromstring(canonical.encode())
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
            shapes.append(Shape(link.get("name", ""), _kind(str(form.tag)), size, _origin(element)))
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
