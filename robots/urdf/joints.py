"""Joints of a URDF: their links, axes and limits."""

from __future__ import annotations

import math
from collections.abc import Collection

from lxml import etree

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
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
    name = name_of(element, say("a <joint>"))
    where = say("joint {name!r}", name=name)
    if name == "universe":
        raise InvalidURDF(
            say("{where}: Pinocchio keeps this name for itself; give it another", where=where)
        )
    type_ = _type(element, where)
    parent, child = (_end(element, role, links, where) for role in ("parent", "child"))
    if parent == child:
        raise InvalidURDF(
            say(
                "{where} joins link {parent!r} to itself; a robot is a tree",
                where=where,
                parent=parent,
            )
        )
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
            say(
                "{where}: type {type} is not supported; write it as revolute and"
                " prismatic joints, or as fixed",
                where=where,
                type=type_,
            )
        )
    if type_ is None:
        raise InvalidURDF(
            say(
                "{where}: its type is missing; give revolute, prismatic, continuous or fixed",
                where=where,
            )
        )
    if type_ not in (*MOVING_TYPES, "fixed"):
        raise InvalidURDF(
            say(
                "{where}: its type is {type}; give revolute, prismatic, continuous or fixed",
                where=where,
                type=quoted(type_),
            )
        )
    return type_


def _end(element: Element, role: str, links: Collection[str], where: str) -> str:
    end = element.find(role)
    link = end.get("link") if end is not None else None
    if link is None:
        raise InvalidURDF(
            say("{where}: <{role} link=…> is missing; give it", where=where, role=role)
        )
    if link not in links:
        raise InvalidURDF(
            say(
                "{where}: its {role} link {link} does not exist; add a <link> of this"
                " name, or mend the name",
                where=where,
                role=role,
                link=quoted(link, 64),
            )
        )
    return link


def _axis(element: Element, where: str) -> Triple:
    axis = element.find("axis")
    if axis is None:
        return 1.0, 0.0, 0.0
    x, y, z = numbers(axis, "xyz", 3, where, "1 0 0")
    norm = math.sqrt(x * x + y * y + z * z)
    if norm < _SHORTEST_AXIS:
        raise InvalidURDF(
            say("{where}: its axis is zero; give a direction such as 0 0 1", where=where)
        )
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
            say(
                "{where}: a {type} joint needs <limit lower upper effort velocity>; add it",
                where=where,
                type=type_,
            )
            + (say(", or make the joint continuous") if type_ == "revolute" else "")
        )
    values: dict[str, float] = {}
    for key in ("effort", "velocity"):
        if limit.get(key) is None and type_ != "continuous":
            raise InvalidURDF(
                say(
                    "{where}: <limit> lacks {key}, which URDF requires; add it",
                    where=where,
                    key=key,
                )
            )
        if limit.get(key) is not None:
            values[key] = _limit(limit, key, where)
            if values[key] < 0:
                raise InvalidURDF(
                    say(
                        "{where}: limit {key} {value:g} is negative; give its magnitude",
                        where=where,
                        key=key,
                        value=values[key],
                    )
                )
    for key in ("lower", "upper"):
        if limit.get(key) is not None:
            values[key] = _limit(limit, key, where)
        elif type_ != "continuous":
            raise InvalidURDF(
                say(
                    "{where}: <limit> lacks {key} (readers would take 0 and freeze the"
                    " joint); give lower and upper",
                    where=where,
                    key=key,
                )
            )
    if type_ == "continuous":
        # URDF: the bounds of a continuous joint have no meaning.
        values.pop("lower", None)
        values.pop("upper", None)
    elif values["lower"] > values["upper"]:
        raise InvalidURDF(
            say(
                "{where}: lower limit {value:g} is above upper {value_2:g}; swap them",
                where=where,
                value=values["lower"],
                value_2=values["upper"],
            )
        )
    if values:
        written = {"effort": UNBOUNDED, "velocity": UNBOUNDED} | values
        etree.SubElement(twin, "limit", {key: repr(value) for key, value in written.items()})
    return values.get("lower"), values.get("upper"), values.get("velocity"), values.get("effort")


def _limit(limit: Element, key: str, where: str) -> float:
    """Read a limit; ±UNBOUNDED stands for none."""
    value = number(limit, key, where, bound=MAX_LIMIT)
    return math.copysign(min(abs(value), UNBOUNDED), value)
