"""A table of an answer: columns of equal length, each with a heading and a unit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.sheets.headings import with_unit

BLOCK = 1_000
"""Rows that are written at a time, so that other threads get a turn."""
_FORMULA = ("=", "+", "-", "@", "\t", "\r")


@dataclass(frozen=True, eq=False)
class Column:
    """One column.

    Attributes:
        heading: What it holds.
        values: One a row; None for an empty cell, as is a number that is not finite.
        unit: Of its numbers; empty where they have none.
    """

    heading: str
    values: Sequence[Any] | NDArray[Any]
    unit: str = ""

    def part(self, rows: slice) -> list[Any]:
        """Return the values of some rows as plain Python values."""
        part = self.values[rows]
        if not isinstance(part, np.ndarray):
            return list(part)
        if part.dtype.kind == "f":
            # Adding zero takes the signs of zeros.
            plain: list[Any] = (part + 0.0).tolist()
            if np.isfinite(part).all():
                return plain
            return [v if keep else None for v, keep in zip(plain, np.isfinite(part), strict=True)]
        return list(part.tolist())


@dataclass(frozen=True, eq=False)
class Sheet:
    """A table.

    Attributes:
        columns: Its columns, all of the same length.
    """

    columns: tuple[Column, ...]

    @classmethod
    def of_rows(cls, rows: Sequence[Mapping[str, Any]]) -> Sheet:
        """Return the table of rows that all have the keys of the first, without units."""
        names = list(rows[0]) if rows else []
        return cls(tuple(Column(name, [row[name] for row in rows]) for name in names))

    def __len__(self) -> int:
        return len(self.columns[0].values) if self.columns else 0

    @cached_property
    def headings(self) -> list[str]:
        """The first line: headings with their units."""
        return [with_unit(column.heading, column.unit) for column in self.columns]

    def blocks(self) -> Iterator[Iterator[tuple[Any, ...]]]:
        """Give the rows, some at a time."""
        for start in range(0, len(self), BLOCK):
            rows = slice(start, start + BLOCK)
            yield zip(*(column.part(rows) for column in self.columns), strict=True)

    def rows(self) -> Iterator[tuple[Any, ...]]:
        """Give the rows."""
        return chain.from_iterable(self.blocks())


SheetSource = Callable[[], Sheet]
"""Makes a table where one is asked for."""


def cell(value: object, digits: int | None) -> object:
    """Return a value as CSV writes it; 1 and 0 are numbers, though Python has True == 1.

    A text that a spreadsheet would take for a formula is quoted, as it may come from a file of
    somebody else.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return (value if digits is None else round(value, digits)) + 0.0
    if isinstance(value, str):
        return f"'{value}" if value.startswith(_FORMULA) else value
    return "" if value is None else value
