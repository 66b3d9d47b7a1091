"""The gate for URDF: a text from anyone -> a checked description and a canonical URDF.

urdfdom and Pinocchio accept much that lies (a zero axis, missing limits, two parents) and refuse
the rest with one and the same message. Everything is therefore checked here first, and only the
canonical text that this module writes ever reaches Pinocchio. Mesh files are never opened.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from lxml import etree

from dh_to_urdf.writer import UNBOUNDED
from robots.errors import InvalidURDF, RobotTooLarge

MAX_BYTES = 2_000_000
MAX_DOF = 64
MAX_LINKS = 300
MAX_SHAPES = 1000
MAX_MAGNITUDE = 1e6

MOVING_TYPES = ("revolute", "prismatic", "continuous")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")
_SHAPES = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
    "capsule": ("radius", "length"),
}
_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True, slots=True)
class URDFJoint:
    """A joint as the file gives it, with a unit axis.

    Attributes:
        name: Its name.
        type: revolute, prismatic, continuous or fixed.
        parent: Parent link.
        child: Child link.
        lower: Smallest value, rad or m; None for continuous and fixed joints.
        upper: Largest value.
        velocity: Largest speed, rad/s or m/s, if the file gives one.
        effort: Largest torque or force, if the file gives one.
    """

    name: str
    type: str
    parent: str
    child: str
    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None


@dataclass(frozen=True)
class URDFDescription:
    """A checked URDF.

    Attributes:
        name: Name of the robot.
        links: Link names in the order of the file.
        joints: Joints in the order of the file.
        root: The link without a parent.
        canonical: URDF text with nothing but what was checked.
        warnings: What was left out or assumed.
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[URDFJoint, ...]
    root: str
    canonical: str
    warnings: tuple[str, ...]

    @property
    def moving(self) -> tuple[URDFJoint, ...]:
        """The joints that are in q, in the order of the file."""
        return tuple(joint for joint in self.joints if joint.type != "fixed")

    def chain(self, leaf: str) -> tuple[str, ...]:
        """Links from the root to a link, both included."""
        parents = {joint.child: joint.parent for joint in self.joints}
        chain = [leaf]
        while chain[-1] in parents:
            chain.append(parents[chain[-1]])
        return tuple(reversed(chain))

    def default_tip(self) -> str:
        """The leaf of the longest chain, counted in moving joints, then in links.

        Of several, the one whose link stands first in the file.
        """
        by_child = {joint.child: joint for joint in self.joints}
        parents = {joint.parent for joint in self.joints}

        def length(leaf: str) -> tuple[int, int]:
            chain = self.chain(leaf)
            moving = sum(by_child[link].type != "fixed" for link in chain[1:])
            return moving, len(chain)

        return max((link for link in self.links if link not in parents), key=length)


def read_urdf(text: str | bytes) -> URDFDescription:
    """Checks a URDF and writes its canonical form.

    Args:
        text: The XML text; at most ``MAX_BYTES`` bytes.

    Returns:
        The description.

    Raises:
        InvalidURDF: Not XML, not one tree, not finite, an unsupported joint type, …
        RobotTooLarge: More links, joints or shapes than the service computes with.
    """
    return _Reader(_parse(text)).read()


