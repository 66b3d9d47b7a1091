"""Judges what the gate does with a document: refused in clear words, or computed right.

The document is read a second time by another parser (expat) and another forward kinematics
(elementary matrices), straight from its own elements and from the canonical text.
"""

from __future__ import annotations

import codecs
import math
import random
import re
import time
import unicodedata
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np

from kinematics.forward import fk
from robots.errors import RobotError
from robots.robot import Robot, robot_from_urdf
from robots.urdf import MAX_DOF, MAX_LINKS
from tests.cost import within

SECONDS = 1.0
TOLERANCE = 1e-9
NOT_READ = ("gazebo", "transmission", "ros2_control", "sensor")
_NAMED = re.compile(r"['<\d]|root|name|link|joint|XML|DOCTYPE")
_FOREIGN = re.compile(r"lxml|libxml|urdfdom|site-packages|Traceback|/work|/home|/usr|\bpin\b", re.I)


@dataclass
class Joint:
    """A joint as the second reading sees it."""

    element: ET.Element
    name: str
    type: str
    parent: str
    child: str


def judge(document: bytes, rng: random.Random) -> str:
    """``refused`` or ``accepted``.

    Raises:
        AssertionError: Neither is right; the message says why.
    """
    started = time.thread_time()
    try:
        robot = robot_from_urdf(document)
    except RobotError as error:
        outcome = error
    else:
        outcome = None
    seconds = time.thread_time() - started
    assert within(seconds, SECONDS), f"took {seconds:.2f} s"
    if outcome is not None:
        check_message(str(outcome))
        return "refused"
    check_robot(robot, document, rng)
    return "accepted"


def check_message(message: str) -> None:
    """Short, in one line, clean, ours, and about something."""
    assert 10 < len(message) < 400, f"message of {len(message)} characters: {message[:100]!r}"
    odd = [c for c in message if unicodedata.category(c) in ("Cc", "Cf", "Cs", "Zl", "Zp", "Co")]
    assert not odd, f"message holds {odd!r}"
    assert _NAMED.search(message), f"message names nothing: {message}"
    assert not _FOREIGN.search(message), f"message of another's: {message}"


def check_robot(robot: Robot, document: bytes, rng: random.Random) -> None:
    """The robot is that of the document, whichever way it is read."""
    assert 1 <= robot.dof <= MAX_DOF
    assert 2 <= len(robot.frames) <= MAX_LINKS
    for warning in robot.warnings:
        check_message(warning)
    original, canonical = _grounded(_second_reading(document), robot), ET.fromstring(robot.urdf)
    # Planar joints are three in the canonical text; tests/robots/urdf/test_standing.py has them.
    readings = [canonical]
    if not any("is planar: it is read as" in warning for warning in robot.warnings):
        readings.append(original)
        _check_nothing_is_lost(robot, original)
        _check_limits(robot, original)
    q = np.array([rng.uniform(-3, 3) for _ in range(robot.dof)])
    by_name = dict(zip((joint.name for joint in robot.joints), q, strict=True))
    found = fk(robot, q, robot.frames)
    for reading in readings:
        origins = (element for element in _read(reading) if element.tag == "origin")
        scale = 1.0 + sum(abs(float(word)) for o in origins for word in o.get("xyz", "0").split())
        expected = frames(reading, by_name)
        assert set(expected) == set(found), "other links"
        base = np.linalg.inv(expected[robot.base_frame])
        for name, T in expected.items():
            assert np.isfinite(found[name]).all(), f"{name} is not finite"
            off = float(np.abs(found[name] - base @ T).max())
            assert off < TOLERANCE * scale, f"frame {name!r} is off by {off:g}"
    again = robot_from_urdf(robot.urdf, base=robot.base_frame, tip=robot.tip_frame)
    assert again.revision == robot.revision, "the canonical text is not its own"


def _second_reading(document: bytes) -> ET.Element:
    """The document's root by expat, which takes neither blanks before a declaration nor marks."""
    for mark, encoding in (
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
        (codecs.BOM_UTF8, "utf-8-sig"),
    ):
        if document.startswith(mark):
            return ET.fromstring(re.sub(r"^\s*<\?xml .*?\?>", "", document.decode(encoding)))
    # A mark within a name of what is left out: a letter since XML 1.0's fifth edition only.
    document = re.sub(rb"""(<\?xml\s+version\s*=\s*["'])[^"']*""", rb"\g<1>1.0", document)
    document = document.strip().replace(codecs.BOM_UTF8, b"")
    try:
        return ET.fromstring(document)
    except ET.ParseError:  # of a declaration with odd attributes
        return ET.fromstring(re.sub(rb"^\s*<\?xml .*?\?>", b"", document))


