"""Links of a URDF: inertia, shapes and materials."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from lxml import etree

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import plural, say
from robots.errors import InvalidURDF, RobotTooLarge
from robots.urdf.limits import MAX_MATERIALS, MAX_SHAPES
from robots.urdf.mesh_names import portable_name
from robots.urdf.values import (
    Element,
    checked_name,
    name_of,
    number,
    numbers,
    origin_of,
    text_of,
    write_origin,
)

_SIZES = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "capsule": {"radius": 1, "length": 1},
}
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_ROUNDING = 1e-9
"""Negative moments of inertia down to this part, or kg m², count as rounding."""


@dataclass
class LinkReader:
    """Reads links one after the other, writing the canonical ones below ``robot``.

    Attributes:
        robot: The canonical root element.
        materials: Names of the materials that the document declares for all links.
        foreign_meshes: Meshes that were left out for their file names.
        odd_inertias: Links whose inertia no body has.
    """

    robot: Element
    materials: set[str] = field(default_factory=set)
    foreign_meshes: list[str] = field(default_factory=list)
    odd_inertias: list[str] = field(default_factory=list)

    def read_materials(self, source: Element) -> None:
        """Read the materials beside the links; the first of a name counts."""
        elements = source.findall("material")
        if len(elements) > MAX_MATERIALS:
            raise RobotTooLarge(
                say(
                    "the robot has {count} materials; at most {max_materials} are read",
                    count=len(elements),
                    max_materials=MAX_MATERIALS,
                )
            )
        for element in elements:
            name = name_of(element, say("a <material>"))
            where = say("material {name!r}", name=name)
            if element.find("color") is not None and name not in self.materials:
                self.materials.add(name)
                twin = etree.SubElement(self.robot, "material", name=name)
                self._color(element, twin, where)

    def read(self, element: Element) -> str:
        """Read a link and return its name."""
        name = name_of(element, say("a <link>"))
        where = say("link {name!r}", name=name)
        twin = etree.SubElement(self.robot, "link", name=name)
        inertial = element.find("inertial")
        if inertial is not None:
            self._inertial(inertial, twin, name, where)
        for kind in ("visual", "collision"):
            for shape in element.findall(kind):
                self._shape(shape, twin, kind, name, where)
        return name

    def warnings(self) -> tuple[str, ...]:
        """Return what was left out or is odd."""
        found = []
        if self.foreign_meshes:
            found.append(
                say(
                    "meshes of {foreign_meshes} are left out; a mesh is kept whose name is"
                    " package://… or a path below the URDF's own",
                    foreign_meshes=_some(self.foreign_meshes),
                )
            )
        if self.odd_inertias:
            found.append(
                say(
                    "the inertia of {odd_inertias} is not positive semi-definite, so no"
                    " body has it; kinematics does not use it",
                    odd_inertias=_some(self.odd_inertias),
                )
            )
        return tuple(found)

    def _inertial(self, element: Element, link: Element, name: str, where: str) -> None:
        mass, inertia = element.find("mass"), element.find("inertia")
        if mass is None or inertia is None:
            raise InvalidURDF(
                say(
                    "{where}: <inertial> needs <mass> and <inertia>; add or remove them",
                    where=where,
                )
            )
        origin = origin_of(element, where)
        value = number(mass, "value", where)
        if value < 0:
            raise InvalidURDF(
                say(
                    "{where}: mass {value:g} is negative; give the mass in kg",
                    where=where,
                    value=value,
                )
            )
        moments = tuple(number(inertia, key, where) for key in _MOMENTS)
        xx, xy, xz, yy, yz, zz = moments
        if min(xx, yy, zz) < -_ROUNDING:
            raise InvalidURDF(
                say(
                    "{where}: a moment of inertia (ixx, iyy or izz) is negative; give it in kg m²",
                    where=where,
                )
            )
        principal = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if principal[0] < -_ROUNDING * max(principal[2], 1.0):
            self.odd_inertias.append(name)
        twin = etree.SubElement(link, "inertial")
        write_origin(origin, twin)
        etree.SubElement(twin, "mass", value=repr(value))
        written = zip(_MOMENTS, map(repr, moments), strict=True)
        etree.SubElement(twin, "inertia", dict(written))

    def _shape(self, element: Element, link: Element, kind: str, name: str, where: str) -> None:
        geometry = element.find("geometry")
        forms = [] if geometry is None else [f for f in geometry if f.tag in (*_SIZES, "mesh")]
        if not forms:
            raise InvalidURDF(
                say(
                    "{where}: a <{kind}> has no geometry; add it or remove the <{kind}>",
                    where=where,
                    kind=kind,
                )
            )
        if len(forms) > 1:
            raise InvalidURDF(
                say(
                    "{where}: a <{kind}> has two geometries; write two <{kind}>",
                    where=where,
                    kind=kind,
                )
            )
        form = forms[0]
        tag = str(form.tag)
        origin = origin_of(element, where)
        written = self._mesh(form, where) if tag == "mesh" else self._sizes(form, tag, where)
        if written is None:
            self.foreign_meshes.append(name)
            return
        twin = etree.SubElement(link, kind)
        if element.get("name", "").strip():
            twin.set(
                "name",
                checked_name(
                    element.get("name", ""), say("{where}: a <{kind}>", where=where, kind=kind)
                ),
            )
        write_origin(origin, twin)
        etree.SubElement(etree.SubElement(twin, "geometry"), tag, written)
        material = element.find("material")
        if kind == "visual" and material is not None and material.get("name"):
            self._material(material, twin, where)

    def _mesh(self, form: Element, where: str) -> dict[str, str] | None:
        """Return the attributes of a mesh; None where its file name is not to be handed on."""
        filename = form.get("filename")
        if filename is None:
            raise InvalidURDF(say("{where}: filename of <mesh> is missing; give it", where=where))
        scale = numbers(form, "scale", 3, where, "1 1 1")
        portable = portable_name(filename)
        if portable is None:
            return None
        return {"filename": portable} | ({"scale": text_of(scale)} if form.get("scale") else {})

    def _sizes(self, form: Element, tag: str, where: str) -> dict[str, str]:
        written = {}
        for key, count in _SIZES[tag].items():
            values = numbers(form, key, count, where)
            if min(values) < 0:
                raise InvalidURDF(
                    say(
                        "{where}: {key} of <{tag}> is negative; give its size in m",
                        where=where,
                        key=key,
                        tag=tag,
                    )
                )
            written[key] = text_of(values)
        return written

    def _material(self, element: Element, visual: Element, where: str) -> None:
        """Return a material that has a colour here or among the declared ones."""
        name = checked_name(element.get("name", ""), say("{where}: a <material>", where=where))
        if element.find("color") is not None:
            self._color(element, etree.SubElement(visual, "material", name=name), where)
        elif name in self.materials:
            etree.SubElement(visual, "material", name=name)

    def _color(self, element: Element, material: Element, where: str) -> None:
        color = element.find("color")
        if color is not None:
            rgba = numbers(color, "rgba", 4, where, "1 1 1 1")
            etree.SubElement(material, "color", rgba=text_of(rgba))


def check_shapes(links: list[Element]) -> None:
    """Refuse more shapes than are handed on, before any is read.

    Raises:
        RobotTooLarge: Too many.
    """
    shapes = sum(child.tag in ("visual", "collision") for link in links for child in link)
    if shapes > MAX_SHAPES:
        raise RobotTooLarge(
            say(
                "the robot has {shapes} visual and collision shapes; at most {max_shapes} are read",
                shapes=shapes,
                max_shapes=MAX_SHAPES,
            )
        )


def _some(names: list[str]) -> str:
    """Return the first few of the links, for a message."""
    unique = tuple(dict.fromkeys(names))
    more = say(" and {count} more", count=len(unique) - 3) if len(unique) > 3 else ""
    shown = ", ".join(quoted(name) for name in unique[:3])
    return plural(
        "link {names}{more}", "links {names}{more}", count=len(unique), names=shown, more=more
    )
