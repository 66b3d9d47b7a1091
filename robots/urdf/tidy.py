"""Faults of a URDF that kinematics does not depend on: mended or left out, each with a warning.

Drawing (several materials, shapes that URDF does not have), spare attributes of an axis, stray
marks between tags, incomplete inertias, a root that floats. What may be another robot is left as it
is, and refused by :mod:`structure` and :mod:`joints`.
"""

from __future__ import annotations

import difflib
import re

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import chained, say
from dh_to_urdf.poses import from_xyz_quaternion, to_rpy
from robots.errors import InvalidURDF
from robots.urdf.markup import UNDECLARED, shown_tag
from robots.urdf.values import Element, label_of, numbers, text_of

_SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_QUATERNIONS_FROM = 1.1
"""Version of URDF that has ``quat_xyzw``."""
_VERSION = re.compile(r"[0-9]{1,3}(?:\.[0-9]{1,3})?")
_TIMING = ("acceleration", "deceleration", "jerk")
_MARKS = re.compile(r"(?:[^\W\d_]|[^\w=<>\"'/]{1,24})")
"""One letter, or marks alone."""


def tidy(robot: Element) -> tuple[str, ...]:
    """Mend a parsed URDF in place.

    Args:
        robot: The root element.

    Returns:
        What was mended or left out, one sentence a kind.

    Raises:
        InvalidURDF: A quaternion that is none, or two orientations of one origin.
    """
    notes: dict[str, list[str]] = {}
    _mend_text(robot, notes)
    _turn_quaternions(robot)
    for link in robot.findall("link"):
        where = _label(link)
        for shape in [child for child in link if child.tag in ("visual", "collision")]:
            _mend_shape(shape, link, where, notes)
        _mend_inertial(link, where, notes)
    for joint in robot.findall("joint"):
        _mend_joint(joint, _label(joint), notes)
    _cut_floating_root(robot, notes)
    prefixes = [p for p, uri in robot.nsmap.items() if p and str(uri).startswith(UNDECLARED)]
    if prefixes:
        shown = ", ".join(f"{prefix}:" for prefix in prefixes[:4])
        text = say("the prefix {shown} is not declared; what has it is left out", shown=shown)
        notes[text] = []
    return tuple(_sentence(text, places) for text, places in notes.items())


def _sentence(text: str, places: list[str]) -> str:
    """Return a warning with the first few of its places."""
    unique = list(dict.fromkeys(places))
    if not unique:
        return text
    more = say(" and {count} more", count=len(unique) - 3) if len(unique) > 3 else ""
    return say("{places}{more}: {text}", places=chained(", ", unique[:3]), more=more, text=text)


def _label(element: Element) -> str:
    return label_of(str(element.tag), element.get("name", ""))


def _mend_text(robot: Element, notes: dict[str, list[str]]) -> None:
    """Remove marks between tags that can be no part of a broken tag."""
    parts = [robot, *robot.findall("link"), *robot.findall("joint")]
    parts += [shape for link in robot.findall("link") for shape in link]
    for part in parts:
        for holder, key in ((part, "text"), *((child, "tail") for child in part)):
            text = getattr(holder, key)
            if text and text.strip() and _MARKS.fullmatch(text.strip()):
                shown = quoted(text.strip(), 24)
                notes.setdefault(
                    say("the stray text {shown} between tags is left out", shown=shown), []
                )
                setattr(holder, key, None)


def _turn_quaternions(robot: Element) -> None:
    """Write ``quat_xyzw`` of an origin as ``rpy``, where the version has it."""
    version = robot.get("version", "1.0")
    if not _VERSION.fullmatch(version) or float(version) < _QUATERNIONS_FROM:
        return
    for origin in robot.iter("origin"):
        if origin.get("quat_xyzw") is None:
            continue
        parent = origin.getparent()
        holder = parent if parent is not None and parent.get("name") else robot
        where = _label(holder)
        if origin.get("rpy") is not None:
            raise InvalidURDF(say("{where}: <origin> has rpy and quat_xyzw; keep one", where=where))
        quaternion = numbers(origin, "quat_xyzw", 4, where)
        try:
            R = from_xyz_quaternion((0.0, 0.0, 0.0), quaternion)[:3, :3]
        except ValueError as error:
            raise InvalidURDF(
                say("{where}: quat_xyzw of <origin> {error}", where=where, error=error)
            ) from None
        del origin.attrib["quat_xyzw"]
        roll, pitch, yaw = to_rpy(R)
        origin.set("rpy", text_of((roll + 0.0, pitch + 0.0, yaw + 0.0)))


