"""Calls of a program: constructors, functions of libraries and of the program, methods."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh_to_urdf.cells.arithmetic import Sum, variable_of
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import (
    array_functions,
    bodies,
    frames,
    harmless,
    library,
    links,
    list_methods,
    numbers,
    poses,
    robots,
)
from dh_to_urdf.pasted.programs.instances import (
    call_on_class,
    call_on_instance,
    call_on_robot,
    has_part,
    instantiate,
)
from dh_to_urdf.pasted.programs.operators import robot_of
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Array,
    Body,
    Function,
    Instance,
    Items,
    Joint,
    Link,
    Method,
    Opaque,
    Pose,
    Robot,
    Tree,
    Unread,
    Unresolved,
    UserClass,
    UserFunction,
    Value,
    is_part,
    number,
)

if TYPE_CHECKING:
    from dh_to_urdf.pasted.programs.evaluation import Expressions


def call(
    machine: Expressions,
    function: Value,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
    wanted: int = 1,
) -> Value:
    """Return what a call returns.

    Args:
        machine: Where it is evaluated.
        function: What is called.
        arguments: Its arguments.
        keywords: Its named arguments.
        line: Where it stands.
        wanted: Number of values that MATLAB asks for.

    Raises:
        Unread: It has no value here.
        DHError: It takes a link or a robot, and its effect is not known.
    """
    if isinstance(function, UserFunction):
        return machine.run_function(function, arguments, keywords, line, wanted)
    if isinstance(function, UserClass):
        return instantiate(machine, function, arguments, keywords, line)
    arguments = [robot_of(value) for value in arguments]
    keywords = {key: robot_of(value) for key, value in keywords.items()}
    if isinstance(function, Method):
        return call_method(machine, function, arguments, keywords, line)
    if isinstance(function, Function):
        return _call_library(machine, function.name, arguments, keywords, line)
    if isinstance(function, Unresolved):
        return _call_unknown(machine, function.name, arguments, keywords, line)
    if isinstance(function, Opaque) and not has_part(arguments, keywords):
        return Opaque(function.why, function.line)
    raise Unread(say("a call of a value of this kind is not read"))


def _call_unknown(
    machine: Expressions,
    name: str,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    """Return a value that is not known, for a function that nothing is known of."""
    if name == "assignin" and len(arguments) == 3 and isinstance(arguments[1], str):
        return _assign_in(machine, arguments[1], arguments[2], line)
    if name in library.REACHING and not _is_startup(arguments):
        raise refused(line, say("{name}() may change any variable, and is not read", name=name))
    first = arguments[0] if arguments else None
    if isinstance(first, (Body, Joint, Tree)):
        return call_method(machine, Method(first, name), arguments[1:], keywords, line)
    if has_part(arguments, keywords) and name not in harmless.FUNCTIONS:
        raise refused(
            line, say("{name}() takes a link or robot, and what it does is not known", name=name)
        )
    return Opaque(say("{name}() is not read", name=name), line)


def _assign_in(machine: Expressions, name: str, value: Value, line: int) -> Value:
    """Set a variable of the workspace, as functions of models of MATLAB do.

    Raises:
        DHError: From a function that a function calls, whose variables are not those meant.
    """
    if len(machine.frames) > 1 or not name.isidentifier():
        raise refused(line, say("assignin() in a function that another one calls is not read"))
    if isinstance(value, Robot):
        value.title = value.title or name
    machine.workspace[name] = value
    return None


def _is_startup(arguments: list[Value]) -> bool:
    """Return whether the one argument names the start file of the Toolbox."""
    return any(isinstance(value, str) and "startup_rv" in value for value in arguments)


def _call_library(
    machine: Expressions,
    name: str,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    if name in links.CLASSES:
        if len(arguments) == 1 and isinstance(arguments[0], Link) and not keywords:
            made = robots.copied(arguments[0])
        else:
            made = links.make_link(name, line, arguments, keywords, machine.warnings)
        machine.links.append(made)
        return made
    if name in robots.CLASSES:
        robot = robots.make_robot(
            name, line, arguments, keywords, machine.warnings, is_matlab=machine.is_matlab
        )
        machine.robots.append(robot)
        return robot
    if name in bodies.CLASSES:
        body = bodies.make_body(name, line, arguments)
        if isinstance(body, Tree):
            machine.trees.append(body)
        elif isinstance(body, Joint):
            machine.joints.append(body)
        return body
    if name in library.OTHER_ROBOTS:
        raise refused(
            line,
            say(
                "{name} makes a robot that is no D-H table; upload it as URDF, or as a table",
                name=name,
            ),
        )
    if name == "super":
        frame = machine.frames[-1] if machine.frames else None
        owner = machine.scopes[0].get("self") if frame else None
        if frame is None or not isinstance(owner, Instance):
            raise Unread(say("super() is not read here"))
        return Method(owner, "super", frame.of)
    if name in library.COPIES and len(arguments) == 1:
        return _copy(machine, arguments[0], deep=name == "deepcopy" or machine.is_matlab, line=line)
    if name in poses.NAMES:
        if any(isinstance(value, (Opaque, Unresolved)) for value in arguments):
            raise Unread(say("{name} of a number that is not known", name=name))
        found = poses.PoseCall(
            name, line, arguments, keywords, machine.is_matlab, machine.angle, machine.warnings
        )
        return poses.make_pose(found)
    first = arguments[0] if arguments else None
    if name in ("symbols", "symbol", "Symbol", "sym") and isinstance(first, str):
        return _symbols(first)
    if name in ("atan2", "arctan2") and len(arguments) == 2:
        y, x = (numbers.as_scalar(value) for value in arguments)
        return numbers.atan2(y, x)
    if name in ("hypot", "pow", "power") and len(arguments) == 2:
        one, two = (numbers.as_scalar(value) for value in arguments)
        if name != "hypot":
            return numbers.combined("**", one, two)
        return number(math.hypot(numbers.real(one), numbers.real(two)))
    if name == "DataFrame" and not has_part(arguments, keywords):
        return frames.data_frame(arguments, keywords)
    if name in library.ONE_NUMBER and len(arguments) == 1:
        return array_functions.of_one(name, arguments[0])
    if name in library.ARRAYS:
        return array_functions.of_arrays(name, arguments, keywords, is_matlab=machine.is_matlab)
    if name in library.LISTS:
        return array_functions.of_lists(machine, name, arguments, keywords)
    return _call_unknown(machine, name, arguments, keywords, line)


def _copy(machine: Expressions, value: Value, *, deep: bool, line: int) -> Value:
    if isinstance(value, Link):
        return robots.copied(value)
    if isinstance(value, Robot):
        if not deep:
            raise Unread(say("copy() of a robot shares its links; use deepcopy()"))
        made = robots.copy_of(value, line)
        machine.robots.append(made)
        return made
    if isinstance(value, Items):
        if not deep:
            return Items(list(value.items), value.is_tuple)
        return Items([_copy(machine, item, deep=True, line=line) for item in value.items])
    if is_part(value):
        raise Unread(say("a copy of this value is not read"))
    return value


def _symbols(text: str) -> Value:
    names = text.replace(",", " ").split()
    if len(names) > 64 or any(":" in name for name in names):
        names = array_functions.expanded(names)
    found: list[Value] = []
    for name in names:
        variable = variable_of(name.lower())
        found.append(Sum(terms=((variable, 1.0),)) if variable else Unresolved(name))
    return found[0] if len(found) == 1 else Items(found, is_tuple=True)


def call_method(
    machine: Expressions,
    function: Method,
    arguments: list[Value],
    keywords: dict[str, Value],
    line: int,
) -> Value:
    """Return what ``owner.name(…)`` returns.

    Raises:
        Unread: It has no value here.
        DHError: It may change a link or a robot in a way that is not read.
    """
    owner, name = function.owner, function.name
    if isinstance(owner, Instance):
        return call_on_instance(machine, function, arguments, keywords, line)
    if isinstance(owner, Function):
        return call_on_class(machine, owner, name, arguments, keywords, line)
    if isinstance(owner, Items):
        return list_methods.call(owner, name, arguments, keywords, line)
    if isinstance(owner, Robot):
        return call_on_robot(machine, owner, name, arguments, line)
    if isinstance(owner, Link):
        if name == "copy":
            return robots.copied(owner)
        if name in harmless.FUNCTIONS:
            return Opaque(say("{name}() of a link", name=name), line)
        raise refused(line, say("{name}() of a link is not read", name=name))
    if isinstance(owner, (Body, Joint, Tree)):
        if bodies.call_on_body(owner, name, arguments, line):
            return None
        if name in harmless.FUNCTIONS:
            return Opaque(say("{name}() of a robot", name=name), line)
        raise refused(
            line, say("{name}() of a rigidBodyTree or of its parts is not read", name=name)
        )
    if isinstance(owner, Pose) and name in ("inv", "inverse", "double"):
        if name == "double":
            return array_functions.of_one("double", owner)
        return array_functions.inverse(owner)
    if isinstance(owner, Array):
        return array_functions.of_array_method(owner, name, arguments, keywords)
    if isinstance(owner, dict) and name in ("values", "keys", "get", "items"):
        return _of_dictionary(owner, name, arguments)
    if has_part(arguments, keywords):
        raise refused(
            line, say("{name}() takes a link or robot, and what it does is not known", name=name)
        )
    return Opaque(say("{name}() is not read", name=name), line)


def _of_dictionary(owner: dict[str, Value], name: str, arguments: list[Value]) -> Value:
    if name == "values":
        return Items(list(owner.values()))
    if name == "keys":
        return Items(list(owner))
    if name == "items":
        return Items([Items([key, value], is_tuple=True) for key, value in owner.items()])
    key = arguments[0] if arguments else None
    if isinstance(key, str) and key in owner:
        return owner[key]
    raise Unread(say("a key is not there"))
