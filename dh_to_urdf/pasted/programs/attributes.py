"""Properties of links, robots, poses and objects: what ``owner.name`` is, and how it is set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import arrays, harmless
from dh_to_urdf.pasted.programs.bodies import set_body
from dh_to_urdf.pasted.programs.library import KNOWN
from dh_to_urdf.pasted.programs.links import PARAMETERS, set_link
from dh_to_urdf.pasted.programs.numbers import real
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.robots import column_of, set_robot
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

_SE3_MEMBERS_TEXT = (
    "\n    Rx Ry Rz Tx Ty Tz tx ty tz Trans transl RPY rpy Eul eul AngVec AngleAxis angvec Rt\n"
)
_SE3_MEMBERS = frozenset(_SE3_MEMBERS_TEXT.split())


def get(machine: Expressions, owner: Value, name: str, line: int, *, called: bool = False) -> Value:
    """Return ``owner.name``.

    Args:
        machine: Where the expression is evaluated.
        owner: The value.
        name: The property.
        line: Where it stands.
        called: Whether parentheses follow.

    Raises:
        Unread: The value has no such property that is read.
    """
    if isinstance(owner, Function):
        if owner.name == "SE3":
            return Function(f"SE3.{name}") if name in _SE3_MEMBERS else Unresolved(f"SE3.{name}")
        if name in KNOWN:
            return Function(name)
        return Method(owner, name) if called else Opaque(f"{owner.name}.{name}", line)
    if isinstance(owner, Unresolved):
        return machine.library_name(name)
    if isinstance(owner, Method) and owner.name == "super":
        return Method(owner.owner, name, owner.of)
    if isinstance(owner, Instance):
        return _of_instance(machine, owner, name, line, called)
    if isinstance(owner, Link):
        return _of_link(owner, name, line, called)
    if isinstance(owner, Robot):
        return _of_robot(machine, owner, name, line, called)
    if isinstance(owner, (Body, Joint, Tree)):
        if isinstance(owner, Body) and name == "Joint" and owner.joint is not None:
            return owner.joint
        return Method(owner, name) if called else Opaque(f".{name}", line)
    if isinstance(owner, Pose) and not called:
        return _of_pose(owner, name, line, is_matlab=machine.is_matlab)
    if isinstance(owner, Array) and not called:
        return _of_array(owner, name, is_matlab=machine.is_matlab)
    if isinstance(owner, dict) and name in owner:
        return owner[name]
    if isinstance(owner, Opaque):
        return Method(owner, name) if called else Opaque(owner.why, owner.line)
    if isinstance(owner, UserClass) and not called:
        return Opaque(say(".{name} of a class", name=name), line)
    if isinstance(owner, Items) and machine.is_matlab and is_part(owner) and not called:
        return _of_row(owner, name)
    return Method(owner, name)


def _of_row(owner: Items, name: str) -> Value:
    """Return ``[L.a]``, the property of each link."""
    if name not in PARAMETERS:
        raise Unread(say(".{name} of several links is not read", name=name))
    links = [item for item in owner.items if isinstance(item, Link)]
    row = [link.numbers[name].value if name in link.numbers else Sum() for link in links]
    return Array((tuple(row),))


def _of_instance(
    machine: Expressions, owner: Instance, name: str, line: int, called: bool
) -> Value:
    if name in owner.attributes:
        return owner.attributes[name]
    if name == "__class__":
        return owner.of
    if method(owner.of, name) is not None:
        return Method(owner, name)
    if owner.robot is not None:
        return _of_robot(machine, owner.robot, name, line, called)
    return Method(owner, name) if called else Opaque(say(".{name} is not set", name=name), line)


def method(of: UserClass, name: str, depth: int = 0) -> UserFunction | None:
    """Return the method of a class or of its superclasses in the program."""
    from dh_to_urdf.pasted.programs import tree

    for statement in of.definition.body:
        if isinstance(statement, tree.Define) and statement.name == name:
            return UserFunction(statement, of.scopes, of)
    for parent in of.parents:
        if isinstance(parent, UserClass) and depth < 8:
            found = method(parent, name, depth + 1)
            if found is not None:
                return found
    return None


def _of_link(link: Link, name: str, line: int, called: bool) -> Value:
    if called:
        return Method(link, name)
    if name in PARAMETERS:
        return link.numbers[name].value if name in link.numbers else Sum()
    if name == "qlim":
        if link.limits is None:
            return None
        return Array((tuple(bound.value for bound in link.limits),), flat=True)
    if name == "sigma":
        return number(link.type == "P")
    if name in ("mdh", "flip"):
        return bool(link.modified if name == "mdh" else link.flipped)
    return Opaque(say(".{name} of a link", name=name), line)


def _of_robot(machine: Expressions, robot: Robot, name: str, line: int, called: bool) -> Value:
    if name == "links":
        return Items(list(robot.links), robot=robot)
    if name in ("base", "tool"):
        return Pose(robot.base if name == "base" else robot.tool)
    if name == "n":
        return number(len(robot.links))
    if name in ("offset", "qlim", "d", "a", "alpha", "theta") and not (
        called and not machine.is_matlab
    ):
        return column_of(robot, name, is_matlab=machine.is_matlab)
    if called or name in harmless.FUNCTIONS:
        return Method(robot, name)
    if machine.is_matlab and name not in harmless.ROBOT_NOTES:
        return Method(robot, name)
    return Opaque(say(".{name} of a robot", name=name), line)


def _of_pose(pose: Pose, name: str, line: int, *, is_matlab: bool) -> Value:
    T = pose.matrix
    if name == ("T" if is_matlab else "A"):
        return arrays.of_matrix(T)
    if name == "R":
        return arrays.of_matrix(T[:3, :3])
    if name == "t":
        column = tuple(number(x) for x in T[:3, 3])
        return Array(tuple((x,) for x in column)) if is_matlab else Array((column,), flat=True)
    if name in ("x", "y", "z"):
        return number(T["xyz".index(name), 3])
    if name in ("inv", "double"):
        return Method(pose, name)
    return Opaque(say(".{name} of a pose", name=name), line)


def _of_array(array: Array, name: str, *, is_matlab: bool) -> Value:
    if name == "T" and not is_matlab:
        return arrays.transposed(array)
    if name == "shape":
        sizes = array.shape[1:] if array.flat else array.shape
        return Items([number(size) for size in sizes], is_tuple=True)
    if name == "size" and not is_matlab:
        return number(len(array.elements))
    return Method(array, name)


def put(machine: Expressions, owner: Value, name: str, value: Value, line: int) -> None:
    """Set ``owner.name`` of an object that variables share.

    Raises:
        Unread: It is no such object.
        DHError: A property that moves the robot and is not read.
    """
    if isinstance(owner, Instance):
        body = owner.robot
        moves = ("base", "tool", "links", "offset", "qlim", "d", "a", "alpha", "theta", "n")
        if body is None or name not in moves:
            owner.attributes[name] = value
            return
        owner = body
    if isinstance(value, Instance) and value.robot is not None:
        value = value.robot
    if isinstance(owner, Link):
        if name == "flip" and not machine.is_matlab:
            raise refused(
                line, say("flip after the link is made turns nothing; give flip=True to it")
            )
        known = name in harmless.LINK_NOTES or name.lower() in (
            *PARAMETERS,
            "qlim",
            "sigma",
            "flip",
            "mdh",
            "jointtype",
            "modified",
        )
        if not known:
            raise refused(
                line, say("{name} of the link is set, which is not read", name=quoted(name))
            )
        set_link(owner, name, value, line, machine.warnings)
    elif isinstance(owner, Robot):
        if name not in harmless.ROBOT_NOTES or name in ("name",):
            _put_robot(machine, owner, name, value, line)
    elif isinstance(owner, (Body, Joint, Tree)):
        set_body(owner, name, value, line)
    else:
        raise Unread(say(".{name} of this value is set", name=name))


def _put_robot(machine: Expressions, robot: Robot, name: str, value: Value, line: int) -> None:
    moving = (
        "links",
        "offset",
        "qlim",
        "base",
        "tool",
        "name",
        "d",
        "a",
        "alpha",
        "theta",
        "n",
        "mdh",
        "sigma",
        "_T",
        "_tool",
        "_links",
        "flip",
        "config",
        "ets",
    )
    if name in moving:
        is_matlab = machine.is_matlab
        set_robot(robot, name, value, line, machine.warnings, is_matlab=is_matlab)
    elif is_part(value):
        raise refused(line, say("{name} of the robot is set to a link or robot", name=quoted(name)))


def with_pose_part(pose: Pose, name: str, value: Value) -> Pose:
    """Return a pose with ``t`` or ``R`` set, as MATLAB sets it.

    Raises:
        Unread: Another part.
    """
    T = pose.matrix.copy()
    if name == "t":
        T[:3, 3] = [real(x) for x in arrays.flat_numbers(value, 3)]
    elif name == "R":
        R = arrays.to_matrix(value)
        if R.shape != (3, 3):
            raise Unread(say("a rotation is no 3x3 matrix"))
        T[:3, :3] = R
    else:
        raise Unread(say(".{name} of a pose is set", name=name))
    return Pose(np.asarray(T))
