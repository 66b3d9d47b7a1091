"""Cells of a D-H table as people write them: ``pi/2``, ``-90deg``, ``0,4``, ``q2 - pi/2``.

A cell is a number, or a short text with numbers, ``+ - * / **`` (or ``^``), parentheses, ``sqrt``,
``sin``, ``cos``, ``tan``, ``atan2``, ``pi`` (or ``π``), unit suffixes (``deg``, ``°``, ``rad``,
``m``, ``cm``, ``mm``), names with a given value, and at most one joint variable with coefficient
±1; more of them, with any coefficients, in the cell of a joint that depends on others.
A plain number is in the units of its table; ``pi`` and suffixed numbers carry their own unit
whatever the table says.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace
from enum import Enum

from dh_to_urdf.cells.arithmetic import (
    CellError,
    Lookup,
    Sum,
    Variable,
    parse_sum,
    variable_of,
)
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say

__all__ = ["Cell", "CellError", "Quantity", "parse_cell"]

MAX_CELL_LENGTH = 64
MAX_MAGNITUDE = 1e6

_SIGNS = str.maketrans({"−": "-", "–": "-", "×": "*", "·": "*", "⋅": "*", "\u00a0": " "})
_DECIMAL_COMMA = re.compile(r"(?<![\d.,])([0-9]+),([0-9]+)(?![\d.,])")
_THOUSANDS = re.compile(r"(?<![\d.,])[1-9][0-9]{0,2},[0-9]{3}(?![\d.,])")
_WITH_COMMA = re.compile(r"(atan2\s?\([^()]{0,40}(?:\([^()]{0,40}\)[^()]{0,40}){0,4}\))")
_DATE = re.compile(r"\s*(?:[0-9]{4}-[0-9]{2}-[0-9]{2}|[0-9]{1,2}/[0-9]{1,2}/[0-9]{4})\s*")
_MIDDLE_DOT = re.compile(r"[0-9]\s*·\s*[0-9]")
_ANGLE_UNIT = re.compile(r"deg|°|rad", re.IGNORECASE)
_RADIANS_AFTER_PI = re.compile(r"^([^a-z]*(?:pi|π)[^a-z]*?)\s*rad\s*$", re.IGNORECASE)


class Quantity(Enum):
    """What a cell measures."""

    ANGLE = "angle"
    LENGTH = "length"
    NUMBER = "number"


_NEEDED = {
    Quantity.ANGLE: say("an angle"),
    Quantity.LENGTH: say("a length"),
    Quantity.NUMBER: say("a number without unit"),
}


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell in SI units.

    Attributes:
        value: The constant part, in rad, m or as it stands.
        variable: Letter of the joint variable in the cell (``q``, ``theta``, ``d``, …) or None.
        index: Number written after the letter, if any.
        sign: Coefficient of the variable, +1 or -1.
        terms: The variables with their coefficients, where there may be others than one ±1.
        plain: The part of the constant that carried no unit, in the units of the table.
        text: The cell as it was written.
    """

    value: float
    variable: str | None = None
    index: int | None = None
    sign: int = 1
    terms: tuple[tuple[Variable, float], ...] = ()
    plain: float = field(default=0.0, compare=False)
    text: str = field(default="", compare=False)

    @property
    def name(self) -> str:
        """Return the joint variable as it is written in the cell, such as ``D3``."""
        words = re.findall(r"[^\W\d_]\w*", self.text)
        return next((word for word in words if variable_of(word.lower())), "")


def parse_cell(
    raw: object,
    quantity: Quantity,
    unit: float = 1.0,
    values: Lookup | None = None,
    angle: float = 1.0,
    *,
    coupled: bool = False,
) -> Cell:
    """Read one cell of a table.

    Args:
        raw: A number, a text as described at the head of this module, or a cell already read.
        quantity: What the cell measures.
        unit: Value of one table unit in SI (``pi/180`` for degrees, ``1e-3`` for millimetres).
        values: What names in the cell stand for, without underscores.
        angle: Value of one unit of the table's angles in rad, for ``sin``, ``cos`` and ``tan``.
        coupled: Whether there may be several joint variables, with any coefficients.

    Returns:
        The cell in rad, m or (for a plain number) unchanged.

    Raises:
        CellError: The cell is not finite, too large, of another quantity or not readable.
    """
    if isinstance(raw, Cell):
        return raw
    if isinstance(raw, bool) or raw is None or not isinstance(raw, (int, float, str)):
        raise CellError(say('is {raw}; give a number or a text such as "pi/2"', raw=quoted(raw)))
    if isinstance(raw, str):
        return _checked(_parse_text(raw, quantity, unit, values, angle, coupled), raw)
    try:
        number = float(raw)
    except OverflowError:
        raise CellError(say("is too large; give a finite number")) from None
    return _checked(Cell(_in_si(number, quantity, unit), plain=number, text=str(raw)), raw)


