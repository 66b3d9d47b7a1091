"""D-H tables: compared as written, then by the motion that they describe."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np

from dh_to_urdf import DHError, compare, read_mapping, to_convention
from dh_to_urdf.documents.layouts import document
from dh_to_urdf.errors import Fault, Location
from dh_to_urdf.extraction.as_written import CellDifference, differences_as_written
from dh_to_urdf.extraction.comparison_result import Verdict as Comparison
from dh_to_urdf.table import DHTable
from kinematics.checking.comparing import diagnosed
from kinematics.checking.question import Question
from kinematics.checking.search import Explanation
from kinematics.checking.situation import BoolArray, Situation, Structure, evaluate, situation_of
from kinematics.checking.slips import Found, SituationSlip, Slip, slips_of
from kinematics.checking.symbols import drawn_q
from kinematics.checking.verdict import MAX_ERRORS, EntryError, Verdict, told
from kinematics.errors import InvalidAnswer, InvalidOption
from kinematics.orientation import wrap
from robots.chains import chain_of_robot
from robots.errors import RobotError
from robots.robot import robot_from_table

MAX_PAIRS = 4000
_GEOMETRY = ("alpha", "a", "d", "theta", "offset", "sign", "gamma", "b", "type", "ant", "r")


def check_table(question: Question, answer: object) -> Verdict:
    """Check a D-H table.

    Raises:
        InvalidAnswer: No document of a table.
        InvalidOption: The robot has no table.
        DHError: The document cannot be used; locations are within ``answer``.
    """
    table = question.robot.table
    if table is None:
        raise InvalidOption(
            "this robot was made from a URDF and has no D-H table to compare with",
            argument="quantity",
        )
    given = _read(question, answer, table)

    def expected() -> Any:
        return document(table)

    tolerance = question.tolerance
    cells = _cells(table, given, tolerance)
    if cells is not None and not cells:
        return Verdict(True, _largest(table, given, question), (), (), "", expected)
    away = _deviation(question, table, given)
    if away is not None and away <= tolerance:
        note = "equivalent, with other frames: the pose of the tool is the same at every q"
        return Verdict(True, told(away), (), (), note, expected)
    shown = cells if cells is not None else _cells_converted(table, given, tolerance)
    rows: Location = () if isinstance(answer, list) else ("joints",)
    errors = tuple(_error(cell, question, rows) for cell in shown[:MAX_ERRORS])
    sizes = [one.off_by for one in errors if one.off_by is not None]
    found = _why(question, table, given)
    note = _note(question, table, given, shown)
    return Verdict(False, max(sizes, default=None), errors, diagnosed(found), note, expected)


def _read(question: Question, answer: object, table: DHTable) -> DHTable:
    rows_only = isinstance(answer, list)
    if rows_only:
        answer = {"joints": answer}
    if not isinstance(answer, Mapping):
        raise InvalidAnswer(
            "answer is no table; give its rows as a list of objects, or a document with convention"
            " and joints",
            argument="answer",
        )
    whole = {"convention": table.convention.value, **answer}
    units = {"angle": "rad" if question.angle == 1.0 else "deg",
             "length": "m" if question.length == 1.0 else "mm"}  # fmt: skip
    whole.setdefault("units", units)
    try:
        return read_mapping(whole, "answer")
    except DHError as error:
        # The place in a list of rows has no name of the field that holds them in a document.
        skipped = 1 if rows_only else 0
        faults = [Fault(("answer", *one.location[skipped:]), one.message) for one in error.faults]
        raise DHError(faults) from None


def _cells(table: DHTable, given: DHTable, tolerance: float) -> list[CellDifference] | None:
    """Return the cells of the geometry that differ as written; None for other conventions."""
    found = differences_as_written(table, given, length=tolerance, angle=tolerance)
    if found is None:
        return None
    return [cell for cell in found if not _is_equal(cell, tolerance)]


def _is_equal(cell: CellDifference, tolerance: float) -> bool:
    """Return whether a difference is none: whole turns, or no matter of geometry."""
    if cell.parameter in ("lower", "upper", "velocity", "effort"):
        return True
    if cell.is_angle and cell.difference is not None:
        return abs(math.remainder(cell.difference, 2 * math.pi)) <= tolerance
    return False


def _cells_converted(table: DHTable, given: DHTable, tolerance: float) -> list[CellDifference]:
    """Return the cells that differ once the answer is in the convention of the table."""
    try:
        converted = to_convention(given, table.convention)
    except DHError:
        return []
    return _cells(table, converted, tolerance) or []


def _largest(table: DHTable, given: DHTable, question: Question) -> float | None:
    cells = differences_as_written(table, given, length=0.0, angle=0.0) or ()
    sizes = [_size(cell, question) for cell in cells if cell.parameter in _GEOMETRY]
    return told(max((one for one in sizes if one is not None), default=0.0))


def _size(cell: CellDifference, question: Question) -> float | None:
    if cell.difference is None:
        return None
    if cell.is_angle:
        return abs(math.remainder(cell.difference, 2 * math.pi)) / question.angle
    if cell.parameter in ("sign", "ant"):
        return abs(cell.difference)
    return abs(cell.difference) / question.length


def _error(cell: CellDifference, question: Question, rows: Location) -> EntryError:
    size = _size(cell, question)
    given: float | str | None = cell.second
    if isinstance(given, float) and cell.is_angle:
        given = given / question.angle
    elif isinstance(given, float) and cell.parameter not in ("sign", "ant"):
        given = given / question.length
    off_by = None if size is None else told(size)
    if not cell.joint:
        return EntryError((cell.name,), given, off_by)
    place: Location = (*rows, cell.joint - 1)
    if cell.parameter != "joints":
        place = (*place, cell.parameter)
    return EntryError(place, given, off_by)


def _deviation(question: Question, table: DHTable, given: DHTable) -> float | None:
    """Return the largest difference of the two tools, m and rad; None for other joints."""
    robot = question.robot
    try:
        other = robot_from_table(given)
    except RobotError:
        return None
    if other.dof != robot.dof or not np.array_equal(other.is_revolute, robot.is_revolute):
        return None
    structure, situation = situation_of(robot, table, np.zeros((1, robot.dof)))
    q = drawn_q(structure)
    poses = []
    for one, own in ((robot, table), (other, given)):
        structure, situation = situation_of(one, own, q)
        poses.append(evaluate(structure, [situation]).pose[0])
    return float(np.abs(poses[0] - poses[1]).max())


def _note(question: Question, table: DHTable, given: DHTable, cells: list[CellDifference]) -> str:
    if given.convention is not table.convention:
        return "compared in the convention of the robot's table"
    if len(given.rows) == len(table.rows):
        wrong = {cell.joint for cell in cells}
        right = [row.name for k, row in enumerate(table.rows, start=1) if k not in wrong]
        if right:
            return f"right rows: {', '.join(right)}"
    try:
        found = compare(chain_of_robot(question.robot), chain_of_robot(robot_from_table(given)))
    except (DHError, RobotError):
        return ""
    if found.verdict is Comparison.EQUIVALENT:
        return "the same arm up to base, tool and zeros of its joints"
    return ""


def _columns_swapped(structure: Structure, situation: Situation) -> Found:
    """α and θ, or a and d, in each other's column: of all rows, or of one."""
    count = structure.count

    def swapped(first: str, rows: BoolArray, one: Situation) -> Situation:
        if first == "a":
            a, d = np.where(rows, one.d, one.a), np.where(rows, one.a, one.d)
            return replace(one, a=a, d=d)
        turning = rows & structure.revolute
        alpha = np.where(turning, one.offset[0], one.alpha)
        return replace(one, alpha=alpha, offset=np.where(turning, one.alpha, one.offset))

    for first, second in (("a", "d"), ("alpha", "offset")):
        x, y = getattr(situation, first), getattr(situation, second)
        slip = Slip("columns_swapped", detail=f"{first}, {second}", cost=1.2)
        yield SituationSlip(slip, partial(swapped, first, np.ones(count, dtype=bool)))
        different = np.atleast_2d(x)[0] != np.atleast_2d(y)[0]
        for row in np.flatnonzero(different):
            only = np.arange(count) == row
            slip = Slip("columns_swapped", structure.rows[row], f"{first}, {second}", 1.25)
            yield SituationSlip(slip, partial(swapped, first, only))


