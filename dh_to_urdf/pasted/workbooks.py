"""Workbooks (``.xlsx``, ``.ods``) -> raw tables.

They are read by python-calamine in a process of its own, whose memory and processor time are
bounded: a few bytes of a workbook may say a million cells.
"""

from __future__ import annotations

import io
import json
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Final

from dh_to_urdf.errors import MAX_FAULTS, DHError, Fault, printable, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.grids import Line
from dh_to_urdf.pasted.headings import COLUMN_QUANTITIES, MAX_COLUMNS, is_heading, read_heading
from dh_to_urdf.pasted.raw_table import RawTable, table_from_lines
from dh_to_urdf.pasted.workbook_process import FORMULA, MAX_TEXT, MEMORY, Unread
from dh_to_urdf.table import Convention

MAX_UNPACKED: Final = 20_000_000
"""Bytes of a workbook when it is unpacked."""
MAX_PARTS: Final = 1_000
"""Files in a workbook."""
WORKBOOK_BYTES: Final = MEMORY + 14 * MAX_TEXT
"""Memory for reading a workbook: that of the process, and here the texts of all cells, each an
object. Cells of two characters, the smallest that are no constants, take 13 for one of the text."""
SECONDS: Final = 20.0
"""Time that reading a workbook may take."""
_READER: Final = Path(__file__).with_name("workbook_process.py")


@dataclass(frozen=True, slots=True)
class _Sheet:
    """A sheet of a workbook.

    Attributes:
        name: As people gave it.
        visible: Whether it is shown.
        rows: Its cells, as texts.
        unread: Cells that have no value, though they are not empty, by row and column from 0.
    """

    name: str
    visible: bool
    rows: list[list[str]]
    unread: dict[tuple[int, int], Unread]


def table_from_workbook(
    content: bytes, convention: Convention, columns: Sequence[str] | None = None
) -> RawTable:
    """Read the one sheet of a workbook that holds a D-H table.

    Args:
        content: The file.
        convention: What the rows mean.
        columns: Headings for a table that has none.

    Raises:
        DHError: No workbook, one that is too large, or no sheet or several with a table.
    """
    _check_size(content)
    sheets = _sheets(content)
    width = None if columns is None else len(columns)
    found: list[tuple[list[Line], str]] = []
    for visible in (True, False):
        # Who sees one table only does not know of a hidden one, which is seldom meant.
        if not found:
            read = (_lines(sheet, width) for sheet in sheets if sheet.visible is visible)
            found = [(lines, notes) for lines, notes in read if lines]
    if not found:
        faults = [fault for sheet in sheets for fault in _faults(sheet, set(), None)]
        if faults:
            raise DHError(faults)
    if len(found) != 1:
        raise DHError.single(
            (),
            say(
                "the workbook holds {count} sheets with a D-H table; keep the one that is meant,"
                " with its heading (such as theta d a alpha) above the rows",
                count=len(found),
            ),
        )
    lines, notes = found[0]
    raw = table_from_lines(lines, convention, columns)
    raw.notes = notes
    return raw


def _check_size(content: bytes) -> None:
    """Refuse a file that is no archive, or a very large one when it is unpacked."""
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            parts = archive.infolist()
            if any(part.flag_bits & 1 for part in parts):
                raise DHError.single((), say("the workbook is encrypted; save it without password"))
            size = sum(part.file_size for part in parts)
    except (zipfile.BadZipFile, ValueError, NotImplementedError, OSError):
        raise DHError.single((), say("the file is no .xlsx or .ods workbook")) from None
    if size > MAX_UNPACKED or len(parts) > MAX_PARTS:
        raise DHError.single(
            (),
            say(
                "the workbook has {size} bytes when it is unpacked; at most {most} are read: keep"
                " the sheet with the table only",
                size=size,
                most=MAX_UNPACKED,
            ),
        )


