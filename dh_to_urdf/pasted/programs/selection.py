"""The one robot that a program makes, out of what its variables hold at its end."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.messages import chained, say
from dh_to_urdf.pasted.programs import bodies, instances, tree
from dh_to_urdf.pasted.programs.execution import Statements
from dh_to_urdf.pasted.programs.library import CONSTRUCTORS
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Instance,
    Items,
    Link,
    Opaque,
    Robot,
    Tree,
    Unread,
    UserClass,
    UserFunction,
    Value,
    parts_of,
)

_NUMBERED = re.compile(r"(.*?)([0-9]{1,4})")


def robot_of(machine: Statements, name: str | None) -> Robot | None:
    """Return the robot that a program makes, None where it makes none.

    Args:
        machine: The program at its end.
        name: The name that the user wants, to choose one of several.

    Raises:
        DHError: It makes several, or its links are not of one list.
    """
    robots = list(_robots(machine))
    if not robots:
        robots = list(_of_definitions(machine)) or list(_robots(machine))
    if len(robots) > 1 and name is not None:
        robots = [r for r in robots if name in (r.name, r.title)] or robots
    if len(robots) > 1:
        shown = chained(
            ", ",
            (
                say("{robot} (line {line})", robot=_title(robot), line=robot.line)
                for robot in robots[:6]
            ),
        )
        raise DHError.single(
            (),
            say(
                "the text makes {count} robots: {shown}; paste one, or give name= of one",
                count=len(robots),
                shown=shown,
            ),
        )
    if robots:
        if not robots[0].links:
            raise refused(
                robots[0].line, say("the robot {robot} has no links", robot=_title(robots[0]))
            )
        return robots[0]
    links = _links(machine)
    return Robot(links[0].line, links, np.eye(4), np.eye(4)) if links else None


def _title(robot: Robot) -> str:
    return quoted(robot.title or robot.name or "robot")


def _held(machine: Statements) -> Iterator[Value]:
    """Return what the variables hold, and what stands alone."""
    yield from machine.scopes[-1].values()
    yield from machine.loose


def _robots(machine: Statements) -> Iterator[Robot]:
    seen: set[int] = set()
    for value in _held(machine):
        for part in parts_of(value):
            if isinstance(part, Robot) and id(part) not in seen and not part.used:
                seen.add(id(part))
                yield part
    if seen:
        return
    rows = [joint for joint in machine.joints if joint.row is not None]
    trees = [t for t in machine.trees if t.bodies] or machine.trees[-1:]
    for found in trees:
        if found.bodies or rows:
            yield bodies.robot_of(found, rows)
    if rows and not trees:
        yield bodies.robot_of(Tree(rows[0].line), rows)


def _of_definitions(machine: Statements) -> Iterator[Robot]:
    """Make robots of classes and functions of the text that nothing calls."""
    defined = [*machine.scopes[-1].values(), *machine.functions.values()]
    classes = {id(v): v for v in defined if isinstance(v, UserClass) and not v.used}
    parents = {id(parent) for v in classes.values() for parent in v.parents}
    for key, value in classes.items():
        if key in parents or not (instances.makes_robot(value) or _makes(value.definition)):
            continue
        line = value.definition.line
        try:
            found = instances.instantiate(machine, value, [], {}, line)
        except Unread as error:
            raise refused(
                line,
                say("class {definition}: {error}", definition=value.definition.name, error=error),
            ) from None
        yield from _named(found, value.definition.name)
    if classes:
        return
    functions = {id(v): v for v in defined if isinstance(v, UserFunction)}
    for function in functions.values():
        if not _makes(function.definition):
            continue
        line = function.definition.line
        try:
            found = machine.run_function(function, [], {}, line)
        except Unread as error:
            raise refused(
                line,
                say(
                    "function {definition}: {error}",
                    definition=function.definition.name,
                    error=error,
                ),
            ) from None
        yield from _named(found, function.definition.name)


def _makes(node: tree.Node) -> bool:
    names = (getattr(part, "name", "") for part in tree.nodes_of(node))
    return any(name in CONSTRUCTORS for name in names)


def _named(value: Value, title: str) -> Iterator[Robot]:
    seen: set[int] = set()
    for part in parts_of(value):
        if isinstance(part, Robot) and not part.used and id(part) not in seen:
            seen.add(id(part))
            part.title = part.title or title
            yield part


def _links(machine: Statements) -> list[Link]:
    """Return the links of a text that makes no robot of them.

    Raises:
        DHError: They are not of one list.
    """
    lists: list[tuple[str, list[Link]]] = []
    single: list[tuple[str, Link]] = []
    named = [*machine.scopes[-1].items(), *(("", value) for value in machine.loose)]
    for name, value in named:
        if isinstance(value, Link):
            single.append((name, value))
        elif isinstance(value, Instance):
            named += value.attributes.items()
        elif isinstance(value, Items) and any(isinstance(v, Link) for v in value.items):
            lists.append((name, _of_list(name, value)))
    if len(lists) > 1 and all(not name for name, _ in lists):
        lists = [("", [link for _, links in lists for link in links])]
    longest = max((links for _, links in lists), key=len, default=[])
    inside = {id(link) for link in longest}
    others = [link for _, links in lists for link in links] + [link for _, link in single]
    if longest:
        stray = next((link for link in others if id(link) not in inside), None)
        same = [links for _, links in lists if len(links) == len(longest)]
        if stray is not None or any(links != longest for links in same):
            line = stray.line if stray is not None else longest[0].line
            raise refused(
                line,
                say(
                    "the text holds several lists of links and makes no robot; paste the"
                    " line that makes it (SerialLink or DHRobot)"
                ),
            )
        return longest
    return _in_order(single)


def _of_list(name: str, value: Items) -> list[Link]:
    found = []
    for k, item in enumerate(value.items, start=1):
        if not isinstance(item, Link):
            why = (
                say("line {line}: {why}", line=item.line, why=item.why)
                if isinstance(item, Opaque)
                else say("it is not made")
            )
            raise DHError.single(
                (),
                say(
                    "link {k} of {name} is missing; {why}",
                    k=k,
                    name=name or say("the list"),
                    why=why,
                ),
            )
        found.append(item)
    return found


def _in_order(single: list[tuple[str, Link]]) -> list[Link]:
    """Return single links in the order of the numbers of their names, or of the text."""
    unique = list({id(link): (name, link) for name, link in single}.values())
    numbers = [_NUMBERED.fullmatch(name) for name, _ in unique]
    stems = {match[1] for match in numbers if match}
    if not unique or not all(numbers) or len(stems) != 1:
        return [link for _, link in sorted(unique, key=lambda pair: pair[1].line)]
    found = sorted((int(match[2]), k) for k, match in enumerate(numbers) if match)
    start = found[0][0]
    if start > 1:
        raise DHError.single((), say("the links start at {start}; link 1 is missing", start=start))
    for expected, (number, k) in enumerate(found, start=start):
        if number != expected:
            raise refused(
                unique[k][1].line,
                say(
                    "link {number} stands where {expected} is due", number=number, expected=expected
                ),
            )
    return [unique[k][1] for _, k in found]
