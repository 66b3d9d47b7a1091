"""Tables pasted as text -> :class:`DHTable`: LaTeX, MATLAB, Python, Markdown, tabs, columns.

Every fault names the line and the column of the text.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from dh_to_urdf.cells.notation import rounding_warnings
from dh_to_urdf.cells.values import read_values
from dh_to_urdf.documents.mapping import CONVENTION_ALIASES, DEFAULT_NAME, MAX_ROWS, read_mapping
from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.cells import ANGLES, LENGTHS, CellReader
from dh_to_urdf.pasted.placement_notes import placement_notes
from dh_to_urdf.pasted.programs.language import is_program
from dh_to_urdf.pasted.programs.reader import table_from_program
from dh_to_urdf.pasted.raw_table import table_from_grid
from dh_to_urdf.pasted.rows import document_rows
from dh_to_urdf.table import DHTable

MAX_PASTED_LENGTH = 100_000
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0e-\x1f\x7f]")


def read_pasted(
    text: str | bytes,
    convention: str | None,
    name: str | None = None,
    angle: str | None = None,
    length: str = "m",
    values: Mapping[str, Any] | None = None,
    columns: str | None = None,
    default_name: str | None = DEFAULT_NAME,
) -> DHTable:
    r"""Read a table that was copied from a paper, a script or a spreadsheet.

    Joint variables may stand in their cells (``\theta_1``, ``q2 - 90°``, ``d3``) and then tell
    revolute joints from prismatic ones; so does a column ``type`` or ``σ``.

    Args:
        text: The text, UTF-8 (or Windows-1252) if bytes.
        convention: What the rows mean; required.
        name: Name of the robot, instead of one in the text.
        angle: Unit of angles without one: ``rad``, ``deg``, or None for rad where no angle looks
            like degrees (a bare 90 is refused then).
        length: Unit of lengths without one, ``m`` or ``mm``.
        values: Numbers for the names in the cells, such as ``l1``.
        columns: ``theta,d,a,alpha``: the columns of a table without a heading.
        default_name: Name for a text that gives none; None requires one.

    Raises:
        DHError: With the line and column of each of the first ten faults.
    """
    text, decoding = _decoded(text)
    meaning = CONVENTION_ALIASES.get(convention.strip().lower()) if convention else None
    if meaning is None or angle not in (None, *ANGLES) or length not in LENGTHS:
        units = {"angle": angle or "rad", "length": length}
        empty: dict[str, Any] = {"units": units, "joints": [{}]}
        if convention is not None:
            empty["convention"] = convention
        read_mapping(empty)
        raise DHError.single((), say("the table cannot be read"))
    listed = [part for part in re.split(r"[,\s]+", columns) if part] if columns else None
    given = read_values(values)
    placements: dict[str, Any]
    if is_program(text):
        raw, placements = table_from_program(
            text, meaning, listed, given, angle, LENGTHS[length], name
        )
    else:
        text, placements = placement_notes(text)
        raw = table_from_grid(text, meaning, listed)
    if len(raw.rows) > MAX_ROWS:
        raise DHError.single(
            (),
            say(
                "the text has {count} rows; at most {max_rows} are read",
                count=len(raw.rows),
                max_rows=MAX_ROWS,
            ),
        )
    cells = CellReader(raw, angle, length, given)
    rows = document_rows(cells, meaning)
    document: dict[str, Any] = {
        "convention": convention,
        "joints": rows,
        "values": given,
        **placements,
    }
    robot_name = name or raw.name
    if robot_name:
        document["name"] = robot_name
    table = read_mapping(document, default_name)
    warnings = (
        *decoding,
        *table.warnings,
        *raw.warnings,
        *cells.warnings,
        *rounding_warnings(table),
    )
    return replace(table, warnings=warnings)


def _decoded(text: str | bytes) -> tuple[str, list[str]]:
    """Return a text, and a warning where its bytes are those of Windows."""
    if len(text) > MAX_PASTED_LENGTH:
        raise DHError.single(
            (),
            say(
                "the text is longer than {max_pasted_length} characters",
                max_pasted_length=MAX_PASTED_LENGTH,
            ),
        )
    if isinstance(text, str):
        return text.lstrip("\ufeff"), []
    try:
        return text.decode("utf-8-sig"), []
    except UnicodeDecodeError:
        pass
    try:
        found = text.decode("cp1252")
    except UnicodeDecodeError:
        found = "\0"
    if _CONTROL.search(found):
        raise DHError.single((), say("the text is not UTF-8; save it as UTF-8"))
    return found, [say("the text is not UTF-8 and was read as Windows-1252; save it as UTF-8")]
