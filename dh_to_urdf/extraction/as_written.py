"""Difference of two D-H tables of one convention as they are written, cell by cell."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np

from dh_to_urdf.messages import chained, plural, say
from dh_to_urdf.poses import Matrix, to_rpy
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType

TOLD = 4
"""Cells that a summary tells."""
_ANGLES = ("alpha", "theta", "gamma")
_GEOMETRY = ("alpha", "a", "d", "theta", "offset", "sign", "gamma", "b")
_LIMITS = ("lower", "upper", "velocity", "effort")
_KHALIL = {"a": "d", "d": "r"}


@dataclass(frozen=True, slots=True)
class CellDifference:
    """One cell that differs.

    Attributes:
        joint: Number of the row, from 1; 0 for base and tool.
        name: Name of the joint in the first table; base or tool.
        parameter: The column, as the convention calls it: alpha, a (Khalil: d), d (Khalil: r),
            theta, offset, sign, gamma, b, type, ant, lower, upper, velocity, effort; placement of
            base and tool; joints for a row that one table lacks.
        first: In the first table; rad, m, a word.
        second: In the second table.
        difference: second - first, not reduced by turns; None where it is no number.
        is_angle: Whether the values are angles.
    """

    joint: int
    name: str
    parameter: str
    first: float | str
    second: float | str
    difference: float | None
    is_angle: bool


def differences_as_written(
    first: DHTable, second: DHTable, *, length: float = 1e-6, angle: float = 1e-6
) -> tuple[CellDifference, ...] | None:
    """Compare two tables cell by cell, without rewriting them.

    Args:
        first: The table to compare with.
        second: The other one.
        length: Differences up to this are none, m; also those of speeds and efforts.
        angle: Differences up to this are none, rad.

    Returns:
        The cells that differ: row by row, base and tool, then limits that both tables give; None
        where the conventions differ, so that cells mean different things.
    """
    if first.convention is not second.convention:
        return None
    pairs = list(zip_longest(first.rows, second.rows))
    found = [
        cell
        for k, (a, b) in enumerate(pairs, start=1)
        for cell in _geometry(k, a, b, first.convention, length, angle)
    ]
    found += _placement("base", first.base, second.base, length, angle)
    found += _placement("tool", first.tool, second.tool, length, angle)
    for k, (a, b) in enumerate(pairs, start=1):
        if a is not None and b is not None:
            found += _limits(k, a, b, length, angle)
    return tuple(found)


def words_as_written(cells: Sequence[CellDifference]) -> str:
    """Return what differs as written, as a sentence; empty where nothing does."""
    if not cells:
        return ""
    told = chained("; ", (_in_words(cell) for cell in cells[:TOLD]))
    more = say("; and {count} more", count=len(cells) - TOLD) if len(cells) > TOLD else ""
    how_many = plural("one cell differs", "{count} cells differ", count=len(cells))
    return say("As written, {how_many}: {told}{more}.", how_many=how_many, told=told, more=more)


def _geometry(
    k: int,
    a: DHRow | None,
    b: DHRow | None,
    convention: Convention,
    length: float,
    angle: float,
) -> Iterator[CellDifference]:
    if a is None or b is None:
        name = (a or b).name  # type: ignore[union-attr]
        one, two = ("present", "missing") if b is None else ("missing", "present")
        yield CellDifference(k, name, "joints", one, two, None, False)
        return
    if _kind(a) != _kind(b):
        yield CellDifference(k, a.name, "type", a.type.value, b.type.value, None, False)
    if a.parent != b.parent:
        difference = float(b.parent - a.parent)
        yield CellDifference(k, a.name, "ant", a.parent, b.parent, difference, False)
    khalil = convention is Convention.KHALIL
    for column in _GEOMETRY:
        turns = column in _ANGLES or (column == "offset" and a.type.is_revolute)
        if column == "offset" and a.type.is_revolute is not b.type.is_revolute:
            turns = False
        x, y = float(getattr(a, column)), float(getattr(b, column))
        if abs(y - x) > (angle if turns else length):
            called = _KHALIL.get(column, column) if khalil else column
            yield CellDifference(k, a.name, called, x, y, y - x, turns)


def _kind(row: DHRow) -> JointType:
    """Return the type of a row; one that turns without limits is revolute all the same."""
    return JointType.REVOLUTE if row.type.is_revolute else row.type


def _limits(k: int, a: DHRow, b: DHRow, length: float, angle: float) -> Iterator[CellDifference]:
    turns = a.type.is_revolute and b.type.is_revolute
    for column in _LIMITS:
        x, y = getattr(a.limits, column), getattr(b.limits, column)
        if x is None or y is None:
            continue
        is_angle = turns and column in ("lower", "upper", "velocity")
        if abs(y - x) > (angle if is_angle else length):
            yield CellDifference(k, a.name, column, x, y, y - x, is_angle)


def _placement(
    name: str, a: Matrix, b: Matrix, length: float, angle: float
) -> Iterator[CellDifference]:
    turned = a[:3, :3].T @ b[:3, :3]
    sine = float(np.linalg.norm(turned - turned.T)) / math.sqrt(8.0)
    away = math.atan2(sine, (float(np.trace(turned)) - 1.0) / 2.0)
    if float(np.linalg.norm(b[:3, 3] - a[:3, 3])) > length or away > angle:
        yield CellDifference(0, name, "placement", _placed(a), _placed(b), None, False)


def _placed(T: Matrix) -> str:
    xyz = " ".join(f"{x + 0.0:.9g}" for x in T[:3, 3].tolist())
    rpy = " ".join(f"{x + 0.0:.9g}" for x in to_rpy(T[:3, :3]))
    return say("xyz {xyz} m, rpy {rpy} rad", xyz=xyz, rpy=rpy)


def _in_words(cell: CellDifference) -> str:
    what = (
        say(
            "joint {joint} ({cell}): {parameter}",
            joint=cell.joint,
            cell=cell.name,
            parameter=cell.parameter,
        )
        if cell.joint
        else cell.name
    )
    if cell.parameter == "joints":
        where = say(
            "{first} in the first and {second} in the second", first=cell.first, second=cell.second
        )
        return say(
            "joint {joint} ({cell}) is {where}", joint=cell.joint, cell=cell.name, where=where
        )
    first, second = (_shown(cell, value) for value in (cell.first, cell.second))
    return say("{what} is {first} and {second}", what=what, first=first, second=second)


def _shown(cell: CellDifference, value: float | str) -> str:
    if isinstance(value, str):
        return value
    if cell.is_angle:
        return f"{value + 0.0:.9g} rad{'/s' if cell.parameter == 'velocity' else ''}"
    unit = {"sign": "", "ant": "", "velocity": " m/s", "effort": ""}.get(cell.parameter, " m")
    return f"{value + 0.0:.9g}{unit}"