def ascii_numbers(text: str) -> str:
    """Write signs in ASCII and decimal commas as points, for ``parse_sum``.

    Raises:
        CellError: A number in it can be read in two ways.
    """
    if _DATE.fullmatch(text):
        raise CellError(
            say("looks like a date, as spreadsheets make of 1/2; write the number as 0.5")
        )
    if _MIDDLE_DOT.search(text):
        raise CellError(say("has a · that is a decimal point or a product; write . or *"))
    text = text.translate(_SIGNS)
    parts = _WITH_COMMA.split(text)
    # The comma of atan2(1,0) parts its arguments.
    for k in range(0, len(parts), 2):
        if _THOUSANDS.search(parts[k]):
            raise CellError(say("reads as two numbers; write a decimal point"))
        parts[k] = _DECIMAL_COMMA.sub(r"\1.\2", parts[k])
    return "".join(parts)


def _in_si(number: float, quantity: Quantity, unit: float) -> float:
    if quantity is Quantity.ANGLE and unit != 1.0:
        return math.radians(number)
    if quantity is Quantity.LENGTH and unit != 1.0:
        return number / round(1.0 / unit)
    return number


def _checked(cell: Cell, raw: object) -> Cell:
    if math.isnan(cell.value):
        raise CellError(say("is NaN; give a finite number"))
    if math.isinf(cell.value):
        raise CellError(say("is infinite; give a finite number"))
    if abs(cell.value) > MAX_MAGNITUDE:
        raise CellError(
            say(
                "is {raw}, beyond ±{max_magnitude:g}; check its unit",
                raw=quoted(raw),
                max_magnitude=MAX_MAGNITUDE,
            )
        )
    # -0.0 becomes 0.0, which a writer that omits zeros gives back unchanged.
    return replace(cell, value=cell.value + 0.0)


def _parse_text(
    raw: str,
    quantity: Quantity,
    unit: float,
    values: Lookup | None,
    angle: float,
    coupled: bool,
) -> Cell:
    shown = quoted(raw)
    if len(raw) > MAX_CELL_LENGTH:
        raise CellError(
            say("is longer than {max_cell_length} characters", max_cell_length=MAX_CELL_LENGTH)
        )
    if not raw.strip():
        raise CellError(say("is empty; give a number"))
    if raw.strip().lstrip("+-").lower() in {"nan", "inf", "infinity", ".nan", ".inf"}:
        raise CellError(say("is {shown}; give a finite number", shown=shown))
    try:
        total = parse_sum(_RADIANS_AFTER_PI.sub(r"\1", ascii_numbers(raw)), values, angle)
    except CellError as error:
        raise CellError(say("is {shown}, which {error}", shown=shown, error=error)) from None
    except (OverflowError, RecursionError):
        raise CellError(say("is {shown}, which is not a finite number", shown=shown)) from None
    with_unit = _ANGLE_UNIT.search(raw) is not None
    return _cell(total, quantity, unit, raw, with_unit=with_unit, coupled=coupled)


def cell_of_sum(
    total: Sum, quantity: Quantity, unit: float, text: str, *, coupled: bool = False
) -> Cell:
    """Return the cell of a number that is computed already.

    Args:
        total: The number.
        quantity: What the cell measures.
        unit: Value of one table unit in SI.
        text: What messages show.
        coupled: As of :func:`parse_cell`.

    Raises:
        CellError: It is not finite, too large or of another quantity.
    """
    return _checked(_cell(total, quantity, unit, text, with_unit=False, coupled=coupled), text)


def _cell(
    total: Sum, quantity: Quantity, unit: float, raw: str, *, with_unit: bool, coupled: bool
) -> Cell:
    shown = quoted(raw)
    if quantity is not Quantity.LENGTH and total.has_length:
        raise CellError(
            say("is {shown}, a length; {needed} is needed", shown=shown, needed=_NEEDED[quantity])
        )
    of_angles = quantity is Quantity.ANGLE or (quantity is Quantity.NUMBER and not with_unit)
    if total.has_angle and not of_angles:
        raise CellError(
            say("is {shown}, an angle; {needed} is needed", shown=shown, needed=_NEEDED[quantity])
        )
    if quantity is Quantity.ANGLE and unit != 1.0 and total.has_angle and total.plain != 0.0:
        raise CellError(
            say("is {shown}, which mixes π or an explicit unit with plain degrees", shown=shown)
        )
    value = _in_si(total.plain, quantity, unit) + total.angle + total.length
    if total.variable is None:
        return Cell(value, plain=total.plain, text=raw)
    (letter, index), coefficient = total.terms[0]
    if coupled:
        if not all(0.0 < abs(factor) <= MAX_MAGNITUDE for _, factor in total.terms):
            raise CellError(
                say("is {shown}; give joint variables coefficients within ±1e6, not 0", shown=shown)
            )
        sign = -1 if coefficient < 0 else 1
        return Cell(value, letter, index, sign, total.terms, total.plain, raw)
    if len(total.terms) > 1:
        raise CellError(
            say(
                "is {shown}, which has two joint variables; a cell may hold one"
                " (constants are given in values)",
                shown=shown,
            )
        )
    if coefficient not in (1.0, -1.0):
        raise CellError(
            say("is {shown}; the joint variable must have coefficient +1 or -1", shown=shown)
        )
    return Cell(value, letter, index, int(coefficient), plain=total.plain, text=raw)
