"""Whether the commas of a table are decimal ones, where one cell alone leaves it open."""

from __future__ import annotations

import re
from collections.abc import Iterable

_POINT = re.compile(r"\d\.\d")
_CERTAIN = re.compile(r"(?<![\d.,])(?:0,\d+|\d+,(?:\d{1,2}|\d{4,}))(?![\d.,])")
_COMMA = re.compile(r"(?<![\d.,])(\d+),(\d+)(?![\d.,])")


def are_decimal(cells: Iterable[str]) -> bool:
    """Return whether numbers of a table have decimal commas: some do for certain, none a point.

    Args:
        cells: The cells of the table.
    """
    certain = False
    for cell in cells:
        if _POINT.search(cell):
            return False
        certain = certain or _CERTAIN.search(cell) is not None
    return certain


def with_points(cell: str) -> str:
    """Return a cell with decimal points for its decimal commas; those of ``atan2`` stay."""
    return cell if "atan2" in cell else _COMMA.sub(r"\1.\2", cell)