def _mend_shape(shape: Element, link: Element, where: str, notes: dict[str, list[str]]) -> None:
    materials = shape.findall("material")
    if len(materials) > 1:
        for extra in materials[1:]:
            shape.remove(extra)
        text = say(
            "a <{tag}> has {count} materials, of which the first is kept",
            tag=shape.tag,
            count=len(materials),
        )
        notes.setdefault(text, []).append(where)
    geometry = shape.find("geometry")
    if geometry is None:
        return
    for mesh in geometry.findall("mesh"):
        scale = (mesh.get("scale") or "").split()
        if len(scale) == 1:
            mesh.set("scale", " ".join(scale * 3))
            text = say("a mesh has one scale, which is taken for x, y, z")
            notes.setdefault(text, []).append(where)
    foreign = [child for child in geometry if child.tag not in _SHAPES and not _is_slip(child)]
    if not foreign:
        return
    for child in foreign:
        geometry.remove(child)
        text = say(
            "<{child}> in <geometry> is no shape of URDF and is left out", child=shown_tag(child)
        )
        notes.setdefault(text, []).append(where)
    if not len(geometry):
        link.remove(shape)


def _is_slip(child: Element) -> bool:
    """Return whether an element looks like a shape that is misspelt, or is one of elsewhere."""
    name = shown_tag(child).lower()
    known = (*_SHAPES, "link", "joint", "robot", "origin", "inertial", "visual", "collision")
    return bool(difflib.get_close_matches(name, known, 1, 0.7)) or ":" in name


def _mend_inertial(link: Element, where: str, notes: dict[str, list[str]]) -> None:
    """Leave out an inertial without moments, or with some of them missing."""
    inertials = link.findall("inertial")
    for inertial in inertials if len(inertials) == 1 else ():
        mass, inertia = inertial.find("mass"), inertial.find("inertia")
        missing = [] if inertia is None else [k for k in _MOMENTS if inertia.get(k) is None]
        slips = [] if inertia is None else [k for k in inertia.attrib if k not in _MOMENTS]
        if (mass is None or inertia is None or missing) and not slips:
            link.remove(inertial)
            text = say("its <inertial> is incomplete and is left out; kinematics does not use it")
            notes.setdefault(text, []).append(where)


def _mend_joint(joint: Element, where: str, notes: dict[str, list[str]]) -> None:
    axis = joint.find("axis")
    if axis is not None and axis.get("xyz") is not None:
        for key in [key for key in axis.attrib if key != "xyz"]:
            del axis.attrib[key]
            text = say("the attribute {key} of <axis> is left out", key=quoted(str(key)))
            notes.setdefault(text, []).append(where)
    limit = joint.find("limit")
    found = [] if limit is None else [k for k in limit.attrib if _local(str(k)) in _TIMING]
    if found:
        names = chained(say(" and "), dict.fromkeys(_local(str(key)) for key in found))
        text = say(
            "{names} in <limit>: left out; retime takes acceleration with the request", names=names
        )
        notes.setdefault(text, []).append(where)


def _local(name: str) -> str:
    return name.rpartition("}")[2]


def _cut_floating_root(robot: Element, notes: dict[str, list[str]]) -> None:
    """Take the child of a floating or planar joint at the root as the base."""
    joints = robot.findall("joint")
    ends = [(joint, _end(joint, "parent"), _end(joint, "child")) for joint in joints]
    children = [child for _, _, child in ends]
    for joint, parent, child in ends:
        type_ = joint.get("type")
        if type_ not in ("floating", "planar") or parent is None or parent == child:
            continue
        if parent in children or sum(p == parent for _, p, _ in ends) > 1 or len(ends) < 2:
            continue
        roots = [link for link in robot.findall("link") if link.get("name") == parent]
        if len(roots) != 1:
            continue
        robot.remove(joint)
        robot.remove(roots[0])
        text = say(
            "{joint} is {type}, so that the pose of the robot is free: link {child} is taken as"
            " the base, and link {parent} is left out",
            joint=_label(joint),
            type=type_,
            child=quoted(child),
            parent=quoted(parent),
        )
        notes[text] = []
        return


def _end(joint: Element, role: str) -> str | None:
    found = joint.find(role)
    return found.get("link") if found is not None else None
