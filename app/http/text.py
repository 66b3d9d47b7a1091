"""Answers for a terminal: aligned matrices and tables under short headings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.languages import ENGLISH, Language
from dh_to_urdf.messages import say

MAX_ROWS = 200
"""Rows of a batch that a terminal is shown."""
LINE = 100
"""Longest line of a mapping; a longer one gets a line an entry."""
WIDEST = 160
"""Widest table; of a wider one with few rows, rows become columns."""
SMALL = 1e-4
"""Lists of numbers below this are written with exponents."""


BIG = 1e6
"""Numbers from here on are written with exponents, too."""
BY_NAME = frozenset({"q", "poses", "joint_values", "messages", "left_out", "definitions", "values"})
"""Fields whose entries go by names of frames, joints or methods, which are said as they are."""
NOISE = 1e-12
"""What is smaller is rounding, and is written as 0."""


def render_text(
    payload: Mapping[str, Any], digits: int | None = None, language: Language = ENGLISH
) -> str:
    """Renders an answer; arrays of numbers become aligned columns.

    Args:
        payload: The answer.
        digits: Decimals of all numbers; None: nine in arrays, nine digits elsewhere.
        language: Of headings and words; messages of the answer are in it already.
    """
    lines: list[str] = []
    # Nothing to warn of, or to note, is no line: who reads a terminal would look for it.
    shown = {k: v for k, v in payload.items() if (k != "warnings" or v) and not _is_blank(v)}
    _Text(digits, lines, language).mapping(shown, "")
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class _Text:
    """Writes an answer line by line.

    Attributes:
        digits: Decimals of all numbers; None: see :func:`render_text`.
        lines: The lines so far.
        language: Of headings and words.
    """

    digits: int | None
    lines: list[str]
    language: Language

    def heading(self, key: str) -> str:
        """The name of an entry, and what follows it."""
        return self.language.heading(key) + self.language.colon

    def mapping(self, payload: Mapping[str, Any], indent: str, by_name: bool = False) -> None:
        """Entries one below the other; ``by_name``: their keys are names of the user's."""
        for key, value in payload.items():
            heading = key + self.language.colon if by_name else self.heading(key)
            head = indent + heading
            array = _array(value)
            if isinstance(value, Mapping):
                if all(
                    not isinstance(item, (Mapping, list, tuple, np.ndarray))
                    for item in value.values()
                ):
                    self.scalars(heading, value, indent, key in BY_NAME)
                else:
                    self.lines.append(head)
                    self.mapping(value, indent + "  ", key in BY_NAME)
            elif array is not None and array.ndim == 1:
                tiny = self.digits is None and _is_tiny(array)
                cell = _tiny if tiny else self.cell
                cells = "  ".join(cell(item) for item in array)
                self.lines.append(f"{head} [{cells.strip()}]" if array.size else f"{head} []")
            elif array is not None:
                self.lines.append(head)
                self.blocks(array, indent + "  ")
            elif isinstance(value, (list, tuple)):
                self.sequence(key, value, indent)
            else:
                self.lines.append(f"{head} {self.scalar(value, key)}")

    def scalars(
        self, heading: str, value: Mapping[str, Any], indent: str, by_name: bool = False
    ) -> None:
        """A mapping without lists: in one line, or where that is long one line each."""
        texts = {
            str(name) if by_name else self.language.heading(str(name)): self.scalar(item, str(name))
            for name, item in value.items()
        }
        inline = f"{indent}{heading} " + "  ".join(f"{name} {text}" for name, text in texts.items())
        if len(inline) <= LINE:
            self.lines.append(inline)
            return
        width = max(len(name) for name in texts)
        self.lines.append(f"{indent}{heading}")
        self.lines.extend(f"{indent}  {name.ljust(width)}  {text}" for name, text in texts.items())

    def sequence(self, key: str, value: Sequence[Any], indent: str) -> None:
        """A list that is no array of numbers."""
        mappings = bool(value) and all(isinstance(item, Mapping) for item in value)
        if mappings and not any(map(_has_matrix, value)):
            self.lines.append(f"{indent}{self.heading(key)}")
            self.table(value, indent + "  ")
        elif mappings or any(isinstance(item, (list, tuple, np.ndarray)) for item in value):
            self.lines.append(f"{indent}{self.heading(key)}")
            for index, item in enumerate(value[:MAX_ROWS]):
                self.mapping({str(index): item}, indent + "  ")
        elif any(len(str(item)) > 40 for item in value):
            self.lines.append(f"{indent}{self.heading(key)}")
            self.lines.extend(f"{indent}  - {self.scalar(item, key)}" for item in value)
        else:
            items = ", ".join(self.scalar(item, key) for item in value)
            shown = items or self.language.word("", "(none)")
            self.lines.append(f"{indent}{self.heading(key)} {shown}")

    def table(self, rows: Sequence[Mapping[str, Any]], indent: str) -> None:
        """Mappings as rows, or where there are few wide ones as columns."""
        columns = list(dict.fromkeys(column for row in rows for column in row))
        body = [
            [self.scalar(row.get(column), column) for column in columns] for row in rows[:MAX_ROWS]
        ]
        table = [[self.language.heading(column) for column in columns], *body]
        widths = _widths(table)
        if sum(widths) + 2 * len(widths) > WIDEST and len(rows) < len(columns):
            table = [list(line) for line in zip(*table, strict=True)]
            widths = _widths(table)
        for line in table:
            cells = (text.ljust(width) for text, width in zip(line, widths, strict=True))
            self.lines.append(indent + "  ".join(cells).rstrip())

    def blocks(self, array: NDArray[Any], indent: str) -> None:
        """An array of two or more axes, as matrices."""
        if array.ndim == 2:
            texts = [[self.cell(item) for item in row] for row in array[:MAX_ROWS]]
            width = max((len(text) for row in texts for text in row), default=0)
            self.lines.extend(indent + " ".join(text.rjust(width) for text in row) for row in texts)
        else:
            for index, block in enumerate(array[:MAX_ROWS]):
                self.lines.append(f"{indent}[{index}]")
                self.blocks(block, indent + "  ")
        if len(array) > MAX_ROWS:
            more = say("… {count} more; ask for JSON or npy", count=len(array) - MAX_ROWS)
            self.lines.append(indent + self.language.text(more))

    def cell(self, value: Any) -> str:
        """A number of an array."""
        if isinstance(value, (int, np.integer)):
            return str(value)
        return _fixed(float(value), 9 if self.digits is None else self.digits)

    def scalar(self, value: object, name: str = "") -> str:
        """A value that stands alone, or in a table, of the field of a name."""
        if value is None:
            return "-"
        if isinstance(value, Mapping):
            return " ".join(
                f"{self.language.heading(key)} {self.scalar(item, key)}"
                for key, item in value.items()
            )
        if isinstance(value, np.ndarray):
            decimals = 6 if self.digits is None else self.digits
            return " ".join(_fixed(float(item), decimals).rjust(decimals + 5) for item in value)
        if isinstance(value, (list, tuple)):
            return ", ".join(self.scalar(item, name) for item in value) or "-"
        if isinstance(value, bool):
            return self.language.word("", "yes" if value else "no")
        if isinstance(value, (float, np.floating)):
            number = float(value)
            number = 0.0 if abs(number) < NOISE else number
            return f"{number:.9g}" if self.digits is None else _fixed(number, self.digits)
        return self.language.word(name, value) if isinstance(value, str) else str(value)


