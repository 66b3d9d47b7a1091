"""Operators of Python and MATLAB between the values of a program."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs import arrays, tree
from dh_to_urdf.pasted.programs.numbers import as_scalar, combined, negated, real, whole
from dh_to_urdf.pasted.programs.robots import appended, multiplied
from dh_to_urdf.pasted.programs.values import (
    MAX_ITEMS,
    Array,
    Instance,
    Items,
    Link,
    Opaque,
    Pose,
    Robot,
    Unread,
    Unresolved,
    Value,
    is_part,
    number,
)
from dh_to_urdf.poses import Matrix

if TYPE_CHECKING:
    from dh_to_urdf.pasted.programs.evaluation import Expressions


def unary(machine: Expressions, node: tree.Unary) -> Value:
    """Return ``-x``, ``not x``, ``x'``.

    Raises:
        Unread: It has no value here.
    """
    value = machine.evaluate(node.operand)
    if node.symbol == "not":
        return not machine.truth(value)
    if node.symbol == "'":
        if isinstance(value, Pose):
            raise Unread(say("the transpose of a pose is not read"))
        if isinstance(value, Items) or not isinstance(value, Array):
            return value
        return arrays.transposed(value)
    if node.symbol not in ("-", "+"):
        raise Unread(say("{symbol} is not read", symbol=node.symbol))
    if isinstance(value, (Array, Items)):
        return arrays.elementwise("*", number(-1.0 if node.symbol == "-" else 1.0), value)
    scalar = as_scalar(value)
    return negated(scalar) if node.symbol == "-" else scalar


def binary(machine: Expressions, node: tree.Binary) -> Value:
    """Return ``left symbol right``.

    Raises:
        Unread: It has no value here.
    """
    symbol = node.symbol
    left = machine.evaluate(node.left)
    if symbol in ("and", "or"):
        if machine.truth(left) is (symbol == "or"):
            return left
        return machine.evaluate(node.right)
    right = machine.evaluate(node.right)
    left, right = robot_of(left), robot_of(right)
    if symbol in ("==", "!=", "<", "<=", ">", ">=", "is", "is not", "in", "not in"):
        return _compared(symbol, left, right)
    if is_part(left) or is_part(right):
        return _of_parts(machine, symbol, left, right, node.line)
    if isinstance(left, Pose) or isinstance(right, Pose):
        return _of_poses(symbol, left, right, is_matlab=machine.is_matlab)
    if isinstance(left, str) or isinstance(right, str):
        if symbol == "+" and isinstance(left, str) and isinstance(right, str):
            return left[:300] + right[:300]
        if isinstance(left, Opaque) or isinstance(right, Opaque):
            return Opaque(say("a text with values in it"), node.line)
        raise Unread(say("this operation on a text is not read"))
    lists = isinstance(left, Items) or isinstance(right, Items)
    arrays_too = isinstance(left, Array) or isinstance(right, Array)
    if lists and not machine.is_matlab and not arrays_too:
        return _of_lists(symbol, left, right)
    if isinstance(left, (Array, Items)) or isinstance(right, (Array, Items)):
        return _of_arrays(machine, symbol, left, right)
    if symbol == "^" and not machine.is_matlab:
        raise Unread(say("^ is no power in Python; write **"))
    return combined(symbol, as_scalar(left), as_scalar(right))


def _of_arrays(machine: Expressions, symbol: str, left: Value, right: Value) -> Value:
    one, two = isinstance(left, (Array, Items)), isinstance(right, (Array, Items))
    if symbol == "@" or (symbol == "*" and machine.is_matlab and one and two):
        return arrays.product(arrays.as_array(left), arrays.as_array(right))
    if machine.is_matlab and symbol in ("^", "\\", "/") and two:
        raise Unread(say("{symbol} of matrices is not read", symbol=symbol))
    if symbol == "^" and machine.is_matlab:
        raise Unread(say("a power of a matrix is not read; write .^"))
    return arrays.elementwise(symbol, left, right)


def _of_parts(machine: Expressions, symbol: str, left: Value, right: Value, line: int) -> Value:
    """Return the sum of lists of links, or a robot with more links."""
    if isinstance(left, Items) and isinstance(right, Items) and not machine.is_matlab:
        return _of_lists(symbol, left, right)
    if isinstance(left, Items) and isinstance(right, (Sum, bool)) and symbol == "*":
        return _of_lists(symbol, left, right)
    if isinstance(left, Robot) and isinstance(right, (Robot, Link)):
        made = None
        if symbol == "+" and not machine.is_matlab:
            made = appended(left, right, line)
        elif symbol == "*" and machine.is_matlab and isinstance(right, Robot):
            made = multiplied(left, right, line)
        if made is not None:
            machine.robots.append(made)
            return made
    raise Unread(say("{symbol} of a link or robot is not read", symbol=symbol))


def _compared(symbol: str, left: Value, right: Value) -> bool:
    if symbol in ("is", "is not"):
        if right is None or isinstance(right, bool):
            if isinstance(left, (Opaque, Unresolved)):
                raise Unread(say("compares a value that is not known"))
            return (left is right) is (symbol == "is")
        raise Unread(say("is between values is not read"))
    if symbol in ("in", "not in"):
        if isinstance(right, (dict, str)) and isinstance(left, str):
            return (left in right) is (symbol == "in")
        raise Unread(say("in is not read here"))
    if isinstance(left, str) and isinstance(right, str) and symbol in ("==", "!="):
        return (left == right) is (symbol == "==")
    one, two = real(left), real(right)
    return {
        "==": one == two,
        "!=": one != two,
        "<": one < two,
        "<=": one <= two,
        ">": one > two,
        ">=": one >= two,
    }[symbol]


def _of_lists(symbol: str, left: Value, right: Value) -> Value:
    if (
        symbol == "+"
        and isinstance(left, Items)
        and isinstance(right, Items)
        and left.is_tuple == right.is_tuple
    ):
        return Items([*left.items, *right.items], left.is_tuple)
    if symbol == "*":
        items, times = (left, right) if isinstance(left, Items) else (right, left)
        if isinstance(items, Items) and len(items.items) * whole(times) <= MAX_ITEMS:
            return Items(items.items * whole(times), items.is_tuple)
    raise Unread(say("{symbol} of these lists is not read", symbol=symbol))


def _of_poses(symbol: str, left: Value, right: Value, *, is_matlab: bool) -> Value:
    if symbol == "*" or (symbol == "@" and not is_matlab):
        if isinstance(left, Pose) and isinstance(right, Pose):
            return Pose(left.matrix @ right.matrix)
        if is_matlab and all(isinstance(v, (Array, Pose)) for v in (left, right)):
            one, two = (arrays.to_matrix(v) for v in (left, right))
            if one.shape == two.shape == (4, 4):
                return Pose(one @ two)
    if symbol == "/" and isinstance(left, Pose) and isinstance(right, Pose):
        return Pose(left.matrix @ _inverse(right))
    raise Unread(say("{symbol} of a pose and this value is not read", symbol=symbol))


def _inverse(pose: Pose) -> Matrix:
    R, p = pose.matrix[:3, :3], pose.matrix[:3, 3]
    T = pose.matrix.copy()
    T[:3, :3], T[:3, 3] = R.T, -R.T @ p
    return T


def robot_of(value: Value) -> Value:
    """Return the robot that an object of the program is; any other value as it is."""
    return value.robot if isinstance(value, Instance) and value.robot is not None else value


def is_empty(value: Value) -> bool:
    """Return whether a value is ``[]``."""
    return isinstance(value, Array) and not value.elements
