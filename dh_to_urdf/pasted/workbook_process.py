"""Reads a workbook from standard input and writes its cells as JSON; run as a process of its own.

It limits its own memory and processor time, and imports nothing but what it needs: its bounds
are read where there is no module ``resource``, too.
"""

from __future__ import annotations

import io
import json
import posixpath
import re
import sys
import zipfile
from collections.abc import Iterator
from typing import NamedTuple
from xml.etree import ElementTree

MEMORY = 128 << 20
"""Bytes of address space; a workbook that says millions of cells ends the process."""
PROCESSOR_SECONDS = 10
MAX_SHEETS, MAX_ROWS, MAX_CELLS = 20, 2_000, 256
MAX_TEXT = 6_000_000
"""Characters of all cells as they are written: a text of one cell may be named by many others."""
FORMULA, ERROR = "formula", "error"
MAX_SHOWN = 60
"""Characters of a formula."""
_OFFICE = "{urn:oasis:names:tc:opendocument:xmlns:office:1.0}"
_TABLE = "{urn:oasis:names:tc:opendocument:xmlns:table:1.0}"
_KIND_OF_ERROR = "{urn:org:documentfoundation:names:experimental:calc:xmlns:calcext:1.0}value-type"
_VALUES = {
    f"{_OFFICE}{name}"
    for name in ("value", "date-value", "time-value", "boolean-value", "string-value")
}


class Unread(NamedTuple):
    """A cell that has no value, though it is not empty.

    Attributes:
        row: Its number, from 0.
        column: The same.
        kind: ``FORMULA``, whose value was not stored, or ``ERROR``.
        text: The formula, or what the error is called.
    """

    row: int
    column: int
    kind: str
    text: str


def main() -> None:
    """Write ``[[name, visible, [[cell, …], …], [unread, …]], …]``, cells as texts."""
    import resource

    resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS))
    content = sys.stdin.buffer.read()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    from python_calamine import CalamineWorkbook, SheetTypeEnum, SheetVisibleEnum

    book = CalamineWorkbook.from_filelike(io.BytesIO(content))
    sheets = [one for one in book.sheets_metadata if one.typ == SheetTypeEnum.WorkSheet]
    found, room, read = [], MAX_TEXT, []
    for one in sheets[:MAX_SHEETS]:
        rows = book.get_sheet_by_name(one.name).to_python(skip_empty_area=False)
        if len(rows) > MAX_ROWS or (rows and len(rows[0]) > MAX_CELLS):
            sys.exit(3)
        read.append((one.name, one.visible == SheetVisibleEnum.Visible, rows))
    # calamine gives formulas without a value, and errors, as empty cells.
    unread = _unread(content, [name for name, *_ in read])
    for name, visible, rows in read:
        texts = [[_text(cell) for cell in row] for row in rows]
        sheet = json.dumps([name, visible, texts, unread[name]])
        room -= len(sheet)
        if room < 0:
            sys.exit(3)
        found.append(sheet)
    sys.stdout.write(f"[{','.join(found)}]")


def _text(cell: object) -> str:
    """Return a cell as text: numbers with all their digits, dates as such."""
    if isinstance(cell, bool):
        return str(cell).upper()
    if isinstance(cell, float):
        return repr(int(cell)) if cell == int(cell) and abs(cell) < 1e15 else repr(cell)
    return str(cell).strip()


def _unread(content: bytes, names: list[str]) -> dict[str, list[Unread]]:
    """Return the cells of each sheet that calamine gives as empty, and that are not.

    Raises:
        KeyError: A sheet has no part in the archive.
    """
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        parts = {part.lower().replace("\\", "/"): part for part in archive.namelist()}
        if "content.xml" in parts:
            return _unread_of_ods(archive.read(parts["content.xml"]), names)
        book = ElementTree.fromstring(archive.read(parts["xl/workbook.xml"]))
        links = ElementTree.fromstring(archive.read(parts["xl/_rels/workbook.xml.rels"]))
        targets = {link.get("Id"): link.get("Target", "") for link in links}
        # The file says so where its writer has computed no value, or old ones only.
        stale = any(
            _local(one.tag) == "calcPr" and one.get("fullCalcOnLoad") in ("1", "true")
            for one in book.iter()
        )
        of_sheet = {}
        for sheet in (one for one in book.iter() if _local(one.tag) == "sheet"):
            link = next(value for key, value in sheet.items() if _local(key) == "id")
            of_sheet[sheet.get("name")] = posixpath.normpath(
                posixpath.join("/xl", targets[link].replace("\\", "/"))
            )
        return {
            name: _bounded(
                _unread_of_xlsx(archive.read(parts[of_sheet[name].lower().lstrip("/")]), stale)
            )
            for name in names
        }


