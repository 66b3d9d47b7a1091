"""Polynomials arranged as expressions: by lengths as in lectures, or nested from base to tip."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from fractions import Fraction

from kinematics.symbolic.expressions import Product, Sum, operations
from kinematics.symbolic.names import ROOTS, Kind, Names
from kinematics.symbolic.polynomial import (
    Coefficient,
    Monomial,
    Polynomial,
    content,
    divided,
    split,
)
from kinematics.symbolic.trigonometry import angle_labels


def folded(p: Polynomial, names: Names) -> Polynomial:
    """Return a polynomial with number symbols multiplied into the coefficients.

    Roots are kept, except beside cosines of angles that are known as numbers only.
    """
    values = {name: names.numbers[name] for name in p.symbols() if name in names.numbers}
    if any("(" in name for name in values):
        values |= {name: Fraction(repr(math.sqrt(square))) for name, square in ROOTS.items()}
    if not values:
        return p
    terms = []
    for monomial, coefficient in p:
        numbers, rest = split(monomial, values)
        value = coefficient
        for name, exponent in numbers:
            value *= values[name] ** exponent
        terms.append((rest, value))
    return Polynomial.collected(terms)


def expanded(p: Polynomial, names: Names) -> Sum:
    """Return a polynomial as a plain sum."""
    return Sum(tuple(_product(m, c, names) for m, c in _sorted(p, names)))


def by_lengths(p: Polynomial, names: Names) -> Sum:
    """Return a polynomial with terms of the same length together: ``R5*(…) + R3*C1*S2``."""
    groups: dict[tuple[Monomial, Coefficient], dict[Monomial, Coefficient]] = {}
    for monomial, coefficient in _sorted(p, names):
        lengths, rest = _lengths(monomial, names)
        sign = 1 if coefficient > 0 else -1
        groups.setdefault((lengths, coefficient * sign), {})[rest] = sign
    terms = []
    for (lengths, size), inner in groups.items():
        sign, body = _positive_first(_grouped_inner(Polynomial(inner), names))
        terms.append((-_degree(inner), lengths, _times(lengths, size * sign, body, names)))
    terms.sort(key=lambda term: term[:2])
    return Sum(_flat(product for _, _, product in terms))


def nested(p: Polynomial, names: Names, labels: list[str]) -> Sum:
    """Return it collected by angles in the given order: ``C1*(C23*(…) - S23*…) - S1*(…)``."""
    if len(p) <= 1:
        return expanded(p, names)
    shared = content(p)
    if shared:
        sign, body = _without_sign(nested(divided(p, shared), names, labels))
        return Sum(_flat([_times(shared, sign, body, names)]))
    for position, label in enumerate(labels):
        parts = _by_angle(p, label)
        if any(outside and len(terms) > 1 for outside, terms in parts.items()):
            following = labels[position + 1 :]
            products = []
            for outside, terms in parts.items():
                sign, body = _without_sign(nested(Polynomial(terms), names, following))
                products.append(_times(outside, sign, body, names))
            return Sum(_flat(products))
    return by_lengths(p, names)


def shortest_form(p: Polynomial, names: Names, *, position: bool = False) -> Sum:
    """Return the form with the fewest operations; positions by lengths."""
    p = folded(p, names)
    if position:
        return by_lengths(p, names)
    labels = angle_labels(p, names)
    forms = [nested(p, names, labels), nested(p, names, labels[::-1]), by_lengths(p, names)]
    return min(forms, key=operations)


def leading_sign(p: Polynomial, names: Names) -> int:
    """Return the sign of the term that is written first."""
    return 1 if not p or _sorted(p, names)[0][1] > 0 else -1


def _by_angle(p: Polynomial, label: str) -> dict[Monomial, dict[Monomial, Coefficient]]:
    parts: dict[Monomial, dict[Monomial, Coefficient]] = {}
    for monomial, coefficient in p:
        outside, inside = split(monomial, (f"C{label}", f"S{label}"))
        parts.setdefault(outside, {})[inside] = coefficient
    return dict(sorted(parts.items(), key=lambda item: (not item[0], item[0])))


def _lengths(monomial: Monomial, names: Names) -> tuple[Monomial, Monomial]:
    return split(monomial, {n for n, _ in monomial if names.kind(n) is not Kind.TRIGONOMETRIC})


def _degree(terms: Iterable[Monomial]) -> int:
    return max(sum(exponent for _, exponent in monomial) for monomial in terms)


def _grouped_inner(p: Polynomial, names: Names) -> Sum:
    shared = content(p)
    if not shared or len(p) == 1:
        return expanded(p, names)
    sign, body = _without_sign(expanded(divided(p, shared), names))
    return Sum((_times(shared, sign, body, names),))


def _without_sign(body: Sum) -> tuple[int, Sum]:
    """Return the body with as few minus signs as possible, the leading one taken out."""
    if body.terms and body.terms[0].coefficient < 0:
        return -1, Sum(tuple(term.scaled(-1) for term in body.terms))
    return 1, body


def _positive_first(body: Sum) -> tuple[int, Sum]:
    """Return the body with a positive term first; if there is none, all signs are taken out."""
    terms = sorted(body.terms, key=lambda term: term.coefficient < 0)
    first_only = body.terms[:1] != tuple(terms[:1])
    moved = (terms[0], *(t for t in body.terms if t is not terms[0])) if first_only else body.terms
    return _without_sign(Sum(moved))


def _times(monomial: Monomial, factor: Coefficient, body: Sum, names: Names) -> Product:
    """Return ``factor * monomial * body``; a body of one term is multiplied in."""
    outside = tuple(sorted(monomial, key=lambda item: names.order(item[0])))
    if len(body.terms) == 1:
        (inner,) = body.terms
        merged = [*outside, *inner.factors]
        plain = [item for item in merged if isinstance(item[0], str)]
        sums = [item for item in merged if not isinstance(item[0], str)]
        plain.sort(key=lambda item: names.order(str(item[0])))
        return Product(factor * inner.coefficient, (*plain, *sums))
    return Product(factor, (*outside, (body, 1)))


def _flat(products: Iterable[Product]) -> tuple[Product, ...]:
    """Return products with those that are only a sum in parentheses opened."""
    found: list[Product] = []
    for product in products:
        if len(product.factors) == 1 and isinstance(product.factors[0][0], Sum):
            inner, exponent = product.factors[0]
            assert isinstance(inner, Sum)
            if exponent == 1 and abs(product.coefficient) == 1:
                found.extend(term.scaled(product.coefficient) for term in inner.terms)
                continue
        found.append(product)
    return tuple(found)


def _product(monomial: Monomial, coefficient: Coefficient, names: Names) -> Product:
    factors = sorted(monomial, key=lambda item: names.order(item[0]))
    return Product(coefficient, tuple(factors))


def _sorted(p: Polynomial, names: Names) -> list[tuple[Monomial, Coefficient]]:
    """Return terms with many factors first, then by the angles nearest the tip, sines first."""
    return sorted(p, key=_term_order(names))


def _term_order(names: Names) -> Callable[[tuple[Monomial, Coefficient]], tuple[object, ...]]:
    def key(term: tuple[Monomial, Coefficient]) -> tuple[object, ...]:
        turning = [(n, e) for n, e in term[0] if names.kind(n) is Kind.TRIGONOMETRIC]
        lengths = [item for item in term[0] if item not in turning]
        angles = sorted(
            ((names.order(name)[1], name[0] == "C", name) for name, _ in turning), reverse=True
        )
        ranked = tuple((tuple(-j for j in joints), cosine) for joints, cosine, _ in angles)
        return -sum(e for _, e in turning), ranked, lengths

    return key
