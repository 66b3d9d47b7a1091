"""Answers as they are given: numbers and formulas, one or in nested lists."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal

import numpy as np

from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.bounds import MAX_VALUE
from kinematics.checking.formulas import Formula, Scope, parse_formula
from kinematics.errors import InvalidAnswer
from robots.robot import FloatArray

MAX_ENTRIES = 2000
MAX_CHARACTERS = 60_000
MAX_NESTING = 3
WRITTEN_IN_FULL = 12
"""Decimals from which on a number counts as not rounded."""
FEW = 3
"""Decimals from which on a number in a formula counts as rounded."""


@dataclass(frozen=True, eq=False)
class Entries:
    """The entries of an answer, row by row.

    Attributes:
        shape: Shape of the nested lists; () for one entry.
        values: Each entry, a number or a formula, flat.
    """

    shape: tuple[int, ...]
    values: tuple[float | Formula, ...]

    @property
    def formulas(self) -> tuple[Formula, ...]:
        """Return the formulas among the entries."""
        return tuple(one for one in self.values if isinstance(one, Formula))

    @property
    def decimals(self) -> int | None:
        """Return with how many decimals the numbers are written; None where not rounded."""
        found = [decimals_of(one) for one in self.values if not isinstance(one, Formula)]
        most = max(found, default=WRITTEN_IN_FULL)
        return None if most >= WRITTEN_IN_FULL or self.formulas else most

    def place(self, flat: int) -> Location:
        """Return the place of an entry in the answer."""
        if not self.shape:
            return ()
        return tuple(int(k) for k in np.unravel_index(flat, self.shape))

    def shown(self, flat: int) -> float | str:
        """Return an entry as it was given."""
        one = self.values[flat]
        return one.text if isinstance(one, Formula) else one

    def at(self, scope: Scope, points: int) -> FloatArray:
        """Return all entries at P points, shape (P, …).

        Raises:
            InvalidAnswer: A name in a formula is unknown.
        """
        columns = [
            np.broadcast_to(one.value(scope) if isinstance(one, Formula) else one, (points,))
            for one in self.values
        ]
        return np.stack(columns, axis=-1).reshape(points, *self.shape)

    def rounded(self, flat: int, lengths: Sequence[float]) -> bool:
        """Return whether an entry is a formula with rounded numbers, other than given lengths."""
        one = self.values[flat]
        if not isinstance(one, Formula):
            return False
        return any(
            decimals_of(number) >= FEW and all(abs(number - abs(x)) > 1e-12 for x in lengths)
            for number in one.numbers
        )


def read_entries(answer: object) -> Entries:
    """Read an answer of numbers and formulas.

    Raises:
        InvalidAnswer: Something else, lists of unequal lengths, too large, or a formula that
            cannot be read; with its place.
    """
    values: list[float | Formula] = []
    budget = [MAX_CHARACTERS]
    shape = _read(answer, (), values, budget)
    return Entries(shape, tuple(values))


def _read(
    answer: object, place: Location, values: list[float | Formula], budget: list[int]
) -> tuple[int, ...]:
    if isinstance(answer, (list, tuple)):
        if len(place) >= MAX_NESTING:
            raise _refusal(say("is nested too deeply; give a matrix as a list of its rows"), place)
        if not answer:
            raise _refusal(say("is empty; give its numbers"), place)
        shapes = []
        for k, one in enumerate(answer):
            shapes.append(_read(one, (*place, k), values, budget))
            if shapes[k] != shapes[0]:
                raise _refusal(
                    say(
                        "has {shape} where the one before has {shape_2}; give rows of equal length",
                        shape=_size(shapes[k]),
                        shape_2=_size(shapes[0]),
                    ),
                    (*place, k),
                )
        return (len(answer), *shapes[0])
    if len(values) >= MAX_ENTRIES:
        raise _refusal(say("has more than {max_entries} entries", max_entries=MAX_ENTRIES), place)
    values.append(_entry(answer, place, budget))
    return ()


def _entry(answer: object, place: Location, budget: list[int]) -> float | Formula:
    if isinstance(answer, str):
        budget[0] -= len(answer)
        if budget[0] < 0:
            raise _refusal(
                say("has more than {max_characters} characters", max_characters=MAX_CHARACTERS),
                place,
            )
        if not answer.strip():
            raise _refusal(say("is an empty text; give a number or a formula"), place)
        return parse_formula(answer, place)
    if isinstance(answer, bool) or not isinstance(answer, (int, float)):
        raise _refusal(say("is {answer}; give a number or a formula", answer=quoted(answer)), place)
    try:
        number = float(answer)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number) or abs(number) > MAX_VALUE * 1000:
        raise _refusal(say("is too large; give a number within ±1e9"), place)
    return number + 0.0


def _refusal(what: str, place: Location) -> InvalidAnswer:
    name = ".".join(("answer", *map(str, place)))
    return InvalidAnswer(f"{name} {what}", argument="answer", index=place)


def _size(shape: tuple[int, ...]) -> str:
    return say("{shape} entries", shape=shape[0]) if shape else say("one number")


def decimals_of(number: float) -> int:
    """Return the number of decimals with which a number is written shortest."""
    exponent = Decimal(repr(float(number))).normalize().as_tuple().exponent
    return max(0, -int(exponent))
