r"""Pasted text -> lines of cells: LaTeX, Markdown, box drawings, tabs, aligned columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.headings import MAX_COLUMNS, is_heading, is_units

MAX_LINES = 2_000
"""Lines that are split in several ways."""
MAX_TITLE = 200
"""Lines among which a heading is looked for."""
_ENVIRONMENT = re.compile(
    r"\\(begin|end)\s*\{(tabular[xy*]?|array|[pbvBV]?matrix|smallmatrix|longtable|NiceTabular)\}"
)
_RULE = re.compile(
    r"\\(?:hline|toprule|midrule|bottomrule|hdashline|addlinespace|cmidrule|cline|rowcolor|endhead"
    r"|specialrule|endfirsthead|noalign|firsthline|lasthline)(?![A-Za-z])"
    r"(?:\s?(?:\([^()]{0,20}\)|\[[^\[\]]{0,20}\]|\{[^{}]{0,20}\}))*"
)
_MULTICOLUMN = re.compile(r"\\multicolumn\s*\{\s*(\d{1,3})\s*\}\s*\{[^{}]{0,20}\}")
_ROW_END = re.compile(r"\\\\(?:\*)?(?:\s?\[[^\[\]]{0,20}\])?|\\tabularnewline|\\cr(?![A-Za-z])")
_BOXES = str.maketrans(dict.fromkeys("│┃║┆┊¦", "|"))
BORDER = re.compile(r"[\s|+:=\-–—_─━═┄┈┌┐└┘├┤┬┴┼╔╗╚╝╠╣╦╩╬╒╕╘╛╞╡╤╧╪╭╮╰╯]+")
_GAP_OR_SIGN = re.compile(r"\t+|\s{2,}|\s(?=[-−]\.?\d)")
_FOOTER = re.compile(r"\s*\[\d+ rows x \d+ columns\]\s*")
_LITERAL = re.compile(r"^\s*[^\W\d]\w{0,30}\s*:?=\s*[\[({]([^\[\](){}]{3,200})[\])}]\s*;?\s*$")
"""A heading that is written as a matrix: ``DH = [theta d a alpha]``."""
_NUMERIC = re.compile(r"[-+−–]?\s?(?:[\d.½π]|pi\b|(?:θ|theta|th|q|d)_?\{?\d|sqrt)")
_TAB_OR_GAP = re.compile(r"\t+|\s{2,}")


@dataclass(frozen=True, slots=True)
class Line:
    """Cells of one row of a table.

    Attributes:
        number: Line of the text, from 1.
        cells: As written.
    """

    number: int
    cells: tuple[str, ...]


def is_latex(text: str) -> bool:
    r"""Return whether the text is a LaTeX table: an environment, or rows with ``&`` and ``\\``."""
    return _ENVIRONMENT.search(text) is not None or ("&" in text and "\\\\" in text)


def grid_lines(text: str, width: int | None = None) -> list[Line]:
    """Return the rows of a table without rules, borders, blank rows and words beside it.

    Args:
        text: The text.
        width: Number of columns of a table without heading, None for one with a heading.

    Raises:
        DHError: Two tables, rows of unequal lengths, or too many columns.
    """
    lines = _latex_lines(text) if is_latex(text) else _text_lines(text, width)
    lines = [line for line in lines if any(cell.strip() for cell in line.cells)]
    for line in lines:
        if len(line.cells) > MAX_COLUMNS:
            raise DHError.single(
                (),
                say(
                    "line {number} has {count} cells; at most {max_columns} are read",
                    number=line.number,
                    count=len(line.cells),
                    max_columns=MAX_COLUMNS,
                ),
            )
    return lines


def _latex_lines(text: str) -> list[Line]:
    text = re.sub(r"(?<!\\)%[^\n]*", "", text)
    begin, body = _environment(text)
    number, counted = text.count("\n", 0, begin) + 1, 0
    body = _RULE.sub("", body)
    lines, start = [], 0
    for match in [*_ROW_END.finditer(body), None]:
        end = match.start() if match else len(body)
        row = body[start:end]
        lead = len(row) - len(row.lstrip())
        number += body.count("\n", counted, start + lead)
        counted = start + lead
        cells = _latex_cells(row)
        if cells is not None:
            lines.append(Line(number, cells))
        start = match.end() if match else end
    return lines


def _environment(text: str) -> tuple[int, str]:
    """Return where the body of the innermost table starts, and the body."""
    starts: list[re.Match[str]] = []
    found: tuple[int, str] | None = None
    for match in _ENVIRONMENT.finditer(text):
        if match[1] == "begin":
            starts.append(match)
        elif starts:
            opened = starts.pop()
            body = text[opened.end() : match.start()]
            if "&" not in body:
                continue
            if found is None:
                found = opened.end(), body
            elif not (opened.end() <= found[0] < match.start()):
                raise DHError.single((), say("the text holds two LaTeX tables; paste one"))
    if found is None:
        body = text[starts[0].end() :] if starts else text
        found = (starts[0].end() if starts else 0), body
    offset, body = found
    skipped = _column_specification(body)
    return offset + skipped, body[skipped:]


def _column_specification(body: str) -> int:
    """Return the length of ``[t]{|c|c|}`` and the like at the start of an environment."""
    position = 0
    while True:
        rest = position
        while rest < len(body) and body[rest].isspace():
            rest += 1
        if rest >= len(body) or body[rest] not in "[{":
            return position
        close = {"[": "]", "{": "}"}[body[rest]]
        depth, end = 0, rest
        for end in range(rest, min(len(body), rest + 300)):
            depth += (body[end] == body[rest]) - (body[end] == close)
            if depth == 0:
                break
        if depth or "&" in body[rest:end]:
            return position
        position = end + 1


def _latex_cells(row: str) -> tuple[str, ...] | None:
    """Return the cells of one row; None for a spanning heading, which names no column."""
    if not row.strip():
        return None
    spans = [int(count) for count in _MULTICOLUMN.findall(row)]
    if any(count > 1 for count in spans):
        return None
    row = _MULTICOLUMN.sub("", row)
    return tuple(cell.strip() for cell in re.split(r"(?<!\\)&", row))


def words_beside(text: str, lines: Sequence[Line]) -> str:
    """Return the lines of a text that are none of its table."""
    if is_latex(text):
        begin, body = _environment(re.sub(r"(?<!\\)%", " ", text))
        return text[:begin] + "\n" + text[begin + len(body) :]
    used = {line.number for line in lines}
    kept = (line for number, line in enumerate(text.splitlines(), start=1) if number not in used)
    return "\n".join(kept)


def _text_lines(text: str, width: int | None) -> list[Line]:
    numbered = [
        (number, line.translate(_BOXES))
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not (BORDER.fullmatch(line) and len(line.strip()) > 2)
    ]
    kept = [(n, line) for n, line in numbered if line.lstrip()[0] not in "#%" or "|" in line]
    if len(kept) < len(numbered) <= MAX_LINES:
        # A comment may be the heading, and # the name of its first column.
        for mark in ("", "#% \t"):
            headed = [
                (n, line.strip().lstrip(mark) if (n, line) not in kept else line)
                for n, line in numbered[:MAX_TITLE]
                if (n, line) in kept or _is_headed(line.strip().lstrip(mark))
            ]
            found = _split(headed, None) if len(headed) > len(kept) and width is None else []
            if found:
                return found
    numbered = kept
    numbered = [(n, _LITERAL.sub(r"\1", line)) for n, line in numbered]
    piped = [(number, line) for number, line in numbered if line.count("|") >= 2]
    if len(piped) >= 2:
        _refuse_unpiped(piped, numbered)
        return [Line(number, _piped(line)) for number, line in piped]
    if not numbered:
        return []
    numbered = [(n, line) for n, line in numbered if not _FOOTER.fullmatch(line)]
    if len(numbered) > MAX_LINES:
        return [Line(number, _at_blanks(line)) for number, line in numbered]
    found = _split(numbered, width)
    if found:
        return found
    if sum("\t" in line for _, line in numbered) * 2 > len(numbered):
        return [Line(number, _at_tabs(line)) for number, line in numbered]
    if all(line.count(";") >= 2 for _, line in numbered):
        return [Line(number, _at_semicolons(line)) for number, line in numbered]
    return _aligned([(number, line.strip()) for number, line in numbered])


def _split(numbered: list[tuple[int, str]], width: int | None) -> list[Line]:
    """Return the table among lines, split in the way that gives one; no lines where none does."""
    for split in (_at_tabs, _at_semicolons, _at_commas, _at_gaps, _at_signs, _at_blanks):
        lines = [Line(number, split(line)) for number, line in numbered]
        found = _under_heading(lines) if width is None else _of_width(lines, width)
        if found:
            return found
    return []


def _is_headed(line: str) -> bool:
    """Return whether a line is a heading when it is split in some way."""
    splits = (_at_tabs, _at_semicolons, _at_commas, _at_gaps, _at_blanks)
    return any(is_heading(split(line)) for split in splits)


def _at_tabs(line: str) -> tuple[str, ...]:
    return tuple(cell.strip().strip('"') for cell in line.split("\t"))


def _at_semicolons(line: str) -> tuple[str, ...]:
    return tuple(cell.strip().strip('"') for cell in line.rstrip().rstrip(";").split(";"))


def _at_commas(line: str) -> tuple[str, ...]:
    cells, depth, start = [], 0, 0
    for k, character in enumerate(line):
        depth += (character in "([") - (character in ")]")
        if character == "," and depth == 0:
            cells.append(line[start:k].strip().strip('"'))
            start = k + 1
    return (*cells, line[start:].strip().strip('"'))


def _at_gaps(line: str) -> tuple[str, ...]:
    return tuple(_TAB_OR_GAP.split(line.strip()))


def _at_signs(line: str) -> tuple[str, ...]:
    return tuple(_GAP_OR_SIGN.split(line.strip()))


def _at_blanks(line: str) -> tuple[str, ...]:
    return tuple(line.split())


def _under_heading(lines: list[Line]) -> list[Line]:
    """Return a heading and the rows below it, where every row has as many cells.

    Rows may begin with a label that the heading leaves out; then the line of the label's name is
    dropped. None of the lines after the last row may look like a row.
    """
    start = next((k for k, line in enumerate(lines[:MAX_TITLE]) if is_heading(line.cells)), None)
    if start is None or len(lines) < start + 2:
        return []
    heading, rows = lines[start], lines[start + 1 :]
    width, units = len(heading.cells), []
    if len(rows) > 1 and is_units(rows[0].cells):
        units = [_spread(rows[0], heading)]
        rows = rows[1:] if len(units[0].cells) == width else rows
    named = len(rows) > 1 and len(rows[0].cells) == 1 and len(rows[1].cells) == width + 1
    if named and not rows[0].cells[0].isdecimal():
        rows = rows[1:]
    cells = len(rows[0].cells)
    if cells not in (width, width + 1):
        return []
    end = next((k for k, row in enumerate(rows) if len(row.cells) != cells), len(rows))
    if any(_looks_like_row(row, width) for row in rows[end:]):
        return []
    if cells != width:
        units = [Line(line.number, ("", *line.cells)) for line in units]
    return [heading, *units, *rows[:end]]


def _spread(units: Line, heading: Line) -> Line:
    """Put units under the columns that have one, where the line leaves out the others."""
    if len(units.cells) == len(heading.cells):
        return units
    keys = [is_heading((cell,), least=1) for cell in heading.cells]
    if sum(keys) != len(units.cells):
        return units
    left = iter(units.cells)
    return Line(units.number, tuple(next(left) if key else "" for key in keys))


def _of_width(lines: list[Line], width: int) -> list[Line]:
    """Return the one run of lines with so many cells, where no other line looks like a row."""
    fits = [len(line.cells) == width for line in lines]
    if not any(fits) or width < 3:
        return []
    first, last = fits.index(True), len(fits) - 1 - fits[::-1].index(True)
    others = lines[:first] + lines[last + 1 :]
    if not all(fits[first : last + 1]) or any(_looks_like_row(line, width) for line in others):
        return []
    return lines[first : last + 1]


def _looks_like_row(line: Line, width: int) -> bool:
    """Return whether a line may be a row with a cell too many or too few."""
    numbers = sum(_NUMERIC.match(cell) is not None for cell in line.cells)
    return numbers >= 2 and numbers * 2 >= min(width, len(line.cells))


def _refuse_unpiped(piped: list[tuple[int, str]], numbered: list[tuple[int, str]]) -> None:
    """Refuse a line without borders where a row may be meant, which would be lost."""
    bordered = {number for number, _ in piped}
    first, last = piped[0][0], piped[-1][0]
    for number, line in numbered:
        row = number == last + 1 and line.lstrip()[:1] in "|0123456789"
        if number not in bordered and (first < number < last or row):
            raise DHError.single(
                (),
                say(
                    "line {number} has no | between its cells, as the others have; add them",
                    number=number,
                ),
            )


def _piped(line: str) -> tuple[str, ...]:
    line = line.strip()
    line = line[1:] if line.startswith("|") else line
    if line.endswith("|") and not line.endswith("\\|"):
        line = line[:-1]
    return tuple(cell.strip() for cell in re.split(r"(?<!\\)\|", line))


def _aligned(numbered: list[tuple[int, str]]) -> list[Line]:
    """Split columns at two blanks or more, or at any blank if that gives equal rows only."""
    if len(numbered) > 1 and all(line.count(",") >= 2 for _, line in numbered):
        by_comma = [
            Line(number, tuple(cell.strip() for cell in line.split(",")))
            for number, line in numbered
        ]
        if len({len(line.cells) for line in by_comma}) == 1:
            return by_comma
    wide = [Line(number, tuple(_TAB_OR_GAP.split(line))) for number, line in numbered]
    if len({len(line.cells) for line in wide}) == 1 and len(wide[0].cells) > 2:
        return wide
    narrow = [Line(number, tuple(line.split())) for number, line in numbered]
    if len({len(line.cells) for line in narrow}) == 1 or len(wide[0].cells) < 3:
        return narrow
    if {len(line.cells) for line in narrow[1:]} == {len(narrow[0].cells) + 1}:
        return narrow  # rows with a label, as pandas prints them
    return wide