def _grounded(root: ET.Element, robot: Robot) -> ET.Element:
    """The document without what a joint that floats cuts off the robot."""
    if any("so that the pose of the robot is free" in warning for warning in robot.warnings):
        for link in root.findall("link"):
            if link.get("name") not in robot.frames:
                root.remove(link)
        for joint in root.findall("joint"):
            ends = (joint.find("parent").get("link"), joint.find("child").get("link"))
            if not set(ends) <= set(robot.frames):
                root.remove(joint)
    return root


def _check_nothing_is_lost(robot: Robot, root: ET.Element) -> None:
    read = _read(root)
    links = [element.get("name") for element in read if element.tag == "link"]
    joints = [element.get("name") for element in read if element.tag == "joint"]
    assert list(robot.frames) == links, "links are lost"
    moving = [e.get("name") for e in read if e.tag == "joint" and e.get("type") != "fixed"]
    mimics = {e.get("name") for e in read if e.tag == "joint" and e.find("mimic") is not None}
    assert len(set(joints)) == len(joints) == len(links) - 1, "joints are lost"
    names = [joint.name for joint in robot.joints]
    assert [name for name in moving if name in names or name not in mimics] == names


def _read(root: ET.Element) -> list[ET.Element]:
    """The links and joints beside each other, and what these joints hold."""
    found = [root]
    for element in root:
        if element.tag in ("link", "joint"):
            found.append(element)
        if element.tag == "joint":
            found += [part for part in element if part.tag not in NOT_READ]
    return found


def _check_limits(robot: Robot, root: ET.Element) -> None:
    elements = {element.get("name"): element for element in root.findall("joint")}
    if any(element.find("mimic") is not None for element in elements.values()):
        return
    for joint in robot.joints:
        limit = elements[joint.name].find("limit")
        for key, value in (("lower", joint.lower), ("upper", joint.upper)):
            if joint.type == "continuous":
                assert value is None, f"{key} of {joint.name!r}"
            else:
                said = float(limit.get(key))
                assert value == (None if abs(said) >= 1e6 else said), f"{key} of {joint.name!r}"


def frames(root: ET.Element, q: dict[str, float]) -> dict[str, np.ndarray]:
    """Poses of all links in the root's axes, from elementary matrices."""
    joints = [
        Joint(
            e,
            e.get("name"),
            e.get("type"),
            e.find("parent").get("link"),
            e.find("child").get("link"),
        )
        for e in root.findall("joint")
    ]
    by_name = {joint.name: joint for joint in joints}
    above = {joint.child: joint for joint in joints}
    found: dict[str, np.ndarray] = {}

    def value(joint: Joint) -> float:
        if joint.name in q:
            return q[joint.name]
        mimic = joint.element.find("mimic")
        multiplier, offset = (float(mimic.get(k, d)) for k, d in (("multiplier", 1), ("offset", 0)))
        return multiplier * value(by_name[mimic.get("joint")]) + offset

    for link in root.findall("link"):
        path, name = [], link.get("name")
        while name in above and name not in found:
            path.append(name)
            name = above[name].parent
            assert len(path) <= len(joints), "a loop"
        T = found.get(name, np.eye(4))
        found[name] = T
        for child in reversed(path):
            joint = above[child]
            T = T @ _origin(joint.element) @ _motion(joint, value)
            found[child] = T
    return found


def _origin(element: ET.Element) -> np.ndarray:
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    x, y, z = (float(word) for word in origin.get("xyz", "0 0 0").split())
    roll, pitch, yaw = (float(word) for word in origin.get("rpy", "0 0 0").split())
    T = _turn((0, 0, 1), yaw) @ _turn((0, 1, 0), pitch) @ _turn((1, 0, 0), roll)
    T[:3, 3] = x, y, z
    return T


def _motion(joint: Joint, value) -> np.ndarray:
    if joint.type == "fixed":
        return np.eye(4)
    element = joint.element.find("axis")
    words = "1 0 0" if element is None else element.get("xyz", "1 0 0")
    axis = np.array([float(word) for word in words.split()])
    axis = axis / math.sqrt(float(axis @ axis))
    if joint.type == "prismatic":
        T = np.eye(4)
        T[:3, 3] = value(joint) * axis
        return T
    return _turn(axis, value(joint))


def _turn(axis, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    T = np.eye(4)
    T[:3, :3] += math.sin(angle) * K + (1 - math.cos(angle)) * K @ K
    return T
