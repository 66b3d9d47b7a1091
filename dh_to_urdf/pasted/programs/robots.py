"""Robots of the Robotics Toolbox: ``SerialLink(L, 'name', 'arm')``, ``DHRobot(L, tool=T)``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.arrays import as_array
from dh_to_urdf.pasted.programs.harmless import ROBOT_NOTES
from dh_to_urdf.pasted.programs.links import as_vector, from_vector, limits_of, set_link, shown
from dh_to_urdf.pasted.programs.poses import pose_matrix
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Array,
    Items,
    Link,
    Opaque,
    Placed,
    Robot,
    Unread,
    Value,
)
from dh_to_urdf.poses import Matrix

CLASSES = ("SerialLink", "DHRobot")
_NOTES = frozenset((*ROBOT_NOTES, "ikine", "nofast", "plotopt3d", "manufacturer", "comment"))
MAX_LINKS = 301


def make_robot(
    name: str,
    line: int,
    arguments: Sequence[Value],
    keywords: dict[str, Value],
    warnings: list[str],
    *,
    is_matlab: bool,
) -> Robot:
    """Return the robot that a class makes.

    Args:
        name: The class.
        line: Where it stands.
        arguments: Links, a matrix or robots, then pairs of a name and a value.
        keywords: Named values, as in Python.
        warnings: Receives what was assumed.
        is_matlab: Whether the program is MATLAB.

    Raises:
        DHError: An argument that is not read.
    """
    options: list[tuple[str, Value]] = list(keywords.items())
    waiting = list(arguments)
    first = [waiting.pop(0)] if waiting and not isinstance(waiting[0], str) else []
    while waiting:
        key = waiting.pop(0)
        if isinstance(key, str) and key.lower() in ("modified", "mdh", "standard", "nofast"):
            options.append((key.lower(), True))
        elif isinstance(key, str) and waiting:
            options.append((key, waiting.pop(0)))
        else:
            raise refused(
                line,
                say("{name} has an argument {key} that is not read", name=name, key=shown(key)),
            )
    links = [value for key, value in options if key in ("links", "L")]
    options = [(key, value) for key, value in options if key not in ("links", "L")]
    first += links
    modified = next((True for key, _ in options if key in ("modified", "mdh")), None)
    robot = Robot(line, [], np.eye(4), np.eye(4), modified=modified)
    if first:
        _take(robot, first[0], line, is_matlab=is_matlab)
    for key, value in options:
        if key in ("modified", "mdh", "standard", "nofast"):
            continue
        if key in ("base", "tool") and value is None:
            continue
        set_robot(robot, key, value, line, warnings, is_matlab=is_matlab)
    return robot


def _take(robot: Robot, value: Value, line: int, *, is_matlab: bool) -> None:
    """Give a robot its links."""
    if isinstance(value, Array) and value.elements:
        if value.flat:
            raise refused(line, say("a robot is made of a list of links, or of a matrix of them"))
        for row in value.rows:
            vector = as_vector(Array((row,)), line)
            robot.links.append(from_vector(vector, value.line or line, robot.modified))
    elif isinstance(value, Link) and is_matlab:
        robot.links.append(value)
    elif isinstance(value, Robot) and is_matlab:
        copied_robot = copy_of(value, line)
        robot.links, robot.base, robot.tool = (
            copied_robot.links,
            copied_robot.base,
            copied_robot.tool,
        )
        robot.name = value.name
    elif isinstance(value, Items):
        if is_matlab and value.items and all(isinstance(item, Robot) for item in value.items):
            _join(robot, [item for item in value.items if isinstance(item, Robot)])
            return
        for item in value.items:
            if isinstance(item, Link):
                robot.links.append(item)
            elif isinstance(item, Robot) and not is_matlab:
                item.used = True
                robot.links += item.links
            else:
                raise refused(
                    line, say("the list of links holds a value {item}", item=_unknown(item))
                )
    elif not isinstance(value, Array):
        raise refused(line, say("the robot is made of a value {value}", value=_unknown(value)))
    if len(robot.links) > MAX_LINKS:
        raise refused(line, say("the robot has too many links"))
    if not is_matlab and len({id(link) for link in robot.links}) < len(robot.links):
        raise refused(line, say("one link stands twice in the list; make each link of its own"))


def _unknown(value: Value) -> str:
    if isinstance(value, Opaque):
        return say("that is not known ({why}, line {line})", why=value.why, line=value.line)
    if value.__class__.__name__ == "Unresolved":
        return say("{value} that is not made", value=quoted(getattr(value, "name", "")))
    return say("that is no link ({value})", value=shown(value))


def _join(robot: Robot, others: Sequence[Robot]) -> None:
    """Take the links of robots, the base of the first and the tool of the last, as MATLAB does."""
    for other in others:
        other.used = True
        robot.links += [copied(link) for link in other.links]
    robot.base, robot.tool = others[0].base, others[-1].tool
    robot.name = others[0].name


def copied(link: Link) -> Link:
    """Return a link of its own with the same properties."""
    return Link(
        link.line,
        dict(link.numbers),
        link.type,
        link.modified,
        link.flipped,
        link.limits,
        link.is_fixed,
    )


def copy_of(robot: Robot, line: int) -> Robot:
    """Return a robot of its own with copies of the links."""
    return Robot(
        line,
        [copied(link) for link in robot.links],
        robot.base,
        robot.tool,
        robot.name,
        robot.modified,
    )


def appended(robot: Robot, other: Robot | Link, line: int) -> Robot:
    """Return ``robot + other`` of Python: its base and tool stay."""
    robot.used = True
    added = [other] if isinstance(other, Link) else list(other.links)
    if isinstance(other, Robot):
        other.used = True
    return Robot(line, [*robot.links, *added], robot.base, robot.tool, robot.name, robot.modified)


def multiplied(robot: Robot, other: Robot, line: int) -> Robot:
    """Return ``robot * other`` of MATLAB."""
    joined = Robot(line, [], np.eye(4), np.eye(4), modified=robot.modified)
    _join(joined, [robot, other])
    return joined


def set_robot(
    robot: Robot, key: str, value: Value, line: int, warnings: list[str], *, is_matlab: bool
) -> None:
    """Set a property of a robot.

    Raises:
        DHError: A property that moves the robot and is not read.
    """
    if key in ("base", "tool"):
        nothing = value is None and key == "tool"
        matrix = np.eye(4) if nothing else placement(key, value, line)
        if key == "base":
            robot.base = matrix
        else:
            robot.tool = matrix
        if isinstance(value, Array) and not is_matlab:
            robot.held.append(value)
    elif key == "name":
        if isinstance(value, str):
            robot.name = value
    elif key in ("offset", "qlim") and (is_matlab or key == "qlim"):
        _set_column(robot, key, value, line, warnings, is_matlab=is_matlab)
    elif key not in _NOTES:
        raise refused(line, say("{key} of the robot is set, which is not read", key=quoted(key)))


def placement(key: str, value: Value, line: int) -> Matrix:
    """Return a base or tool that a program gives.

    Raises:
        DHError: It is no 4x4 matrix of numbers.
    """
    try:
        matrix = pose_matrix(value)
    except Unread as error:
        raise refused(line, say("{key} {error}", key=key, error=error)) from None
    if matrix is None and isinstance(value, Array) and not value.elements:
        return np.eye(4)
    if matrix is None:
        why = (
            say(" ({why}, line {line})", why=value.why, line=value.line)
            if isinstance(value, Opaque)
            else ""
        )
        raise refused(
            line,
            say(
                "{key} is set to a value that is not read{why}; write transl(0, 0,"
                " 0.1), SE3(0, 0, 0.1) or a 4x4 matrix of numbers",
                key=key,
                why=why,
            ),
        )
    return matrix


def _set_column(
    robot: Robot, key: str, value: Value, line: int, warnings: list[str], *, is_matlab: bool
) -> None:
    """Set offsets or limits of all links."""
    try:
        array = as_array(value)
    except Unread as error:
        raise refused(line, say("{key} of the robot {error}", key=key, error=error)) from None
    n = len(robot.links)
    if key == "offset":
        if len(array.elements) != n:
            raise refused(line, say("offset of the robot has not {n} numbers", n=n))
        for link, element in zip(robot.links, array.elements, strict=True):
            set_link(link, "offset", element, line, warnings)
        return
    rows = array.rows if is_matlab else tuple(zip(*array.rows, strict=True))
    if array.flat or array.shape != ((n, 2) if is_matlab else (2, n)):
        raise refused(line, say("qlim of the robot has not {n} pairs of numbers", n=n))
    for link, row in zip(robot.links, rows, strict=True):
        link.limits = limits_of(Array((row,)), line)


def column_of(robot: Robot, key: str, *, is_matlab: bool) -> Value:
    """Return a property of all links as an array.

    Raises:
        Unread: Limits that are not all given.
    """
    if key == "qlim":
        pairs = [link.limits for link in robot.links]
        if None in pairs:
            raise Unread(say("qlim is not given for every link"))
        rows = tuple((pair[0].value, pair[1].value) for pair in pairs if pair)
        return Array(rows if is_matlab else tuple(zip(*rows, strict=True)))
    zero = Placed(Sum(), robot.line)
    row = tuple(link.numbers.get(key, zero).value for link in robot.links)
    return Array((row,), flat=not is_matlab)
