"""D-H tables: compared as written, then by the motion that they describe."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from dh_to_urdf import DHError, compare, read_mapping, to_convention
from dh_to_urdf.documents.layouts import document
from dh_to_urdf.errors import Fault, Location
from dh_to_urdf.extraction.as_written import CellDifference, differences_as_written
from dh_to_urdf.extraction.comparison_result import Verdict as Comparison
from dh_to_urdf.messages import say
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
from robots.robot import FloatArray, robot_from_table

MAX_PAIRS = 500
MOST_SHOWN = 3
IDENTICAL = 1e-6
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
            say("this robot was made from a URDF and has no D-H table to compare with"),
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
        note = say("equivalent, with other frames: the pose of the tool is the same at every q")
        return Verdict(True, told(away), (), (), note, expected)
    shown = cells if cells is not None else _cells_converted(table, given, tolerance)
    rows: Location = () if isinstance(answer, list) else ("joints",)
    errors = tuple(_error(cell, question, rows) for cell in shown[:MAX_ERRORS])
    sizes = [one.off_by for one in errors if one.off_by is not None]
    found = _why(question, table, given)
    why = _note(question, table, given, shown)
    return Verdict(False, max(sizes, default=None), errors, diagnosed(found), why, expected)


def _read(question: Question, answer: object, table: DHTable) -> DHTable:
    rows_only = isinstance(answer, list)
    if rows_only:
        answer = {"joints": answer}
    if not isinstance(answer, Mapping):
        raise InvalidAnswer(
            say(
                "answer is no table; give its rows as a list of objects, or a document"
                " with convention and joints"
            ),
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
        return say("compared in the convention of the robot's table")
    if len(given.rows) == len(table.rows):
        wrong = {cell.joint for cell in cells}
        right = [row.name for k, row in enumerate(table.rows, start=1) if k not in wrong]
        if right:
            return say("right rows: {right}", right=", ".join(right))
    try:
        found = compare(chain_of_robot(question.robot), chain_of_robot(robot_from_table(given)))
    except (DHError, RobotError):
        return ""
    if found.verdict is Comparison.EQUIVALENT:
        return say("the same arm up to base, tool and zeros of its joints")
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
    return _explained(structure, right, wrong, slips, question.tolerance)


def _explained(
    structure: Structure,
    right: Situation,
    given: Situation,
    slips: list[SituationSlip],
    tolerance: float,
) -> list[Explanation]:
    """Return the slips, one or two, that turn the right table into the given one."""
    turns = _turning_cells(structure)
    start, end = _cell_values(right), _cell_values(given)
    moved = np.array([_cell_values(one.apply(right)) for one in slips]).reshape(len(slips), -1)
    single = _differences(moved - end, turns)
    for threshold in (IDENTICAL, tolerance):
        found = [
            Explanation((slip.slip,), float(distance))
            for slip, distance in zip(slips, single, strict=True)
            if distance <= threshold
        ]
        if not found:
            found = _in_pairs(right, slips, moved - start, start, end, turns, threshold)
        if found:
            return sorted(found, key=lambda one: one.cost)[:MOST_SHOWN]
    return []


def _in_pairs(
    right: Situation,
    slips: list[SituationSlip],
    changes: FloatArray,
    start: FloatArray,
    end: FloatArray,
    turns: BoolArray,
    threshold: float,
) -> list[Explanation]:
    """Return pairs of slips that lead from the right cells to the given ones.

    Slips of different cells add up; of those that share one, one is made after the other.
    """
    found: list[Explanation] = []
    touched = np.abs(changes) > 0.0
    tried = 0
    for k, one in enumerate(slips[:-1]):
        added = _differences(start + changes[k] + changes[k + 1 :] - end, turns)
        shared = (touched[k] & touched[k + 1 :]).any(axis=1)
        for j, two in enumerate(slips[k + 1 :]):
            distance = float(added[j])
            if shared[j] and tried < MAX_PAIRS:
                tried += 1
                both = _cell_values(two.apply(one.apply(right)))
                distance = float(_differences((both - end)[None], turns)[0])
            if distance <= threshold:
                found.append(Explanation((one.slip, two.slip), distance))
    return found


def _cell_values(one: Situation) -> FloatArray:
    """Return all cells of a table, its placements and its convention, in one row."""
    angles = (one.alpha, one.theta, one.gamma, one.offset[0])
    others = (one.a[0], one.d[0], one.b[0], one.sign, one.base[0].ravel(), one.tool[0].ravel())
    return np.concatenate((*angles, *others, [float(one.standard)]))


def _turning_cells(structure: Structure) -> BoolArray:
    """Return which of the cells are angles."""
    count = structure.count
    angles = np.ones(3 * count, dtype=bool)
    rest = np.zeros(4 * count + 33, dtype=bool)
    return np.concatenate((angles, structure.revolute, rest))


def _differences(cells: FloatArray, turns: BoolArray) -> FloatArray:
    """Return the largest entry of each row of differences, of angles without whole turns."""
    return np.asarray(np.abs(np.where(turns, wrap(cells), cells)).max(axis=1))
