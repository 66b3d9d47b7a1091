"""Identities of sines and cosines: squares, and sums of angles."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from math import comb

from kinematics.symbolic.angles import total
from kinematics.symbolic.names import ROOTS, Kind, Names
from kinematics.symbolic.polynomial import (
    ZERO,
    Coefficient,
    Monomial,
    Polynomial,
    split,
    vanishes,
)

MAX_DEGREE = 6
"""Number of sines and cosines of dependent angles above which a product is not changed."""

_Exponents = tuple[tuple[str, int], ...]
"""``e^(i Σ n ψ)`` as (label of ψ, n), sorted, without zeros."""


def reduced(p: Polynomial, names: Names, keep: str = "C") -> Polynomial:
    """Replace ``S²`` by ``1 - C²`` and ``√2²`` by 2; a normal form while angles are independent.

    Args:
        p: The polynomial.
        names: Its symbols.
        keep: ``"S"`` replaces ``C²`` by ``1 - S²`` instead.
    """
    replaced: dict[str, tuple[int, str | None]] = {}
    for name in p.symbols():
        if name in ROOTS:
            replaced[name] = (ROOTS[name], None)
        elif names.kind(name) is Kind.TRIGONOMETRIC and name[0] != keep:
            replaced[name] = (1, f"{keep}{name[1:]}")
        elif name.startswith("sin("):
            replaced[name] = (1, f"cos{name[3:]}")
    if not any(e > 1 and name in replaced for monomial in p.terms for name, e in monomial):
        return p
    return Polynomial.collected(_reduced_terms(p, replaced))


def _reduced_terms(
    p: Polynomial, replaced: dict[str, tuple[int, str | None]]
) -> Iterable[tuple[Monomial, Coefficient]]:
    for monomial, coefficient in p:
        parts: list[tuple[dict[str, int], Coefficient]] = [(dict(monomial), coefficient)]
        for name, exponent in monomial:
            if exponent < 2 or name not in replaced:
                continue
            square, other = replaced[name]
            half = exponent // 2
            grown = []
            for exponents, value in parts:
                exponents[name] = exponent % 2
                if other is None:
                    grown.append((exponents, value * square**half))
                    continue
                for k in range(half + 1):
                    added = {**exponents, other: exponents.get(other, 0) + 2 * k}
                    grown.append((added, value * (-1) ** k * comb(half, k)))
            parts = grown
        for exponents, value in parts:
            yield tuple(sorted((n, e) for n, e in exponents.items() if e)), value


def combined(p: Polynomial, names: Names) -> Polynomial:
    """Join sums of angles where that is shorter: ``C2 C3 - S2 S3`` becomes ``C23``.

    Sines and cosines of angles that share joints are converted to exponentials, in which equal
    terms have one form, and back.
    """
    for family in _families(p, names):
        symbols = {f"{letter}{label}" for label in family for letter in "CS"}
        outer: dict[Monomial, dict[Monomial, Coefficient]] = {}
        for monomial, coefficient in p:
            inside, outside = split(monomial, symbols)
            outer.setdefault(outside, {})[inside] = coefficient
        parts: list[tuple[Monomial, Coefficient]] = []
        for outside, terms in outer.items():
            joined = _joined(terms, names)
            better = joined is not None and _weight(joined.terms) < _weight(terms)
            chosen = joined.terms if joined is not None and better else terms
            parts.extend(
                (tuple(sorted((*outside, *inside))), value) for inside, value in chosen.items()
            )
        p = Polynomial.collected(parts)
    return p


def _weight(terms: Iterable[Monomial]) -> int:
    return sum(1 + sum(e for _, e in monomial) for monomial in terms)


def _families(p: Polynomial, names: Names) -> list[set[str]]:
    """Return the labels of angles that share joints, two or more a family."""
    families: list[tuple[set[str], set[int]]] = []
    for name in sorted(p.symbols()):
        angle = names.angle_of(name)
        if angle is None:
            continue
        labels, joints = {name[1:]}, set(angle.joints)
        apart = []
        for other in families:
            if other[1] & joints:
                labels |= other[0]
                joints |= other[1]
            else:
                apart.append(other)
        families = [*apart, (labels, joints)]
    return [labels for labels, _ in families if len(labels) > 1]


def _joined(terms: dict[Monomial, Coefficient], names: Names) -> Polynomial | None:
    """Return a sum of single sines and cosines; None where that needs multiples such as 2 q2."""
    if len(terms) < 2 or any(sum(e for _, e in monomial) > MAX_DEGREE for monomial in terms):
        return None
    waves: dict[_Exponents, tuple[Coefficient, Coefficient]] = {}
    for monomial, coefficient in terms.items():
        exact = coefficient if isinstance(coefficient, float) else Fraction(coefficient)
        for exponents, real, imaginary in _exponentials(monomial, exact):
            before = waves.get(exponents, (0, 0))
            waves[exponents] = (before[0] + real, before[1] + imaginary)
    result = ZERO
    for exponents, (real, imaginary) in waves.items():
        if vanishes(real) and vanishes(imaginary):
            continue
        angle = total((names.angles[label], n) for label, n in exponents)
        if any(abs(n) > 1 for _, n in angle.multiples):
            return None
        cosine, sine = names.cos_sin(angle) if exponents else (Polynomial.constant(1), ZERO)
        # Its conjugate, -exponents, adds the other half and cancels the imaginary part.
        result += cosine.scaled(_plain(real)) + sine.scaled(_plain(-imaginary))
    return result


def _plain(value: Coefficient) -> Coefficient:
    whole = isinstance(value, Fraction) and value.denominator == 1
    return value.numerator if whole and isinstance(value, Fraction) else value


def _exponentials(
    monomial: Monomial, coefficient: Coefficient
) -> list[tuple[_Exponents, Coefficient, Coefficient]]:
    """Multiply out ``C = (E + 1/E)/2`` and ``S = (E - 1/E)/(2i)``."""
    parts: list[tuple[dict[str, int], Coefficient, Coefficient]] = [({}, coefficient, Fraction(0))]
    for name, exponent in monomial:
        letter, label = name[0], name[1:]
        for _ in range(exponent):
            grown = []
            for exponents, real, imaginary in parts:
                for step in (1, -1):
                    moved = {**exponents, label: exponents.get(label, 0) + step}
                    if letter == "C":
                        grown.append((moved, real / 2, imaginary / 2))
                    else:  # times -i * step / 2
                        grown.append((moved, imaginary * step / 2, -real * step / 2))
            parts = grown
    return [(tuple(sorted((n, e) for n, e in x.items() if e)), r, i) for x, r, i in parts]


def angle_labels(p: Polynomial, names: Names) -> list[str]:
    """Return the labels of the angles in it, from the base to the tip."""
    labels = {name[1:] for name in p.symbols() if names.angle_of(name) is not None}
    return sorted(labels, key=lambda label: names.order(f"C{label}"))


def shortest(p: Polynomial, names: Names) -> Polynomial:
    """Return the shortest of the equal polynomials found by squares and sums of angles."""
    candidates = [reduced(p, names), reduced(p, names, keep="S")]
    joined = [combined(candidate, names) for candidate in candidates]
    candidates += joined
    candidates += [reduced(candidate, names) for candidate in joined]
    return min(candidates, key=lambda candidate: _weight(candidate.terms))
