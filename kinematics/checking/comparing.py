"""Numbers and formulas held against the right values, entry by entry."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.checking.answers import FEW, WRITTEN_IN_FULL, Entries, decimals_of
from kinematics.checking.formulas import Formula
from kinematics.checking.ground import Ground, ground_of
from kinematics.checking.messages import message_of
from kinematics.checking.question import Question
from kinematics.checking.rounding import IDENTICAL, cut_short, thresholds
from kinematics.checking.search import (
    Comparison,
    Explanation,
    Reading,
    Trial,
    explanations,
    independent,
    to_given,
)
from kinematics.checking.situation import (
    Motion,
    Situation,
    Structure,
    at_first_points,
    evaluate,
    situation_of,
)
from kinematics.checking.slips import Slip, slips_of
from kinematics.checking.symbols import (
    AngleReading,
    Points,
    drawn_q,
    lengths_in,
    points_at,
    scope_of,
    uses_joints,
)
from kinematics.checking.verdict import MAX_ERRORS, Diagnosis, EntryError, Verdict, largest, told
from kinematics.errors import InvalidAnswer
from kinematics.symbolic.length_names import Length
from robots.robot import FloatArray

DIAGNOSED_POINTS = 3


@dataclass(frozen=True, eq=False)
class Measure:
    """How a quantity is computed, and how far an answer may be from it.

    Attributes:
        values: Gives the right values of a motion, shape (N, P, …).
        exact: Gives them from the robot itself at q of shape (P, dof), where it has no table.
        readings: Gives the right reading, and those of slips.
        allowed: Gives the largest error of each entry that counts as right, for a tolerance.
        unit: Value of 1 in the answer, in m or rad, that goes with its shape.
        note: Says what is right of an answer, from where it is wrong.
        frame: Frame; None: the tip.
        rows: Rows of the table, where they are not those from the base to the frame.
        product: Whether link matrices are multiplied.
        prepared: Changes the situation before anything is computed.
    """

    values: Callable[[Motion], FloatArray]
    exact: Callable[[FloatArray], FloatArray]
    readings: Callable[[Structure], list[Reading]]
    allowed: Callable[[FloatArray, float], FloatArray]
    unit: FloatArray
    note: Callable[[NDArray[np.bool_]], str]
    frame: str | None = None
    rows: Sequence[int] | None = None
    product: bool = True
    prepared: Callable[[Situation], Situation] = lambda situation: situation


@dataclass(frozen=True, eq=False)
class _Compared:
    """An answer beside the right values, at P points, in m and rad."""

    structure: Structure
    situation: Situation
    lengths: Mapping[str, FloatArray]
    given: FloatArray
    expected: FloatArray
    allowed: FloatArray

    @property
    def errors(self) -> FloatArray:
        """Return the largest error of each entry over the points; inf where not finite."""
        away = np.abs(self.given - self.expected)
        return np.asarray(np.where(np.isfinite(away), away, np.inf).max(axis=0))

    @property
    def wrong(self) -> NDArray[np.bool_]:
        """Return which entries are beyond their tolerance."""
        away = np.abs(self.given - self.expected)
        return np.asarray((~(away <= self.allowed)).any(axis=0))

    @property
    def excess(self) -> float:
        """Return the largest error in parts of what is allowed."""
        away = np.abs(self.given - self.expected) / self.allowed
        return float(np.where(np.isfinite(away), away, np.inf).max())


def check_entries(question: Question, entries: Entries, measure: Measure) -> Verdict:
    """Hold an answer of numbers and formulas against the right values.

    Args:
        question: What is asked.
        entries: The answer, of the shape that the measure has.
        measure: How the right values are computed.

    Raises:
        InvalidAnswer: A name in a formula is unknown, or q is needed and missing.
    """
    ground = ground_of(question, measure.frame, measure.rows)
    formulas = entries.formulas
    general = any(uses_joints(one, ground.names) for one in formulas)
    if question.q is None and not formulas:
        raise InvalidAnswer(
            say("q is missing; give the joint values that the answer holds at, or a formula"),
            argument="q",
        )
    lacking: Slip | None = None
    if general or question.q is None:
        found, lacking = _with_formulas(question, entries, measure, ground)
    else:
        found = _at(question, entries, measure, ground, question.q[None], (), general=False)
    return _judged(question, entries, measure, ground, found, lacking, general=general)


def _with_formulas(
    question: Question, entries: Entries, measure: Measure, ground: Ground
) -> tuple[_Compared, Slip | None]:
    """Compare at drawn q, and at drawn lengths where the formulas name some."""
    named = lengths_in(entries.formulas, ground.names)
    q = drawn_q(situation_of(question.robot, ground.table, np.zeros((1, question.robot.dof)))[0])
    if not named:
        return _at(question, entries, measure, ground, q, (), general=True), None
    every = tuple(ground.names)
    found = _at(question, entries, measure, ground, q, every, general=True)
    if not found.wrong.any():
        return found, None
    only = tuple(n for n, one in ground.names.items() if (one.row, one.column) in named)
    part = _at(question, entries, measure, ground, q, only, general=True)
    if part.wrong.any():
        return found, None
    numbers = {abs(x) for one in entries.formulas for x in one.numbers}
    missing = [
        one
        for one in {(o.row, o.column): o for o in ground.names.values()}.values()
        if (one.row, one.column) not in named and not _is_among(abs(one.value), numbers)
    ]
    needed = [one for one in missing if _matters(question, entries, measure, ground, q, only, one)]
    if not needed:
        return part, None
    one = needed[0]
    return found, Slip("length_missing", one.name, f"{one.value:g}")


def _is_among(value: float, numbers: set[float]) -> bool:
    return any(abs(value - number) <= IDENTICAL * max(1.0, value) for number in numbers)


def _matters(
    question: Question,
    entries: Entries,
    measure: Measure,
    ground: Ground,
    q: FloatArray,
    only: tuple[str, ...],
    one: Length,
) -> bool:
    """Return whether the right values change with a length."""
    own = tuple(n for n, x in ground.names.items() if (x.row, x.column) == (one.row, one.column))
    found = _at(question, entries, measure, ground, q, (*only, *own), general=True)
    return bool(found.wrong.any())


def _at(
    question: Question,
    entries: Entries,
    measure: Measure,
    ground: Ground,
    q: FloatArray,
    varied: tuple[str, ...],
    *,
    general: bool,
) -> _Compared:
    rows = measure.rows
    structure, situation = situation_of(question.robot, ground.table, q, ground.frame, rows)
    points = points_at(measure.prepared(situation), structure, ground.names, varied)
    if ground.is_written:
        expected = measure.values(evaluate(structure, [points.situation]))[0]
    else:
        expected = measure.exact(q)
    allowed = _allowed(question, entries, measure, ground, expected, general=general)
    readings = AngleReading if entries.formulas else (AngleReading.JOINT,)
    found = [
        _Compared(
            structure,
            points.situation,
            points.lengths,
            _given(question, entries, structure, points, reading) * measure.unit,
            expected,
            allowed,
        )
        for reading in readings
    ]
    return min(found, key=lambda one: one.excess)


def _given(
    question: Question,
    entries: Entries,
    structure: Structure,
    points: Points,
    reading: AngleReading,
) -> FloatArray:
    scope = scope_of(structure, points, reading, degrees=question.angle != 1.0)
    try:
        return entries.at(scope, len(points.situation.q))
    except InvalidAnswer:
        if reading is AngleReading.JOINT:
            raise
        return np.full((len(points.situation.q), *entries.shape), np.inf)


def _allowed(
    question: Question,
    entries: Entries,
    measure: Measure,
    ground: Ground,
    expected: FloatArray,
    *,
    general: bool,
) -> FloatArray:
    allowed = measure.allowed(expected, question.tolerance)
    if not general:
        return allowed
    exact = np.minimum(allowed, IDENTICAL * np.maximum(1.0, np.abs(expected)))
    lengths = [one.value for one in ground.names.values()]
    rounded = np.array(
        [
            entries.rounded(k, lengths)
            if isinstance(one, Formula)
            else FEW <= decimals_of(one) < WRITTEN_IN_FULL
            for k, one in enumerate(entries.values)
        ]
    ).reshape(entries.shape)
    return np.where(rounded, allowed, exact)


def _judged(
    question: Question,
    entries: Entries,
    measure: Measure,
    ground: Ground,
    found: _Compared,
    lacking: Slip | None,
    *,
    general: bool,
) -> Verdict:
    unit = np.broadcast_to(measure.unit, entries.shape)
    shown = found.errors / np.abs(unit)
    wrong = found.wrong

    def expected() -> Any:
        if not general:
            return found.expected[0] / unit
        if question.q is None:
            return None
        q = question.q[None]
        return _at(question, entries, measure, ground, q, (), general=False).expected[0] / unit

    if not wrong.any():
        return Verdict(True, largest(shown), (), (), "", expected)
    errors = tuple(
        EntryError(entries.place(int(k)), entries.shown(int(k)), told(float(np.ravel(shown)[k])))
        for k in np.flatnonzero(wrong)[:MAX_ERRORS]
    )
    if lacking is not None:
        diagnosis = diagnosed([Explanation((lacking,), 0.0)])
    elif not np.isfinite(found.given).all():
        diagnosis = diagnosed([Explanation((Slip("not_finite"),), 0.0)])
    elif _is_right_exchanged(question, entries, measure, found):
        diagnosis = diagnosed([Explanation((Slip("sin_and_cos_exchanged"),), 0.0)])
    else:
        cut = (
            None if general else cut_short(entries, found.given[0] / unit, found.expected[0] / unit)
        )
        diagnosis = diagnosed(
            [Explanation((cut,), 0.0)]
            if cut is not None
            else explanations(_trial(question, entries, measure, ground, found, general=general))
        )
    return Verdict(False, largest(shown), errors, diagnosis, measure.note(wrong), expected)


def _is_right_exchanged(
    question: Question, entries: Entries, measure: Measure, found: _Compared
) -> bool:
    """Return whether formulas are right with sin for cos, and cos for sin."""
    if not entries.formulas:
        return False
    points = Points(found.situation, found.lengths)
    degrees = question.angle != 1.0
    for reading in AngleReading:
        scope = scope_of(found.structure, points, reading, degrees=degrees, exchanged=True)
        try:
            given = entries.at(scope, len(found.given)) * measure.unit
        except InvalidAnswer:
            continue
        if (np.abs(given - found.expected) <= found.allowed).all():
            return True
    return False


def _trial(
    question: Question,
    entries: Entries,
    measure: Measure,
    ground: Ground,
    found: _Compared,
    *,
    general: bool,
) -> Trial:
    points = DIAGNOSED_POINTS if general else 1
    situation = at_first_points(found.situation, points)
    structure, given = found.structure, found.given[:points]
    slips = slips_of(structure, situation, written=ground.is_written, product=measure.product)
    right = Comparison((), to_given(given))
    # Many slips make a determinant 0: an answer that is 0 everywhere tells none of them.
    limits = thresholds(entries, question.tolerance) if np.any(np.abs(given) > IDENTICAL) else ()
    return Trial(
        structure,
        situation,
        slips,
        measure.readings(structure),
        (right,),
        limits,
        independent(found.expected[:points]) if not general else 8,
    )


def diagnosed(found: Sequence[Explanation]) -> tuple[Diagnosis, ...]:
    """Return the slips of explanations with their messages."""
    return tuple(
        Diagnosis(slip.code, message_of(slip), number)
        for number, one in enumerate(found, start=1)
        for slip in sorted(one.slips, key=lambda slip: slip.cost)
    )


def without_base(situation: Situation) -> Situation:
    """Return a situation whose base is that of frame 0."""
    return replace(situation, base=np.broadcast_to(np.eye(4), situation.base.shape))
