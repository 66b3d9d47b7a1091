"""Robots of MathWorks' Robotics System Toolbox: ``rigidBodyTree`` with D-H joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.arrays import as_array
from dh_to_urdf.pasted.programs.links import limits_of
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import (
    Array,
    Body,
    Items,
    Joint,
    Link,
    Placed,
    Pose,
    Robot,
    Tree,
    Unread,
    Value,
)

CLASSES = (
    "rigidBodyTree",
    "rigidBody",
    "rigidBodyJoint",
    "robotics.RigidBodyTree",
    "robotics.RigidBody",
    "robotics.Joint",
    "RigidBodyTree",
    "RigidBody",
    "Joint",
)
_NOTES = ("HomePosition", "Mass", "CenterOfMass", "Inertia", "DataFormat", "Gravity", "BaseName")
_COLUMNS = ("a", "alpha", "d", "theta")
_TYPES = {"revolute": "R", "prismatic": "P", "fixed": "F"}


def make_body(name: str, line: int, arguments: Sequence[Value]) -> Tree | Body | Joint:
    """Return what a constructor makes.

    Raises:
        DHError: An argument that is not read.
    """
    kind = name.removeprefix("robotics.").lower().removeprefix("rigidbody") or "body"
    texts = [value for value in arguments if isinstance(value, str)]
    if kind == "tree":
        if arguments and not isinstance(arguments[0], str):
            raise refused(line, say("a rigidBodyTree of another robot is not read"))
        return Tree(line)
    if not texts:
        raise refused(line, say("{name} without a name is not read", name=name))
    if kind == "body":
        return Body(line, texts[0])
    type_ = texts[1] if len(texts) > 1 else "fixed"
    if type_ not in _TYPES:
        raise refused(
            line,
            say("the joint is {type}; revolute, prismatic, fixed are read", type=quoted(type_)),
        )
    return Joint(line, texts[0], type_)


def set_body(owner: Body | Joint | Tree, key: str, value: Value, line: int) -> None:
    """Set a property of a body or a joint.

    Raises:
        DHError: A property that is not read.
    """
    _refuse_given(owner, line)
    if isinstance(owner, Body) and key == "Joint" and isinstance(value, Joint):
        owner.joint = Joint(**vars(value))
        value.given = True
    elif isinstance(owner, Joint) and key == "PositionLimits":
        owner.limits = limits_of(value, line)
    elif isinstance(owner, Joint) and key == "JointAxis":
        _set_axis(owner, value, line)
    elif key not in _NOTES:
        raise refused(
            line,
            say(
                "{key} of the {owner} is set, which is not read",
                key=quoted(key),
                owner=_kind(owner),
            ),
        )


def _refuse_given(owner: Body | Joint | Tree, line: int) -> None:
    """Refuse to change what a body or a robot has taken: whether it follows is not known."""
    if not isinstance(owner, Tree) and owner.given:
        raise refused(
            line,
            say(
                "the {owner} is changed after it was given on; change it before", owner=_kind(owner)
            ),
        )


def _set_axis(joint: Joint, value: Value, line: int) -> None:
    try:
        axis = [getattr(element, "plain", None) for element in as_array(value).elements]
    except Unread:
        axis = []
    if axis not in ([0, 0, 1], [0, 0, -1]):
        raise refused(line, say("JointAxis other than [0 0 1] is no D-H row"))
    joint.flipped = axis[2] == -1


def _kind(owner: Body | Joint | Tree) -> str:
    return {"Body": "body", "Joint": "joint", "Tree": "rigidBodyTree"}[type(owner).__name__]


def call_on_body(
    owner: Body | Joint | Tree, name: str, arguments: Sequence[Value], line: int
) -> bool:
    """Run a method that builds a robot; return False for one that is not known."""
    if isinstance(owner, Joint) and name == "setFixedTransform":
        _refuse_given(owner, line)
        _set_row(owner, arguments, line)
        return True
    if isinstance(owner, Tree) and name == "addBody" and len(arguments) == 2:
        body, parent = arguments
        if not isinstance(body, Body) or not isinstance(parent, str):
            raise refused(line, say("addBody needs a body and the name of its parent"))
        body.given = True
        joint = body.joint and Joint(**vars(body.joint))
        owner.bodies.append((Body(body.line, body.name, joint), parent))
        return True
    return False


def _set_row(joint: Joint, arguments: Sequence[Value], line: int) -> None:
    if len(arguments) == 2 and isinstance(arguments[0], (Array, Items)):
        convention = arguments[1]
        row = as_array(arguments[0]).elements
        if convention in ("dh", "mdh") and len(row) == 4:
            joint.row, joint.convention, joint.row_line = row, str(convention), line
            return
    if len(arguments) == 1 and isinstance(arguments[0], (Array, Pose)):
        raise refused(
            line,
            say(
                "setFixedTransform with a matrix is no D-H row; give [a alpha d theta]"
                " and 'dh' or 'mdh', or upload the robot as URDF"
            ),
        )
    raise refused(line, say("setFixedTransform is read as (joint, [a alpha d theta], 'dh')"))


def robot_of(tree: Tree, joints: Sequence[Joint]) -> Robot:
    """Return the robot of a tree, which must be a chain.

    Args:
        tree: The tree; without bodies, the joints in their order make the chain.
        joints: All joints with a D-H row, in the order of the text.

    Raises:
        DHError: The tree branches, or a joint has no row.
    """
    chain = _chain(tree) if tree.bodies else list(joints)
    robot = Robot(tree.line, [], np.eye(4), np.eye(4), title=tree.title)
    for joint in chain:
        robot.links.append(_link(joint))
    return robot


def _chain(tree: Tree) -> list[Joint]:
    names = [body.name for body, _ in tree.bodies]
    chain: list[Joint] = []
    for k, (body, parent) in enumerate(tree.bodies):
        expected = names[k - 1] if k else None
        if (k and parent != expected) or (not k and parent in names):
            raise refused(
                body.line,
                say(
                    "body {body} is on {parent}; only a serial chain, added in its order, is read",
                    body=quoted(body.name),
                    parent=quoted(parent),
                ),
            )
        if body.joint is None:
            raise refused(
                body.line, say("body {body} has no joint of its own", body=quoted(body.name))
            )
        chain.append(body.joint)
    return chain


def _link(joint: Joint) -> Link:
    if joint.row is None:
        raise refused(
            joint.line,
            say("joint {joint} has no D-H row (setFixedTransform)", joint=quoted(joint.name)),
        )
    type_ = _TYPES[joint.type]
    link = Link(
        joint.row_line,
        type=type_,
        modified=joint.convention == "mdh",
        flipped=joint.flipped,
        limits=joint.limits if type_ != "F" else None,
        is_fixed=type_ == "F",
    )
    own = {"R": "theta", "P": "d"}.get(type_)
    for key, element in zip(_COLUMNS, joint.row, strict=True):
        # MathWorks ignores theta of a revolute joint and d of a prismatic one.
        if key != own:
            link.numbers[key] = Placed(element, joint.row_line)
    return link
