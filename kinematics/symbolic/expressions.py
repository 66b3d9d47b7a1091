"""Expressions: sums of products, with parentheses."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import TypeAlias

from kinematics.symbolic.polynomial import Coefficient

DIGITS = 17


@dataclass(frozen=True, slots=True)
class Product:
    """``coefficient * factor^exponent * …``; factors are symbols or sums."""

    coefficient: Coefficient
    factors: tuple[tuple[Factor, int], ...] = ()

    def scaled(self, by: Coefficient) -> Product:
        """Return the product times a number."""
        return Product(self.coefficient * by, self.factors)


@dataclass(frozen=True, slots=True)
class Sum:
    """A sum of products; empty for zero."""

    terms: tuple[Product, ...] = ()


Factor: TypeAlias = str | Sum


def operations(expression: Sum) -> int:
    """Return the number of additions and multiplications that evaluate it."""
    return max(0, len(expression.terms) - 1) + sum(_of_product(term) for term in expression.terms)


def _of_product(product: Product) -> int:
    count = -1 if abs(product.coefficient) == 1 and product.factors else 0
    for factor, exponent in product.factors:
        count += exponent + (exponent * operations(factor) if isinstance(factor, Sum) else 0)
    return count


def evaluate(expression: Sum, values: Mapping[str, float]) -> float:
    """Return its value, given the values of its symbols."""
    return math.fsum(_value_of(term, values) for term in expression.terms)


def _value_of(product: Product, values: Mapping[str, float]) -> float:
    value = float(product.coefficient)
    for factor, exponent in product.factors:
        base = evaluate(factor, values) if isinstance(factor, Sum) else values[factor]
        value *= base**exponent
    return value


def symbols(expression: Sum) -> set[str]:
    """Return the names that occur."""
    found: set[str] = set()
    for term in expression.terms:
        for factor, _ in term.factors:
            found |= symbols(factor) if isinstance(factor, Sum) else {factor}
    return found


def number_text(value: Coefficient) -> str:
    """Return a number in decimal digits, exact with at most 17, else as the nearest double."""
    value = Fraction(value)
    if value.denominator == 1:
        return str(value.numerator)
    rest = value.denominator
    for prime in (2, 5):
        while rest % prime == 0:
            rest //= prime
    if rest == 1:
        exact = Decimal(value.numerator) / Decimal(value.denominator)
        if Fraction(exact) == value and len(exact.as_tuple().digits) <= DIGITS:
            return f"{exact:f}" if 1e-6 <= abs(exact) < 1e15 else repr(float(exact))
    return repr(float(value))


def text(expression: Sum) -> str:
    """Return text as ``R5*(C1*C2*C3*S4 - S1*S3*S4 + C1*S2*C4) + R3*C1*S2``, valid in Python."""
    return _written(expression, _text_product)


def latex(expression: Sum) -> str:
    """Return an expression in LaTeX."""
    return _written(expression, _latex_product)


def _written(expression: Sum, write: Callable[[Product], str]) -> str:
    parts = []
    for term in expression.terms:
        sign = "-" if term.coefficient < 0 else "+"
        parts.append(f"{sign} {write(term.scaled(-1) if sign == '-' else term)}")
    joined = " ".join(parts) or "+ 0"
    return joined[2:] if joined[0] == "+" else f"-{joined[2:]}"


def _text_product(product: Product) -> str:
    parts = []
    if product.coefficient != 1 or not product.factors:
        parts.append(number_text(product.coefficient))
    for factor, exponent in product.factors:
        base = f"({text(factor)})" if isinstance(factor, Sum) else factor
        parts.append(base if exponent == 1 else f"{base}**{exponent}")
    return "*".join(parts)


def _latex_product(product: Product) -> str:
    parts = []
    if product.coefficient != 1 or not product.factors:
        parts.append(latex_number(product.coefficient))
    for factor, exponent in product.factors:
        base = rf"\left({latex(factor)}\right)" if isinstance(factor, Sum) else latex_name(factor)
        parts.append(base if exponent == 1 else f"{base}^{{{exponent}}}")
    return r" \, ".join(parts)


def latex_number(value: Coefficient) -> str:
    r"""Return digits, or ``1.2 \cdot 10^{-9}``."""
    mantissa, e, exponent = number_text(value).partition("e")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}" if e else mantissa


def latex_name(name: str) -> str:
    r"""Return ``C_{23}`` for C23, ``\sqrt{2}`` for sqrt(2)."""
    if name.startswith("sqrt("):
        return rf"\sqrt{{{name[5:-1]}}}"
    letters = name.rstrip("0123456789_m") if name[0] in "CS" else name.rstrip("0123456789")
    letters = letters or name[0]
    index = name[len(letters) :].replace("_", ",").replace("m", "-")
    letters = (letters.rstrip("_") if index else letters).replace("_", r"\_")
    return f"{letters}_{{{index}}}" if index else letters
