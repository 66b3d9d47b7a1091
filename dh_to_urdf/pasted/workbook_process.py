"""Reads a workbook from standard input and writes its cells as JSON; run as a process of its own.

It limits its own memory and processor time, and imports nothing but what it needs: its bounds
are read where there is no module ``resource``, too.
"""

from __future__ import annotations

import io
import json
import sys

MEMORY = 128 << 20
"""Bytes of address space; a workbook that says millions of cells ends the process."""
PROCESSOR_SECONDS = 10
MAX_SHEETS, MAX_ROWS, MAX_CELLS = 20, 2_000, 256
MAX_TEXT = 6_000_000
"""Characters of all cells as they are written: a text of one cell may be named by many others."""


def main() -> None:
    """Write ``[[name, [[cell, …], …]], …]``, cells as texts."""
    import resource

    resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS))
    content = sys.stdin.buffer.read()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    from python_calamine import CalamineWorkbook

    book = CalamineWorkbook.from_filelike(io.BytesIO(content))
    found, room = [], MAX_TEXT
    for name in book.sheet_names[:MAX_SHEETS]:
        rows = book.get_sheet_by_name(name).to_python(skip_empty_area=False)
        if len(rows) > MAX_ROWS or (rows and len(rows[0]) > MAX_CELLS):
            sys.exit(3)
        sheet = json.dumps([name, [[_text(cell) for cell in row] for row in rows]])
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


if __name__ == "__main__":
    main()
