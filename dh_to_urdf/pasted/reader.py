"""Tables pasted as text -> :class:`DHTable`: LaTeX, MATLAB, Python, Markdown, tabs, columns.

Every fault names the line and the column of the text.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.cells.notation import rounding_warnings
from dh_to_urdf.cells.values import Values, read_values
from dh_to_urdf.documents.mapping import CONVENTION_ALIASES, DEFAULT_NAME, MAX_ROWS, read_mapping
from dh_to_urdf.encodings import decoded
from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.boxes import only_table, stated_robot
from dh_to_urdf.pasted.cells import ANGLES, LENGTHS, CellReader
from dh_to_urdf.pasted.grids import is_latex
from dh_to_urdf.pasted.headings import COLUMN_QUANTITIES
from dh_to_urdf.pasted.html_tables import is_html, table_from_html
from dh_to_urdf.pasted.names import name_of
from dh_to_urdf.pasted.placement_notes import placement_notes
from dh_to_urdf.pasted.programs.braces import with_brackets
from dh_to_urdf.pasted.programs.language import is_program
from dh_to_urdf.pasted.programs.reader import table_from_program
from dh_to_urdf.pasted.raw_table import RawTable, table_from_grid
from dh_to_urdf.pasted.rows import document_rows
from dh_to_urdf.pasted.stated_units import FACTORS, StatedUnits, stated_units
from dh_to_urdf.pasted.workbooks import table_from_workbook
from dh_to_urdf.table import Convention, DHTable


def read_pasted(
    text: str | bytes,
    convention: str | None,
    name: str | None = None,
    angle: str | None = None,
    length: str | None = None,
    values: Mapping[str, Any] | None = None,
    columns: str | None = None,
    default_name: str | None = DEFAULT_NAME,
    encoding: str | None = None,
) -> DHTable:
    r"""Read a table that was copied from a paper, a script or a spreadsheet.

    Joint variables may stand in their cells (``\theta_1``, ``q2 - 90°``, ``d3``) and then tell
    revolute joints from prismatic ones; so does a column ``type`` or ``σ``.

    Args:
        text: The text; bytes are decoded as of :func:`~dh_to_urdf.encodings.decoded`.
        convention: What the rows mean; required, but for prints of robots that state it.
        name: Name of the robot, instead of one in the text.
        angle: Unit of angles without one: ``rad``, ``deg``, or None for rad where no angle looks
            like degrees (a bare 90 is refused then).
        length: Unit of lengths without one, ``m`` or ``mm``; None for m where the words beside
            the table say no other.
        values: Numbers for the names in the cells, such as ``l1``.
        columns: ``theta,d,a,alpha``: the columns of a table without a heading.
        default_name: Name for a text that gives none; None requires one.
        encoding: The encoding that the text is said to have; None to detect it.

    Raises:
        DHError: With the line and column of each of the first ten faults.
    """
    text, decoding = decoded(text, encoding)
    text = text if is_latex(text) else with_brackets(text)
    stated = stated_robot(text)
    meaning = _meaning(convention, angle, length, stated)
    listed = [part for part in re.split(r"[,\s]+", columns) if part] if columns else None
    given = read_values(values)
    placements: dict[str, Any]
    if is_html(text):
        raw = table_from_html(text, meaning, listed)
        placements = {}
    elif is_program(text):
        raw, placements = table_from_program(
            text, meaning, listed, given, angle, FACTORS[length or "m"], name
        )
    else:
        text, placements = placement_notes(text)
        boxes = only_table(text, placements)
        raw = table_from_grid(boxes.text, meaning, listed)
        raw.warnings += boxes.warnings
        placements = {**boxes.placements, **placements}
    if stated is not None and raw.name is None:
        raw.name = name_of(stated[0], raw.warnings)
    table = _table_of(raw, placements, meaning, name, angle, length, given, default_name)
    return replace(table, warnings=(*decoding, *table.warnings))


def read_spreadsheet(
    content: bytes,
    convention: str | None,
    name: str | None = None,
    angle: str | None = None,
    length: str | None = None,
    values: Mapping[str, Any] | None = None,
    columns: str | None = None,
    default_name: str | None = DEFAULT_NAME,
) -> DHTable:
    """Read a table from a workbook (``.xlsx`` or ``.ods``), values of formulas included.

    Args:
        content: The file.
        convention: As of :func:`read_pasted`, like the others.
        name: Name of the robot.
        angle: Unit of angles without one.
        length: Unit of lengths without one.
        values: Numbers for the names in the cells.
        columns: The columns of a table without a heading.
        default_name: Name for a file that gives none; None requires one.

    Raises:
        DHError: No workbook, no table or several, or faults of its cells.
    """
    meaning = _meaning(convention, angle, length, None)
    listed = [part for part in re.split(r"[,\s]+", columns) if part] if columns else None
    raw = table_from_workbook(content, meaning, listed)
    return _table_of(raw, {}, meaning, name, angle, length, read_values(values), default_name)


def _meaning(
    convention: str | None,
    angle: str | None,
    length: str | None,
    stated: tuple[str, str] | None,
) -> Convention:
    """Return the convention, which a print of a robot may state.

    Raises:
        DHError: None is given, or another than the print states; or a unit is unknown.
    """
    if convention is None and stated is not None:
        convention = stated[1]
    meaning = CONVENTION_ALIASES.get(convention.strip().lower()) if convention else None
    if meaning is None or angle not in (None, *ANGLES) or length not in (None, *LENGTHS):
        units = {"angle": angle or "rad", "length": length or "m"}
        empty: dict[str, Any] = {"units": units, "joints": [{}]}
        if convention is not None:
            empty["convention"] = convention
        read_mapping(empty)
        raise DHError.single((), say("the table cannot be read"))
    if stated is not None and stated[1] != meaning.value:
        raise DHError.single(
            ("convention",),
            say(
                "the text is the print of a robot in the {stated} convention, but convention says"
                " {convention}; give convention={stated}",
                stated=stated[1],
                convention=meaning.value,
            ),
        )
    return meaning


def _table_of(
    raw: RawTable,
    placements: dict[str, Any],
    meaning: Convention,
    name: str | None,
    angle: str | None,
    length: str | None,
    given: Values,
    default_name: str | None,
) -> DHTable:
    """Return the table of raw cells."""
    if len(raw.rows) > MAX_ROWS:
        raise DHError.single(
            (),
            say(
                "the text has {count} rows; at most {max_rows} are read",
                count=len(raw.rows),
                max_rows=MAX_ROWS,
            ),
        )
    units = stated_units(raw.notes, angle, length)
    cells = CellReader(raw, units, given)
    rows = document_rows(cells, meaning)
    document: dict[str, Any] = {
        "convention": meaning.value,
        "units": {"angle": units.angle or "rad"},
        "joints": rows,
        "values": given,
        **_scaled(placements, raw, units),
    }
    robot_name = name or raw.name
    if robot_name:
        document["name"] = robot_name
    table = read_mapping(document, default_name)
    warnings = (
        *table.warnings,
        *raw.warnings,
        *_told(units, angle, length),
        *cells.warnings,
        *rounding_warnings(table),
    )
    return replace(table, warnings=warnings)


def _told(units: StatedUnits, angle: str | None, length: str | None) -> list[str]:
    """Say which units were taken from the words beside the table."""
    told = [unit for unit, given in ((units.angle, angle), (units.length, length)) if not given]
    found = [unit for unit in told if unit not in (None, "rad", "m")]
    if not found:
        return []
    return [
        say(
            "plain numbers are in {units}, as the words beside the table say",
            units=", ".join(map(str, found)),
        )
    ]


def _scaled(placements: dict[str, Any], raw: RawTable, units: StatedUnits) -> dict[str, Any]:
    """Return base and tool in m, where those of a text are in the unit of its lengths."""
    named = {
        cell.unit
        for row in raw.rows
        for key, cell in row.cells.items()
        if COLUMN_QUANTITIES.get(key) is Quantity.LENGTH
    }
    unit = named.pop() if len(named) == 1 else None
    factor = unit if unit is not None else units.factor(Quantity.LENGTH)
    if factor in (None, 1.0) or raw.placed_in_m:
        return placements
    found = {}
    for key, placement in placements.items():
        matrix = [list(row) for row in placement["matrix"]]
        for row in matrix[:3]:
            row[3] = (
                row[3] / round(1 / factor)
                if isinstance(row[3], float)
                else f"({row[3]})/{round(1 / factor)}"
            )
        found[key] = {"matrix": matrix}
    return found
