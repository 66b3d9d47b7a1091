"""Places of the elements of a URDF: what kinematics reads, and what is left out.

Kinematics reads links by name, and of joints their ends, origin, axis, limits and what they follow.
Everything else draws, simulates or decorates; it is left out and named in a warning. What may have
been meant to move the robot (an <axis> beside its joint, <orgin>, a joint in another element, text
that was a tag) is a fault, since other readers would ignore it and compute another robot.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass
from functools import lru_cache

from lxml import etree

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from robots.errors import InvalidURDF
from robots.urdf.faults import Faults, fault_at
from robots.urdf.markup import UNDECLARED, shown_tag
from robots.urdf.notes import Notes
from robots.urdf.values import label_of

_LINK = ("inertial", "visual", "collision")
_DRAWN = (*_LINK, "geometry", "origin", "material", "mesh", "mass", "inertia")
"""What holds no text in a link."""
_MOVING = ("origin", "parent", "child", "axis", "limit", "mimic")
"""What a <joint> holds that kinematics reads."""
_OF_MOTION = ("axis", "limit", "mimic")
"""What has no meaning in a fixed joint."""
_FREE = ("gazebo", "transmission", "sensor", "ros2_control")
"""Extensions beside links and joints, with links and joints of their own meaning inside."""
_KNOWN: dict[str, tuple[str, ...]] = {
    "robot": ("material",),
    "link": ("contact", "collision_checking", "self_filter", "gravity", "kinematic", "surface"),
    "joint": ("calibration", "dynamics", "safety_controller"),
}
"""Elements that common programs write and that have no part in kinematics."""
_OF_NO_ACCOUNT = ("verbose", "material", "contact_coefficients")
"""Elements that are left out without a warning."""
_NOT_DONE = {
    "include": say("put the elements of that file in its place"),
    "loop_joint": say("a robot is a tree; cut its loops"),
}
"""Elements without which it would be another robot, and the remedy."""
_XACRO = "http://www.ros.org/wiki/xacro"
_SHOWN = 8
_TAG_LIKE = re.compile(r"[=\"]|/>")
"""Text that was perhaps a tag."""
_VALUE_LIKE = re.compile(r"\w")
"""Text that was perhaps the value of an attribute."""


@dataclass(frozen=True, slots=True)
class Survey:
    """The elements that are read, and those that are not.

    Attributes:
        links: The <link> elements.
        joints: The <joint> elements.
        left_out: Kinds of elements that are left out, in the order of the document.
        suspects: Elements that look like a misspelt <link> or <joint>, each with what to say of
            it; they are faults where the rest is no tree.
    """

    links: tuple[etree._Element, ...]
    joints: tuple[etree._Element, ...]
    left_out: tuple[str, ...]
    suspects: tuple[tuple[etree._Element, str], ...]


def survey(robot: etree._Element, faults: Faults, notes: Notes) -> Survey:
    """Sort the elements of a robot.

    Args:
        robot: The root element.
        faults: Takes what may be another robot.
        notes: Takes what is left out.

    Raises:
        InvalidURDF: The root is no <robot>, or the document is a xacro file.
    """
    if robot.tag != "robot":
        raise InvalidURDF(
            say(
                "the root element is <{robot}>; a URDF starts with <robot name=…>",
                robot=shown_tag(robot),
            )
            + (say(" without a prefix") if str(robot.tag).endswith("}robot") else "")
        )
    links = tuple(child for child in robot if child.tag == "link")
    joints = tuple(child for child in robot if child.tag == "joint")
    _refuse_xacro(robot, joints)
    left_out: dict[str, None] = {}
    suspects: list[tuple[etree._Element, str]] = []
    where = say("the robot")
    _drop_text(robot, where, faults, notes)
    for child in robot:
        if child.tag in ("link", "joint", "material"):
            continue
        _check_left_out(child, "robot", where, faults)
        meant = _meant(_local(child), ("link", "joint"))
        if meant is not None:
            same = _local(child) == meant
            message = _misplaced(child, where, "robot") if same else _unknown(child, where, meant)
            suspects.append((child, message))
        _leave_out(child, left_out)
    for link in links:
        _survey_link(link, faults, notes, left_out)
    for joint in joints:
        _survey_joint(joint, faults, notes, left_out)
    return Survey(links, joints, tuple(left_out), tuple(suspects))


def left_out_sentence(kinds: tuple[str, ...]) -> tuple[str, ...]:
    """Return the warning that names the kinds of elements that are left out."""
    if not kinds:
        return ()
    shown = ", ".join(f"<{kind}>" for kind in kinds[:_SHOWN])
    shown += ", …" if len(kinds) > _SHOWN else ""
    return (say("left out, since kinematics does not use it: {shown}", shown=shown),)


def misspelt(joint: etree._Element, tag: str) -> bool:
    """Return whether a joint holds an unknown element that looks like one that it lacks."""
    known = (*_MOVING, *_KNOWN["joint"])
    return any(child.tag not in known and _meant(_local(child), _MOVING) == tag for child in joint)


def label(element: etree._Element) -> str:
    """Return what messages call a link or joint: its kind and name."""
    name = element.get("name")
    tag = str(element.tag)
    return label_of(tag, name) if name is not None else say("a <{tag}>", tag=tag)


def _leave_out(child: etree._Element, left_out: dict[str, None]) -> None:
    if child.tag not in _OF_NO_ACCOUNT and len(left_out) <= _SHOWN:
        left_out[shown_tag(child)] = None


def _survey_link(
    link: etree._Element, faults: Faults, notes: Notes, left_out: dict[str, None]
) -> None:
    where = label(link)
    _drop_text(link, where, faults, notes)
    for child in link:
        if child.tag in _LINK:
            for part in child.iter(*_DRAWN):
                _drop_text(part, where, faults, notes)
            _check_hidden(child, where, faults)
            continue
        if child.tag == "origin":
            if _moves(child):
                notes.add(
                    say("an <origin> in <link> has no meaning in URDF and is left out"), where
                )
            continue
        _check_left_out(child, "link", where, faults)
        _leave_out(child, left_out)


def _survey_joint(
    joint: etree._Element, faults: Faults, notes: Notes, left_out: dict[str, None]
) -> None:
    where = label(joint)
    is_fixed = joint.get("type") == "fixed"
    present = {str(child.tag) for child in joint}
    _drop_text(joint, where, faults, notes, _TAG_LIKE)
    for child in joint:
        name = str(child.tag)
        if name in _MOVING:
            if not (is_fixed and name in _OF_MOTION):
                _drop_text(child, where, faults, notes, _VALUE_LIKE)
            for part in child:
                if _local(part) in ("robot", "link", "joint", *_MOVING):
                    faults.add(part, _misplaced(part, where, name))
                else:
                    _leave_out(part, left_out)
            continue
        _check_left_out(child, "joint", where, faults)
        meant = _meant(_local(child), _MOVING)
        counts = meant is not None and meant not in present and name not in _KNOWN["joint"]
        if meant is None or not counts or (is_fixed and meant in _OF_MOTION):
            _leave_out(child, left_out)
        else:
            faults.add(child, _unknown(child, where, meant))


def _unknown(child: etree._Element, where: str, meant: str) -> str:
    return say(
        "{where}: <{shown}> is unknown; did you mean <{meant}>?",
        where=where,
        shown=shown_tag(child),
        meant=meant,
    )


def _misplaced(child: etree._Element, where: str, parent: str) -> str:
    return say(
        "{where}: <{shown}> cannot stand in <{parent}>; put it in its place or remove it",
        where=where,
        shown=shown_tag(child),
        parent=parent,
    )


def _drop_text(
    part: etree._Element,
    where: str,
    faults: Faults,
    notes: Notes,
    risky: re.Pattern[str] | None = None,
) -> None:
    """Note text between tags; text that may have been a tag or a value is a fault.

    Args:
        part: The element whose own text and that behind its children is looked at.
        where: Link or joint, for the message.
        faults: Takes what is risky.
        notes: Takes the rest.
        risky: What text must not hold here; None: text is harmless.
    """
    for text in (part.text, *(child.tail for child in part)):
        stray = text.strip() if text else ""
        if not stray:
            continue
        shown = quoted(stray, 24)
        if risky is not None and risky.search(stray):
            message = say(
                "{where} holds the text {stray} in <{tag}>; remove it, or mend the tag that it was",
                where=where,
                stray=shown,
                tag=shown_tag(part),
            )
            faults.add(part, message)
        else:
            notes.add(say("the stray text {shown} between tags is left out", shown=shown))


def _check_left_out(child: etree._Element, parent: str, where: str, faults: Faults) -> None:
    """Keep as a fault an element that could have been meant to move the robot."""
    tag = str(child.tag)
    name, shown = _local(child), shown_tag(child)
    if tag in _FREE or tag in _KNOWN[parent]:
        return
    if name in _NOT_DONE:
        faults.add(
            child,
            say(
                "{where} holds <{shown}>, which is not read: {not_done}",
                where=where,
                shown=shown,
                not_done=_NOT_DONE[name],
            ),
        )
        return
    if tag.startswith("{"):
        return
    misplaced = ("robot", "link", "joint", *(() if parent == "joint" else _MOVING))
    if name in misplaced:
        faults.add(child, _misplaced(child, where, parent))
        return
    _check_hidden(child, where, faults)


def _check_hidden(child: etree._Element, where: str, faults: Faults) -> None:
    """Keep as a fault a whole joint in an element that is left out or only draws."""
    hidden = next((one for one in child.iter("joint") if one.find("child") is not None), None)
    if hidden is not None:
        faults.add(
            child,
            say(
                "{where}: <{child}> holds a <{tag}>; put that into <robot>, or remove <{child}>",
                where=where,
                child=shown_tag(child),
                tag=str(hidden.tag),
            ),
        )


def _refuse_xacro(robot: etree._Element, joints: tuple[etree._Element, ...]) -> None:
    """Refuse xacro where it could make links and joints; in drawings it is left out."""
    for parent in (robot, *joints):
        for child in parent:
            namespace = str(child.tag).removeprefix("{").rpartition("}")[0]
            if (
                namespace.startswith(_XACRO)
                or namespace.endswith("/xacro")
                or (namespace == f"{UNDECLARED}xacro")
            ):
                message = say(
                    "the file holds <xacro:{shown}>: xacro is never evaluated by the service;"
                    " expand the file on your machine, where its packages are: denavit push"
                    " robot.urdf.xacro, or xacro robot.urdf.xacro > robot.urdf",
                    shown=shown_tag(child),
                )
                raise InvalidURDF.of([fault_at(child, message)])


def _local(element: etree._Element) -> str:
    return str(element.tag).rpartition("}")[2].lower()


def _moves(origin: etree._Element) -> bool:
    """Return whether an <origin> has any number that is not zero."""
    return bool(set("".join(map(str, origin.values()))) & set("123456789"))


@lru_cache(256)
def _meant(name: str, known: tuple[str, ...]) -> str | None:
    """Return the one of the known names that a name looks like."""
    if len(name) > 32:
        return None
    close = difflib.get_close_matches(name, known, 1, 0.7)
    return close[0] if close else None
