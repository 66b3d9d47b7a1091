"""Joints of a URDF: their links, axes and limits."""

from __future__ import annotations

import difflib
import math
from collections.abc import Collection
from dataclasses import dataclass

from lxml import etree

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.writer import UNBOUNDED
from robots.errors import InvalidURDF
from robots.urdf.description import MOVING_TYPES, Origin, Triple, URDFJoint
from robots.urdf.faults import Faults
from robots.urdf.limits import MAX_LIMIT
from robots.urdf.notes import Notes
from robots.urdf.structure import misspelt
from robots.urdf.values import (
    Element,
    name_of,
    number,
    numbers,
    read_origin,
    text_of,
    write_origin,
)

FREE_TYPES = ("floating", "planar")
"""Types that are no single motion."""
_SHORTEST_AXIS = 1e-6
_ATTRIBUTES = {"origin": ("xyz", "rpy", "quat_xyzw"), "axis": ("xyz",)}
"""Attributes with defaults, of which a misspelt one would be ignored and move the robot."""
_TIMING = ("acceleration", "jerk")


@dataclass(frozen=True, slots=True)
class JointReader:
    """Reads the joints of one document.

    Where a link that a joint names does not exist, the name is empty in what is returned.

    Attributes:
        links: Names of all links.
        faults: Takes what is wrong.
        notes: Takes what is left out.
        quaternions: Whether the version of the document has ``quat_xyzw``.
    """

    links: Collection[str]
    faults: Faults
    notes: Notes
    quaternions: bool

    def read(self, element: Element) -> URDFJoint:
        """Read a joint; where something of it is wrong, the faults tell it.

        Args:
            element: The <joint>.
        """
        name = self.faults.read(
            element, element.get("name", ""), lambda: name_of(element, say("a <joint>"))
        )
        where = say("joint {name!r}", name=name)
        if name == "universe":
            self.faults.add(
                element,
                say("{where}: Pinocchio keeps this name for itself; give it another", where=where),
            )
        type_ = self.faults.read(element, "continuous", lambda: _type(element, where))
        parent, child = (self._end(element, role, where) for role in ("parent", "child"))
        if parent and parent == child:
            self.faults.add(
                element,
                say(
                    "{where} joins link {parent!r} to itself; a robot is a tree",
                    where=where,
                    parent=parent,
                ),
            )
            child = ""
        origin = self._origin(element, where)
        if type_ == "fixed":
            self._fixed(element, where)
            return URDFJoint(name, type_, parent, child, origin)
        if type_ == "floating":
            return URDFJoint(name, type_, parent, child, origin)
        axis = self._axis(element, where)
        if type_ == "planar":
            if element.find("limit") is not None:
                self.notes.add(say("the <limit> of a planar joint is left out"), where)
            return URDFJoint(name, type_, parent, child, origin, axis)
        values = self._limits(element, type_, where)
        return URDFJoint(
            name,
            type_,
            parent,
            child,
            origin,
            axis,
            lower=values.get("lower"),
            upper=values.get("upper"),
            velocity=values.get("velocity"),
            effort=values.get("effort"),
            acceleration=values.get("acceleration"),
            jerk=values.get("jerk"),
        )

    def _end(self, element: Element, role: str, where: str) -> str:
        end = self._one(element, role, where)
        link = end.get("link") if end is not None else None
        if link is None:
            if end is not None or not misspelt(element, role):
                self.faults.add(
                    end if end is not None else element,
                    say("{where}: <{role} link=…> is missing; give it", where=where, role=role),
                )
            return ""
        if link not in self.links:
            self.faults.add(
                end,
                say(
                    "{where}: its {role} link {link} does not exist; add a <link> of this"
                    " name, or mend the name",
                    where=where,
                    role=role,
                    link=quoted(link, 64),
                ),
            )
            return ""
        return link

    def _origin(self, element: Element, where: str) -> Origin:
        origin = self._one(element, "origin", where)
        if origin is None:
            return Origin()
        self._check_attributes(origin, where)
        return self.faults.read(
            origin, Origin(), lambda: read_origin(origin, where, quaternions=self.quaternions)
        )

    def _axis(self, element: Element, where: str) -> Triple:
        axis = self._one(element, "axis", where)
        if axis is None:
            return 1.0, 0.0, 0.0
        self._check_attributes(axis, where)
        return self.faults.read(axis, (0.0, 0.0, 1.0), lambda: _direction(axis, where))

    def _fixed(self, element: Element, where: str) -> None:
        """Note what has no meaning in a joint that does not move."""
        for tag in ("axis", "limit", "mimic"):
            if element.find(tag) is not None:
                self.notes.add(say("<{tag}> of a fixed joint is left out", tag=tag), where)

    def _one(self, joint: Element, tag: str, where: str) -> Element | None:
        """Return the child of a tag; several that are equal count as one."""
        found = joint.findall(tag)
        if len(found) > 1:
            if len({_content(one) for one in found}) > 1:
                self.faults.add(
                    found[1],
                    say(
                        "{where} has two <{name}> in <{tag}>; keep one",
                        where=where,
                        name=tag,
                        tag="joint",
                    ),
                )
            else:
                self.notes.add(
                    say(
                        "has {count} equal <{tag}>, of which one is kept", count=len(found), tag=tag
                    ),
                    where,
                )
        return found[0] if found else None

    def _check_attributes(self, element: Element, where: str) -> None:
        """Keep misspelt attributes as faults; note those that say nothing here."""
        known = _ATTRIBUTES[str(element.tag)]
        missing = [key for key in known if element.get(key) is None]
        if "rpy" in known and "rpy" not in missing and "quat_xyzw" in missing:
            missing.remove("quat_xyzw")
        for key in map(str, element.keys()):
            if key in known:
                continue
            if not key.startswith("{") and _resembles(key, missing):
                self.faults.add(
                    element,
                    say(
                        "{where}: <{tag}> has an attribute {key}; known are {known}",
                        where=where,
                        tag=element.tag,
                        key=quoted(key),
                        known=", ".join(known),
                    ),
                )
            else:
                self.notes.add(
                    say(
                        "the attribute {key} of <{tag}> is left out",
                        key=quoted(key.rpartition("}")[2]),
                        tag=element.tag,
                    ),
                    where,
                )

    def _limits(self, element: Element, type_: str, where: str) -> dict[str, float]:
        limit = self._one(element, "limit", where)
        is_bounded = type_ != "continuous"
        if limit is None:
            if is_bounded and not misspelt(element, "limit"):
                self.faults.add(
                    element,
                    say(
                        "{where}: a {type} joint needs <limit lower upper effort velocity>; add it",
                        where=where,
                        type=type_,
                    )
                    + (say(", or make the joint continuous") if type_ == "revolute" else ""),
                )
            return {}
        values: dict[str, float] = {}
        for key in ("effort", "velocity", "lower", "upper"):
            value = self._limit(limit, key, where, is_bounded=is_bounded)
            if value is not None:
                values[key] = value
        if {"lower", "upper"} <= set(values) and values["lower"] > values["upper"]:
            self.faults.add(
                limit,
                say(
                    "{where}: lower limit {value:g} is above upper {value_2:g}; swap them",
                    where=where,
                    value=values["lower"],
                    value_2=values["upper"],
                ),
            )
        for key in map(str, limit.keys()):
            name = key.rpartition("}")[2]
            if name in _TIMING:
                self._timing(limit, key, name, where, values)
            elif key not in ("effort", "velocity", "lower", "upper"):
                self.notes.add(
                    say(
                        "the attribute {key} of <{tag}> is left out", key=quoted(name), tag="limit"
                    ),
                    where,
                )
        return values

    def _limit(self, limit: Element, key: str, where: str, *, is_bounded: bool) -> float | None:
        """Read a limit; ±UNBOUNDED stands for none."""
        is_bound = key in ("lower", "upper")
        if limit.get(key) is None or (is_bound and not is_bounded):
            # URDF: the bounds of a continuous joint have no meaning.
            if is_bounded:
                self.faults.add(limit, _lacking(key, where))
            return None
        value = self.faults.read(limit, None, lambda: number(limit, key, where, bound=MAX_LIMIT))
        if value is not None and value < 0 and not is_bound:
            self.faults.add(
                limit,
                say(
                    "{where}: limit {key} {value:g} is negative; give its magnitude",
                    where=where,
                    key=key,
                    value=value,
                ),
            )
        return None if value is None else math.copysign(min(abs(value), UNBOUNDED), value)

    def _timing(
        self, limit: Element, key: str, name: str, where: str, values: dict[str, float]
    ) -> None:
        """Keep a limit that only timing uses; what is none is left out."""
        try:
            value = number(limit, key, where, bound=MAX_LIMIT)
        except InvalidURDF:
            value = -1.0
        if value <= 0.0:
            self.notes.add(
                say("{key} of <limit> is no number above 0 and is left out", key=name), where
            )
        elif value < UNBOUNDED:
            values[name] = value


