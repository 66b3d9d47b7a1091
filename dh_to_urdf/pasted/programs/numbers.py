"""Arithmetic of the numbers of a program, which tell angles with π from plain numbers."""

from __future__ import annotations

import math
from collections.abc import Callable

from dh_to_urdf.cells.arithmetic import CellError, Sum
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.programs.values import Opaque, Scalar, Unread, Unresolved, Value

MAX_PLAIN_ANGLE = 2 * math.pi
PI = Sum(angle=math.pi, has_angle=True)


def as_scalar(value: Value) -> Scalar:
    """Return a number, a truth value as 1 or 0, or an unknown one.

    Raises:
        Unread: It is no number.
    """
    if isinstance(value, bool):
        return Sum(plain=float(value))
    if isinstance(value, (Sum, Unresolved, Opaque)):
        return value
    raise Unread(say("is no number"))


def known(value: Value) -> Sum:
    """Return a number that is known.

    Raises:
        Unread: It is unknown, or no number.
    """
    scalar = as_scalar(value)
    if isinstance(scalar, Unresolved):
        raise Unread(say("has an unknown name {scalar}", scalar=quoted(scalar.name, 20)))
    if isinstance(scalar, Opaque):
        raise Unread(scalar.why)
    return scalar


def in_radians(total: Sum) -> float:
    """Return a number as the program computes with it.

    Raises:
        Unread: It holds a joint variable.
    """
    if total.variable is not None:
        raise Unread(say("holds a joint variable"))
    return _finite(total.plain + total.angle + total.length)


def real(value: Value) -> float:
    """Return a known number as the program computes with it.

    Raises:
        Unread: It is unknown, or no number.
    """
    return in_radians(known(value))


def whole(value: Value) -> int:
    """Return a whole number.

    Raises:
        Unread: It is none.
    """
    found = real(value)
    if found != int(found) or abs(found) > 1e6:
        raise Unread(say("is no whole number"))
    return int(found)


def _finite(value: float) -> float:
    if not math.isfinite(value):
        raise Unread(say("is not a finite number"))
    return value


def negated(value: Scalar) -> Scalar:
    """Return minus a number."""
    return value.scaled(-1.0) if isinstance(value, Sum) else value


def combined(symbol: str, left: Scalar, right: Scalar) -> Scalar:
    """Return ``left symbol right``.

    Args:
        symbol: ``+ - * / // % **`` or an elementwise spelling of one.
        left: The left operand.
        right: The right operand.

    Raises:
        Unread: The operation is not read, or its result is not finite.
    """
    for operand in (left, right):
        if not isinstance(operand, Sum):
            return operand
    assert isinstance(left, Sum)
    assert isinstance(right, Sum)
    try:
        result = _OPERATIONS[symbol.removeprefix(".")](left, right)
    except KeyError:
        raise Unread(say("{symbol} is not read", symbol=quoted(symbol))) from None
    except (CellError, ArithmeticError) as error:
        words = str(error) if isinstance(error, CellError) else say("is not a finite number")
        raise Unread(words) from None
    _finite(result.plain + result.angle + result.length)
    return result


def _times(left: Sum, right: Sum) -> Sum:
    if left.is_plain:
        return right.scaled(left.plain)
    if right.is_plain:
        return left.scaled(right.plain)
    return Sum(plain=in_radians(left) * in_radians(right))


def _divided(left: Sum, right: Sum) -> Sum:
    if right.is_plain:
        if right.plain == 0.0:
            raise CellError(say("divides by zero"))
        return left.divided(right.plain)
    divisor = in_radians(right)
    if divisor == 0.0:
        raise CellError(say("divides by zero"))
    return Sum(plain=in_radians(left) / divisor)


def _power(left: Sum, right: Sum) -> Sum:
    if right.is_plain and right.plain == 1.0:
        return left
    result = in_radians(left) ** in_radians(right)
    if isinstance(result, complex):
        raise CellError(say("is no real number"))
    return Sum(plain=float(result))


_OPERATIONS: dict[str, Callable[[Sum, Sum], Sum]] = {
    "+": lambda left, right: left.plus(right),
    "-": lambda left, right: left.plus(right.scaled(-1.0)),
    "*": _times,
    "/": _divided,
    "//": lambda left, right: Sum(plain=float(in_radians(left) // in_radians(right))),
    "%": lambda left, right: Sum(plain=float(in_radians(left) % in_radians(right))),
    "**": _power,
    "^": _power,
}


def _turned(function: Callable[[float], float]) -> Callable[[Sum], Sum]:
    def of(total: Sum) -> Sum:
        if abs(total.plain) > MAX_PLAIN_ANGLE:
            raise Unread(
                say(
                    "takes the sine or cosine of {plain:g} rad; write {plain:g}*pi/180",
                    plain=total.plain,
                )
            )
        return Sum(plain=function(in_radians(total)))

    return of


def _degrees_turned(function: Callable[[float], float]) -> Callable[[Sum], Sum]:
    return lambda total: Sum(plain=function(math.radians(in_radians(total))))


def _angle(function: Callable[[float], float]) -> Callable[[Sum], Sum]:
    return lambda total: Sum(angle=function(in_radians(total)), has_angle=True)


def _plain(function: Callable[[float], float]) -> Callable[[Sum], Sum]:
    return lambda total: Sum(plain=float(function(in_radians(total))))


def _radians(total: Sum) -> Sum:
    return Sum(angle=math.radians(in_radians(total)), has_angle=True)


FUNCTIONS: dict[str, Callable[[Sum], Sum]] = {
    "sin": _turned(math.sin),
    "cos": _turned(math.cos),
    "tan": _turned(math.tan),
    "sind": _degrees_turned(math.sin),
    "cosd": _degrees_turned(math.cos),
    "tand": _degrees_turned(math.tan),
    **{name: _angle(math.asin) for name in ("asin", "arcsin")},
    **{name: _angle(math.acos) for name in ("acos", "arccos")},
    **{name: _angle(math.atan) for name in ("atan", "arctan")},
    **dict.fromkeys(("radians", "deg2rad", "rad", "degtorad"), _radians),
    **{name: _plain(math.degrees) for name in ("degrees", "rad2deg", "radtodeg")},
    "sqrt": _plain(math.sqrt),
    "exp": _plain(math.exp),
    "floor": _plain(math.floor),
    "ceil": _plain(math.ceil),
    "fix": _plain(math.trunc),
}
"""Functions of one number, by their names in both languages."""
SAME = ("double", "float", "float64", "single", "sym", "vpa", "N", "Rational", "Float", "simplify")
"""Functions that return their argument."""


def function_of(name: str, argument: Scalar) -> Scalar:
    """Return a function of one number.

    Raises:
        Unread: It has no value there.
    """
    if not isinstance(argument, Sum):
        return argument
    if name == "abs":
        return argument if in_radians(argument) >= 0 else argument.scaled(-1.0)
    try:
        return FUNCTIONS[name](argument)
    except (ValueError, ArithmeticError):
        raise Unread(say("takes {name} of a number that has none", name=name)) from None


def atan2(y: Scalar, x: Scalar) -> Scalar:
    """Return the angle of a point."""
    for operand in (y, x):
        if not isinstance(operand, Sum):
            return operand
    return Sum(angle=math.atan2(real(y), real(x)), has_angle=True)
