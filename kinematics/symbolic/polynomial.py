"""Sparse polynomials in named symbols, with exact coefficients where that is affordable.

Cosine and sine of an angle are independent symbols here; ``S² = 1 - C²`` is applied by
:mod:`kinematics.symbolic.trigonometry`. SymPy's rings need the symbols in advance, but sums of
angles such as C23 arise during the computation; its expressions are a hundred times as slow.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import TypeAlias

from dh_to_urdf.messages import say

Coefficient: TypeAlias = int | Fraction | float
Monomial: TypeAlias = tuple[tuple[str, int], ...]
"""Symbols with their exponents, sorted by name."""

ROUNDING = 1e-15
"""Bound below which a floating coefficient, a sum of products of cosines, is zero."""
MAX_TERMS = 4_000
MAX_PRODUCTS = 200_000


class TooManyTerms(ArithmeticError):
    """A polynomial exceeded the limits of readable size."""


class Polynomial:
    """An immutable polynomial. ``terms`` maps monomials to nonzero coefficients."""

    __slots__ = ("terms",)

    def __init__(self, terms: Mapping[Monomial, Coefficient]) -> None:
        if len(terms) > MAX_TERMS:
            raise TooManyTerms(say("an entry has over {max_terms} terms", max_terms=MAX_TERMS))
        self.terms = terms

    @classmethod
    def constant(cls, value: Coefficient) -> Polynomial:
        """Return a constant."""
        return cls({(): value}) if value else cls({})

    @classmethod
    def symbol(cls, name: str) -> Polynomial:
        """Return one symbol."""
        return cls({((name, 1),): 1})

    @classmethod
    def collected(cls, terms: Iterable[tuple[Monomial, Coefficient]]) -> Polynomial:
        """Return the sum of terms, in which a monomial may occur more than once."""
        found: dict[Monomial, Coefficient] = {}
        for monomial, coefficient in terms:
            found[monomial] = found.get(monomial, 0) + coefficient
        return cls({monomial: value for monomial, value in found.items() if not vanishes(value)})

    def __bool__(self) -> bool:
        return bool(self.terms)

    def __len__(self) -> int:
        return len(self.terms)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polynomial) and self.terms == other.terms

    def __hash__(self) -> int:
        return hash(frozenset(self.terms.items()))

    def __iter__(self) -> Iterator[tuple[Monomial, Coefficient]]:
        return iter(self.terms.items())

    def __neg__(self) -> Polynomial:
        return self.scaled(-1)

    def __add__(self, other: Polynomial) -> Polynomial:
        if not self or not other:
            return self if self else other
        return Polynomial.collected((*self, *other))

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + -other

    def __mul__(self, other: Polynomial) -> Polynomial:
        if len(self) * len(other) > MAX_PRODUCTS:
            raise TooManyTerms(
                say("a product has over {max_products} terms", max_products=MAX_PRODUCTS)
            )
        return Polynomial.collected(
            (multiplied(one, two), first * second) for one, first in self for two, second in other
        )

    def scaled(self, factor: Coefficient) -> Polynomial:
        """Return the polynomial times a number."""
        if factor == 1:
            return self
        return Polynomial({m: c * factor for m, c in self} if factor else {})

    def symbols(self) -> set[str]:
        """Names that occur."""
        return {name for monomial in self.terms for name, _ in monomial}

    @property
    def exact(self) -> bool:
        """Whether no coefficient is rounded."""
        return not any(isinstance(coefficient, float) for coefficient in self.terms.values())


def vanishes(value: Coefficient) -> bool:
    """Return True for zero, and for rounding errors of zero."""
    return abs(value) < ROUNDING if isinstance(value, float) else value == 0


ZERO = Polynomial({})
ONE = Polynomial.constant(1)


def multiplied(one: Monomial, two: Monomial) -> Monomial:
    """Return the product of two monomials."""
    if not one or not two:
        return one if one else two
    exponents = dict(one)
    for name, exponent in two:
        exponents[name] = exponents.get(name, 0) + exponent
    return tuple(sorted(exponents.items()))


def split(monomial: Monomial, names: Iterable[str]) -> tuple[Monomial, Monomial]:
    """Return the part of a monomial in some symbols, and the rest."""
    chosen = names if isinstance(names, (set, frozenset, dict)) else set(names)
    inside = tuple(item for item in monomial if item[0] in chosen)
    return inside, tuple(item for item in monomial if item[0] not in chosen)


def content(p: Polynomial) -> Monomial:
    """Return the largest monomial that divides every term."""
    terms = iter(p.terms)
    shared = dict(next(terms, ()))
    for monomial in terms:
        exponents = dict(monomial)
        shared = {n: min(e, exponents[n]) for n, e in shared.items() if n in exponents}
        if not shared:
            break
    return tuple(sorted(shared.items()))


def divided(p: Polynomial, monomial: Monomial) -> Polynomial:
    """Return ``p`` divided by a monomial that divides every term of it."""
    if not monomial:
        return p
    lowered = {name: -exponent for name, exponent in monomial}
    terms: dict[Monomial, Coefficient] = {}
    for other, coefficient in p:
        rest = ((name, exponent + lowered.get(name, 0)) for name, exponent in other)
        terms[tuple(item for item in rest if item[1])] = coefficient
    return Polynomial(terms)
