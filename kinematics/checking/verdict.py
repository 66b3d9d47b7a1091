"""What is found of an answer: right or not, where, by how much, and why."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from dh_to_urdf.errors import Location
from robots.robot import FloatArray

MAX_ERRORS = 100
ERROR_DIGITS = 2
"""Digits of an error: enough to find it, too few to correct the answer by it."""


@dataclass(frozen=True)
class EntryError:
    """An entry that is beyond the tolerance.

    Attributes:
        index: Its place in the answer.
        given: As given.
        off_by: Size of its error, without sign, in the units of the answer; None where it is no
            number.
    """

    index: Location
    given: float | str | None
    off_by: float | None


@dataclass(frozen=True)
class Diagnosis:
    """One slip of an explanation.

    Attributes:
        code: Kind of slip.
        message: What seems to have happened, for the student.
        explanation: Number of the explanation that it belongs to, from 1; slips of one number
            happened together, others are other ways to explain the answer.
    """

    code: str
    message: str
    explanation: int = 1


@dataclass(frozen=True, eq=False)
class Verdict:
    """What is found of an answer.

    Attributes:
        correct: Whether it is right within the tolerance.
        largest_error: Of its entries, in the units of the answer; None where none is a number.
        errors: The entries beyond the tolerance, at most 100.
        diagnosis: Slips that explain the answer, the best explanation first.
        note: What is right of it, or in which form; empty where there is nothing to say.
        expected: Gives what would be right, in the units of the answer.
    """

    correct: bool
    largest_error: float | None
    errors: tuple[EntryError, ...]
    diagnosis: tuple[Diagnosis, ...]
    note: str
    expected: Callable[[], Any]


def told(error: float) -> float | None:
    """Return the size of an error with few digits; None where it is no number."""
    if not math.isfinite(error):
        return None
    return float(f"{abs(error):.{ERROR_DIGITS}g}")


def largest(errors: FloatArray) -> float | None:
    """Return the largest error with few digits; None where one is no number."""
    return told(float(np.max(np.abs(errors), initial=0.0)))
