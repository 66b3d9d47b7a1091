"""Sums and products of a cell, parsed by recursive descent (no ``eval``)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say

_NUMBER = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_TOKEN = re.compile(
    rf"\s*(?:(?P<number>{_NUMBER})|(?P<word>[^\W\d_]\w*)|(?P<symbol>\*\*|[-+*/(),°^]))", re.UNICODE
)
_VARIABLE = re.compile(r"(?P<letter>q|theta|th|t|θ|ϑ|d|r)_?(?P<index>[0-9]{0,6})")
Variable: TypeAlias = tuple[str, int | None]
"""Letter and index of a joint variable."""
_ANGLE_UNITS = {"deg": math.pi / 180, "rad": 1.0}
_LENGTH_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
_TURNS = {"sin": math.sin, "cos": math.cos, "tan": math.tan}
FUNCTIONS = ("sqrt", "sin", "cos", "tan", "atan2", "deg2rad", "radians")


class CellError(ValueError):
    """A cell that cannot be read; the message says why and what to write."""


@dataclass(frozen=True, slots=True)
class Sum:
    """``plain + angle rad + length m + Σ coefficient * variable``, plain in the table's units.

    Attributes:
        terms: Each joint variable, as letter and index, with its coefficient.
    """

    plain: float = 0.0
    angle: float = 0.0
    length: float = 0.0
    terms: tuple[tuple[Variable, float], ...] = ()
    has_angle: bool = False
    has_length: bool = False

    @property
    def variable(self) -> Variable | None:
        """Return the first joint variable, None where there is none."""
        return self.terms[0][0] if self.terms else None

    def scaled(self, factor: float) -> Sum:
        """Return the sum times a number."""
        return Sum(
            self.plain * factor,
            self.angle * factor,
            self.length * factor,
            tuple((variable, coefficient * factor) for variable, coefficient in self.terms),
            self.has_angle,
            self.has_length,
        )

    def divided(self, divisor: float) -> Sum:
        """Return the sum divided by a number."""
        return Sum(
            self.plain / divisor,
            self.angle / divisor,
            self.length / divisor,
            tuple((variable, coefficient / divisor) for variable, coefficient in self.terms),
            self.has_angle,
            self.has_length,
        )

    def plus(self, other: Sum) -> Sum:
        """Return the sum of both."""
        terms = dict(self.terms)
        for variable, coefficient in other.terms:
            terms[variable] = terms.get(variable, 0.0) + coefficient
        return Sum(
            self.plain + other.plain,
            self.angle + other.angle,
            self.length + other.length,
            tuple(terms.items()),
            self.has_angle or other.has_angle,
            self.has_length or other.has_length,
        )

    @property
    def is_plain(self) -> bool:
        """Return True for a number without unit and variable."""
        return not (self.has_angle or self.has_length or self.terms)


def parse_sum(text: str, values: Lookup | None = None, angle: float = 1.0) -> Sum:
    """Read the arithmetic of one cell.

    Args:
        text: The cell, at most a few hundred characters: they bound the depth of the descent.
        values: What names stand for, without underscores; None where no names can be given.
        angle: Factor of plain numbers in ``sin``, ``cos`` and ``tan`` to rad.

    Raises:
        CellError: The text cannot be read.
        OverflowError: A number is not finite.
    """
    return _Parser(text, values, angle).parse()


def variable_of(name: str) -> tuple[str, int | None] | None:
    """Return letter and index of a joint variable (``th3``: ``("theta", 3)``), else None."""
    match = _VARIABLE.fullmatch(name)
    if match is None:
        return None
    letter = match["letter"]
    return (
        "theta" if letter in {"t", "th", "θ", "ϑ"} else letter,
        int(match["index"]) if match["index"] else None,
    )


class Lookup(Protocol):
    """What names stand for."""

    def get(self, name: str, /) -> Sum | None:
        """Return the value of a name without underscores, or None."""


def _power(base: Sum, exponent: Sum) -> Sum:
    """Return a plain number to a plain power."""
    if not base.is_plain or not exponent.is_plain:
        raise CellError(say("takes a power of something that is not a plain number"))
    if exponent.plain == 0.0:
        raise CellError(
            say("has the exponent 0, which may be a degree sign; write 90° or leave it out")
        )
    if base.plain == 0.0 and exponent.plain < 0.0:
        raise CellError(say("divides by zero"))
    result = base.plain**exponent.plain
    if isinstance(result, complex):
        raise CellError(say("takes a root of a negative number"))
    return Sum(plain=float(result))


class _Parser:
    """Recursive descent over one cell."""

    def __init__(self, text: str, values: Lookup | None, angle: float) -> None:
        self.tokens = list(self._tokens(text))
        self.position = 0
        self.values = values
        self.angle = angle

    @staticmethod
    def _tokens(text: str) -> list[tuple[str, str]]:
        tokens, position = [], 0
        stripped = text.rstrip()
        while position < len(stripped):
            match = _TOKEN.match(stripped, position)
            if match is None:
                raise CellError(
                    say("has an unexpected {text!r}", text=stripped[position:].lstrip()[:1])
                )
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

    def parse(self) -> Sum:
        result = self.sum()
        if self.peek()[0] != "end":
            raise CellError(say("has an unexpected {token!r}", token=self.peek()[1]))
        return result

    def sum(self) -> Sum:
        result = self.product()
        while symbol := self.take("+", "-"):
            term = self.product()
            result = result.plus(term if symbol == "+" else term.scaled(-1.0))
        return result

    def product(self) -> Sum:
        result = self.signed()
        while True:
            if self.take("*"):
                result = self._times(result, self.signed())
            elif self.take("/"):
                divisor = self.signed()
                if not divisor.is_plain:
                    raise CellError(say("divides by something that is not a plain number"))
                if divisor.plain == 0.0:
                    raise CellError(say("divides by zero"))
                result = result.divided(divisor.plain)
            elif self.peek()[0] == "word" or self.peek() == ("symbol", "("):
                self._refuse_uncertainty()
                result = self._times(result, self.signed())
            else:
                return result

    def _refuse_uncertainty(self) -> None:
        """Refuse ``0.4318(2)``, which is 0.4318 ± 0.0002 in a paper and could be a product."""
        near = self.tokens[self.position - 1 : self.position + 3]
        kinds = [kind for kind, _ in near]
        if kinds == ["number", "symbol", "number", "symbol"] and near[3][1] == ")":
            raise CellError(
                say("has a number in parentheses after a number; write * or leave it out")
            )

    @staticmethod
    def _times(left: Sum, right: Sum) -> Sum:
        if left.is_plain:
            return right.scaled(left.plain)
        if right.is_plain:
            return left.scaled(right.plain)
        raise CellError(say("multiplies two quantities that both carry a unit or a variable"))

    def signed(self) -> Sum:
        if self.take("-"):
            return self.signed().scaled(-1.0)
        if self.take("+"):
            return self.signed()
        base = self.with_unit(self.atom())
        if not self.take("**", "^"):
            return base
        exponent = self.signed()
        return _power(base, exponent)

    def with_unit(self, value: Sum) -> Sum:
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
            raise CellError(
                say("puts the unit {text!r} on something that is not a plain number", text=text)
            )
        if unit in _ANGLE_UNITS:
            angle = math.radians(value.plain) if unit == "deg" else value.plain
            return Sum(angle=angle, has_angle=True)
        length = value.plain * _LENGTH_UNITS[unit]
        if unit != "m":
            length = value.plain / round(1.0 / _LENGTH_UNITS[unit])
        return Sum(length=length, has_length=True)

    def atom(self) -> Sum:
        kind, text = self.peek()
        self.position += 1
        if kind == "number":
            return Sum(plain=float(text))
        if kind == "word":
            return self._word(text)
        if (kind, text) == ("symbol", "("):
            inner = self.sum()
            if not self.take(")"):
                raise CellError(say("lacks a closing parenthesis"))
            return inner
        raise CellError(
            say("ends too early") if kind == "end" else say("has an unexpected {text!r}", text=text)
        )

    def _word(self, text: str) -> Sum:
        given = self.values.get(text.replace("_", "")) if self.values is not None else None
        if given is not None:
            return given
        lowered = text.lower()
        if lowered in {"pi", "π"}:
            return Sum(angle=math.pi, has_angle=True)
        if lowered in FUNCTIONS:
            return self._function(lowered)
        variable = variable_of(lowered)
        if variable is None:
            remedy = (
                ""
                if self.values is None
                else say("; if it is a number, give values {text}:0.5", text=text)
            )
            raise CellError(
                say("has an unknown name {text}{remedy}", text=quoted(text, 20), remedy=remedy)
            )
        return Sum(terms=((variable, 1.0),))

    def _function(self, name: str) -> Sum:
        if not self.take("("):
            raise CellError(say("needs parentheses after {name}", name=name))
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        first, *others = arguments
        if not self.take(")") or len(others) != (name == "atan2"):
            wanted = (
                say('two arguments, separated by ", "') if name == "atan2" else say("one argument")
            )
            raise CellError(
                say("needs {wanted} in the parentheses after {name}", wanted=wanted, name=name)
            )
        if name == "atan2":
            return self._atan2(first, others[0])
        if name in _TURNS:
            if first.has_length or first.variable:
                raise CellError(say("takes the {name} of something that is no angle", name=name))
            if self.angle == 1.0 and abs(first.plain) > 2 * math.pi:
                raise CellError(
                    say(
                        "takes the {name} of {plain:g} rad; write {plain:g}°",
                        name=name,
                        plain=first.plain,
                    )
                )
            return Sum(plain=_TURNS[name](first.plain * self.angle + first.angle))
        if not first.is_plain or (name == "sqrt" and first.plain < 0):
            what = say("square root of something that is not a plain number ≥ 0")
            raise CellError(
                say("takes the {what}", what=what)
                if name == "sqrt"
                else say("needs a plain number in {name}", name=name)
            )
        if name == "sqrt":
            return Sum(plain=math.sqrt(first.plain))
        return Sum(angle=math.radians(first.plain), has_angle=True)

    @staticmethod
    def _atan2(y: Sum, x: Sum) -> Sum:
        for argument in (y, x):
            mixed = argument.has_length and argument.plain != 0.0
            if argument.has_angle or argument.variable or mixed:
                raise CellError(say("takes the atan2 of something that is no number and no length"))
        if y.has_length != x.has_length and 0.0 not in (y.plain + y.length, x.plain + x.length):
            raise CellError(say("takes the atan2 of a length and a plain number; give both alike"))
        return Sum(angle=math.atan2(y.plain + y.length, x.plain + x.length), has_angle=True)
