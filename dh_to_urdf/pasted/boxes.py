"""Several boxes in one text, as the Robotics Toolbox prints a robot, or as pages have tables.

One box holds the table; that of base and tool is read, the others are passed over and named.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.grids import BORDER
from dh_to_urdf.pasted.headings import read_heading
from dh_to_urdf.pasted.pose_text import printed_pose

_TOP = "┌╔╒╭┏"
_SIDES = str.maketrans(dict.fromkeys("│┃║┆┊¦", "|"))
_PLACED = {"base": "base", "tool": "tool", "outil": "tool", "socle": "base"}


@dataclass(frozen=True)
class Boxes:
    """A text with one box.

    Attributes:
        text: The text, in which the other boxes are blank lines.
        placements: Base and tool of a box, as fields of a document.
        warnings: Which boxes were passed over, and what was read.
    """

    text: str
    placements: dict[str, Any] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Box:
    first: int
    last: int
    cells: list[list[str]]


def only_table(text: str, placed: Mapping[str, Any]) -> Boxes:
    """Return a text with only the box that holds the table; other lines of boxes are blank.

    Args:
        text: The text.
        placed: Base and tool that are known already, which win over those of a box.

    Raises:
        DHError: A box holds a base or tool that cannot be read, or rows without a heading.
    """
    lines = text.splitlines()
    boxes = _boxes(lines)
    tables = [box for box in boxes if _is_table(box)]
    gaps = [lines[a.last + 1 : b.first] for a, b in pairwise(boxes)]
    broken = any(all(line.strip() for line in gap) and gap for gap in gaps)
    if len(boxes) < 2 or len(tables) != 1 or broken:
        return Boxes(text)
    width = len(tables[0].cells[0])
    placements: dict[str, Any] = {}
    warnings: list[str] = []
    for box in boxes:
        if box is tables[0]:
            continue
        if all(row and row[0].lower() in _PLACED for row in box.cells):
            placements |= _placements(box, placed, warnings)
        else:
            if _is_of_rows(box, width):
                raise DHError.single(
                    (),
                    say(
                        "line {line}: these rows stand apart from the table and have no heading;"
                        " if they belong to it, remove what is between, else leave them out",
                        line=box.first + 1,
                    ),
                )
            warnings.append(
                say(
                    "line {top}: the box of {cells} is left out",
                    top=box.first + 1,
                    cells=_title(box.cells),
                )
            )
        lines[box.first : box.last + 1] = [""] * (box.last + 1 - box.first)
    return Boxes("\n".join(lines), placements, warnings)


def _boxes(lines: list[str]) -> list[_Box]:
    """Return the runs of lines with borders."""
    boxes: list[_Box] = []
    first: int | None = None
    for k, line in enumerate([*lines, ""]):
        bare = line.strip()
        bordered = line.translate(_SIDES).count("|") >= 2 or (
            len(bare) > 2 and BORDER.fullmatch(bare) is not None
        )
        starts = bordered and bare[:1] in _TOP if bare else False
        if first is not None and (not bordered or starts):
            cells = _cells(lines, first, k - 1)
            if cells:
                boxes.append(_Box(_first_row(lines, first), k - 1, cells))
            first = None
        if bordered and first is None:
            first = k
    return boxes


def _first_row(lines: list[str], first: int) -> int:
    """Return the first line of a box that is no border."""
    while lines[first].translate(_SIDES).count("|") < 2:
        first += 1
    return first


def _cells(lines: list[str], first: int, last: int) -> list[list[str]]:
    rows = []
    for line in lines[first : last + 1]:
        parts = line.translate(_SIDES).strip()
        if parts.count("|") >= 2 and not BORDER.fullmatch(parts):
            rows.append([cell.strip() for cell in parts.strip("|").split("|")])
    return rows


def _is_table(box: _Box) -> bool:
    """Return whether a heading, or the first column, names alpha and another column."""
    firsts = [row[0] for row in box.cells]
    for texts in (*box.cells[:3], firsts):
        found = {heading.key for text in texts if text and (heading := read_heading(text))}
        if "alpha" in found and len(found - {"index", "name", "ignored"}) > 1:
            return True
    return False


def _is_of_rows(box: _Box, width: int) -> bool:
    """Return whether a box may hold rows of the table."""
    head = box.cells[0]
    if head[0].lower() in ("name", "nom") or len(head) != width:
        return False
    return any(any(c.isdigit() for c in cell) for cell in head[1:])


def _placements(box: _Box, placed: Mapping[str, Any], warnings: list[str]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for row in box.cells:
        key, shown = _PLACED[row[0].lower()], " ".join(row[1:]).strip()
        if key in placed:
            continue
        T = printed_pose(shown)
        if T is None:
            raise DHError.single(
                (key,),
                say(
                    "line {line}: the box says of the {key} {shown}, which is no pose; write its"
                    " matrix on a line of its own, as {key} = [1 0 0 0; 0 1 0 0; 0 0 1 0.1; 0 0 0"
                    " 1]",
                    line=box.first + 1,
                    key=key,
                    shown=quoted(shown) if shown else say("nothing"),
                ),
            )
        found[key] = {"matrix": T.tolist()}
        warnings.append(
            say(
                "line {line}: the {key} is read from a box, where numbers are rounded (to two"
                " digits by the Robotics Toolbox); for the exact one add a line {key} = [4x4]",
                line=box.first + 1,
                key=key,
            )
        )
    return found


def _title(cells: list[list[str]]) -> str:
    if cells and cells[0][0].lower() == "name":
        return say("named configurations")
    return repr(" ".join(cells[0])[:40]) if cells else "nothing"


_ROBOT = re.compile(
    r"^[ \t]{0,20}\w{0,30}Robot(?:\.\w+)?:[ ]?(?P<name>[^,\n(]{0,80}?)"
    r"(?:\s*\(by [^)\n]*\))?,.{0,200}\b(?P<convention>standard|modified) DH parameters",
    re.MULTILINE,
)
_SERIAL_LINK = re.compile(
    r"^[ \t]{0,20}(?P<name>[^:\[\s][^:\[\n]{0,80}?)[ \t]{0,5}"
    r"(?:\[[^\]\n]*\])?::?.{0,80}\baxis\b.{0,120}\b(?P<convention>std|mod)DH\b",
    re.MULTILINE,
)
_OWN = re.compile(
    r"^(?P<name>[^\n,]{1,80}), (?P<convention>standard|modified|modifié|khalil)[ \u00a0]?: "
    r"[RT][xz]\(",
    re.MULTILINE,
)


_CONVENTIONS = {"std": "standard", "mod": "modified", "modifié": "modified"}


def stated_robot(text: str) -> tuple[str, str] | None:
    """Return name and convention that the print of a robot states, None for no such print.

    Args:
        text: The text: a print of RTB for Python or MATLAB, or of this service.
    """
    for pattern in (_ROBOT, _SERIAL_LINK, _OWN):
        found = pattern.search(text)
        if found:
            word = found["convention"]
            return found["name"].strip(), _CONVENTIONS.get(word, word)
    return None
