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
from pathlib import Path
from typing import Final

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.grids import Line
from dh_to_urdf.pasted.headings import COLUMN_QUANTITIES, MAX_COLUMNS, is_heading, read_heading
from dh_to_urdf.pasted.raw_table import RawTable, table_from_lines
from dh_to_urdf.pasted.workbook_process import MAX_TEXT, MEMORY
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
    found = []
    for name, rows in _sheets(content):
        lines, notes = _lines(rows, None if columns is None else len(columns))
        if lines:
            found.append((name, lines, notes))
    if len(found) != 1:
        raise DHError.single(
            (),
            say(
                "the workbook holds {count} sheets with a D-H table; keep the one that is meant,"
                " with its heading (such as theta d a alpha) above the rows",
                count=len(found),
            ),
        )
    _, lines, notes = found[0]
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


def _sheets(content: bytes) -> list[tuple[str, list[list[str]]]]:
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
    sheets: list[tuple[str, list[list[str]]]] = json.loads(done.stdout)
    return sheets


def _lines(rows: list[list[str]], width: int | None) -> tuple[list[Line], str]:
    """Return the table of a sheet, and the words beside it; no lines for a sheet without one."""
    numbered = [(k, row) for k, row in enumerate(rows, start=1) if any(row)]
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
