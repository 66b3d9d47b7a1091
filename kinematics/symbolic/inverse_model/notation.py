"""Expressions of a derivation in each notation: text and Python, C, MATLAB, LaTeX."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from kinematics.symbolic.expressions import Product, Sum, latex_name, latex_number, number_text
from kinematics.symbolic.inverse_model.statements import Angle, Coordinate, Let, Towards, Trig

_GREEK = re.compile(r"(theta|e)(\d+)(_*)")
_WORDS = {"xs": "x_s", "ys": "y_s", "zs": "z_s", "fs": "f_s", "gs": "g_s"}
_INDEXED = re.compile(r"([a-z])([a-z])(_*)")
_LETTER_DIGITS = re.compile(r"([a-z]+)(\d+)(_*)")


def _power(base: str, exponent: int) -> str:
    return f"{base}**{exponent}"


def _repeated(base: str, exponent: int) -> str:
    return "*".join([base] * exponent)


def _caret(base: str, exponent: int) -> str:
    return f"{base}^{exponent}"


def latex_symbol(name: str) -> str:
    r"""Return ``\theta_{1}`` for theta1, ``\varepsilon_{1}`` for e1, ``x_{w}`` for xw."""
    if found := _GREEK.fullmatch(name):
        letter = r"\theta" if found[1] == "theta" else r"\varepsilon"
        return f"{letter}_{{{found[2]}}}" + "'" * len(found[3])
    if found := _INDEXED.fullmatch(name):
        return f"{found[1]}_{{{found[2]}}}" + "'" * len(found[3])
    if name[-1] == "_":
        return latex_symbol(name.rstrip("_")) + "'" * (len(name) - len(name.rstrip("_")))
    return latex_name(name)


@dataclass(frozen=True)
class Style:
    """How expressions are written.

    Attributes:
        power: Writes a power of a base that is a name or in parentheses.
        name: Writes a symbol.
        number: Writes a number's size.
        times: Between factors.
        opening: Of parentheses.
        closing: Of parentheses.
        atan2: Writes an angle from y and x.
        minus: Between a sign's name and what it stands before.
        fraction: Writes a quotient, given its numerator and denominator.
    """

    power: Callable[[str, int], str] = _power
    name: Callable[[str], str] = str
    number: Callable[[object], str] = number_text  # type: ignore[assignment]
    times: str = "*"
    opening: str = "("
    closing: str = ")"
    atan2: str = "atan2({y}, {x})"
    is_latex: bool = False

    def sum(self, value: Sum) -> str:
        """Return an expression."""
        found = ""
        for term in value.terms:
            negative = term.coefficient < 0
            body = self._product(term.scaled(-1) if negative else term)
            if found:
                found += f" {'-' if negative else '+'} {body}"
            else:
                found = f"-{body}" if negative else body
        return found or "0"

    def _product(self, product: Product) -> str:
        parts = []
        if product.coefficient != 1 or not product.factors:
            parts.append(self.number(product.coefficient))
        for factor, exponent in product.factors:
            if isinstance(factor, Sum):
                base = f"{self.opening}{self.sum(factor)}{self.closing}"
            else:
                base = self.name(factor)
            parts.append(base if exponent == 1 else self.power(base, exponent))
        return self.times.join(parts)

    def let(self, one: Let) -> str:
        """Return the right side of a definition."""
        top = self.sum(one.value)
        if one.over is None:
            return top
        if self.is_latex:
            return rf"\frac{{{top}}}{{{self.sum(one.over)}}}"
        top = top if len(one.value.terms) == 1 else f"({top})"
        return f"{top}/{self._divisor(one.over)}"

    def _divisor(self, value: Sum) -> str:
        found = self.sum(value)
        if len(value.terms) != 1 or found.startswith("-"):
            return f"({found})"
        (term,) = value.terms
        plain = len(term.factors) + (term.coefficient != 1) <= 1
        return found if plain else f"({found})"

    def angle(self, one: Angle) -> str:
        """Return the right side of an angle."""
        found = ""
        for part in one.parts:
            sign, call = self._part(part)
            found += f" {sign} {call}" if found else (f"-{call}" if sign == "-" else call)
        return found

    def _part(self, part: Towards) -> tuple[str, str]:
        call = self.atan2.format(y=self.sum(part.y), x=self.sum(part.x))
        if part.sign is None:
            return "+", call
        sign = self.sum(part.sign)
        if sign in ("1", "-1"):
            return ("-" if sign == "-1" else "+"), call
        if sign.startswith("-"):
            return "-", f"{sign[1:]}{self.times}{call}"
        return "+", f"{sign}{self.times}{call}"

    def argument(self, one: Trig) -> str:
        """Return the argument of a cosine and sine."""
        found = ""
        for name, n in one.terms:
            size = self.name(name) if abs(n) == 1 else f"{abs(n)}{self.times}{self.name(name)}"
            if found:
                found += f" {'-' if n < 0 else '+'} {size}"
            else:
                found = f"-{size}" if n < 0 else size
        if one.constant:
            found += f" {'-' if one.constant < 0 else '+'} {abs(one.constant)!r}"
        return found

    def coordinate(self, one: Coordinate, turn: str) -> str:
        """Return the value of an entry of q, given the size of its constant turn as text."""
        found = self.sum(one.value)
        if not one.turn:
            return found
        return f"{found} {'-' if one.turn < 0 else '+'} {turn}"


PYTHON = Style()
C = Style(power=_repeated)
MATLAB = Style(power=_caret)
LATEX = Style(
    power=lambda base, exponent: f"{base}^{{{exponent}}}",
    name=latex_symbol,
    number=latex_number,  # type: ignore[arg-type]
    times=r" \, ",
    opening=r"\left(",
    closing=r"\right)",
    atan2=r"\mathrm{{atan2}}\left({y}, \; {x}\right)",
    is_latex=True,
)
