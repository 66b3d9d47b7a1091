"""A derivation as text, whose lines are valid in Python."""

from __future__ import annotations

from dh_to_urdf.messages import chained
from kinematics.symbolic.angles import turn_text
from kinematics.symbolic.expressions import Sum, text
from kinematics.symbolic.inverse_model.statements import (
    Angle,
    Branch,
    Coordinate,
    Derivation,
    Equation,
    Let,
    Posture,
    Remark,
    Root,
    Roots,
    Statement,
    Towards,
    Trig,
    Upwards,
)


def divided(value: Sum, over: Sum | None) -> str:
    """Return a quotient."""
    if over is None:
        return text(value)
    top = text(value)
    top = top if len(value.terms) == 1 else f"({top})"
    return f"{top}/{factor(over)}"


def factor(value: Sum) -> str:
    """Return an expression in parentheses where a factor needs them."""
    found = text(value)
    single = len(value.terms) == 1 and not found.startswith("-")
    plain = single and len(value.terms[0].factors) + (value.terms[0].coefficient != 1) <= 1
    return found if plain else f"({found})"


def atan2(part: Towards) -> tuple[str, str]:
    """Return the sign and the rest of a part of an angle."""
    call = f"atan2({text(part.y)}, {text(part.x)})"
    if part.sign is None:
        return "+", call
    sign = text(part.sign)
    if sign in ("1", "-1"):
        return ("-" if sign == "-1" else "+"), call
    return ("-", f"{sign[1:]}*{call}") if sign.startswith("-") else ("+", f"{sign}*{call}")


def angle(statement: Angle) -> str:
    """Return the right side of an angle."""
    found = ""
    for part in statement.parts:
        sign, call = atan2(part)
        found += f" {sign} {call}" if found else (f"-{call}" if sign == "-" else call)
    return found


def trig(statement: Trig) -> str:
    """Return the argument of cosine and sine."""
    found = ""
    for name, n in statement.terms:
        size = name if abs(n) == 1 else f"{abs(n)}*{name}"
        found += (f" {'-' if n < 0 else '+'} {size}") if found else (f"-{size}" if n < 0 else size)
    return found


def coordinate(one: Coordinate) -> str:
    """Return the value of an entry of q."""
    found = text(one.value)
    turn = turn_text(abs(one.turn))
    if turn == "0":
        return found
    return f"{found} {'-' if one.turn < 0 else '+'} {turn}"
