"""Formulas as students write them: ``a1 a2 S2``, ``-L1*cos q1 - L2 C12``, ``√3/2``.

Read by recursive descent into a tree, without ``eval``; lengths and depths are bounded. Products
may leave out the sign, functions of one angle the parentheses.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.errors import InvalidAnswer
from robots.robot import FloatArray

MAX_LENGTH = 4000
MAX_DEPTH = 40
MAX_EXPONENT = 12
_WRITTEN = (
    (r"\cdot", "*"), (r"\times", "*"), (r"\theta", "θ"), (r"\pi", "π"), (r"\sqrt", "sqrt"),
    (r"\left", ""), (r"\right", ""), (r"\sin", "sin"), (r"\cos", "cos"), (r"\tan", "tan"),
    (r"\,", " "), ("**", "^"),
)  # fmt: skip
_SIGNS = str.maketrans(
    "−–·⋅×∗÷ϑϴₒ₀₁₂₃₄₅₆₇₈₉{}[]\u00a0\u2009\t\n\r",
    "--****/θθo0123456789()()     ",
)
_POWERS = {"²": "^2", "³": "^3", "⁴": "^4"}
_COMMA = re.compile(r"(?<=\d),(?=\d)")
_SUBSCRIPT = re.compile(r"_\s*\(\s*([0-9]+(?:\s*[,+]?\s*[0-9]+)*)\s*\)")
_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![0-9.]))"
    r"|(?P<word>[^\W\d_]+(?:_?[0-9]+)?(?:_[0-9]+)*(?:m[0-9]+(?:_[0-9]+)*)?)"
    r"|(?P<symbol>[-+*/^()°√]))"
)
FUNCTIONS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "sqrt": np.sqrt,
    "√": np.sqrt,
}
_TURNS = ("sin", "cos", "tan")
_EXCHANGED = {"sin": "cos", "cos": "sin"}
_GLUED = re.compile(r"(sin|cos|tan)(?=[qtθ])(.+)", re.IGNORECASE)


@dataclass(frozen=True)
class Scope:
    """What the names of a formula stand for.

    Attributes:
        look_up: Value of a name at P points, None for an unknown one; angles in rad.
        exchanged: Whether sin stands for cos, and the other way round.
        degrees: Whether plain numbers within sin and cos are degrees.
        known: Names for messages.
    """

    look_up: Callable[[str], FloatArray | None]
    degrees: bool = False
    exchanged: bool = False
    known: tuple[str, ...] = ()


Node = Callable[[Scope, float], FloatArray]
"""Gives the value of a part of a formula; the number is what 1 of a plain angle is, in rad."""


@dataclass(frozen=True, eq=False)
class Formula:
    """A formula that has been read.

    Attributes:
        text: As it was given.
        words: Names in it, in order.
        numbers: Plain numbers in it.
        location: Where it stands in the answer.
    """

    text: str
    words: tuple[str, ...]
    numbers: tuple[float, ...]
    location: Location
    _root: Node

    def value(self, scope: Scope) -> FloatArray:
        """Return its value at P points; not finite where it has none.

        Raises:
            InvalidAnswer: A name in it is unknown.
        """
        with np.errstate(all="ignore"):
            return np.asarray(self._root(scope, 1.0), dtype=np.float64)


def parse_formula(text: str, location: Location = ()) -> Formula:
    """Read a formula.

    Args:
        text: The formula.
        location: Where it stands in the answer, for errors.

    Raises:
        InvalidAnswer: It is too long or too deep, or cannot be read; with the place in it.
    """
    if len(text) > MAX_LENGTH:
        raise InvalidAnswer(
            say(
                "a formula is longer than {max_length} characters; give a shorter one",
                max_length=MAX_LENGTH,
            ),
            argument="answer",
            index=location,
        )
    return _Parser(text, location).formula()


def _normalised(text: str) -> str:
    for written, meant in _WRITTEN:
        text = text.replace(written, meant)
    text = text.translate(_SIGNS)
    for written, meant in _POWERS.items():
        text = text.replace(written, meant)
    text = _COMMA.sub(".", text)
    return _SUBSCRIPT.sub(lambda found: "_".join(re.findall(r"[0-9]+", "_" + found[1])), text)


class _Parser:
    """Reads one formula from left to right."""

    def __init__(self, text: str, location: Location) -> None:
        self.text, self.location = text, location
        self.tokens = self._tokens(_normalised(text))
        self.at = 0
        self.depth = 0
        self.words: list[str] = []
        self.numbers: list[float] = []

    def formula(self) -> Formula:
        root = self._sum()
        if self.at < len(self.tokens):
            self._refuse(
                say(
                    "has {token} where nothing can follow",
                    token=quoted(self.tokens[self.at][1], 12),
                )
            )
        words, numbers = tuple(self.words), tuple(self.numbers)
        return Formula(self.text, words, numbers, self.location, root)

    def _tokens(self, text: str) -> list[tuple[str, str]]:
        found: list[tuple[str, str]] = []
        place = 0
        text = text.rstrip()
        while place < len(text):
            match = _TOKEN.match(text, place)
            if match is None:
                shown = quoted(text[place : place + 12].strip(), 12)
                self._refuse(say("has {text}, which is no part of a formula", text=shown), place)
            kind = match.lastgroup or ""
            word = match[kind]
            glued = _GLUED.fullmatch(word) if kind == "word" else None
            if glued is not None:
                found += [("word", glued[1]), ("word", glued[2])]
            else:
                found.append((kind, word))
            place = match.end()
        return found

    def _refuse(self, what: str, place: int | None = None) -> NoReturn:
        raise InvalidAnswer(
            say(
                "the formula {text} {what}; write it such as a1*C1 + a2*C12 or L1 cos(q1)",
                text=quoted(self.text, 60),
                what=what,
            ),
            argument="answer",
            index=self.location,
            value=self.text[:64],
            position=place,
        )

    def _peek(self) -> tuple[str, str]:
        return self.tokens[self.at] if self.at < len(self.tokens) else ("end", "")

    def _take(self, symbols: str) -> str:
        kind, word = self._peek()
        if kind == "symbol" and word in symbols:
            self.at += 1
            return word
        return ""

    def _sum(self) -> Node:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            self._refuse(say("is nested more than {max_depth} deep", max_depth=MAX_DEPTH))
        terms = [(1.0, self._product())]
        while sign := self._take("+-"):
            terms.append((1.0 if sign == "+" else -1.0, self._product()))
        self.depth -= 1
        return terms[0][1] if len(terms) == 1 else _sum_of(terms)

    def _product(self) -> Node:
        factors, divisors = [self._signed()], []
        while True:
            if self._take("*"):
                factors.append(self._signed())
            elif self._take("/"):
                divisors.append(self._signed())
            elif self._begins_factor():
                factors.append(self._power())
            elif len(factors) == 1 and not divisors:
                return factors[0]
            else:
                return _product_of(factors, divisors)

    def _signed(self) -> Node:
        negative = False
        while sign := self._take("+-"):
            negative ^= sign == "-"
        power = self._power()
        return _scaled(power, -1.0) if negative else power

    def _begins_factor(self) -> bool:
        kind, word = self._peek()
        return kind in ("number", "word") or (kind == "symbol" and word in "(√")

    def _power(self) -> Node:
        found = self._factor()
        if not self._take("^"):
            return found
        exponent = self._exponent()
        if self._take("^"):
            self._refuse(say("has a power of a power"))
        return _raised(found, exponent)

    def _exponent(self) -> float:
        bracket = self._take("(")
        negative = bool(self._take("-"))
        kind, word = self._peek()
        if kind != "number":
            self._refuse(say("has an exponent that is no number"))
        self.at += 1
        exponent = float(word)
        if bracket and self._take("/"):
            kind, word = self._peek()
            if kind != "number" or float(word) == 0.0:
                self._refuse(say("has an exponent that is no number"))
            self.at += 1
            exponent /= float(word)
        if bracket and not self._take(")"):
            self._refuse(say("has an exponent without a closing bracket"))
        if exponent > MAX_EXPONENT:
            self._refuse(say("has an exponent above {max_exponent}", max_exponent=MAX_EXPONENT))
        return -exponent if negative else exponent

    def _factor(self) -> Node:
        kind, word = self._peek()
        if kind == "end":
            self._refuse(say("ends too early"))
        self.at += 1
        if kind == "number":
            return self._number(float(word))
        if kind == "word":
            return self._function(word) if word.lower() in FUNCTIONS else self._name(word)
        if word == "√":
            self.depth += 1
            if self.depth > MAX_DEPTH:
                self._refuse(say("is nested more than {max_depth} deep", max_depth=MAX_DEPTH))
            root = _applied("sqrt", self._factor())
            self.depth -= 1
            return root
        if word == "(":
            inner = self._sum()
            if not self._take(")"):
                self._refuse(say("lacks a closing bracket"))
            return inner
        return self._refuse(say("has {word} where a value is needed", word=quoted(word, 4)))

    def _number(self, value: float) -> Node:
        if not np.isfinite(value) or abs(value) > 1e12:
            self._refuse(say("has a number beyond ±1e12"))
        self.numbers.append(value)
        if self._take("°"):
            return lambda _, unit: np.asarray(np.deg2rad(value) / unit)
        return lambda _scope, _unit: np.asarray(value)

    def _name(self, word: str) -> Node:
        location = self.location
        if word.lower() in ("pi", "π"):
            return lambda _, unit: np.asarray(np.pi / unit)
        self.words.append(word)

        def value(scope: Scope, unit: float) -> FloatArray:
            found = scope.look_up(word)
            if found is None:
                raise InvalidAnswer(
                    say(
                        "{word} is no name here; known are {known}, and S12, C1 or sin(q1 +"
                        " q2); say what others are in symbols",
                        word=quoted(word, 24),
                        known=", ".join(scope.known),
                    ),
                    argument="answer",
                    index=location,
                    value=word[:24],
                    known=scope.known,
                )
            return found / unit

        return value

    def _function(self, word: str) -> Node:
        name = word.lower()
        exponent = self._exponent() if self._take("^") else 1.0
        argument = self._factor() if self._peek() == ("symbol", "(") else self._argument()
        applied = _applied(name, argument)
        return applied if exponent == 1.0 else _raised(applied, exponent)

    def _argument(self) -> Node:
        """Read what follows a function without brackets: ``q2``, ``2 q2``, ``30°``, ``-q1``."""
        negative = bool(self._take("-"))
        kind, word = self._peek()
        if kind not in ("number", "word") or word.lower() in FUNCTIONS:
            self._refuse(say("has a function without an argument"))
        argument = self._factor()
        if kind == "number" and self._peek()[0] == "word":
            following = self._peek()[1].lower()
            if following not in FUNCTIONS and following[:1] in "qtθ":
                argument = _product_of([argument, self._factor()], [])
        return _scaled(argument, -1.0) if negative else argument


def _sum_of(terms: Sequence[tuple[float, Node]]) -> Node:
    def total(scope: Scope, unit: float) -> FloatArray:
        found = np.asarray(0.0)
        for sign, term in terms:
            found = found + sign * term(scope, unit)
        return found

    return total


def _product_of(factors: Sequence[Node], divisors: Sequence[Node]) -> Node:
    def product(scope: Scope, unit: float) -> FloatArray:
        found = np.asarray(1.0)
        for factor in factors:
            found = found * factor(scope, unit)
        for divisor in divisors:
            found = found / divisor(scope, 1.0)
        return found

    return product


def _raised(inner: Node, exponent: float) -> Node:
    return lambda scope, unit: inner(scope, unit) ** exponent


def _scaled(inner: Node, factor: float) -> Node:
    return lambda scope, unit: factor * inner(scope, unit)


def _applied(name: str, argument: Node) -> Node:
    function = FUNCTIONS[name]
    if name not in _TURNS:
        return lambda scope, _: function(argument(scope, 1.0))

    def turned(scope: Scope, unit: float) -> FloatArray:
        del unit
        plain = np.pi / 180 if scope.degrees else 1.0
        turn = FUNCTIONS[_EXCHANGED.get(name, name)] if scope.exchanged else function
        return turn(plain * argument(scope, plain))

    return turned
