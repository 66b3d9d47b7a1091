"""Links of a URDF: names, which count, and inertia, shapes and materials, which do not.

What draws or weighs never refuses a robot: a part with a fault is left out, and a warning names it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from lxml import etree

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import plural, say
from robots.errors import InvalidURDF
from robots.urdf.faults import Faults
from robots.urdf.limits import MAX_MATERIALS, MAX_SHAPES
from robots.urdf.markup import shown_tag
from robots.urdf.mesh_names import MeshNames, portable_name
from robots.urdf.notes import Notes
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
_LINK, _MATERIAL, _INERTIAL = say("a <link>"), say("a <material>"), say("<inertial>")
_ROUNDING = 1e-9
"""Negative moments of inertia down to this part, or kg m², count as rounding."""


@dataclass
class LinkReader:
    """Reads links one after the other, writing the canonical ones below ``robot``.

    Attributes:
        robot: The canonical root element.
        faults: Takes names that cannot be used.
        notes: Takes what is left out.
        quaternions: Whether the version of the document has ``quat_xyzw``.
        mesh_names: Names meshes.
        materials: Names of the materials that the document declares for all links.
        foreign_meshes: Meshes that were left out for their file names.
        odd_inertias: Links whose inertia no body has.
        shapes: Shapes that were written.
    """

    robot: Element
    faults: Faults
    notes: Notes
    quaternions: bool
    mesh_names: MeshNames = portable_name
    materials: set[str] = field(default_factory=set)
    foreign_meshes: list[str] = field(default_factory=list)
    odd_inertias: list[str] = field(default_factory=list)
    shapes: int = 0

    def read_materials(self, source: Element) -> None:
        """Read the materials beside the links; the first of a name counts."""
        for element in source.findall("material"):
            if len(self.materials) >= MAX_MATERIALS:
                self.notes.add(
                    say("materials beyond {count} are left out", count=MAX_MATERIALS),
                )
                return
            twin = etree.Element("material")
            try:
                name = name_of(element, _MATERIAL)
                twin.set("name", name)
                self._color(element, twin)
            except InvalidURDF as error:
                self.notes.add(
                    say("a <{tag}> is left out: {reason}", tag="material", reason=str(error))
                )
                continue
            if len(twin) and name not in self.materials:
                self.materials.add(name)
                self.robot.append(twin)

    def read(self, element: Element) -> str:
        """Read a link and return its name."""
        name = self.faults.read(element, element.get("name", ""), lambda: name_of(element, _LINK))
        where = say("link {name!r}", name=name)
        twin = etree.SubElement(self.robot, "link", name=name)
        inertials = element.findall("inertial")
        if len(inertials) > 1:
            self._extra("inertial", len(inertials), where)
        for inertial in inertials[:1]:
            self._keep(twin, inertial, where, lambda part: self._inertial(part, name))
        for kind in ("visual", "collision"):
            for shape in element.findall(kind):
                if self.shapes >= MAX_SHAPES:
                    self.notes.add(say("shapes beyond {count} are left out", count=MAX_SHAPES))
                    return name
                self._keep(twin, shape, where, lambda part: self._shape(part, name, where))
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

    def _keep(
        self, link: Element, part: Element, where: str, read: Callable[[Element], Element | None]
    ) -> None:
        """Write a part of a link; where something of it is wrong, leave it out."""
        try:
            twin = read(part)
        except InvalidURDF as error:
            self.notes.add(
                say("a <{tag}> is left out: {reason}", tag=shown_tag(part), reason=str(error)),
                where,
            )
            return
        if twin is not None:
            link.append(twin)

    def _extra(self, tag: str, count: int, where: str) -> None:
        self.notes.add(
            say("has {count} <{tag}>, of which the first is kept", count=count, tag=tag), where
        )

    def _inertial(self, element: Element, name: str) -> Element:
        mass, inertia = element.find("mass"), element.find("inertia")
        if mass is None or inertia is None:
            raise InvalidURDF(
                say("{where} is incomplete: it needs <mass> and <inertia>", where=_INERTIAL)
            )
        tags = [str(child.tag) for child in element]
        for tag in ("origin", "mass", "inertia"):
            if tags.count(tag) > 1:
                raise InvalidURDF(
                    say("{where} has two <{tag}>; keep one", where=_INERTIAL, tag=tag)
                )
        origin = origin_of(element, _INERTIAL, quaternions=self.quaternions)
        value = number(mass, "value", _INERTIAL)
        if value < 0:
            raise InvalidURDF(
                say(
                    "{where}: mass {value:g} is negative; give the mass in kg",
                    where=_INERTIAL,
                    value=value,
                )
            )
        moments = tuple(number(inertia, key, _INERTIAL) for key in _MOMENTS)
        xx, xy, xz, yy, yz, zz = moments
        if min(xx, yy, zz) < -_ROUNDING:
            raise InvalidURDF(
                say(
                    "{where}: a moment of inertia (ixx, iyy or izz) is negative; give it in kg m²",
                    where=_INERTIAL,
                )
            )
        principal = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if principal[0] < -_ROUNDING * max(principal[2], 1.0):
            self.odd_inertias.append(name)
        twin = etree.Element("inertial")
        write_origin(origin, twin)
        etree.SubElement(twin, "mass", value=repr(value))
        written = zip(_MOMENTS, map(repr, moments), strict=True)
        etree.SubElement(twin, "inertia", dict(written))
        return twin

    def _shape(self, element: Element, name: str, where: str) -> Element | None:
        tag = str(element.tag)
        inside = f"<{tag}>"
        form = self._form(element, where)
        origin = origin_of(element, inside, quaternions=self.quaternions)
        kind = str(form.tag)
        written = (
            self._mesh(form, inside, where) if kind == "mesh" else self._sizes(form, kind, inside)
        )
        if written is None:
            self.foreign_meshes.append(name)
            return None
        twin = etree.Element(tag)
        if element.get("name", "").strip():
            try:
                twin.set("name", checked_name(element.get("name", ""), inside))
            except InvalidURDF as error:
                self.notes.add(say("a name is left out: {reason}", reason=str(error)), where)
        write_origin(origin, twin)
        etree.SubElement(etree.SubElement(twin, "geometry"), kind, written)
        if tag == "visual":
            self._material(element, twin, where)
        self.shapes += 1
        return twin

    def _form(self, element: Element, where: str) -> Element:
        """Return the one shape of a <visual> or <collision> that URDF has."""
        for child in element:
            if child.tag not in ("origin", "geometry", "material", "verbose"):
                self._foreign(child, str(element.tag), where)
        forms = []
        for geometry in element.findall("geometry"):
            for child in geometry:
                if child.tag in (*_SIZES, "mesh"):
                    forms.append(child)
                else:
                    self._foreign(child, "geometry", where)
        if not forms:
            raise InvalidURDF(say("it has no geometry of URDF (box, cylinder, sphere, mesh)"))
        if len(forms) > 1:
            self._extra("geometry", len(forms), where)
        return forms[0]

    def _foreign(self, child: Element, parent: str, where: str) -> None:
        if child.tag != "contact_coefficients":
            self.notes.add(
                say(
                    "<{child}> in <{parent}> is no part of URDF and is left out",
                    child=shown_tag(child),
                    parent=parent,
                ),
                where,
            )

    def _mesh(self, form: Element, inside: str, where: str) -> dict[str, str] | None:
        """Return the attributes of a mesh; None where its file name is not to be handed on."""
        filename = form.get("filename")
        if filename is None:
            raise InvalidURDF(say("{where}: filename of <mesh> is missing; give it", where=inside))
        given = form.get("scale")
        if given is not None and len(given.split()) == 1:
            scale = numbers(form, "scale", 1, inside) * 3
            self.notes.add(say("a mesh has one scale, which is taken for x, y, z"), where)
        else:
            scale = numbers(form, "scale", 3, inside, "1 1 1")
        portable = self.mesh_names(filename)
        if portable is None:
            return None
        return {"filename": portable} | ({"scale": text_of(scale)} if given else {})

    def _sizes(self, form: Element, tag: str, inside: str) -> dict[str, str]:
        written = {}
        for key, count in _SIZES[tag].items():
            values = numbers(form, key, count, inside)
            if min(values) < 0:
                raise InvalidURDF(
                    say(
                        "{where}: {key} of <{tag}> is negative; give its size in m",
                        where=inside,
                        key=key,
                        tag=tag,
                    )
                )
            written[key] = text_of(values)
        return written

    def _material(self, element: Element, visual: Element, where: str) -> None:
        """Write the material of a visual that has a colour here or among the declared ones."""
        found = element.findall("material")
        if len(found) > 1:
            self.notes.add(
                say(
                    "a <{tag}> has {count} materials, of which the first is kept",
                    tag="visual",
                    count=len(found),
                ),
                where,
            )
        for material in found[:1]:
            if not material.get("name"):
                return
            try:
                name = checked_name(material.get("name", ""), _MATERIAL)
                twin = etree.Element("material", name=name)
                self._color(material, twin)
            except InvalidURDF as error:
                self.notes.add(
                    say("a <{tag}> is left out: {reason}", tag="material", reason=str(error)), where
                )
                return
            if len(twin) or name in self.materials:
                visual.append(twin)

    def _color(self, element: Element, material: Element) -> None:
        color = element.find("color")
        if color is not None:
            rgba = numbers(color, "rgba", 4, _MATERIAL, "1 1 1 1")
            etree.SubElement(material, "color", rgba=text_of(rgba))


def _some(names: list[str]) -> str:
    """Return the first few of the links, for a message."""
    unique = tuple(dict.fromkeys(names))
    more = say(" and {count} more", count=len(unique) - 3) if len(unique) > 3 else ""
    shown = ", ".join(quoted(name) for name in unique[:3])
    return plural(
        "link {names}{more}", "links {names}{more}", count=len(unique), names=shown, more=more
    )
