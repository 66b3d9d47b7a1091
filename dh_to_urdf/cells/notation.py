"""Numbers as people write them, exactly: ``pi/2``, ``0.4318``, ``-th2 + pi/2``."""

from __future__ import annotations

import math
from fractions import Fraction

from dh_to_urdf.cells.expressions import Quantity, parse_cell
from dh_to_urdf.table import DHTable

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
                    f"joint {k} ({row.name}): {column} is {angle!r}, which is used as it stands;"
                    f" if {angle_text(exact)} is meant, write that",
                )
    return ()
