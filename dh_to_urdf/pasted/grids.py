r"""Pasted text -> lines of cells: LaTeX, Markdown, box drawings, tabs, aligned columns."""

from __future__ import annotations

import re
from dataclasses import dataclass

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say

MAX_COLUMNS = 32
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
_BORDER = re.compile(r"[\s|+:=\-–—_─━═┄┈┌┐└┘├┤┬┴┼╔╗╚╝╠╣╦╩╬╒╕╘╛╞╡╤╧╪╭╮╰╯]+")
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


def grid_lines(text: str) -> list[Line]:
    """Return the rows of a table without rules, borders and blank rows.

    Raises:
        DHError: Two tables, rows of unequal lengths, or too many columns.
    """
    lines = _latex_lines(text) if is_latex(text) else _text_lines(text)
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


def _text_lines(text: str) -> list[Line]:
    numbered = [
        (number, line.translate(_BOXES))
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not (_BORDER.fullmatch(line) and len(line.strip()) > 2)
    ]
    numbered = [(n, line) for n, line in numbered if line.lstrip()[0] not in "#%" or "|" in line]
    piped = [(number, line) for number, line in numbered if line.count("|") >= 2]
    if len(piped) >= 2:
        _refuse_unpiped(piped, numbered)
        return [Line(number, _piped(line)) for number, line in piped]
    if not numbered:
        return []
    if sum("\t" in line for _, line in numbered) * 2 > len(numbered):
        return [
            Line(number, tuple(cell.strip().strip('"') for cell in line.split("\t")))
            for number, line in numbered
        ]
    if all(line.count(";") >= 2 for _, line in numbered):
        return [
            Line(number, tuple(cell.strip() for cell in line.rstrip().rstrip(";").split(";")))
            for number, line in numbered
        ]
    return _aligned([(number, line.strip()) for number, line in numbered])


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
