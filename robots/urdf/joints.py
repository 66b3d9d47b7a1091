"""Joints of a URDF: their links, axes and limits."""

from __future__ import annotations

import math
from collections.abc import Collection

from lxml import etree

from dh_to_urdf.errors import quoted
from dh_to_urdf.writer import UNBOUNDED
from robots.errors import InvalidURDF
from robots.urdf.description import MOVING_TYPES, Triple, URDFJoint
from robots.urdf.limits import MAX_LIMIT
from robots.urdf.values import (
    Element,
    name_of,
    number,
    numbers,
    origin_of,
    text_of,
    write_origin,
)

_SHORTEST_AXIS = 1e-6


def read_joint(element: Element, robot: Element, links: Collection[str]) -> URDFJoint:
    """Read a joint and write the canonical one below ``robot``.

    Args:
        element: The <joint>.
        robot: The canonical root element.
        links: Names of all links.

    Raises:
        InvalidURDF: With the joint's name, what is wrong and what to write.
    """
    name = name_of(element, "a <joint>")
    where = f"joint {name!r}"
    if name == "universe":
        raise InvalidURDF(f"{where}: Pinocchio keeps this name for itself; give it another")
    type_ = _type(element, where)
    parent, child = (_end(element, role, links, where) for role in ("parent", "child"))
    if parent == child:
        raise InvalidURDF(f"{where} joins link {parent!r} to itself; a robot is a tree")
    origin = origin_of(element, where)
    twin = etree.SubElement(robot, "joint", name=name, type=type_)
    etree.SubElement(twin, "parent", link=parent)
    etree.SubElement(twin, "child", link=child)
    write_origin(origin, twin)
    if type_ == "fixed":
        return URDFJoint(name, type_, parent, child, origin)
    axis = _axis(element, where)
    etree.SubElement(twin, "axis", xyz=text_of(axis))
    lower, upper, velocity, effort = _limits(element, twin, type_, where)
    return URDFJoint(name, type_, parent, child, origin, axis, lower, upper, velocity, effort)


def _type(element: Element, where: str) -> str:
    type_ = element.get("type")
    if type_ in ("floating", "planar"):
        raise InvalidURDF(
            f"{where}: type {type_} is not supported; write it as revolute and prismatic"
            " joints, or as fixed"
        )
    if type_ is None:
        raise InvalidURDF(
            f"{where}: its type is missing; give revolute, prismatic, continuous or fixed"
        )
    if type_ not in (*MOVING_TYPES, "fixed"):
        raise InvalidURDF(
            f"{where}: its type is {quoted(type_)}; give revolute, prismatic, continuous or fixed"
        )
    return type_


def _end(element: Element, role: str, links: Collection[str], where: str) -> str:
    end = element.find(role)
    link = end.get("link") if end is not None else None
    if link is None:
        raise InvalidURDF(f"{where}: <{role} link=…> is missing; give it")
    if link not in links:
        raise InvalidURDF(
            f"{where}: its {role} link {quoted(link, 64)} does not exist; add a <link> of this"
            " name, or mend the name"
        )
    return link


def _axis(element: Element, where: str) -> Triple:
    axis = element.find("axis")
    if axis is None:
        return 1.0, 0.0, 0.0
    x, y, z = numbers(axis, "xyz", 3, where, "1 0 0")
    norm = math.sqrt(x * x + y * y + z * z)
    if norm < _SHORTEST_AXIS:
        raise InvalidURDF(f"{where}: its axis is zero; give a direction such as 0 0 1")
    if abs(norm - 1.0) <= 1e-15:
        return x, y, z
    return x / norm, y / norm, z / norm


def _limits(
    element: Element, twin: Element, type_: str, where: str
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
            values[key] = _limit(limit, key, where)
            if values[key] < 0:
                raise InvalidURDF(
                    f"{where}: limit {key} {values[key]:g} is negative; give its magnitude"
                )
    for key in ("lower", "upper"):
        if limit.get(key) is not None:
            values[key] = _limit(limit, key, where)
        elif type_ != "continuous":
            raise InvalidURDF(
                f"{where}: <limit> lacks {key} (readers would take 0 and freeze the joint);"
                " give lower and upper"
            )
    if type_ == "continuous":
        # URDF: the bounds of a continuous joint have no meaning.
        values.pop("lower", None)
        values.pop("upper", None)
    elif values["lower"] > values["upper"]:
        raise InvalidURDF(
            f"{where}: lower limit {values['lower']:g} is above upper {values['upper']:g};"
            " swap them"
        )
    if values:
        written = {"effort": UNBOUNDED, "velocity": UNBOUNDED} | values
        etree.SubElement(twin, "limit", {key: repr(value) for key, value in written.items()})
    return values.get("lower"), values.get("upper"), values.get("velocity"), values.get("effort")


def _limit(limit: Element, key: str, where: str) -> float:
    """Read a limit; ±UNBOUNDED stands for none."""
    value = number(limit, key, where, bound=MAX_LIMIT)
    return math.copysign(min(abs(value), UNBOUNDED), value)
