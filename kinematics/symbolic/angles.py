"""Angles ``±q1 ± q2 + constant``, and the constants that have an exact cosine."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction

KNOWN = 1e-12
"""Distance, rad, below which an angle counts as a multiple of π/12."""

_STEP = math.pi / 12


@dataclass(frozen=True, slots=True)
class Angle:
    """A sum of joint variables and a constant.

    Attributes:
        multiples: (number of the joint from 1, coefficient), sorted, without zeros.
        constant: rad.
    """

    multiples: tuple[tuple[int, int], ...] = ()
    constant: float = 0.0

    def __add__(self, other: Angle) -> Angle:
        return total(((self, 1), (other, 1)))

    def __neg__(self) -> Angle:
        return Angle(tuple((j, -n) for j, n in self.multiples), -self.constant)

    @property
    def joints(self) -> frozenset[int]:
        """Numbers of the joints in it."""
        return frozenset(joint for joint, _ in self.multiples)


def total(parts: Iterable[tuple[Angle, int]]) -> Angle:
    """Return the sum of angles, each times an integer."""
    multiples: dict[int, int] = {}
    constant = 0.0
    for angle, factor in parts:
        constant += factor * angle.constant
        for joint, n in angle.multiples:
            multiples[joint] = multiples.get(joint, 0) + factor * n
    return Angle(tuple(sorted((j, n) for j, n in multiples.items() if n)), constant)


def twelfths(angle: float) -> int | None:
    """Return ``angle / (π/12)``, 0 to 23, where that is an integer within ``KNOWN``; else None."""
    steps = round(angle / _STEP)
    return steps % 24 if abs(angle - steps * _STEP) <= KNOWN else None


def turn_text(angle: float) -> str:
    """Return ``pi/2``, ``-3*pi/4``, or the digits of a number that is no such multiple of π."""
    steps = round(angle / _STEP)
    if abs(angle - steps * _STEP) > KNOWN:
        return repr(angle)
    part = Fraction(steps, 12)
    sign, over = "-" if part < 0 else "", "" if part.denominator == 1 else f"/{part.denominator}"
    times = "" if abs(part.numerator) == 1 else f"{abs(part.numerator)}*"
    return f"{sign}{times}pi{over}" if part else "0"


def angle_text(angle: Angle) -> str:
    """Return an angle as text, such as ``q1 + q2 - q4 + pi/6``."""
    parts = []
    for joint, n in angle.multiples:
        size = "" if abs(n) == 1 else f"{abs(n)}*"
        parts.append(f"{'-' if n < 0 else '+'} {size}q{joint}")
    if twelfths(angle.constant) != 0:
        sign = "-" if angle.constant < 0 else "+"
        parts.append(f"{sign} {turn_text(abs(angle.constant))}")
    text = " ".join(parts) or "+ 0"
    return text.removeprefix("+ ") if text[0] == "+" else f"-{text[2:]}"