def _parse(text: str | bytes) -> etree._Element:
    try:
        raw = text.encode() if isinstance(text, str) else text
    except UnicodeEncodeError:
        raise InvalidURDF("the text holds characters that are no Unicode text") from None
    if len(raw) > MAX_BYTES:
        raise RobotTooLarge(f"the URDF has {len(raw)} bytes; at most {MAX_BYTES} are read")
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        dtd_validation=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    if b"<!DOCTYPE" in raw[:MAX_BYTES] or b"<!ENTITY" in raw:
        raise InvalidURDF("the URDF has a DOCTYPE or entities; remove them")
    if isinstance(text, str):
        raw = re.sub(rb"^\s*<\?xml[^>]*\?>", b"", raw)
    try:
        root = etree.fromstring(raw.strip(), parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        reason = _CONTROL.sub(" ", str(error))[:160]
        raise InvalidURDF(f"the text is not well-formed XML: {reason}") from None
    if root.getroottree().docinfo.doctype:  # type: ignore[union-attr]
        raise InvalidURDF("the URDF has a DOCTYPE; remove it")
    return root


class _Reader:
    """Checks one document and builds its canonical twin on the way."""

    def __init__(self, root: etree._Element) -> None:
        self.source = root
        self.robot = etree.Element("robot")
        self.warnings: list[str] = []
        self.shapes = 0

    def read(self) -> URDFDescription:
        if self.source.tag != "robot":
            shown = str(self.source.tag)[:40]
            raise InvalidURDF(f"the root element is <{shown}>; a URDF starts with <robot name=…>")
        name = self._name(self.source, "the root element")
        self.robot.set("name", name)
        link_elements = list(self.source.findall("link"))
        joint_elements = list(self.source.findall("joint"))
        if len(link_elements) > MAX_LINKS:
            raise RobotTooLarge(
                f"the robot has {len(link_elements)} links; at most {MAX_LINKS} are computed"
            )
        moving = sum(element.get("type") in MOVING_TYPES for element in joint_elements)
        if moving > MAX_DOF:
            raise RobotTooLarge(f"the robot has {moving} joints; at most {MAX_DOF} are computed")
        self._materials()
        links = tuple(self._link(element) for element in link_elements)
        _refuse_twice("link", links)
        if not links:
            raise InvalidURDF("the robot has no <link>")
        joints = tuple(self._joint(element, links) for element in joint_elements)
        _refuse_twice("joint", tuple(joint.name for joint in joints))
        root = _check_tree(links, joints)
        if not any(joint.type != "fixed" for joint in joints):
            raise InvalidURDF("the robot has no joint that moves")
        etree.indent(self.robot, "  ")
        canonical = etree.tostring(self.robot, encoding="unicode")
        return URDFDescription(
            name, links, joints, root, f'<?xml version="1.0"?>\n{canonical}\n', tuple(self.warnings)
        )

    def _name(self, element: etree._Element, where: str) -> str:
        name = element.get("name")
        if name is None or not name.strip():
            raise InvalidURDF(f"{where} has no name attribute; give it one")
        if len(name) > 128 or _CONTROL.search(name):
            raise InvalidURDF(f"{where} has a name with control characters or over 128 characters")
        return name

    def _materials(self) -> None:
        seen: set[str] = set()
        for material in self.source.findall("material"):
            color, name = material.find("color"), material.get("name", "")
            if name and color is not None and name not in seen:
                seen.add(name)
                twin = etree.SubElement(self.robot, "material", name=material.get("name", ""))
                rgba = _floats(color, "rgba", 4, "material", "1 1 1 1")
                etree.SubElement(twin, "color", rgba=_text(rgba))

    def _link(self, element: etree._Element) -> str:
        name = self._name(element, "a <link>")
        where = f"link {name!r}"
        twin = etree.SubElement(self.robot, "link", name=name)
        inertial = element.find("inertial")
        if inertial is not None:
            self._inertial(inertial, twin, where)
        for kind in ("visual", "collision"):
            for shape in element.findall(kind):
                self._shape(shape, twin, kind, where)
        return name

    def _inertial(self, element: etree._Element, link: etree._Element, where: str) -> None:
        mass, inertia = element.find("mass"), element.find("inertia")
        if mass is None or inertia is None:
            raise InvalidURDF(f"{where}: <inertial> needs <mass> and <inertia>; add or remove them")
        twin = etree.SubElement(link, "inertial")
        self._origin(element, twin, where)
        value = _float(mass, "value", where)
        if value < 0:
            raise InvalidURDF(f"{where}: mass {value:g} is negative")
        etree.SubElement(twin, "mass", value=repr(value))
        moments = {key: _float(inertia, key, where, 0.0) for key in _INERTIA}
        etree.SubElement(twin, "inertia", {key: repr(value) for key, value in moments.items()})

    def _shape(self, element: etree._Element, link: etree._Element, kind: str, where: str) -> None:
        self.shapes += 1
        if self.shapes > MAX_SHAPES:
            raise RobotTooLarge(f"the robot has over {MAX_SHAPES} visual and collision shapes")
        geometry = element.find("geometry")
        if geometry is None or len(geometry) == 0:
            raise InvalidURDF(f"{where}: a <{kind}> has no geometry")
        form = geometry[0]
        twin = etree.SubElement(link, kind)
        if element.get("name") and not _CONTROL.search(element.get("name", "")):
            twin.set("name", element.get("name", "")[:128])
        self._origin(element, twin, where)
        target = etree.SubElement(etree.SubElement(twin, "geometry"), str(form.tag))
        if form.tag == "mesh":
            target.set("filename", form.get("filename", "")[:512])
            if form.get("scale"):
                target.set("scale", _text(_floats(form, "scale", 3, where)))
        elif form.tag in _SHAPES:
            for key in _SHAPES[str(form.tag)]:
                values = _floats(form, key, 3 if key == "size" else 1, where)
                if min(values) < 0:
                    raise InvalidURDF(f"{where}: the {form.tag}'s {key} is negative")
                target.set(key, _text(values))
        else:
            raise InvalidURDF(
                f"{where}: geometry <{str(form.tag)[:40]}> is unknown; use box, cylinder, sphere,"
                " capsule or mesh"
            )
        material = element.find("material")
        if kind == "visual" and material is not None and material.get("name"):
            copy = etree.SubElement(twin, "material", name=material.get("name", "")[:128])
            color = material.find("color")
            if color is not None:
                etree.SubElement(copy, "color", rgba=_text(_floats(color, "rgba", 4, where)))

    def _joint(self, element: etree._Element, links: tuple[str, ...]) -> URDFJoint:
        name = self._name(element, "a <joint>")
        where = f"joint {name!r}"
        if name == "universe":
            raise InvalidURDF(f"{where}: Pinocchio keeps this name for itself; give it another")
        type_ = element.get("type")
        if type_ in ("floating", "planar"):
            raise InvalidURDF(
                f"{where}: type {type_} is not supported; write it as revolute and prismatic"
                " joints, or as fixed"
            )
        if type_ not in (*MOVING_TYPES, "fixed"):
            shown = repr(type_)[:40]
            raise InvalidURDF(
                f"{where}: type is {shown}; give revolute, prismatic, continuous or fixed"
            )
        ends = []
        for role in ("parent", "child"):
            end = element.find(role)
            link = end.get("link") if end is not None else None
            if link is None:
                raise InvalidURDF(f"{where}: <{role} link=…> is missing")
            if link not in links:
                raise InvalidURDF(f"{where}: its {role} link {link[:64]!r} does not exist")
            ends.append(link)
        twin = etree.SubElement(self.robot, "joint", name=name, type=type_)
        etree.SubElement(twin, "parent", link=ends[0])
        etree.SubElement(twin, "child", link=ends[1])
        self._origin(element, twin, where)
        if type_ == "fixed":
            return URDFJoint(name, type_, ends[0], ends[1], None, None, None, None)
        etree.SubElement(twin, "axis", xyz=_text(_axis(element, where)))
        lower, upper, velocity, effort = _limits(element, twin, type_, where)
        if element.find("mimic") is not None:
            self.warnings.append(f"{where} mimics another; it is treated as independent")
        return URDFJoint(name, type_, ends[0], ends[1], lower, upper, velocity, effort)

    def _origin(self, element: etree._Element, twin: etree._Element, where: str) -> None:
        origin = element.find("origin")
        if origin is not None:
            xyz = _floats(origin, "xyz", 3, where, "0 0 0")
            rpy = _floats(origin, "rpy", 3, where, "0 0 0")
            etree.SubElement(twin, "origin", xyz=_text(xyz), rpy=_text(rpy))


def _axis(element: etree._Element, where: str) -> list[float]:
    axis = element.find("axis")
    xyz = [1.0, 0.0, 0.0] if axis is None else _floats(axis, "xyz", 3, where, "1 0 0")
    norm = math.sqrt(sum(value * value for value in xyz))
    if norm < 1e-6:
        raise InvalidURDF(f"{where}: its axis is zero; give a direction such as 0 0 1")
    if abs(norm - 1.0) <= 1e-15:
        return xyz
    return [value / norm for value in xyz]


def _limits(
    element: etree._Element, twin: etree._Element, type_: str, where: str
) -> tuple[float | None, float | None, float | None, float | None]:
    limit = element.find("limit")
    if limit is None:
        if type_ == "continuous":
            return None, None, None, None
        raise InvalidURDF(
            f"{where}: a {type_} joint needs <limit lower upper effort velocity>; add it"
            + (", or make the joint continuous" if type_ == "revolute" else "")
        )
    values: dict[str, float] = {}
    for key in ("effort", "velocity"):
        if limit.get(key) is None and type_ != "continuous":
            raise InvalidURDF(f"{where}: <limit> lacks {key}, which URDF requires; add it")
        if limit.get(key) is not None:
            values[key] = _float(limit, key, where)
            if values[key] < 0:
                raise InvalidURDF(f"{where}: limit {key} {values[key]:g} is negative")
    bounds: list[float | None] = [None, None]
    if type_ != "continuous":
        for index, key in enumerate(("lower", "upper")):
            if limit.get(key) is None:
                raise InvalidURDF(
                    f"{where}: <limit> lacks {key} (readers would take 0 and freeze the joint);"
                    " give lower and upper"
                )
            bounds[index] = values[key] = _float(limit, key, where)
        if values["lower"] > values["upper"]:
            raise InvalidURDF(
                f"{where}: lower limit {values['lower']:g} is above upper {values['upper']:g};"
                " swap them"
            )
    if values:
        written = {"effort": UNBOUNDED, "velocity": UNBOUNDED} | values
        etree.SubElement(twin, "limit", {key: repr(value) for key, value in written.items()})
    return bounds[0], bounds[1], values.get("velocity"), values.get("effort")


def _float(element: etree._Element, key: str, where: str, default: float | None = None) -> float:
    if element.get(key) is None and default is not None:
        return default
    return _floats(element, key, 1, where)[0]


def _floats(
    element: etree._Element, key: str, count: int, where: str, default: str | None = None
) -> list[float]:
    text = element.get(key, default)
    what = f"{where}: {key} of <{element.tag}>"
    if text is None:
        raise InvalidURDF(f"{what} is missing")
    words = text[:1000].split()
    if len(words) != count:
        raise InvalidURDF(f"{what} is {text[:40]!r}; give {count} number(s) separated by spaces")
    for word in words:
        if _NUMBER.fullmatch(word) is None:
            remedy = "write a decimal point" if "," in word else "give a finite number"
            raise InvalidURDF(f"{what} has {word[:40]!r}; {remedy}")
    values = [float(word) for word in words]
    if max(map(abs, values)) > MAX_MAGNITUDE and key not in (
        "effort",
        "velocity",
        "lower",
        "upper",
    ):
        raise InvalidURDF(f"{what} is {text[:40]!r}, beyond ±{MAX_MAGNITUDE:g}; check the unit")
    return [math.copysign(min(abs(value), 1e9), value) for value in values]


def _text(values: list[float]) -> str:
    return " ".join(repr(value) for value in values)


def _refuse_twice(kind: str, names: tuple[str, ...]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise InvalidURDF(f"two {kind}s are called {name[:64]!r}; give each its own name")
        seen.add(name)


def _check_tree(links: tuple[str, ...], joints: tuple[URDFJoint, ...]) -> str:
    parent: dict[str, URDFJoint] = {}
    for joint in joints:
        if joint.child in parent:
            raise InvalidURDF(
                f"link {joint.child!r} is the child of two joints, {parent[joint.child].name!r} and"
                f" {joint.name!r}; a robot is a tree"
            )
        parent[joint.child] = joint
    roots = [link for link in links if link not in parent]
    if len(roots) > 1:
        shown = ", ".join(repr(link) for link in roots[:4])
        raise InvalidURDF(f"the robot has {len(roots)} root links ({shown}); join them by a joint")
    if not roots:
        raise InvalidURDF("the joints form a loop: every link has a parent; a robot is a tree")
    reached = set(_descendants(roots[0], joints))
    lost = [link for link in links if link not in reached]
    if lost:
        raise InvalidURDF(
            f"link {lost[0]!r} is not connected to the root {roots[0]!r}: its joints form a loop"
        )
    return roots[0]


def _descendants(root: str, joints: tuple[URDFJoint, ...]) -> Iterator[str]:
    children: dict[str, list[str]] = {}
    for joint in joints:
        children.setdefault(joint.parent, []).append(joint.child)
    queue = [root]
    while queue:
        link = queue.pop()
        yield link
        queue.extend(children.get(link, ()))
