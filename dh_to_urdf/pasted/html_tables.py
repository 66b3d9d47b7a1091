"""Tables of HTML pages -> raw tables."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from lxml import etree, html

from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.grids import Line
from dh_to_urdf.pasted.headings import MAX_COLUMNS, is_heading, read_heading
from dh_to_urdf.pasted.raw_table import RawTable, table_from_lines
from dh_to_urdf.table import Convention

_HTML = re.compile(r"<table[\s>].*?<t[dh][\s>]|<tr[\s>].*?<t[dh][\s>]", re.IGNORECASE | re.DOTALL)
MAX_SPAN = 100


def is_html(text: str) -> bool:
    """Return whether a text has a table in HTML."""
    return _HTML.search(text) is not None


def table_from_html(
    text: str, convention: Convention, columns: Sequence[str] | None = None
) -> RawTable:
    """Read the one D-H table of a page; scripts and styles are passed over.

    Args:
        text: The page, or a part of one.
        convention: What the rows mean.
        columns: Headings for a table that has none.

    Raises:
        DHError: No table or several, or one that cannot be read.
    """
    if not re.search(r"<table[\s>]", text, re.IGNORECASE):
        text = f"<table>{text}</table>"
    parser = html.HTMLParser(no_network=True, huge_tree=False, remove_comments=True)
    try:
        root = html.document_fromstring(text, parser=parser)
    except (etree.ParserError, etree.XMLSyntaxError, ValueError):
        raise DHError.single((), say("the text is no HTML that can be read")) from None
    for element in list(root.iter("script", "style")):
        _drop(element)
    found = [(table, _lines(table)) for table in root.iter("table") if not _has_table(table)]
    tables = [(table, lines) for table, lines in found if columns or _is_table(lines)]
    if len(tables) != 1:
        raise DHError.single(
            (),
            say(
                "the text holds {count} HTML tables with D-H parameters; paste the one that is"
                " meant, with its heading",
                count=len(tables),
            ),
        )
    table, lines = tables[0]
    raw = table_from_lines(lines, convention, columns)
    _drop(table)
    raw.notes = _text(root)
    return raw


def _drop(element: etree._Element) -> None:
    """Remove an element and what it holds, but not the text behind it."""
    parent, before = element.getparent(), element.getprevious()
    if parent is None:
        return
    if before is not None:
        before.tail = (before.tail or "") + " " + (element.tail or "")
    else:
        parent.text = (parent.text or "") + " " + (element.tail or "")
    parent.remove(element)


def _has_table(table: etree._Element) -> bool:
    return any(inner is not table for inner in table.iter("table"))


def _is_table(lines: list[Line]) -> bool:
    if any(is_heading(line.cells) for line in lines[:4]):
        return True
    firsts = [read_heading(line.cells[0]) for line in lines if line.cells and line.cells[0]]
    return "alpha" in {heading.key for heading in firsts if heading} and len(firsts) > 2


def _lines(table: etree._Element) -> list[Line]:
    """Return the rows of a table; cells that span several columns or rows stand in each.

    Raises:
        DHError: Too many columns.
    """
    lines: list[Line] = []
    below: dict[int, tuple[int, str]] = {}
    for number, row in enumerate(table.iter("tr"), start=1):
        cells: list[str] = []
        spanned = False
        for cell in row.iterchildren("td", "th"):
            _fill(cells, below)
            text = _text(cell)
            wide, high = _span(cell, "colspan"), _span(cell, "rowspan")
            spanned = spanned or wide > 1
            for _ in range(wide):
                if high > 1:
                    below[len(cells)] = (high - 1, text)
                cells.append(text)
            if len(cells) > MAX_COLUMNS:
                raise DHError.single(
                    (),
                    say(
                        "line {number} has {count} cells; at most {max_columns} are read",
                        number=number,
                        count=len(cells),
                        max_columns=MAX_COLUMNS,
                    ),
                )
        _fill(cells, below)
        # A heading that spans columns names none of them.
        if any(cells) and not (spanned and not any(c.isdigit() for c in "".join(cells))):
            lines.append(Line(number, tuple(cells)))
    return lines


def _fill(cells: list[str], below: dict[int, tuple[int, str]]) -> None:
    """Append the cells that reach down from rows above."""
    while len(cells) in below:
        left, text = below.pop(len(cells))
        if left > 1:
            below[len(cells)] = (left - 1, text)
        cells.append(text)


def _span(cell: etree._Element, name: str) -> int:
    text = cell.get(name, "1").strip()
    return min(MAX_SPAN, max(1, int(text))) if re.fullmatch(r"[0-9]{1,4}", text) else 1


def _text(element: etree._Element) -> str:
    """Return the text of an element; subscripts after ``_``, raised ones after ``^``."""
    return " ".join("".join(_parts(element)).split())


def _parts(element: etree._Element) -> Iterator[str]:
    before = {"sub": "_{", "sup": "^{"}.get(str(element.tag))
    if before:
        yield before
    yield element.text or ""
    for child in element:
        if isinstance(child.tag, str):
            if child.tag in ("br", "p", "div", "tr", "td", "th", "h1", "h2", "h3", "li", "caption"):
                yield " "
            yield from _parts(child)
        yield child.tail or ""
    if before:
        yield "}"
