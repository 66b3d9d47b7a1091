"""The table that an answer is about, its lengths and its rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dh_to_urdf.extraction.extract import extract
from dh_to_urdf.table import Convention, DHTable
from kinematics.checking.question import Question
from kinematics.checking.situation import rows_to
from kinematics.checking.symbols import named_lengths
from kinematics.symbolic.length_names import Length
from robots.chains import chain_of_robot


@dataclass(frozen=True, eq=False)
class Ground:
    """The table that an answer is about.

    Attributes:
        table: Of the robot; or worked out from its joint axes, for one made from a URDF.
        is_written: Whether it is the robot's own.
        names: Lengths by name.
        rows: Indices of the rows on the way to the frame.
        frame: Frame of the table.
    """

    table: DHTable
    is_written: bool
    names: dict[str, Length]
    rows: list[int]
    frame: str


def ground_of(
    question: Question, frame: str | None = None, rows: Sequence[int] | None = None
) -> Ground:
    """Return the table that an answer is about."""
    robot, table = question.robot, question.robot.table
    if table is None:
        found = extract(chain_of_robot(robot, None, frame), Convention.MODIFIED).table
        return Ground(found, False, {}, rows_to(found, "tool"), "tool")
    name = frame or "tool"
    chosen = rows_to(table, name) if rows is None else list(rows)
    lengths = named_lengths(table, question.symbols, chosen, tool=name == "tool")
    return Ground(table, True, lengths, chosen, name)
