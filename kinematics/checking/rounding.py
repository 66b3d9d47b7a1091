"""Numbers with few decimals: what they can tell, and answers that are right but for them."""

from __future__ import annotations

import math

import numpy as np

from kinematics.checking.answers import Entries
from kinematics.checking.formulas import Formula
from kinematics.checking.slips import Slip
from robots.robot import FloatArray

IDENTICAL = 1e-9
"""Differences up to which formulas are equal, relative to values over 1."""


def thresholds(entries: Entries, tolerance: float, unit: float = 1.0) -> tuple[float, ...]:
    """Return the differences up to which an explanation fits, the closest first.

    Args:
        entries: The answer: numbers with few decimals cannot be met more closely than these say.
        tolerance: Of the question.
        unit: Value of 1 of the answer.
    """
    found = {IDENTICAL}
    if not entries.formulas or any(not isinstance(one, Formula) for one in entries.values):
        decimals = entries.decimals
        if decimals is not None and decimals >= 2:
            found.add(min(1.05 * 10.0**-decimals * unit, 0.02))
        found.add(tolerance)
    elif any(entries.rounded(k, ()) for k in range(len(entries.values))):
        found.add(tolerance)
    return tuple(sorted(found))


def cut_short(entries: Entries, given: FloatArray, expected: FloatArray) -> Slip | None:
    """Return the slip of an answer that is right but for its few digits; None where it is not.

    Args:
        entries: The answer.
        given: Its numbers, in its own units.
        expected: The right ones, in the same units.
    """
    if entries.formulas:
        return None
    decimals = entries.decimals
    if decimals is not None and decimals <= 8:
        scale = 10.0**decimals
        for code, values in (
            ("rounded", np.round(expected, decimals)),
            ("truncated", np.trunc(expected * scale) / scale),
        ):
            if np.abs(values - given).max() <= IDENTICAL and np.abs(given).max() > 0.0:
                return Slip(code, detail=_count(decimals, "decimal"))
    for digits in range(1, 7):
        values = np.array([_significant(x, digits) for x in np.ravel(expected)])
        if np.abs(values - np.ravel(given)).max() <= IDENTICAL * max(1.0, np.abs(given).max()):
            return Slip("rounded", detail=_count(digits, "digit"))
    return None


def _significant(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}") if math.isfinite(value) else value


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
