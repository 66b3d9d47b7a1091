"""Tables of unread cells, by column and with their lines, as readers of pasted text give them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.documents.checks import NAME
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.grids import Line, grid_lines, words_beside
from dh_to_urdf.pasted.headings import (
    COLUMN_QUANTITIES,
    KNOWN,
    Heading,
    heading_problem,
    is_angle_unit,
    is_units,
    read_heading,
    unit_factor,
    unit_of,
)
from dh_to_urdf.table import Convention


@dataclass(frozen=True, slots=True)
class RawCell:
    """One cell.

    Attributes:
        text: As written.
        column: Its heading or parameter, as written.
        line: Line of the text, from 1.
        unit: Factor of its plain numbers to rad or m, None for that of the table.
        total: Its number where a program computed it; the text shows it then.
    """

    text: str
    column: str
    line: int
    unit: float | None = None
    total: Sum | None = None


@dataclass(frozen=True)
class RawRow:
    """One joint.

    Attributes:
        line: Line of the text, from 1.
        cells: By column of a D-H table.
        own_constant: False where a constant in the variable's own column would be ignored by the
            program that the text is written for.
    """

    line: int
    cells: dict[str, RawCell]
    own_constant: bool = True


@dataclass
class RawTable:
    """A pasted table.

    Attributes:
        rows: The joints.
        typed: Whether rows without a type are revolute, as in the program of the text.
        name: Name of the robot, if the text has one.
        warnings: What was assumed.
        notes: The words beside the table, which may say its units.
        placed_in_m: Whether lengths of base and tool are in m whatever the unit of the table.
    """

    rows: list[RawRow]
    typed: bool = False
    name: str | None = None
    warnings: list[str] = field(default_factory=list)
    notes: str = ""
    placed_in_m: bool = False


def table_from_grid(text: str, convention: Convention, columns: Sequence[str] | None) -> RawTable:
    """Read a table of lines and cells under a heading.

    Args:
        text: The text.
        convention: What the rows mean.
        columns: Headings for a table that has none.

    Raises:
        DHError: No table, no heading, an unknown column, or rows of unequal lengths.
    """
    lines = grid_lines(text, None if columns is None else len(columns))
    table = table_from_lines(lines, convention, columns)
    table.notes = words_beside(text, lines)
    return table


def table_from_lines(
    lines: list[Line], convention: Convention, columns: Sequence[str] | None = None
) -> RawTable:
    """Read a table of cells under a heading, or beside one.

    Args:
        lines: The cells.
        convention: What the rows mean.
        columns: Headings for a table that has none.

    Raises:
        DHError: As of :func:`table_from_grid`.
    """
    lines = _without_blank_columns(lines)
    if not lines:
        raise DHError.single((), say("the text holds no table; paste its heading and its rows"))
    if columns is not None:
        headings = headings_of(columns, convention, "columns")
        if len(lines) > 1 and _known(lines[0], convention) >= len(lines[0].cells):
            lines = lines[1:]
        turned = len(lines) == len(headings) and {len(line.cells) for line in lines} != {len(lines)}
    else:
        beside = _beside(lines, convention)
        if beside is not None:
            return _turned(lines, beside, convention)
        lines, headings = _headed(lines, convention)
        turned = False
    if lines and is_units(lines[0].cells) and len(lines[0].cells) == len(headings):
        headings = [_with_unit(*pair) for pair in zip(headings, lines[0].cells, strict=True)]
        lines = lines[1:]
    if turned:
        return _turned(lines, list(enumerate(headings)), convention)
    problem, warning = heading_problem(headings, convention.value)
    if problem:
        raise DHError.single((), problem)
    if _has_index(lines, headings):
        headings = [Heading("index", ""), *headings]
    passed = [
        say("column {heading} is left out", heading=quoted(heading.text))
        for heading in headings
        if heading.key == "ignored"
    ]
    table = RawTable(
        [_row(line, headings) for line in lines],
        warnings=[*([warning] if warning else []), *passed],
    )
    _check_index(table)
    return table


def _with_unit(heading: Heading, cell: str) -> Heading:
    """Return a heading with the unit in the cell below it."""
    unit = unit_of(cell)
    if not unit:
        return heading
    quantity = COLUMN_QUANTITIES.get(heading.key)
    if quantity is not None and (quantity is Quantity.ANGLE) != is_angle_unit(unit):
        raise DHError.single(
            (),
            say(
                "column {heading} has the unit {unit}, which is of another kind; mend the row of"
                " units or leave it out",
                heading=quoted(heading.text),
                unit=quoted(unit),
            ),
        )
    return replace(heading, unit=unit_factor(unit))


def _beside(lines: list[Line], convention: Convention) -> list[tuple[int, Heading]] | None:
    """Return the lines whose first cell names a parameter, where each joint is a column.

    None where the first line, or one near it, is a heading, or the first column is none.
    """
    khalil = convention is Convention.KHALIL
    found: list[tuple[int, Heading]] = []
    for k, line in enumerate(lines):
        heading = read_heading(line.cells[0], khalil=khalil) if line.cells else None
        if heading is None or not line.cells[0].strip():
            if k == 0:
                continue
            return None
        if heading.key in ("index", "name"):
            if k == 0:
                continue
            return None
        found.append((k, heading))
    named = {heading.key for _, heading in found}
    if "alpha" not in named or len(named & set(COLUMN_QUANTITIES)) < 3 or len(found) != len(named):
        return None
    widths = {len(lines[k].cells) for k, _ in found}
    first = lines[0]
    if found[0][0] > 0 and len(first.cells) not in (*widths, *(w - 1 for w in widths)):
        return None
    return found if len(widths) == 1 and widths.pop() > 1 else None


def _turned(
    lines: list[Line], named: list[tuple[int, Heading]], convention: Convention
) -> RawTable:
    """Read a table whose joints are columns: each line begins with the name of a parameter."""
    problem, warning = heading_problem([heading for _, heading in named], convention.value)
    if problem:
        raise DHError.single((), problem)
    labelled = len(lines[named[0][0]].cells) > 1 and bool(
        read_heading(lines[named[0][0]].cells[0]) and lines[named[0][0]].cells[0].strip()
    )
    start = int(labelled)
    head = lines[0] if named[0][0] == 1 else None
    unit_column = labelled and all(
        len(lines[k].cells) > 2 and unit_of(lines[k].cells[1]) for k, _ in named
    )
    if unit_column:
        start += 1
        named = [(k, _with_unit(heading, lines[k].cells[1])) for k, heading in named]
    rows = []
    width = len(lines[named[0][0]].cells)
    for column in range(start, width):
        cells = {}
        for k, heading in named:
            if heading.key != "ignored":
                cells[heading.key] = RawCell(
                    lines[k].cells[column], heading.text, lines[k].number, heading.unit
                )
        if head is not None:
            shift = len(head.cells) - width
            label = head.cells[column + shift]
            cells["index"] = RawCell(_number(label), "1", head.number)
        rows.append(RawRow(lines[named[0][0]].number, cells))
    table = RawTable(rows, warnings=[warning] if warning else [])
    _check_index(table)
    return table


def _number(label: str) -> str:
    """Return the number in a label such as ``Joint 1``, else the label."""
    match = re.fullmatch(r"[^\W\d_]{1,20}[ .]{0,2}(\d{1,3})", label.strip())
    return match[1] if match and read_heading(label.strip()[: match.start(1)]) else label


def headings_of(texts: Sequence[str], convention: Convention, where: str) -> list[Heading]:
    """Return the columns that a list of headings names.

    Raises:
        DHError: One is unknown or stands twice.
    """
    headings: list[Heading] = []
    for text in texts:
        heading = read_heading(text, khalil=convention is Convention.KHALIL)
        if heading is None:
            raise DHError.single(
                (),
                say(
                    "{where}: the column {text} is unknown; known are {known}. Give it one of"
                    " these names, or leave the column out if it says nothing of the geometry",
                    where=where,
                    text=quoted(text),
                    known=KNOWN,
                ),
            )
        if heading.key != "ignored" and heading.key in [other.key for other in headings]:
            raise DHError.single(
                (),
                say(
                    "{where}: the column {text} stands twice; keep one",
                    where=where,
                    text=quoted(text),
                ),
            )
        headings.append(heading)
    return headings


def _known(line: Line, convention: Convention) -> int:
    khalil = convention is Convention.KHALIL
    return sum(read_heading(cell, khalil=khalil) is not None for cell in line.cells)


def _headed(lines: list[Line], convention: Convention) -> tuple[list[Line], list[Heading]]:
    """Return the rows below the heading, and the heading."""
    khalil = convention is Convention.KHALIL
    for position, line in enumerate(lines[:5]):
        found = [read_heading(cell, khalil=khalil) for cell in line.cells if cell.strip()]
        named = {heading.key for heading in found if heading is not None}
        named -= {"index", "name", "ignored"}
        if len(named) < 2 or ("alpha" not in named and len(named) < 3):
            continue
        headings = headings_of(line.cells, convention, say("line {number}", number=line.number))
        return lines[position + 1 :], headings
    shown = " ".join(" | ".join(lines[0].cells).split())
    raise DHError.single(
        (),
        say(
            "line {number}: {shown} names no columns; write a heading such as theta"
            " d a alpha above the rows, or give columns=theta,d,a,alpha",
            number=lines[0].number,
            shown=quoted(shown),
        ),
    )


def _without_blank_columns(lines: list[Line]) -> list[Line]:
    """Remove columns at the end that are empty in every row, as in spreadsheets."""
    width = max((len(line.cells) for line in lines), default=0)
    while width and not any("".join(line.cells[width - 1 :]).strip() for line in lines):
        width -= 1
    return [Line(line.number, line.cells[:width]) for line in lines]


def _has_index(lines: list[Line], headings: list[Heading]) -> bool:
    """Return whether each row begins with a label that the heading leaves out, as pandas does."""
    if {"index", "name"} & {heading.key for heading in headings} or len(lines) < 2:
        return False
    if any(len(line.cells) != len(headings) + 1 for line in lines):
        return False
    labels = [line.cells[0].strip() for line in lines]
    if all(label.isdecimal() and len(label) < 5 for label in labels):
        start = int(labels[0])
        return start < 2 and [int(label) for label in labels] == list(
            range(start, start + len(labels))
        )
    return all(NAME.fullmatch(label) and not label.isdecimal() for label in labels)


def _row(line: Line, headings: list[Heading]) -> RawRow:
    if len(line.cells) != len(headings):
        raise DHError.single(
            (),
            say(
                "line {number} has {count} cells under {count_2} columns ({headings});"
                " give each column a cell",
                number=line.number,
                count=len(line.cells),
                count_2=len(headings),
                headings=", ".join(heading.text for heading in headings),
            ),
        )
    return RawRow(
        line.number,
        {
            heading.key: RawCell(cell, heading.text, line.number, heading.unit)
            for heading, cell in zip(headings, line.cells, strict=True)
            if heading.key != "ignored"
        },
    )


def _check_index(table: RawTable) -> None:
    """Refuse numbers of joints that do not count up: a row is missing or out of place."""
    cells = [row.cells["index"] for row in table.rows if "index" in row.cells]
    numbers = [cell.text.strip().strip("$*") for cell in cells]
    if not all(number.isdecimal() and len(number) < 5 for number in numbers):
        return
    for position, (cell, number) in enumerate(zip(cells, numbers, strict=True)):
        expected = int(numbers[0]) + position
        if int(number) != expected or int(numbers[0]) > 1:
            raise DHError.single(
                ("joints", position),
                say(
                    "line {line}, column {column}: the joint is number {number} where"
                    " {expected} is due; list every joint in order",
                    line=cell.line,
                    column=cell.column or "1",
                    number=number,
                    expected=expected if int(numbers[0]) <= 1 else 1,
                ),
            )
