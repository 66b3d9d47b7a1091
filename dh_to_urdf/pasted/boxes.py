"""Several boxes in one text, as the Robotics Toolbox for Python prints a robot."""

from __future__ import annotations

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.headings import read_heading

_TOP, _BOTTOM = "┌╔╒╭┏", "└╚╘╰┗"
_SIDES = str.maketrans(dict.fromkeys("│┃║┆┊¦", "|"))


def table_box(text: str) -> tuple[str, list[str]]:
    """Return a text with only the box that holds the table; other lines of boxes are blank.

    Args:
        text: The text.

    Returns:
        The text with the same line numbers, and warnings of the boxes that are passed over.

    Raises:
        DHError: A box holds a base or a tool.
    """
    lines = text.splitlines()
    tops = [k for k, line in enumerate(lines) if line.strip()[:1] and line.strip()[0] in _TOP]
    if len(tops) < 2:
        return text, []
    warnings: list[str] = []
    kept = list(lines)
    boxes = [(top, _end(lines, top)) for top in tops]
    tables = [box for box in boxes if _is_table(lines, box)]
    if len(tables) != 1:
        return text, []
    for top, end in boxes:
        if (top, end) in tables:
            continue
        cells = _cells(lines, top, end)
        if any(row and row[0].lower() in ("base", "tool") for row in cells):
            raise DHError.single(
                (),
                say(
                    "line {top}: the box with base and tool shows rounded numbers; write"
                    " their matrices on lines of their own, as tool = [1 0 0 0; 0 1 0 0; 0"
                    " 0 1 0.1; 0 0 0 1], and leave the box out",
                    top=top + 2,
                ),
            )
        warnings.append(
            say("line {top}: the box of {cells} is left out", top=top + 2, cells=_title(cells))
        )
        kept[top : end + 1] = [""] * (end + 1 - top)
    return "\n".join(kept), warnings


def _end(lines: list[str], top: int) -> int:
    for k in range(top + 1, len(lines)):
        mark = lines[k].strip()[:1]
        if mark and mark in _BOTTOM:
            return k
        if mark and mark in _TOP:
            return k - 1
    return len(lines) - 1


def _cells(lines: list[str], top: int, end: int) -> list[list[str]]:
    rows = []
    for line in lines[top : end + 1]:
        parts = line.translate(_SIDES).strip()
        if parts.startswith("|"):
            rows.append([cell.strip() for cell in parts.strip("|").split("|")])
    return rows


def _is_table(lines: list[str], box: tuple[int, int]) -> bool:
    cells = _cells(lines, *box)
    if not cells:
        return False
    found = {heading.key for cell in cells[0] if (heading := read_heading(cell)) is not None}
    return "alpha" in found


def _title(cells: list[list[str]]) -> str:
    if cells and cells[0][0].lower() == "name":
        return say("named configurations")
    return repr(" ".join(cells[0])[:40]) if cells else "nothing"
