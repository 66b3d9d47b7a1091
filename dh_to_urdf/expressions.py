"""Cells of a D-H table as people write them: ``pi/2``, ``-90deg``, ``0,4``, ``q2 - pi/2``.

A cell is a number, or a short text with numbers, ``+ - * /``, parentheses, ``sqrt``, ``pi`` (or
``π``), unit suffixes (``deg``, ``°``, ``rad``, ``m``, ``cm``, ``mm``) and at most one joint
variable with coefficient ±1. A plain number is in the units of its table; ``pi`` and suffixed
numbers carry their own unit whatever the table says.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from enum import Enum

from dh_to_urdf.errors import quoted

MAX_CELL_LENGTH = 64
MAX_MAGNITUDE = 1e6

_NUMBER = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_TOKEN = re.compile(
    rf"\s*(?:(?P<number>{_NUMBER})|(?P<word>[^\W\d_]+_?\d*)|(?P<symbol>[-+*/()°]))", re.UNICODE
)
_VARIABLE = re.compile(r"(?P<letter>q|theta|th|θ|d|r)_?(?P<index>\d*)")
_SIGNS = str.maketrans({"−": "-", "–": "-", "×": "*", "·": "*", "⋅": "*", "\u00a0": " "})
_DECIMAL_COMMA = re.compile(r"(?<![\d.,])(\d+),(\d+)(?![\d.,])")
_THOUSANDS = re.compile(r"(?<![\d.,])[1-9]\d{0,2},\d{3}(?![\d.,])")
_RADIANS_AFTER_PI = re.compile(r"^([^a-z]*(?:pi|π)[^a-z]*?)\s*rad\s*$", re.IGNORECASE)
_ANGLE_UNITS = {"deg": math.pi / 180, "rad": 1.0}
_LENGTH_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}


class Quantity(Enum):
    """What a cell measures."""

    ANGLE = "angle"
    LENGTH = "length"
    NUMBER = "number"


class CellError(ValueError):
    """A cell that cannot be read; the message says why and what to write."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell in SI units.

    Attributes:
        value: The constant part, in rad, m or as it stands.
        variable: Letter of the joint variable in the cell (``q``, ``theta``, ``d``, …) or None.
        index: Number written after the letter, if any.
        sign: Coefficient of the variable, +1 or -1.
    """

    value: float
    variable: str | None = None
    index: int | None = None
    sign: int = 1


@dataclass(frozen=True, slots=True)
class _Sum:
    """``plain + angle rad + length m + coefficient * variable``."""

    plain: float = 0.0
    angle: float = 0.0
    length: float = 0.0
    coefficient: float = 0.0
    variable: tuple[str, int | None] | None = None
    has_angle: bool = False
    has_length: bool = False

    def scaled(self, factor: float) -> _Sum:
        return _Sum(
            self.plain * factor,
            self.angle * factor,
            self.length * factor,
            self.coefficient * factor,
            self.variable,
            self.has_angle,
            self.has_length,
        )

    def divided(self, divisor: float) -> _Sum:
        return _Sum(
            self.plain / divisor,
            self.angle / divisor,
            self.length / divisor,
            self.coefficient / divisor,
            self.variable,
            self.has_angle,
            self.has_length,
        )

    def plus(self, other: _Sum) -> _Sum:
        if self.variable and other.variable and self.variable != other.variable:
            raise CellError("has two joint variables; a cell may hold one")
        return _Sum(
            self.plain + other.plain,
            self.angle + other.angle,
            self.length + other.length,
            self.coefficient + other.coefficient,
            self.variable or other.variable,
            self.has_angle or other.has_angle,
            self.has_length or other.has_length,
        )

    @property
    def is_plain(self) -> bool:
        return not (self.has_angle or self.has_length or self.variable)


class _Parser:
    """Recursive descent over one cell; its depth is bounded by ``MAX_CELL_LENGTH``."""

    def __init__(self, text: str) -> None:
        self.tokens = list(self._tokens(text))
        self.position = 0

    @staticmethod
    def _tokens(text: str) -> list[tuple[str, str]]:
        tokens, position = [], 0
        stripped = text.rstrip()
        while position < len(stripped):
            match = _TOKEN.match(stripped, position)
            if match is None:
                raise CellError(f"has an unexpected {stripped[position:].lstrip()[:1]!r}")
            kind = match.lastgroup or ""
            tokens.append((kind, match.group(kind)))
            position = match.end()
        return tokens

    def peek(self) -> tuple[str, str]:
        return self.tokens[self.position] if self.position < len(self.tokens) else ("end", "")

    def take(self, *symbols: str) -> str | None:
        kind, text = self.peek()
        if kind == "symbol" and text in symbols:
            self.position += 1
            return text
        return None

    def parse(self) -> _Sum:
        result = self.sum()
        if self.peek()[0] != "end":
            raise CellError(f"has an unexpected {self.peek()[1]!r}")
        return result

    def sum(self) -> _Sum:
        result = self.product()
        while symbol := self.take("+", "-"):
            term = self.product()
            result = result.plus(term if symbol == "+" else term.scaled(-1.0))
        return result

    def product(self) -> _Sum:
        result = self.signed()
        while True:
            if self.take("*"):
                result = self._times(result, self.signed())
            elif self.take("/"):
                divisor = self.signed()
                if not divisor.is_plain:
                    raise CellError("divides by something that is not a plain number")
                if divisor.plain == 0.0:
                    raise CellError("divides by zero")
                result = result.divided(divisor.plain)
            elif self.peek()[0] == "word" or self.peek() == ("symbol", "("):
                result = self._times(result, self.signed())
            else:
                return result

    @staticmethod
    def _times(left: _Sum, right: _Sum) -> _Sum:
        if left.is_plain:
            return right.scaled(left.plain)
        if right.is_plain:
            return left.scaled(right.plain)
        raise CellError("multiplies two quantities that both carry a unit or a variable")

    def signed(self) -> _Sum:
        if self.take("-"):
            return self.signed().scaled(-1.0)
        if self.take("+"):
            return self.signed()
        return self.with_unit(self.atom())

    def with_unit(self, value: _Sum) -> _Sum:
        kind, text = self.peek()
        unit = "deg" if text == "°" else text.lower()
        if unit in {"degree", "degrees"}:
            unit = "deg"
        if (kind, text) != ("symbol", "°") and (
            kind != "word" or (unit not in _ANGLE_UNITS and unit not in _LENGTH_UNITS)
        ):
            return value
        self.position += 1
        if unit == "rad" and value.has_angle and not value.has_length and not value.variable:
            return value
        if not value.is_plain:
            raise CellError(f"puts the unit {text!r} on something that is not a plain number")
        if unit in _ANGLE_UNITS:
            angle = math.radians(value.plain) if unit == "deg" else value.plain
            return _Sum(angle=angle, has_angle=True)
        length = value.plain * _LENGTH_UNITS[unit]
        if unit != "m":
            length = value.plain / round(1.0 / _LENGTH_UNITS[unit])
        return _Sum(length=length, has_length=True)

    def atom(self) -> _Sum:
        kind, text = self.peek()
        self.position += 1
        if kind == "number":
            return _Sum(plain=float(text))
        if kind == "word":
            return self._word(text)
        if (kind, text) == ("symbol", "("):
            inner = self.sum()
            if not self.take(")"):
                raise CellError("lacks a closing parenthesis")
            return inner
        raise CellError("ends too early" if kind == "end" else f"has an unexpected {text!r}")

    def _word(self, text: str) -> _Sum:
        lowered = text.lower()
        if lowered in {"pi", "π"}:
            return _Sum(angle=math.pi, has_angle=True)
        if lowered == "sqrt":
            if not self.take("("):
                raise CellError("needs parentheses after sqrt")
            inner = self.sum()
            if not self.take(")") or not inner.is_plain or inner.plain < 0:
                raise CellError("takes the square root of something that is not a plain number ≥ 0")
            return _Sum(plain=math.sqrt(inner.plain))
        match = _VARIABLE.fullmatch(lowered)
        if match is None:
            raise CellError(f"has an unknown name {quoted(text, 20)}")
        index = int(match["index"]) if match["index"] else None
        letter = "theta" if match["letter"] in {"th", "θ"} else match["letter"]
        return _Sum(coefficient=1.0, variable=(letter, index))


def parse_cell(raw: object, quantity: Quantity, unit: float = 1.0) -> Cell:
    """Reads one cell of a table.

    Args:
        raw: A number, or a text as described at the head of this module.
        quantity: What the cell measures.
        unit: Value of one table unit in SI (``pi/180`` for degrees, ``1e-3`` for millimetres).

    Returns:
        The cell in rad, m or (for a plain number) unchanged.

    Raises:
        CellError: The cell is not finite, too large, of another quantity or not readable.
    """
    if isinstance(raw, bool) or raw is None or not isinstance(raw, (int, float, str)):
        raise CellError(f'is {quoted(raw)}; give a number or a text such as "pi/2"')
    if isinstance(raw, str):
        return _checked(_parse_text(raw, quantity, unit), raw)
    try:
        number = float(raw)
    except OverflowError:
        raise CellError("is too large; give a finite number") from None
    return _checked(Cell(_in_si(number, quantity, unit)), raw)


def _in_si(number: float, quantity: Quantity, unit: float) -> float:
    if quantity is Quantity.ANGLE and unit != 1.0:
        return math.radians(number)
    if quantity is Quantity.LENGTH and unit != 1.0:
        return number / round(1.0 / unit)
    return number


def _checked(cell: Cell, raw: object) -> Cell:
    if math.isnan(cell.value):
        raise CellError("is NaN; give a finite number")
    if math.isinf(cell.value):
        raise CellError("is infinite; give a finite number")
    if abs(cell.value) > MAX_MAGNITUDE:
        raise CellError(f"is {quoted(raw)}, beyond ±{MAX_MAGNITUDE:g}; check its unit")
    # -0.0 would not survive being written as nothing at all.
    return replace(cell, value=cell.value + 0.0)


def _parse_text(raw: str, quantity: Quantity, unit: float) -> Cell:
    shown = quoted(raw)
    if len(raw) > MAX_CELL_LENGTH:
        raise CellError(f"is longer than {MAX_CELL_LENGTH} characters")
    if not raw.strip():
        raise CellError("is empty; give a number")
    if raw.strip().lstrip("+-").lower() in {"nan", "inf", "infinity", ".nan", ".inf"}:
        raise CellError(f"is {shown}; give a finite number")
    text = raw.translate(_SIGNS)
    if _THOUSANDS.search(text):
        raise CellError(f"is {shown}, which reads as two numbers; write a decimal point")
    text = _RADIANS_AFTER_PI.sub(r"\1", text)
    try:
        total = _Parser(_DECIMAL_COMMA.sub(r"\1.\2", text)).parse()
    except CellError as error:
        raise CellError(f"is {shown}, which {error}") from None
    except (OverflowError, RecursionError):
        raise CellError(f"is {shown}, which is not a finite number") from None
    if quantity is not Quantity.LENGTH and total.has_length:
        raise CellError(f"is {shown}, a length; an {quantity.value} is needed")
    if quantity is Quantity.LENGTH and total.has_angle:
        raise CellError(f"is {shown}, an angle; a length is needed")
    if quantity is Quantity.ANGLE and unit != 1.0 and total.has_angle and total.plain != 0.0:
        raise CellError(f"is {shown}, which mixes π or an explicit unit with plain degrees")
    value = _in_si(total.plain, quantity, unit) + total.angle + total.length
    if total.variable is None:
        return Cell(value)
    if total.coefficient not in (1.0, -1.0):
        raise CellError(f"is {shown}; the joint variable must have coefficient +1 or -1")
    letter, index = total.variable
    return Cell(value, letter, index, int(total.coefficient))
