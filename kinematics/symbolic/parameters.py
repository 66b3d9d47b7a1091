"""Lengths of a table and the names that courses give them."""

from __future__ import annotations

from dataclasses import dataclass

from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHTable, JointType


@dataclass(frozen=True, slots=True)
class Length:
    """A length that can have a name.

    Attributes:
        name: Name by default.
        row: Number of its row from 1; 0 for the base, -1 for the tool.
        column: ``a``, ``d``, ``b``, ``offset``, or ``x``, ``y``, ``z`` of base and tool.
        value: m.
    """

    name: str
    row: int
    column: str
    value: float


def lengths_of(table: DHTable) -> list[Length]:
    """Every length that is not zero, with the name it has in the courses.

    standard: ``a_k``, ``d_k``. modified: ``a_{k-1}``, ``d_k`` (Craig's row k holds a_{k-1}).
    khalil: ``D_k`` for d, ``R_k`` for r, ``B_k`` for b. ``o_k`` is the offset of a prismatic
    joint; ``xb yb zb`` and ``xt yt zt`` place the base and the tool.
    """
    khalil = table.convention is Convention.KHALIL
    shift = 1 if table.convention is Convention.MODIFIED else 0
    letters = {"a": "D", "d": "R", "b": "B", "offset": "o"} if khalil else {"offset": "o"}
    found = []
    for k, row in enumerate(table.rows, start=1):
        for column in ("a", "d", "b", "offset"):
            if column == "offset" and row.type is not JointType.PRISMATIC:
                continue
            number = k - shift if column == "a" else k
            name = f"{letters.get(column, column)}{number}"
            found.append(Length(name, k, column, float(getattr(row, column))))
    for row_number, letter, placement in ((0, "b", table.base), (-1, "t", table.tool)):
        found += _placement(row_number, letter, placement)
    return [length for length in found if length.value != 0.0]


def _placement(row: int, letter: str, placement: Matrix) -> list[Length]:
    return [
        Length(f"{axis}{letter}", row, axis, float(value))
        for axis, value in zip("xyz", placement[:3, 3], strict=True)
    ]