def _sheets(content: bytes) -> list[_Sheet]:
    """Return the cells of each sheet, as texts."""
    try:
        done = subprocess.run(
            [sys.executable, "-I", str(_READER)],
            input=content,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        done = None
    if done is None or done.returncode != 0:
        raise DHError.single(
            (),
            say(
                "the workbook cannot be read, or has too many cells; save the sheet with the table"
                " as a workbook of its own, or paste its cells"
            ),
        )
    return [_sheet(*sheet) for sheet in json.loads(done.stdout)]


def _sheet(
    name: str, visible: bool, rows: list[list[str]], unread: list[tuple[int, int, str, str]]
) -> _Sheet:
    """Return a sheet in which the cells without a value hold what they have, so none is empty."""
    cells = {(row, column): Unread(row, column, kind, text) for row, column, kind, text in unread}
    for (row, column), cell in cells.items():
        while len(rows) <= row:
            rows.append([])
        rows[row] += [""] * (column + 1 - len(rows[row]))
        rows[row][column] = cell.text or "?"
    return _Sheet(name, visible, rows, cells)


def _faults(sheet: _Sheet, table: set[int], last: int | None) -> list[Fault]:
    """Return what is wrong with the cells of a sheet that have no value.

    An error is none of the table's where it stands in another row; a formula may be a title that
    says the units.

    Args:
        sheet: The sheet.
        table: Numbers of the rows of the table.
        last: Columns of the table; None where there is no table, and each cell counts.
    """
    counted = (cell for cell in sheet.unread.values() if last is None or _counts(cell, table, last))
    return [Fault((), _complaint(sheet.name, cell)) for cell in islice(counted, MAX_FAULTS + 1)]


def _counts(cell: Unread, table: set[int], last: int) -> bool:
    return cell.kind == FORMULA or (cell.row + 1 in table and cell.column < last)


def _complaint(sheet: str, cell: Unread) -> str:
    place = f"{_letters(cell.column)}{cell.row + 1}"
    if cell.kind == FORMULA:
        return say(
            "cell {cell} of sheet {sheet} holds the formula {formula} without its value; open the"
            " workbook in a spreadsheet program and save it, which writes the values",
            cell=place,
            sheet=quoted(sheet),
            formula=printable(cell.text),
        )
    return say(
        "cell {cell} of sheet {sheet} is the error {error}; mend its formula, or write the value",
        cell=place,
        sheet=quoted(sheet),
        error=printable(cell.text) or "?",
    )


def _letters(column: int) -> str:
    """Return the name of a column, from 0: A, B, …, Z, AA."""
    before, letter = divmod(column, 26)
    return (_letters(before - 1) if before else "") + chr(65 + letter)


def _lines(sheet: _Sheet, width: int | None) -> tuple[list[Line], str]:
    """Return the table of a sheet, and the words beside it; no lines for a sheet without one.

    Raises:
        DHError: Cells without a value, or rows of numbers apart.
    """
    numbered = [(k, row) for k, row in enumerate(sheet.rows, start=1) if any(row)]
    start = next((k for k, (_, row) in enumerate(numbered) if _is_head(row, width)), None)
    if start is None and width is None:
        keys = [_first_key(row) for _, row in numbered]
        start = next((k for k, key in enumerate(keys) if "alpha" in keys[k : k + 6] and key), None)
    if start is None:
        return [], ""
    first = next(k for k, cell in enumerate(numbered[start][1]) if cell)
    below = [row for _, row in numbered[start : start + 3]]
    while first > 0 and any(row[first - 1 : first] not in ([], [""]) for row in below):
        first -= 1
    lines: list[Line] = []
    for number, row in numbered[start:]:
        cells = row[first:]
        apart = bool(lines) and number > lines[-1].number + 1
        if lines and (apart or sum(1 for cell in cells if cell) < 2):
            break
        lines.append(Line(number, tuple(cells)))
    wide = max(len(line.cells) for line in lines)
    lines = [Line(line.number, line.cells + ("",) * (wide - len(line.cells))) for line in lines]
    used = {line.number for line in lines}
    faults = _faults(sheet, used, first + wide)
    if faults:
        raise DHError(faults)
    rest = [row for number, row in numbered if number not in used]
    for row in rest:
        if sum(any(c.isdigit() for c in cell) and len(cell) < 30 for cell in row) > 2:
            raise DHError.single(
                (),
                say(
                    "a row of numbers stands apart from the table; remove what is between, or the"
                    " row if it is none of the table"
                ),
            )
    return lines, "\n".join(" ".join(cell for cell in row if cell) for row in rest)


def _is_head(row: list[str], width: int | None) -> bool:
    cells = row[next((k for k, cell in enumerate(row) if cell), 0) :]
    while cells and not cells[-1]:
        cells = cells[:-1]
    if width is not None:
        return len(cells) == width
    if len(cells) > MAX_COLUMNS or not cells:
        return False
    return is_heading(cells)


def _first_key(row: list[str]) -> str | None:
    """Return the parameter that the first cell of a row names, None for none."""
    heading = read_heading(next((cell for cell in row if cell), ""))
    return heading.key if heading is not None and heading.key in COLUMN_QUANTITIES else None
