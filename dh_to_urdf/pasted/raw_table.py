"""Tables of unread cells, by column and with their lines, as readers of pasted text give them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.documents.checks import NAME
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.boxes import table_box
from dh_to_urdf.pasted.grids import Line, grid_lines
from dh_to_urdf.pasted.headings import KNOWN, Heading, heading_problem, read_heading
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
    """

    rows: list[RawRow]
    typed: bool = False
    name: str | None = None
    warnings: list[str] = field(default_factory=list)


def table_from_grid(text: str, convention: Convention, columns: Sequence[str] | None) -> RawTable:
    """Read a table of lines and cells under a heading.

    Args:
        text: The text.
        convention: What the rows mean.
        columns: Headings for a table that has none.

    Raises:
        DHError: No table, no heading, an unknown column, or rows of unequal lengths.
    """
    text, passed = table_box(text)
    lines = _without_blank_columns(grid_lines(text))
    if not lines:
        raise DHError.single((), say("the text holds no table; paste its heading and its rows"))
    if columns is not None:
        headings = headings_of(columns, convention, "columns")
        if len(lines) > 1 and _known(lines[0], convention) >= len(lines[0].cells):
            lines = lines[1:]
    else:
        lines, headings = _headed(lines, convention)
    problem, warning = heading_problem(headings, convention.value)
    if problem:
        raise DHError.single((), problem)
    if _has_index(lines, headings):
        headings = [Heading("index", ""), *headings]
    table = RawTable(
        [_row(line, headings) for line in lines],
        warnings=[*([warning] if warning else []), *passed],
    )
    _check_index(table)
    return table


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
                    "{where}: the column {text} is unknown; known are {known}",
                    where=where,
                    text=quoted(text),
                    known=KNOWN,
                ),
            )
        if heading.key in [other.key for other in headings]:
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
        named = {heading.key for heading in found if heading is not None} - {"index", "name"}
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