def write_joint(joint: URDFJoint, robot: Element) -> None:
    """Write a joint that was read below the canonical root element."""
    twin = etree.SubElement(robot, "joint", name=joint.name, type=joint.type)
    etree.SubElement(twin, "parent", link=joint.parent)
    etree.SubElement(twin, "child", link=joint.child)
    write_origin(joint.origin, twin)
    if joint.axis is not None:
        etree.SubElement(twin, "axis", xyz=text_of(joint.axis))
    keys = ("effort", "velocity", "lower", "upper", "acceleration", "jerk")
    values = {key: value for key in keys if (value := getattr(joint, key)) is not None}
    if values:
        written = {"effort": UNBOUNDED, "velocity": UNBOUNDED} | values
        etree.SubElement(twin, "limit", {key: repr(value) for key, value in written.items()})
    if joint.mimic is not None:
        written_mimic = {
            "joint": joint.mimic.joint,
            "multiplier": repr(joint.mimic.multiplier),
            "offset": repr(joint.mimic.offset),
        }
        etree.SubElement(twin, "mimic", written_mimic)


def _type(element: Element, where: str) -> str:
    type_ = element.get("type")
    if type_ is None:
        raise InvalidURDF(
            say(
                "{where}: its type is missing; give revolute, prismatic, continuous or fixed",
                where=where,
            )
        )
    if type_ not in (*MOVING_TYPES, *FREE_TYPES, "fixed"):
        raise InvalidURDF(
            say(
                "{where}: its type is {type}; give revolute, prismatic, continuous or fixed",
                where=where,
                type=quoted(type_),
            )
        )
    return type_


def _direction(axis: Element, where: str) -> Triple:
    x, y, z = numbers(axis, "xyz", 3, where, "1 0 0")
    norm = math.sqrt(x * x + y * y + z * z)
    if norm < _SHORTEST_AXIS:
        raise InvalidURDF(
            say("{where}: its axis is zero; give a direction such as 0 0 1", where=where)
        )
    if abs(norm - 1.0) <= 1e-15:
        return x, y, z
    return x / norm, y / norm, z / norm


def _lacking(key: str, where: str) -> str:
    if key in ("effort", "velocity"):
        return say(
            "{where}: <limit> lacks {key}, which URDF requires; add it", where=where, key=key
        )
    return say(
        "{where}: <limit> lacks {key} (readers would take 0 and freeze the"
        " joint); give lower and upper",
        where=where,
        key=key,
    )


def _content(element: Element) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Return the attributes of an element, their blanks made even."""
    return tuple(sorted((str(k), tuple(str(v).split())) for k, v in element.attrib.items()))


def _resembles(key: str, missing: list[str]) -> bool:
    """Return whether an attribute was perhaps meant as one that is missing."""
    return bool(difflib.get_close_matches(key[:32].lower(), missing, 1, 0.6))