def _in_wrong_unit(structure: Structure, _: Situation) -> Found:
    """Lengths in mm for m, constant angles in degrees for rad and the other way round."""

    def lengths(one: Situation) -> Situation:
        slides = ~structure.revolute
        offset = np.where(slides, 1e3 * one.offset, one.offset)
        return replace(one, a=1e3 * one.a, d=1e3 * one.d, b=1e3 * one.b, offset=offset)

    def angles(factor: float, one: Situation) -> Situation:
        offset = np.where(structure.revolute, factor * one.offset, one.offset)
        return replace(one, alpha=factor * one.alpha, theta=factor * one.theta, offset=offset)

    yield SituationSlip(Slip("mm_for_m", cost=1.1), lengths)
    for code, factor in (
        ("degrees_for_radians", 180 / np.pi),
        ("radians_for_degrees", np.pi / 180),
    ):
        yield SituationSlip(Slip(code, detail="table"), partial(angles, factor))


def _why(question: Question, table: DHTable, given: DHTable) -> list[Explanation]:
    """Return the slips that make the right table the given one."""
    try:
        other = robot_from_table(given)
    except RobotError:
        return []
    if len(given.rows) != len(table.rows) or other.dof != question.robot.dof:
        return []
    rows = range(len(table.rows))
    q = np.zeros((1, question.robot.dof))
    structure, right = situation_of(question.robot, table, q, rows=rows)
    other_structure, wrong = situation_of(other, given, q, rows=rows)
    if not np.array_equal(structure.revolute, other_structure.revolute):
        return []
    # Whether q is taken in another order or unit does not show in a table.
    kinds: list[Callable[[Structure, Situation], Found]] = [_columns_swapped, _in_wrong_unit]
    slips = [one for kind in kinds for one in kind(structure, right)]
    slips += [
        one
        for one in slips_of(structure, right, product=False, units=False)
        if one.slip.code != "row_missing"
        and not (one.slip.code == "joint_sign" and one.slip.detail == "value")
    ]
    # Frames differ by whole turns of their angles only.
    away = partial(_away, structure, wrong)
    for threshold in (1e-6, question.tolerance):
        for candidates in (_singly(slips, right), _in_pairs(slips, right)):
            found = [
                Explanation(made, distance)
                for made, situation in candidates
                if (distance := away(situation)) <= threshold
            ]
            if found:
                return sorted(found, key=lambda one: one.cost)[:3]
    return []


def _singly(
    slips: list[SituationSlip], right: Situation
) -> Iterator[tuple[tuple[Slip, ...], Situation]]:
    for one in slips:
        yield (one.slip,), one.apply(right)


def _in_pairs(
    slips: list[SituationSlip], right: Situation
) -> Iterator[tuple[tuple[Slip, ...], Situation]]:
    for count, (one, two) in enumerate(combinations(slips, 2)):
        if count >= MAX_PAIRS:
            return
        yield (one.slip, two.slip), two.apply(one.apply(right))


def _away(structure: Structure, given: Situation, one: Situation) -> float:
    """Return the largest difference of two tables, rad and m; inf for other conventions."""
    if one.standard is not given.standard:
        return math.inf
    turns = structure.revolute
    offset = one.offset - given.offset
    differences = (
        wrap(one.alpha - given.alpha),
        wrap(one.theta - given.theta),
        wrap(one.gamma - given.gamma),
        np.where(turns, wrap(offset), offset),
        one.a - given.a,
        one.d - given.d,
        one.b - given.b,
        one.sign - given.sign,
        one.base - given.base,
        one.tool - given.tool,
    )
    return max(float(np.abs(part).max(initial=0.0)) for part in differences)