def _unread_of_xlsx(sheet: bytes, stale: bool) -> Iterator[Unread]:
    """Give formulas without a value (all, where values are stale) and errors (ECMA-376, 18.3.1)."""
    row = column = -1
    for event, element in ElementTree.iterparse(io.BytesIO(sheet), ("start", "end")):
        tag = _local(element.tag)
        if event == "start":
            if tag == "row":
                row, column = int(element.get("r", row + 2)) - 1, -1
            elif tag == "c":
                place = re.fullmatch(r"([A-Z]{1,3})([0-9]{1,7})", element.get("r", "").upper())
                if place is None:
                    column += 1
                else:
                    row, column = int(place[2]) - 1, _column(place[1])
            continue
        if tag == "c":
            children = {_local(child.tag): child.text or "" for child in element}
            kind, value = element.get("t"), children.get("v", "")
            if kind == "e":
                yield Unread(row, column, ERROR, value.strip())
            elif "f" in children and (stale or (not value and kind != "str")):
                yield Unread(row, column, FORMULA, f"={children['f']}")
        if tag in ("row", "c"):
            element.clear()


def _unread_of_ods(content: bytes, names: list[str]) -> dict[str, list[Unread]]:
    """Return formulas without a value and errors (OpenDocument 1.3, 9.1.4)."""
    found: dict[str, list[Unread]] = {name: [] for name in names}
    name, depth, row, column = "", 0, 0, 0
    in_row: list[Unread] = []
    for event, element in ElementTree.iterparse(io.BytesIO(content), ("start", "end")):
        tag = element.tag
        if tag == f"{_TABLE}table":
            depth += 1 if event == "start" else -1
            if event == "start" and depth == 1:
                name, row = element.get(f"{_TABLE}name", ""), 0
            elif event == "end":
                element.clear()
        if depth != 1:
            continue
        if tag == f"{_TABLE}table-row" and event == "start":
            column, in_row = 0, []
        elif tag == f"{_TABLE}table-row":
            times = int(element.get(f"{_TABLE}number-rows-repeated", 1))
            if in_row and name in found:
                again = (one._replace(row=row + k) for k in range(times) for one in in_row)
                found[name] += _bounded(again)
            row += times
            element.clear()
        elif tag in (f"{_TABLE}table-cell", f"{_TABLE}covered-table-cell") and event == "end":
            times = int(element.get(f"{_TABLE}number-columns-repeated", 1))
            kind, text = _unread_cell(element)
            if kind:
                in_row += _bounded(Unread(row, column + k, kind, text) for k in range(times))
            column += times
    return found


def _unread_cell(cell: ElementTree.Element) -> tuple[str, str]:
    """Return what a cell holds instead of a value: a kind and a text, empty where it has one."""
    formula = cell.get(f"{_TABLE}formula")
    shown = "".join(cell.itertext()).strip()
    if cell.get(_KIND_OF_ERROR) == "error":
        return ERROR, shown
    valued = cell.get(f"{_OFFICE}value-type") == "string" or not _VALUES.isdisjoint(cell.keys())
    return ("", "") if formula is None or valued else (FORMULA, formula)


def _bounded(cells: Iterator[Unread]) -> list[Unread]:
    """Return cells with short texts, and end where they are too many."""
    found: list[Unread] = []
    for one in cells:
        if len(found) == MAX_ROWS * MAX_CELLS or one.row >= MAX_ROWS or one.column >= MAX_CELLS:
            sys.exit(3)
        found.append(one._replace(text=one.text[:MAX_SHOWN]))
    return found


def _column(letters: str) -> int:
    number = 0
    for letter in letters:
        number = 26 * number + ord(letter) - 64
    return number - 1


def _local(tag: str) -> str:
    return tag.rpartition("}")[2]


if __name__ == "__main__":
    main()
