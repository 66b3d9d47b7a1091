"""What the names in a formula stand for: lengths of the table, joint variables, S12 and C1."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from dh_to_urdf.table import DHTable
from kinematics.checking.formulas import Formula, Scope
from kinematics.checking.situation import Situation, Structure, with_columns
from kinematics.symbolic.length_names import Length
from kinematics.symbolic.parameters import lengths_of
from robots.robot import FloatArray

POINTS = 12
"""Configurations at which formulas are compared."""
LEAST, MOST = 0.35, 1.45
"""Lengths in these comparisons, in parts of the real ones."""
_TRIGONOMETRIC = re.compile(
    r"(?P<letter>[sScC])_?(?P<plus>\d+(?:_\d+)*)(?:m(?P<minus>\d+(?:_\d+)*))?"
)
_VARIABLE = re.compile(r"(?P<letter>q|t|th|theta|θ|d|r)_?(?P<number>\d+)", re.IGNORECASE)


_ZERO = re.compile(r"[aA]_?(?P<number>\d{1,3})")
"""An a without a length of its own: that of a row of the table where it is 0."""


class AngleReading(Enum):
    """What S2 and θ2 mean where a table has offsets: the sine of q2, or of q2 + offset."""

    JOINT = "joint"
    TABLE = "table"


@dataclass(frozen=True, eq=False)
class Points:
    """Where formulas are compared: joint values and lengths.

    Attributes:
        situation: At P points, each with lengths of its own where these are varied.
        lengths: Values of the named lengths, shape (P,), by name without underscores.
    """

    situation: Situation
    lengths: Mapping[str, FloatArray]


def plain(name: str) -> str:
    """Return a name without underscores."""
    return name.replace("_", "")


def named_lengths(
    table: DHTable, chosen: Mapping[str, str], rows: Sequence[int], *, tool: bool
) -> dict[str, Length]:
    """Return the lengths between base and frame that are not zero, by every name that they have.

    Beside the default names (a2, d4; Khalil's D2, R4) and the ``chosen`` ones, L1, L2, … are the
    lengths in the order in which they follow each other from the base to the tip.

    Args:
        table: The table.
        chosen: Other names by default name, or default names by other name.
        rows: Indices of the rows between base and frame.
        tool: Whether the tool counts.
    """
    on_the_way = {k + 1 for k in rows} | {0} | ({-1} if tool else set())
    found = [one for one in lengths_of(table) if one.row in on_the_way]
    names = {plain(one.name): one for one in found}
    given = {}
    for key, value in chosen.items():
        for default, other in ((key, value), (value, key)):
            if plain(default) in names:
                given[plain(other)] = names[plain(default)]
    links = [one for one in found if one.row != 0]
    numbered = {f"L{k}": one for k, one in enumerate(links, start=1)}
    khalil = {}
    for one in found:
        if one.column in ("a", "d") and one.row > 0:
            letter = {"a": "d", "d": "r"}[one.column]
            khalil[f"{letter}{one.row}"] = one
    spellings = khalil | numbered | names | given
    lower = {name.lower(): one for name, one in reversed(spellings.items())}
    return lower | spellings


def points_at(
    situation: Situation,
    structure: Structure,
    names: Mapping[str, Length],
    varied: Sequence[str] = (),
) -> Points:
    """Return the situation with some lengths drawn at random at each point.

    Args:
        situation: At P points.
        structure: The chain.
        names: As :func:`named_lengths` gives them.
        varied: Names of lengths that are drawn.
    """
    count = len(situation.q)
    random = np.random.default_rng(20260101)
    drawn: dict[tuple[int, str], FloatArray] = {}
    for name in varied:
        one = names[name]
        key = (one.row, one.column)
        if key not in drawn:
            drawn[key] = one.value * random.uniform(LEAST, MOST, count)
    for (row, column), values in drawn.items():
        situation = _with_length(situation, structure, row, column, values)
    lengths = {
        name: drawn.get((one.row, one.column), np.full(count, one.value))
        for name, one in names.items()
    }
    return Points(situation, lengths)


def _with_length(
    situation: Situation,
    structure: Structure,
    row: int,
    column: str,
    values: FloatArray,
) -> Situation:
    if row <= 0:
        which = "base" if row == 0 else "tool"
        placement = getattr(situation, which).copy()
        placement[:, "xyz".index(column), 3] = values
        return with_columns(situation, {which: placement})
    place = structure.numbers.index(row)
    changed = getattr(situation, column).copy()
    changed[:, place] = values
    return with_columns(situation, {column: changed})


def drawn_q(structure: Structure, count: int = POINTS) -> FloatArray:
    """Return joint values in general position, shape (count, dof), rad and m."""
    random = np.random.default_rng(20260102)
    q = random.uniform(-3.0, 3.0, (count, len(structure.joints)))
    return np.where(structure.turning, q, 0.2 * q)


def scope_of(
    structure: Structure,
    points: Points,
    reading: AngleReading,
    *,
    degrees: bool = False,
    exchanged: bool = False,
) -> Scope:
    """Return what names stand for at some points; ``exchanged`` takes sin for cos and back."""
    situation = points.situation
    values = situation.q @ structure.matrix.T + structure.constant
    variables = situation.sign * values + situation.offset
    dof = len(structure.joints)

    def angle(number: int) -> FloatArray | None:
        """Return the angle that S and C with a number are of."""
        if reading is AngleReading.TABLE:
            if number in structure.numbers:
                return np.asarray(variables[:, structure.numbers.index(number)])
            return None
        return np.asarray(situation.q[:, number - 1]) if 1 <= number <= dof else None

    def combined(text: str) -> FloatArray | None:
        parts = text.split("_") if "_" in text else [text] if _whole(text) else list(text)
        found = [angle(int(part)) for part in parts]
        known = [one for one in found if one is not None]
        return np.asarray(sum(known)) if len(known) == len(found) else None

    def _whole(text: str) -> bool:
        return dof >= 10 and 1 <= int(text) <= max(dof, max(structure.numbers, default=0))

    def look_up(word: str) -> FloatArray | None:
        if plain(word) in points.lengths:
            return points.lengths[plain(word)]
        match = _TRIGONOMETRIC.fullmatch(word)
        if match is not None:
            total = combined(match["plus"])
            less = combined(match["minus"]) if match["minus"] else None
            if total is not None and (less is not None or not match["minus"]):
                total = total if less is None else total - less
                is_sine = (match["letter"] in "sS") ^ exchanged
                return np.asarray(np.sin(total) if is_sine else np.cos(total))
        match = _VARIABLE.fullmatch(word)
        if match is not None:
            number, letter = int(match["number"]), match["letter"].lower()
            if letter in ("d", "r"):
                if number in structure.numbers:
                    place = structure.numbers.index(number)
                    if structure.prismatic[place]:
                        return np.asarray(variables[:, place])
                    column = situation.d if letter == "r" or not _khalil(structure) else situation.a
                    return np.asarray(column[:, place])
            elif letter == "q":
                return np.asarray(situation.q[:, number - 1]) if 1 <= number <= dof else None
            else:
                return angle(number)
        zero = _ZERO.fullmatch(word)
        if zero is not None and int(zero["number"]) in (0, *structure.numbers):
            return np.zeros(len(situation.q))
        if word in structure.joints:
            return np.asarray(situation.q[:, structure.joints.index(word)])
        return None

    lengths = [name for name in points.lengths if not name[0].islower() or len(name) < 4]
    known = tuple(dict.fromkeys((*sorted(lengths)[:12], *(f"q{k + 1}" for k in range(dof)))))
    return Scope(look_up, degrees, exchanged, known)


def _khalil(structure: Structure) -> bool:
    return structure.convention.value == "khalil"


def uses_joints(formula: Formula, names: Mapping[str, Length]) -> bool:
    """Return whether a formula has other names than those of lengths."""
    return any(plain(word) not in names for word in formula.words)


def lengths_in(formulas: Sequence[Formula], names: Mapping[str, Length]) -> set[tuple[int, str]]:
    """Return row and column of the lengths that formulas name."""
    found = (names.get(plain(word)) for formula in formulas for word in formula.words)
    return {(one.row, one.column) for one in found if one is not None}
