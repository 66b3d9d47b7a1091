"""Objects of classes of a program: how they are made, and their methods."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import attributes, harmless, links, robots
from dh_to_urdf.pasted.programs.operators import robot_of
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Function,
    Instance,
    Items,
    Method,
    Opaque,
    Robot,
    Unread,
    UserClass,
    Value,
    is_part,
)

if TYPE_CHECKING:
    from dh_to_urdf.pasted.programs.evaluation import Expressions


def has_part(arguments: Sequence[Value], keywords: dict[str, Value]) -> bool:
    """Return whether a link or a robot is among the arguments of a call."""
    return any(is_part(value) for value in (*arguments, *keywords.values()))


def call_on_robot(
    machine: Expressions, robot: Robot, name: str, arguments: list[Value], line: int
) -> Value:
    """Return what a method of a robot returns; only those that leave it as it is are read."""
    if name in ("copy", "deepcopy") and not arguments and machine.is_matlab:
        made = robots.copy_of(robot, line)
        machine.robots.append(made)
        return made
    if name in harmless.FUNCTIONS or name in harmless.ROBOT_NOTES:
        return Opaque(say("{name}() of a robot", name=name), line)
    raise refused(line, say("{name}() of the robot is not read", name=name))


def call_on_class(
    machine: Expressions,
    owner: Function,
    name: str,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    """Return what ``DHRobot.__init__(self, …)`` does, and ``Link.empty``."""
    if owner.name in robots.CLASSES and name == "__init__" and arguments:
        first = arguments[0]
        if isinstance(first, Instance):
            return _init(machine, first, arguments[1:], keywords, line)
    if owner.name in links.CLASSES and name == "empty":
        return Items([])
    if has_part(arguments, keywords):
        raise refused(
            line,
            say(
                "{owner}.{name}() takes a link or robot, and is not read",
                owner=owner.name,
                name=name,
            ),
        )
    return Opaque(say("{owner}.{name}() is not read", owner=owner.name, name=name), line)


def _init(
    machine: Expressions,
    instance: Instance,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    """Make the robot of an object whose class is a robot's."""
    arguments = [robot_of(value) for value in arguments]
    robot = robots.make_robot(
        "DHRobot", line, arguments, keywords, machine.warnings, is_matlab=machine.is_matlab
    )
    machine.robots.append(robot)
    instance.robot = robot
    for key in ("base", "tool"):
        instance.attributes.pop(key, None)
    return None


def call_on_instance(
    machine: Expressions,
    function: Method,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    """Return what a method of an object of the program returns.

    Raises:
        Unread: It has no value here.
        DHError: It is not in the text, and takes a link or a robot.
    """
    owner, name = function.owner, function.name
    assert isinstance(owner, Instance)
    if name == "super":
        raise Unread(say("super() alone is not read"))
    if function.of is not None:
        return _call_super(machine, owner, function.of, name, arguments, keywords, line)
    found = attributes.method(owner.of, name)
    if found is not None:
        has_self = machine.is_matlab and any(value is owner for value in arguments)
        given = arguments if has_self else [owner, *arguments]
        return machine.run_function(found, given, keywords, line)
    if owner.robot is not None:
        return call_on_robot(machine, owner.robot, name, arguments, line)
    touches = is_part(owner) or has_part(arguments, keywords)
    if touches and name not in harmless.FUNCTIONS:
        raise refused(
            line, say("{name}() is not in the text, and what it does is not known", name=name)
        )
    return Opaque(say("{name}() is not read", name=name), line)


def _call_super(
    machine: Expressions,
    owner: Instance,
    of: UserClass,
    name: str,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    for parent in of.parents:
        if isinstance(parent, UserClass):
            found = attributes.method(parent, name)
            if found is not None:
                return machine.run_function(found, [owner, *arguments], keywords, line)
        if isinstance(parent, Function) and parent.name in robots.CLASSES and name == "__init__":
            return _init(machine, owner, arguments, keywords, line)
    if is_part(owner) or has_part(arguments, keywords):
        raise refused(line, say("super().{name}() is not read", name=name))
    return None


def instantiate(
    machine: Expressions,
    of: UserClass,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    """Return an object of a class of the program."""
    of.used = True
    instance = Instance(of)
    machine.class_attributes(of, instance)
    name = of.definition.name if machine.is_matlab else "__init__"
    found = attributes.method(of, name)
    if found is not None:
        given = arguments if machine.is_matlab else [instance, *arguments]
        machine.run_function(found, given, keywords, line, instance=instance)
        return instance
    if makes_robot(of):
        return _init(machine, instance, arguments, keywords, line) or instance
    if has_part(arguments, keywords):
        raise refused(
            line,
            say(
                "{definition}() takes a link or robot, and is not read",
                definition=of.definition.name,
            ),
        )
    return instance


def makes_robot(of: UserClass, depth: int = 0) -> bool:
    """Return whether a class derives from a robot's class."""
    for parent in of.parents:
        if isinstance(parent, Function) and parent.name in robots.CLASSES:
            return True
        if isinstance(parent, UserClass) and depth < 8 and makes_robot(parent, depth + 1):
            return True
    return False
