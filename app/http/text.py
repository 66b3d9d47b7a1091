"""Answers for a terminal: aligned matrices and tables under short headings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

MAX_ROWS = 200
"""Rows of a batch that a terminal is shown."""
LINE = 100
"""Longest line of a mapping; a longer one gets a line an entry."""
WIDEST = 160
"""Widest table; of a wider one with few rows, rows become columns."""
SMALL = 1e-4
"""Lists of numbers below this are written with exponents."""


def render_text(payload: Mapping[str, Any]) -> str:
    """Renders an answer; arrays of numbers become aligned columns."""
    lines: list[str] = []
    # Nothing to warn of is no line: those who read a terminal would look for the warning.
    quiet = not payload.get("warnings", True)
    shown = {k: v for k, v in payload.items() if k != "warnings"} if quiet else payload
    _mapping(shown, lines, "")
    return "\n".join(lines) + "\n"


def _mapping(payload: Mapping[str, Any], lines: list[str], indent: str) -> None:
    for key, value in payload.items():
        array = _array(value)
        if isinstance(value, Mapping):
            if all(
                not isinstance(item, (Mapping, list, tuple, np.ndarray)) for item in value.values()
            ):
                _scalars(key, value, lines, indent)
            else:
                lines.append(f"{indent}{key}:")
                _mapping(value, lines, indent + "  ")
        elif array is not None and array.ndim == 1:
            cell = _tiny if _is_tiny(array) else _cell
            cells = "  ".join(cell(item) for item in array)
            lines.append(
                f"{indent}{key}: [{cells.strip()}]" if array.size else f"{indent}{key}: []"
            )
        elif array is not None:
            lines.append(f"{indent}{key}:")
            _blocks(array, lines, indent + "  ")
        elif isinstance(value, (list, tuple)):
            _sequence(key, value, lines, indent)
        else:
            lines.append(f"{indent}{key}: {_scalar(value)}")


def _scalars(key: str, value: Mapping[str, Any], lines: list[str], indent: str) -> None:
    """A mapping without lists: in one line, or where that is long one line each."""
    texts = {str(name): _scalar(item) for name, item in value.items()}
    inline = f"{indent}{key}: " + "  ".join(f"{name} {text}" for name, text in texts.items())
    if len(inline) <= LINE:
        lines.append(inline)
        return
    width = max(len(name) for name in texts)
    lines.append(f"{indent}{key}:")
    lines.extend(f"{indent}  {name.ljust(width)}  {text}" for name, text in texts.items())


def _sequence(key: str, value: Sequence[Any], lines: list[str], indent: str) -> None:
    if value and all(isinstance(item, Mapping) for item in value):
        lines.append(f"{indent}{key}:")
        _table(value, lines, indent + "  ")
    elif any(isinstance(item, (list, tuple, np.ndarray)) for item in value):
        lines.append(f"{indent}{key}:")
        for index, item in enumerate(value[:MAX_ROWS]):
            _mapping({str(index): item}, lines, indent + "  ")
    elif any(len(str(item)) > 40 for item in value):
        lines.append(f"{indent}{key}:")
        lines.extend(f"{indent}  - {_scalar(item)}" for item in value)
    else:
        lines.append(f"{indent}{key}: {', '.join(_scalar(item) for item in value) or '(none)'}")


def _table(rows: Sequence[Mapping[str, Any]], lines: list[str], indent: str) -> None:
    columns = list(dict.fromkeys(column for row in rows for column in row))
    body = [[_scalar(row.get(column)) for column in columns] for row in rows[:MAX_ROWS]]
    table = [columns, *body]
    widths = _widths(table)
    if sum(widths) + 2 * len(widths) > WIDEST and len(rows) < len(columns):
        table = [list(line) for line in zip(*table, strict=True)]
        widths = _widths(table)
    for line in table:
        cells = (text.ljust(width) for text, width in zip(line, widths, strict=True))
        lines.append(indent + "  ".join(cells).rstrip())


def _widths(table: Sequence[Sequence[str]]) -> list[int]:
    return [max(len(cell) for cell in column) for column in zip(*table, strict=True)]


def _blocks(array: NDArray[Any], lines: list[str], indent: str) -> None:
    if array.ndim == 2:
        texts = [[_cell(item) for item in row] for row in array[:MAX_ROWS]]
        width = max((len(text) for row in texts for text in row), default=0)
        lines.extend(indent + " ".join(text.rjust(width) for text in row) for row in texts)
    else:
        for index, block in enumerate(array[:MAX_ROWS]):
            lines.append(f"{indent}[{index}]")
            _blocks(block, lines, indent + "  ")
    if len(array) > MAX_ROWS:
        lines.append(f"{indent}… {len(array) - MAX_ROWS} more; ask for JSON or npy")


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
    return array.dtype.kind == "f" and 0 < float(np.abs(array).max(initial=0.0)) < SMALL


def _tiny(value: Any) -> str:
    return f"{float(value):.2e}" if value else "0"


def _cell(value: Any) -> str:
    if isinstance(value, (int, np.integer)):
        return str(value)
    number = float(value)
    if abs(number) < 5e-13:
        number = 0.0
    return f"{number:.9f}" if abs(number) < 1e6 else f"{number:.6e}"


def _scalar(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, Mapping):
        return " ".join(f"{key} {_scalar(item)}" for key, item in value.items())
    if isinstance(value, np.ndarray):
        return " ".join(f"{float(item):.6f}".rjust(11) for item in value)
    if isinstance(value, (list, tuple)):
        return ", ".join(_scalar(item) for item in value) or "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return f"{float(value):.9g}"
    return str(value)