def _is_blank(value: object) -> bool:
    return isinstance(value, str) and not value


def _fixed(number: float, decimals: int) -> str:
    """Write a number with so many decimals; no zero has a sign."""
    if abs(number) >= BIG:
        return f"{number:.{min(decimals, 6)}e}"
    return f"{round(number, decimals) + 0.0:.{decimals}f}"


def _tiny(value: Any) -> str:
    return f"{float(value):.2e}" if abs(value) >= NOISE else "0"


def _has_matrix(row: Mapping[str, Any]) -> bool:
    """Whether an entry has more axes than a cell of a table can show."""
    return any(isinstance(value, np.ndarray) and value.ndim > 1 for value in row.values())


def _widths(table: Sequence[Sequence[str]]) -> list[int]:
    return [max(len(cell) for cell in column) for column in zip(*table, strict=True)]


def _array(value: object) -> NDArray[Any] | None:
    if isinstance(value, np.ndarray):
        return value if value.dtype.kind in "fiu" else None
    if isinstance(value, (list, tuple)) and value:
        try:
            array = np.asarray(value)
        except ValueError:
            return None
        return array if array.dtype.kind in "fiu" else None
    return None


def _is_tiny(array: NDArray[Any]) -> bool:
    """Numbers of which nine decimals would show next to nothing, as errors are."""
    return array.dtype.kind == "f" and NOISE <= float(np.abs(array).max(initial=0.0)) < SMALL
