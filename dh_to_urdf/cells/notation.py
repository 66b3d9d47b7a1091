"""Numbers as people write them, exactly: ``pi/2``, ``0.4318``, ``-th2 + pi/2``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction

from dh_to_urdf.cells.expressions import Quantity, parse_cell
from dh_to_urdf.couplings import coefficient_in, joint_map, moving_joints
from dh_to_urdf.messages import say
from dh_to_urdf.table import DHTable

DEGREES = 180.0 / math.pi
"""One rad in degrees."""
ROUNDED = 2e-3
"""Distance from a multiple of π/2 below which an angle looks like that multiple, rounded."""


def number_text(value: float) -> str:
    """Write a number as the shortest text that is read as exactly this number."""
    text = repr(float(value) + 0.0)
    return text.removesuffix(".0")


def angle_text(value: float) -> str:
    """Write an angle (rad) as ``3*pi/4`` where that is exactly its value, else in digits."""
    twelfths = value / (math.pi / 12)
    if abs(twelfths) > 48 or round(twelfths) == 0 or abs(twelfths - round(twelfths)) > 1e-9:
        return number_text(value)
    ratio = Fraction(round(twelfths), 12)
    factor = {1: "", -1: "-"}.get(ratio.numerator, f"{ratio.numerator}*")
    text = f"{factor}pi" + (f"/{ratio.denominator}" if ratio.denominator > 1 else "")
    return text if parse_cell(text, Quantity.ANGLE).value == value else number_text(value)


def in_degrees(angle: float) -> float:
    """Return an angle (rad) in degrees, 90 where rounding made 90.00000000000001 of it."""
    degrees = math.degrees(angle)
    rounded = round(degrees, 10)
    return rounded if abs(degrees - rounded) <= 3e-14 * max(1.0, abs(degrees)) else degrees


def variable_text(variable: str, sign: int, offset: str) -> str:
    """Write ``sign*variable + offset`` for an offset in text form: ``-th2 + pi/2``."""
    text = variable if sign > 0 else f"-{variable}"
    if offset == "0":
        return text
    return f"{text} - {offset[1:]}" if offset.startswith("-") else f"{text} + {offset}"


def sum_text(terms: Iterable[tuple[str, float]], constant: str = "0") -> str:
    """Write ``-2*q1 + 0.5*q2 + 0.1`` of variables, coefficients and a constant in text form."""
    text = ""
    for variable, coefficient in terms:
        size = number_text(abs(coefficient))
        term = variable if size == "1" else f"{size}*{variable}"
        negative = coefficient < 0
        text += (f" - {term}" if negative else f" + {term}") if text else "-" * negative + term
    if constant == "0":
        return text
    return f"{text} - {constant[1:]}" if constant.startswith("-") else f"{text} + {constant}"


def variable_cell(table: DHTable, k: int, turn: str, slide: str, *, degrees: bool = False) -> str:
    """Write the cell of a joint variable: ``-th2 + pi/2``, and ``th3 + th2`` where it is coupled.

    Args:
        table: The table.
        k: Number of the row, from 0.
        turn: Letters before the numbers of joints that turn.
        slide: Letters before those of joints that slide.
        degrees: Whether plain numbers of the table are degrees.
    """
    row = table.rows[k]

    def write(value: float) -> str:
        if not row.type.is_revolute:
            return number_text(value)
        return number_text(in_degrees(value)) if degrees else angle_text(value)

    turns = {other.name: other.type.is_revolute for other in table.rows}

    variables = {
        other.name: f"{turn if other.type.is_revolute else slide}{n}"
        for n, other in enumerate(table.rows, start=1)
    }
    if row.mimic is None and not row.coupling:
        return variable_text(variables[row.name], row.sign, write(row.offset))
    # In the written form the variables of followers have no offsets of their own.
    away = joint_map(*moving_joints(table)).offset[table.moving_rows.index(k)]
    constant = row.offset + row.sign * float(away)
    first = (row.name, 1.0)
    if row.mimic is not None:
        first = (row.mimic.joint, row.mimic.multiplier)
    unit, own = DEGREES if degrees else 1.0, row.type.is_revolute
    terms = (
        (
            variables[name],
            row.sign * coefficient_in(unit, c, turns=own, leader_turns=turns[name]),
        )
        for name, c in (first, *row.coupling)
    )
    return sum_text(terms, write(constant))


def rounding_warnings(table: DHTable) -> tuple[str, ...]:
    """Warn of an angle that is a multiple of π/2 with digits lost, such as 1.5708.

    Such an angle is used as it stands, and moves the tip by some 1e-5 of the arm's length.
    """
    for k, row in enumerate(table.rows, start=1):
        offset = row.offset if row.type.is_revolute else 0.0
        cells = {"alpha": row.alpha, "theta": row.theta + offset, "gamma": row.gamma}
        for column, angle in cells.items():
            quarters = round(angle / (math.pi / 2))
            exact = quarters * (math.pi / 2)
            if quarters and 1e-14 < abs(angle - exact) < ROUNDED:
                return (
                    say(
                        "joint {k} ({row}): {column} is {angle!r}, which is used as it stands;"
                        " if {exact} is meant, write that",
                        k=k,
                        row=row.name,
                        column=column,
                        angle=angle,
                        exact=angle_text(exact),
                    ),
                )
    return ()
