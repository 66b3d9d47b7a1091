"""URDF text -> the serial chain between two of its links.

Reads joints with their origins, axes and limits, and nothing else. Use it for trusted texts: those
of strangers need a full check first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from dh_to_urdf.couplings import CouplingError, MovingJoint, joint_map
from dh_to_urdf.errors import DHError, DHSyntaxError, quoted
from dh_to_urdf.extraction.axes import ChainJoint, SerialChain
from dh_to_urdf.extraction.dependences import depending
from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix, from_xyz_rpy
from dh_to_urdf.table import JointType, Limits, Mimic
from dh_to_urdf.writer import UNBOUNDED

MAX_BYTES = 20_000_000
_MOVING = ("revolute", "prismatic", "continuous")


@dataclass(frozen=True)
class _Joint:
    element: ET.Element
    name: str
    type: str
    parent: str
    child: str


def read_chain(text: str | bytes, base: str | None = None, tip: str | None = None) -> SerialChain:
    """Read the chain from one link of a URDF to another.

    A chain may run up the tree and down again; the axis of a joint on the way up is reversed, so
    that q keeps its meaning.

    Args:
        text: The URDF.
        base: Link to start from; default the root.
        tip: Link to end at; default the leaf with most moving joints before it.

    Raises:
        DHError: Not a URDF, an unknown link, or a joint on the way that has no D-H row.
    """
    root = _parse(text)
    links = [link.get("name", "") for link in root.findall("link")]
    joints = [_joint(element) for element in root.findall("joint")]
    above = _tree(links, joints)
    for role, link in (("base", base), ("tip", tip)):
        if link is not None and link not in links:
            known = ", ".join(links[:12])
            raise DHError.single(
                (role,),
                say(
                    "{role} is {link}, which is no link; known are {known}",
                    role=role,
                    link=quoted(link),
                    known=known,
                ),
            )
    start = next(link for link in links if link not in above) if base is None else base
    end = _default_tip(links, above) if tip is None else tip
    up, down = _path(above, start), _path(above, end)
    while up and down and up[0] is down[0]:
        up, down = up[1:], down[1:]
    warnings: list[str] = []
    T = np.eye(4)
    found: list[ChainJoint] = []
    for joint in reversed(up):
        # inv(placement M(q)) = M(-q) inv(placement): the same motion about the opposite axis.
        if joint.type != "fixed":
            found.append(_chain_joint(joint, T, -1.0, warnings))
            T = np.eye(4)
        T = T @ _inverse(_origin(joint))
    for joint in down:
        T = T @ _origin(joint)
        if joint.type != "fixed":
            found.append(_chain_joint(joint, T, 1.0, warnings))
            T = np.eye(4)
    if not found:
        raise DHError.single(
            ("tip",), say("no joint moves between {start!r} and {end!r}", start=start, end=end)
        )
    name = root.get("name") or "robot"
    chain = SerialChain(name, start, end, tuple(found), T, tuple(warnings))
    moving = [_moving(joint) for joint in joints if joint.type in _MOVING]
    if not any(joint.mimic for joint in moving):
        return chain
    fixed = [joint.name for joint in joints if joint.type not in _MOVING]
    try:
        joint_map(moving, fixed)
    except CouplingError as error:
        raise DHError.single((), str(error)) from None
    return depending(chain, moving)


def _moving(joint: _Joint) -> MovingJoint:
    """Return what a joint depends on."""
    type_, element = JointType(joint.type), joint.element.find("mimic")
    if element is None:
        return MovingJoint(joint.name, type_, Limits())
    where = say("joint {joint!r}", joint=joint.name)
    multiplier, offset = (
        _numbers(element, key, 1, where, default)[0]
        for key, default in (("multiplier", "1"), ("offset", "0"))
    )
    return MovingJoint(
        joint.name, type_, Limits(), Mimic(element.get("joint", ""), multiplier, offset)
    )


def _parse(text: str | bytes) -> ET.Element:
    if len(text) > MAX_BYTES:
        raise DHError.single(
            (), say("the URDF is longer than {max_bytes} bytes", max_bytes=MAX_BYTES)
        )
    if (b"<!ENTITY" if isinstance(text, bytes) else "<!ENTITY") in text:  # type: ignore[operator]
        raise DHSyntaxError.single((), say("the URDF has entities; remove them"))
    try:
        root = ET.fromstring(text)
    except (ET.ParseError, ValueError, LookupError) as error:
        raise DHSyntaxError.single(
            (), say("the text is not well-formed XML: {error}", error=error)
        ) from None
    if root.tag != "robot":
        raise DHError.single(
            (), say("the root element is <{tag}>; a URDF starts with <robot>", tag=root.tag[:40])
        )
    return root


def _joint(element: ET.Element) -> _Joint:
    name = element.get("name", "")
    ends = []
    for role in ("parent", "child"):
        end = element.find(role)
        link = end.get("link") if end is not None else None
        if link is None:
            raise DHError.single(
                (), say("joint {name!r}: <{role} link=…> is missing", name=name, role=role)
            )
        ends.append(link)
    return _Joint(element, name, element.get("type", ""), *ends)


def _tree(links: list[str], joints: list[_Joint]) -> dict[str, _Joint]:
    """Return the joint above each link, after checking that the joints form one tree."""
    above: dict[str, _Joint] = {}
    for joint in joints:
        for link in (joint.parent, joint.child):
            if link not in links:
                raise DHError.single(
                    (),
                    say(
                        "joint {joint!r}: link {link!r} does not exist",
                        joint=joint.name,
                        link=link[:64],
                    ),
                )
        if joint.child in above:
            raise DHError.single(
                (),
                say(
                    "link {child!r} is the child of two joints; a robot is a tree",
                    child=joint.child,
                ),
            )
        above[joint.child] = joint
    roots = [link for link in links if link not in above]
    if len(roots) != 1:
        raise DHError.single(
            (), say("the URDF has {count} root links; a robot is a tree with one", count=len(roots))
        )
    for link in links:
        seen, walked = link, 0
        while seen in above:
            seen, walked = above[seen].parent, walked + 1
            if walked > len(joints):
                raise DHError.single(
                    (), say("link {link!r} is part of a loop; a robot is a tree", link=link)
                )
    return above


def _path(above: dict[str, _Joint], link: str) -> list[_Joint]:
    path = []
    while link in above:
        path.append(above[link])
        link = above[link].parent
    return path[::-1]


def _default_tip(links: list[str], above: dict[str, _Joint]) -> str:
    parents = {joint.parent for joint in above.values()}

    def length(leaf: str) -> tuple[int, int]:
        path = _path(above, leaf)
        return sum(joint.type != "fixed" for joint in path), len(path)

    return max((link for link in links if link not in parents), key=length)


def _chain_joint(joint: _Joint, placement: Matrix, sense: float, warnings: list[str]) -> ChainJoint:
    where = say("joint {joint!r}", joint=joint.name)
    if joint.type not in _MOVING:
        raise DHError.single(
            (),
            say(
                "{where}: type {type!r} has no D-H row; write it as revolute,"
                " prismatic, continuous or fixed joints, or choose base and tip so that"
                " it is not between",
                where=where,
                type=joint.type[:40],
            ),
        )
    element = joint.element.find("axis")
    axis = np.array([1.0, 0.0, 0.0] if element is None else _numbers(element, "xyz", 3, where))
    norm = float(np.linalg.norm(axis))
    if norm < 1e-6:
        raise DHError.single(
            (), say("{where}: its axis is zero; give a direction such as 0 0 1", where=where)
        )
    axis = sense * axis / norm
    limits = _limits(joint, where, warnings)
    return ChainJoint(joint.name, JointType(joint.type), placement, axis, limits)


def _limits(joint: _Joint, where: str, warnings: list[str]) -> Limits:
    element = joint.element.find("limit")
    values: dict[str, float] = {}
    for key in ("lower", "upper", "velocity", "effort") if element is not None else ():
        if element is not None and element.get(key) is not None:
            values[key] = _numbers(element, key, 1, where)[0]
    known = {key: value for key, value in values.items() if abs(value) < UNBOUNDED}
    bounded = "lower" in known and "upper" in known
    if joint.type == "continuous" or not bounded:
        known.pop("lower", None)
        known.pop("upper", None)
        if joint.type != "continuous" and not {"lower", "upper"} <= set(values):
            warnings.append(
                say("{where} has no lower and upper limit; none is assumed", where=where)
            )
    elif known["lower"] > known["upper"]:
        raise DHError.single(
            (), say("{where}: its lower limit is above the upper one; swap them", where=where)
        )
    return Limits(**known)


def _origin(joint: _Joint) -> Matrix:
    origin = joint.element.find("origin")
    if origin is None:
        return np.eye(4)
    where = say("joint {joint!r}", joint=joint.name)
    xyz, rpy = (_numbers(origin, key, 3, where, "0 0 0") for key in ("xyz", "rpy"))
    return from_xyz_rpy(xyz, rpy)


def _numbers(
    element: ET.Element, key: str, count: int, where: str, default: str = ""
) -> list[float]:
    text = element.get(key, default)
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        what = (
            say("one finite number") if count == 1 else say("{count} finite numbers", count=count)
        )
        raise DHError.single(
            (),
            say(
                "{where}: {key} of <{tag}> is {text}; give {what}",
                where=where,
                key=key,
                tag=element.tag,
                text=quoted(text),
                what=what,
            ),
        )
    return values


def _inverse(T: Matrix) -> Matrix:
    result = np.eye(4)
    result[:3, :3] = T[:3, :3].T
    result[:3, 3] = -T[:3, :3].T @ T[:3, 3]
    return result
