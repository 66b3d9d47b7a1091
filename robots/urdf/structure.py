"""Places and numbers of the elements of a URDF.

The elements that kinematics reads are listed; extensions of simulators and controllers are left out
and named in a warning. Whatever may be a mistake (a second <origin>, <orgin>, a <link> in a <link>,
text between tags) is refused, since other readers would ignore it and compute another robot.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from functools import lru_cache

from lxml import etree

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from robots.errors import InvalidURDF
from robots.urdf.markup import shown_tag
from robots.urdf.values import label_of

_MANY = 1_000_000
_CHILDREN: dict[str, dict[str, int]] = {
    "robot": {"link": _MANY, "joint": _MANY, "material": _MANY},
    "link": {"inertial": 1, "visual": _MANY, "collision": _MANY},
    "inertial": {"origin": 1, "mass": 1, "inertia": 1},
    "visual": {"origin": 1, "geometry": 1, "material": 1},
    "collision": {"origin": 1, "geometry": 1},
    "geometry": {"box": 1, "cylinder": 1, "sphere": 1, "capsule": 1, "mesh": 1},
    "material": {"color": 1},
    "joint": {"origin": 1, "parent": 1, "child": 1, "axis": 1, "limit": 1, "mimic": 1},
}
_OPTIONAL_ATTRIBUTES = {
    "origin": ("xyz", "rpy"),
    "axis": ("xyz",),
    "mimic": ("joint", "multiplier", "offset"),
}
"""Elements whose attributes have defaults, so that a misspelt one would be ignored."""
_FREE = ("gazebo", "transmission", "sensor", "ros2_control")
"""Extensions beside links and joints, with links and joints of their own meaning inside."""
_KNOWN: dict[str, tuple[str, ...]] = {
    "link": ("contact", "collision_checking", "self_filter", "gravity", "kinematic", "surface"),
    "collision": ("material", "verbose", "contact_coefficients"),
    "material": ("texture",),
    "joint": ("calibration", "dynamics", "safety_controller"),
}
"""Elements that common programs write and that have no part in kinematics."""
_OF_NO_ACCOUNT = ("verbose", "origin", "material", "contact_coefficients")
"""Elements that are left out without a warning."""
_READ = {tag for children in _CHILDREN.values() for tag in children} | {"robot"}
_MAX_LEFT_OUT = 20
_NOT_DONE = {
    "include": say("put the elements of that file in its place"),
    "loop_joint": say("a robot is a tree; cut its loops"),
}
"""Elements without which it would be another robot, and the remedy."""
_XACRO = "http://www.ros.org/wiki/xacro"


def check_structure(robot: etree._Element) -> tuple[str, ...]:
    """Refuse elements that are in a wrong place, twice, or misspelt.

    Args:
        robot: The root element.

    Returns:
        Names of the kinds of elements that are left out, in the order of the document.

    Raises:
        InvalidURDF: With the element, and the link or joint that it stands in.
    """
    if robot.tag != "robot":
        raise InvalidURDF(
            say(
                "the root element is <{robot}>; a URDF starts with <robot name=…>",
                robot=shown_tag(robot),
            )
            + (say(" without a prefix") if str(robot.tag).endswith("}robot") else "")
        )
    left_out: dict[str, None] = {}
    for element, where in _walk(robot, say("the robot")):
        tag = str(element.tag)
        known = _CHILDREN.get(tag, {})
        _refuse_text(element, where)
        _check_attributes(element, where)
        counts: dict[str, int] = {}
        for child in element:
            name = str(child.tag)
            counts[name] = counts.get(name, 0) + 1
            if name in known:
                if counts[name] > known[name]:
                    raise InvalidURDF(
                        say(
                            "{where} has two <{name}> in <{tag}>; keep one",
                            where=where,
                            name=name,
                            tag=tag,
                        )
                    )
                continue
            _check_left_out(child, tag, where)
            if name not in _OF_NO_ACCOUNT:
                left_out[shown_tag(child)] = None
            if len(left_out) > _MAX_LEFT_OUT:
                raise InvalidURDF(
                    say(
                        "the URDF has over {max_left_out} kinds of elements that are unknown,"
                        " such as <{child}>; remove them",
                        max_left_out=_MAX_LEFT_OUT,
                        child=shown_tag(child),
                    )
                )
    return tuple(left_out)


def _walk(element: etree._Element, where: str) -> Iterator[tuple[etree._Element, str]]:
    """Iterate over the elements that are read, each with its link or joint."""
    yield element, where
    known = _CHILDREN.get(str(element.tag), {})
    for child in element:
        if child.tag in known:
            yield from _walk(child, _label(child) if element.tag == "robot" else where)


def _label(element: etree._Element) -> str:
    name = element.get("name")
    tag = str(element.tag)
    return label_of(tag, name) if name is not None else say("a <{tag}>", tag=tag)


def _refuse_text(element: etree._Element, where: str) -> None:
    texts = [element.text, *(child.tail for child in element)]
    stray = next((text.strip() for text in texts if text and text.strip()), None)
    if stray is not None:
        raise InvalidURDF(
            say(
                "{where} holds the text {stray} in <{tag}>; remove it, or mend the tag that it was",
                where=where,
                stray=quoted(stray, 24),
                tag=element.tag,
            )
        )


def _check_attributes(element: etree._Element, where: str) -> None:
    known = _OPTIONAL_ATTRIBUTES.get(str(element.tag))
    for key in element.keys() if known is not None else ():
        if known is not None and key not in known:
            raise InvalidURDF(
                say(
                    "{where}: <{tag}> has an attribute {key}; known are {known}",
                    where=where,
                    tag=element.tag,
                    key=quoted(str(key)),
                    known=", ".join(known),
                )
            )


def _check_left_out(child: etree._Element, parent: str, where: str) -> None:
    if child.tag in _FREE or _is_zero_origin(child, parent):
        return
    if child.tag not in _KNOWN.get(parent, ()):
        _check_unknown(child, parent, where)
    hidden = next(child.iter("link", "joint"), None)
    if hidden is not None:
        raise InvalidURDF(
            say(
                "{where}: <{child}> holds a <{tag}>; put that into <robot>, or remove <{child}>",
                where=where,
                child=shown_tag(child),
                tag=hidden.tag,
            )
        )


def _check_unknown(child: etree._Element, parent: str, where: str) -> None:
    """Refuse an unknown element that could have been meant to be read."""
    namespace, _, name = str(child.tag).removeprefix("{").rpartition("}")
    shown = shown_tag(child)
    if namespace.startswith(_XACRO) or namespace.endswith("/xacro"):
        raise InvalidURDF(
            say(
                "{where} holds <xacro:{shown}>; expand the xacro file first",
                where=where,
                shown=shown,
            )
        )
    if name.lower() in _NOT_DONE:
        raise InvalidURDF(
            say(
                "{where} holds <{shown}>, which is not read: {not_done}",
                where=where,
                shown=shown,
                not_done=_NOT_DONE[name.lower()],
            )
        )
    if parent == "geometry":
        raise InvalidURDF(
            say(
                "{where}: geometry <{shown}> is unknown; use box, cylinder, sphere,"
                " capsule or mesh",
                where=where,
                shown=shown,
            )
        )
    if name.lower() in _READ:
        raise InvalidURDF(
            say(
                "{where}: <{shown}> cannot stand in <{parent}>; put it in its place or remove it",
                where=where,
                shown=shown,
                parent=parent,
            )
        )
    meant = _meant(name, parent)
    if meant is not None:
        raise InvalidURDF(
            say(
                "{where}: <{shown}> is unknown; did you mean <{meant}>?",
                where=where,
                shown=shown,
                meant=meant,
            )
        )


@lru_cache(256)
def _meant(name: str, parent: str) -> str | None:
    """Return the child of an element that a name looks like."""
    if len(name) > 32:
        return None
    close = difflib.get_close_matches(name.lower(), _CHILDREN.get(parent, ()), 1, 0.7)
    return close[0] if close else None


def _is_zero_origin(child: etree._Element, parent: str) -> bool:
    """Return True for an <origin> in a <link> (unknown to URDF) that changes nothing."""
    digits = "".join(map(str, child.values()))
    return parent == "link" and child.tag == "origin" and not set(digits) & set("123456789")
