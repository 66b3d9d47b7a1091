"""Symbols of one computation: lengths, joint variables, C1, S23, and their definitions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from enum import IntEnum
from fractions import Fraction
from itertools import chain, count

from kinematics.symbolic.angles import Angle, angle_text, twelfths
from kinematics.symbolic.length_names import Length, written_name
from kinematics.symbolic.polynomial import ONE, ZERO, Polynomial

HALF = Fraction(1, 2)
_QUARTER = Fraction(1, 4)
ROOT2, ROOT3 = "sqrt(2)", "sqrt(3)"
ROOTS = {ROOT2: 2, ROOT3: 3}
ENTRY = 1e-14
"""Distance of a rotation matrix entry from a known cosine below which it is that cosine."""


class Kind(IntEnum):
    """Kind of a symbol, in the order in which factors are written."""

    NUMBER = 0
    ROOT = 1
    LENGTH = 2
    VARIABLE = 3
    TRIGONOMETRIC = 4


class Names:
    """The symbols that occur in one computation.

    Attributes:
        lengths: Value of each named length, m.
        numbers: Exact value of each symbol that stands for a number.
        angles: The angle of each label: ``23`` is q2 + q3, C23 and S23 are symbols.
        variables: Joint variables that are symbols themselves (prismatic ones).
    """

    def __init__(
        self, dof: int, symbolic: bool, chosen: Mapping[str, str], *, rounded: bool = False
    ) -> None:
        """Create an empty set of symbols.

        Args:
            dof: Length of q.
            symbolic: Whether lengths have names.
            chosen: Names of lengths by their default names.
            rounded: Whether numbers are multiplied out at once instead of kept as symbols, where
                there would be too many.
        """
        self.lengths: dict[str, float] = {}
        self.numbers: dict[str, Fraction] = {}
        self.angles: dict[str, Angle] = {}
        self.variables: dict[str, int] = {}
        self._separator = "" if dof < 10 else "_"
        self._symbolic = symbolic
        self._chosen = chosen
        self._rounded = rounded
        self._labels: dict[Angle, str] = {}

    def length(self, length: Length) -> Polynomial:
        """Return the symbol of a length of the table, or its number."""
        name, sign = written_name(length, self._chosen, symbolic=self._symbolic)
        if name is None:
            return self.number(length.value)
        self.lengths[name] = sign * length.value
        return Polynomial.symbol(name).scaled(sign)

    def number(self, value: float) -> Polynomial:
        """Return a number as a symbol of its own, kept apart until it is written."""
        if value == 0.0 or value == 1.0 or value == -1.0:
            return Polynomial.constant(int(value))
        if self._rounded:
            return Polynomial.constant(float(value))
        name = repr(abs(float(value)))
        self.numbers[name] = Fraction(name)
        return Polynomial.symbol(name).scaled(1 if value > 0 else -1)

    def variable(self, joint: int) -> Polynomial:
        """Return q of a prismatic joint."""
        self.variables[f"q{joint}"] = joint
        return Polynomial.symbol(f"q{joint}")

    def entry(self, value: float) -> Polynomial:
        """Return an entry of a rotation matrix; exact where it is the cosine of a known angle."""
        exact = known_cosine(value)
        return self.number(value) if exact is None else exact

    def cos_sin(self, angle: Angle) -> tuple[Polynomial, Polynomial]:
        """Return cosine and sine of an angle."""
        if not angle.multiples:
            return self._constant(angle.constant)
        if angle.multiples[0][1] < 0:
            cosine, sine = self.cos_sin(-angle)
            return cosine, -sine
        quarters = round(angle.constant / (math.pi / 2))
        if twelfths(angle.constant - quarters * math.pi / 2) != 0:
            quarters = 0
            rest = math.remainder(angle.constant, 2 * math.pi)
        else:
            rest = 0.0
        label = self._label(Angle(angle.multiples, rest))
        cosine, sine = Polynomial.symbol(f"C{label}"), Polynomial.symbol(f"S{label}")
        return ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[quarters % 4]

    def kind(self, name: str) -> Kind:
        """Return the kind of a symbol."""
        if name in ROOTS:
            return Kind.ROOT
        if name in self.numbers:
            return Kind.NUMBER
        if name in self.lengths:
            return Kind.LENGTH
        return Kind.VARIABLE if name in self.variables else Kind.TRIGONOMETRIC

    def angle_of(self, name: str) -> Angle | None:
        """Return the angle of a symbol such as S23; None for other symbols."""
        return self.angles.get(name[1:]) if self.kind(name) is Kind.TRIGONOMETRIC else None

    def definition(self, name: str) -> str:
        """Return the definition of a symbol: ``cos(q2 + q3)`` for C23."""
        return f"{'cos' if name[0] == 'C' else 'sin'}({angle_text(self.angles[name[1:]])})"

    def order(self, name: str) -> tuple[int, tuple[int, ...], str]:
        """Return the sort key of a factor: numbers, lengths, angles from the base to the tip."""
        kind = self.kind(name)
        if kind is not Kind.TRIGONOMETRIC:
            return kind, (), name
        return kind, tuple(joint for joint, _ in self.angles[name[1:]].multiples), name

    def values(self, q: Mapping[int, float]) -> dict[str, float]:
        """Return every symbol's value at joint values by number."""
        found = {name: float(value) for name, value in self.numbers.items()}
        found.update({name: math.sqrt(value) for name, value in ROOTS.items()})
        found.update(self.lengths)
        found.update({name: q[joint] for name, joint in self.variables.items()})
        for label, angle in self.angles.items():
            value = angle.constant + sum(n * q[joint] for joint, n in angle.multiples)
            found[f"C{label}"], found[f"S{label}"] = math.cos(value), math.sin(value)
        return found

    def _constant(self, angle: float) -> tuple[Polynomial, Polynomial]:
        steps = twelfths(angle)
        if steps is not None:
            known, shifted = _known_cosine(steps), _known_cosine((steps - 6) % 24)
            return known, shifted
        if self._rounded:
            return Polynomial.constant(math.cos(angle)), Polynomial.constant(math.sin(angle))
        sign = 1 if math.sin(angle) > 0 else -1
        values = (math.cos(angle), abs(math.sin(angle)))
        rest = math.remainder(angle, 2 * math.pi)
        pair = (f"cos({abs(rest)!r})", f"sin({abs(rest)!r})")
        for name, value in zip(pair, values, strict=True):
            self.numbers[name] = Fraction(repr(value))
        return Polynomial.symbol(pair[0]), Polynomial.symbol(pair[1]).scaled(sign)

    def _label(self, angle: Angle) -> str:
        key = Angle(angle.multiples, round(angle.constant, 13))
        if key in self._labels:
            return self._labels[key]
        plus, minus = ([str(j) for j, n in angle.multiples if n * sign > 0] for sign in (1, -1))
        label = self._separator.join(plus)
        if minus:
            label += f"m{self._separator.join(minus)}"
        for suffix in chain(("", "b", "c", "d"), (f"_{n}" for n in count(5))):
            if f"{label}{suffix}" not in self.angles:
                break
        label += suffix
        self.angles[label] = angle
        self._labels[key] = label
        return label


def known_cosine(value: float) -> Polynomial | None:
    """Return a number as the exact cosine of a multiple of π/12; None where it is none."""
    exact = map(_known_cosine, range(13))
    return next((p for p in exact if abs(value - _evaluated(p)) <= ENTRY), None)


def _known_cosine(steps: int) -> Polynomial:
    """Return the exact cosine of ``steps`` twelfths of π."""
    steps = min(steps % 24, -steps % 24)
    if steps > 6:
        return -_known_cosine(12 - steps)
    root2, root3 = Polynomial.symbol(ROOT2), Polynomial.symbol(ROOT3)
    return (
        ONE,
        root2.scaled(_QUARTER) + (root2 * root3).scaled(_QUARTER),
        root3.scaled(HALF),
        root2.scaled(HALF),
        Polynomial.constant(HALF),
        (root2 * root3).scaled(_QUARTER) - root2.scaled(_QUARTER),
        ZERO,
    )[steps]


def _evaluated(p: Polynomial) -> float:
    return sum(
        float(c) * math.prod(math.sqrt(ROOTS[name]) ** e for name, e in monomial)
        for monomial, c in p
    )
