"""Factorisation of products of polynomials into short factors."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from sympy import QQ
from sympy.core.random import seed
from sympy.polys.rings import ring

from kinematics.symbolic.arrange import folded, leading_sign, shortest_form
from kinematics.symbolic.expressions import Factor, Product, Sum
from kinematics.symbolic.names import Names
from kinematics.symbolic.polynomial import Coefficient, Polynomial, content, divided
from kinematics.symbolic.trigonometry import reduced, shortest

MAX_VARIED = 12
"""Number of terms above which only the shortest form is factored."""
MAX_FACTORED = 40
"""Number of terms above which only polynomials linear in a symbol are factored."""


def factored(factors: Iterable[Polynomial], names: Names, *, deeply: bool = True) -> Product:
    """Return the product of polynomials, each factored over the rationals (SymPy).

    Sines and cosines count as independent, so that a factorisation that only holds with
    ``S² + C² = 1`` is found where one of its forms shows it.

    Args:
        factors: The polynomials.
        names: Their symbols.
        deeply: False only takes out common divisors of all terms.
    """
    powers: dict[Factor, int] = {}
    coefficient: Coefficient = 1
    for p in factors:
        shape = min((_factors(form, names, deeply) for form in _forms(p, names)), key=_size)
        coefficient *= shape.coefficient
        for factor, exponent in shape.factors:
            powers[factor] = powers.get(factor, 0) + exponent
    if coefficient == 0:
        return Product(0)
    symbols: list[Factor] = [*sorted((f for f in powers if isinstance(f, str)), key=names.order)]
    sums: list[Factor] = [f for f in powers if isinstance(f, Sum)]
    return Product(coefficient, tuple((f, powers[f]) for f in (*symbols, *sums)))


def _forms(p: Polynomial, names: Names) -> list[Polynomial]:
    forms = [shortest(p, names)]
    if len(forms[0]) <= MAX_VARIED:
        forms += [reduced(p, names), reduced(p, names, keep="S")]
    return [form for k, form in enumerate(forms) if form not in forms[:k]]


def _size(product: Product) -> tuple[int, int]:
    terms = sum(len(f.terms) * e for f, e in product.factors if isinstance(f, Sum))
    return terms, -sum(exponent for _, exponent in product.factors)


def _factors(p: Polynomial, names: Names, deeply: bool) -> Product:
    if not p:
        return Product(0)
    shared = content(p)
    rest = divided(p, shared)
    powers: list[tuple[Factor, int]] = []
    coefficient: Coefficient = 1
    parts = _irreducible(rest) if deeply and len(rest) > 1 and rest.exact else [(rest, 1)]
    for part, exponent in parts:
        sign = leading_sign(folded(part, names), names)
        coefficient *= sign**exponent
        body = shortest_form(part.scaled(sign), names)
        if len(body.terms) == 1:
            (term,) = body.terms
            coefficient *= term.coefficient**exponent
            powers += [(factor, e * exponent) for factor, e in term.factors]
            continue
        powers.append((body, exponent))
    (numbers,) = folded(Polynomial({shared: 1}), names)
    coefficient *= numbers[1]
    return Product(coefficient, (*numbers[0], *powers))


def _irreducible(p: Polynomial) -> list[tuple[Polynomial, int]]:
    """Return the factors of a polynomial that no monomial divides."""
    symbols = sorted(p.symbols())
    polynomials = ring([f"x{k}" for k in range(len(symbols))], QQ)[0]
    place = {name: k for k, name in enumerate(symbols)}
    terms = {}
    for monomial, coefficient in p:
        exponents = [0] * len(symbols)
        for name, exponent in monomial:
            exponents[place[name]] = exponent
        value = Fraction(coefficient)
        terms[tuple(exponents)] = QQ(value.numerator, value.denominator)
    return [
        (
            Polynomial(
                {
                    tuple((symbols[k], e) for k, e in enumerate(exponents) if e): _plain(value)
                    for exponents, value in part.terms()
                }
            ),
            power,
        )
        for part, power in _split(polynomials.from_dict(terms))
    ]


def _split(p: Any) -> list[tuple[Any, int]]:
    """Return the factors of an element of a ring.

    ``a x + b`` splits into gcd(a, b) and an irreducible part. Nearly all polynomials here are
    linear in some symbol; SymPy's factorisation, which is randomised and of unbounded time, is
    for small remainders.
    """
    polynomials, linear = p.ring, {}
    for k, x in enumerate(polynomials.gens):
        degrees = {exponents[k] for exponents in p.itermonoms()}
        if degrees == {0, 1}:
            linear[x] = polynomials.from_dict({m: c for m, c in p.terms() if m[k]}).exquo(x)
    if linear:
        x = min(linear, key=lambda x: len(linear[x]))
        shared = linear[x].gcd(p - linear[x] * x) if len(linear[x]) > 1 else polynomials.one
        rest = [(p.exquo(shared), 1)]
        return rest if shared.is_ground else [*rest, *_split(shared)]
    if len(p) > MAX_FACTORED:
        return [(p, 1)]
    seed(0)
    leading, found = p.factor_list()
    return [(polynomials.one * leading, 1), *found]


def _plain(value: object) -> Coefficient:
    exact = Fraction(str(value))
    return exact.numerator if exact.denominator == 1 else exact
