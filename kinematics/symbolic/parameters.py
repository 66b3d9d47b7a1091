"""Lengths of a table and their names in lectures."""

from __future__ import annotations

import math

from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHTable, JointType
from kinematics.symbolic.angles import KNOWN, turn_text, twelfths
from kinematics.symbolic.length_names import Length, distinct, is_usable
from kinematics.symbolic.names import known_cosine

NEAR = 2e-3
"""Distance, rad, somewhat above that of 1.57 from π/2."""


def lengths_of(table: DHTable) -> list[Length]:
    """Return every length that is not zero, with its default name.

    standard: ``a_k``, ``d_k``. modified: ``a_{k-1}``, ``d_k`` (Craig's row k holds a_{k-1}).
    khalil: ``D_k`` for d, ``R_k`` for r, ``B_k`` for b. ``o_k`` is the offset of a prismatic
    joint; ``xb yb zb`` and ``xt yt zt`` place the base and the tool. A name of the table comes
    with its length, where it can be used and names one value only.
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
            given = dict(row.symbols).get(column, "")
            plain = given.lstrip("+-−– ")
            sign = 1 if plain == given or given[0] == "+" else -1
            plain = plain if is_usable(plain) else ""
            found.append(Length(name, k, column, float(getattr(row, column)), plain, sign))
    for row_number, letter, placement in ((0, "b", table.base), (-1, "t", table.tool)):
        found += _placement(row_number, letter, placement)
    return distinct([length for length in found if length.value != 0.0])


def unusual_angles(table: DHTable) -> int:
    """Return the number of constants without exact cosine: twists, fixed angles, base, tool."""
    found: set[float] = set()
    for row in table.rows:
        constants = (row.alpha, row.gamma, 0.0 if row.type.is_revolute else row.theta)
        found |= {abs(angle) for angle in constants if twelfths(angle) is None}
    placements = (table.base[:3, :3], table.tool[:3, :3])
    return len(found) + sum(3 for R in placements if not _exact(R))


def nearly_right_angles(table: DHTable) -> list[str]:
    """Describe angles written with few digits, such as 1.5708 for π/2."""
    found: list[str] = []
    for k, row in enumerate(table.rows, start=1):
        columns = {"alpha": row.alpha, "gamma": row.gamma, "theta": row.theta}
        if row.type.is_revolute:
            columns["theta"] = row.offset
        for column, angle in columns.items():
            meant = round(angle / (math.pi / 2)) * math.pi / 2
            if KNOWN < abs(angle - meant) < NEAR:
                found.append(
                    say(
                        "joint {k}: {column} is {angle!r} and not {meant}; write {meant} if"
                        " that is meant, the formulas get shorter",
                        k=k,
                        column=column,
                        angle=angle,
                        meant=turn_text(meant),
                    )
                )
    return found


def _exact(R: Matrix) -> bool:
    return all(known_cosine(float(value)) is not None for value in R.flat)


def _placement(row: int, letter: str, placement: Matrix) -> list[Length]:
    return [
        Length(f"{axis}{letter}", row, axis, float(value))
        for axis, value in zip("xyz", placement[:3, 3], strict=True)
    ]
