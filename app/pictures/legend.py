"""The legend of a chart: below it, in rows, and curves that lie on each other told apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.pictures.canvas import INK, Canvas
from app.pictures.curves import Curve, Level, range_of
from app.pictures.lettering import fitted, width_of

ROW = 13.0
"""Height of a row, pixels."""
SIZE, SWATCH, GAP = 9.0, 10.0, 9.0
SAME, EXACT = 1 / 300, 1e-9
"""Differences, as parts of the height of a chart, that nobody sees, and that are rounding."""
DASH = 6.0
"""Part of a curve that is drawn before the next of those that lie on it."""
CYCLES = (None, "7 3", "2 3", "7 3 2 3")
"""Dashes of curves that have the colours of others."""
LEVELS = ("5 3", "1.5 3", "8 3 1.5 3")


@dataclass(frozen=True)
class Style:
    """How a curve is drawn.

    Attributes:
        color: Of the line.
        dash: Of SVG, or None.
        offset: Where the dashes begin, pixels.
    """

    color: str
    dash: str | None = None
    offset: float = 0.0


@dataclass(frozen=True)
class Entry:
    """One entry.

    Attributes:
        styles: Of the lines beside its text.
        text: Its text.
    """

    styles: tuple[Style, ...]
    text: str

    @property
    def width(self) -> float:
        """Its width, pixels."""
        return len(self.styles) * (SWATCH + 2) + 1 + width_of(self.text, SIZE)


@dataclass(frozen=True)
class Legend:
    """The legend of some curves.

    Attributes:
        styles: Of each curve.
        levels: Of each level.
        rows: Entries, row by row.
    """

    styles: tuple[Style, ...]
    levels: tuple[Style, ...]
    rows: tuple[tuple[Entry, ...], ...]

    @property
    def height(self) -> float:
        """Of its rows beyond the first, pixels."""
        return ROW * max(0, len(self.rows) - 1)

    def draw(self, canvas: Canvas, x: float, y: float) -> None:
        """Draw it; y is the middle of the first row."""
        for number, row in enumerate(self.rows):
            at = x
            for entry in row:
                start = at
                for style in entry.styles:
                    ends = [(start, y + ROW * number), (start + SWATCH, y + ROW * number)]
                    canvas.line(ends, style.color, 2, dash=style.dash)
                    start += SWATCH + 2
                canvas.text((start + 1, y + ROW * number + 3), entry.text, SIZE)
                at += entry.width + GAP


def legend_of(
    curves: Sequence[Curve], levels: Sequence[Level], width: float, taken: float, *, log: bool
) -> Legend:
    """Return the legend of curves and levels.

    Args:
        curves: The curves.
        levels: The levels.
        width: Of a row, pixels.
        taken: What the first row has less.
        log: Whether the axis is logarithmic.
    """
    styles = [
        Style(curve.color, CYCLES[before % len(CYCLES)])
        for k, curve in enumerate(curves)
        for before in (sum(other.color == curve.color for other in curves[:k]),)
    ]
    entries: list[Entry] = []
    for group, exact in _groups(curves, log):
        if len(group) > 1:
            gap = DASH * (len(group) - 1)
            for place, k in enumerate(group):
                styles[k] = replace(styles[k], dash=f"{DASH:g} {gap:g}", offset=-DASH * place)
        entries += _entries([(curves[k], styles[k]) for k in group], exact, width)
    drawn: list[Style] = []
    for level in levels:
        number = sum(bool(other.label) for other in levels[: len(drawn) + 1]) - 1
        drawn.append(Style(INK, LEVELS[max(0, number) % len(LEVELS)]))
        if level.label:
            entries.append(Entry((drawn[-1],), fitted(level.label, width - 20, SIZE)))
    return Legend(tuple(styles), tuple(drawn), _rows(entries, width, taken))


def _entries(members: Sequence[tuple[Curve, Style]], exact: bool, width: float) -> list[Entry]:
    """Return one entry of curves that lie on each other, or more where one has no room."""
    sign = " = " if exact else " ≈ "
    found: list[Entry] = []
    for curve, style in members:
        if not curve.label:
            continue
        # Dashes of a group are for the chart; beside a text the colour tells.
        plain = Style(style.color, None if len(members) > 1 else style.dash)
        label = fitted(curve.label, width - 40, SIZE)
        if found:
            joined = Entry((*found[-1].styles, plain), f"{found[-1].text}{sign}{label}")
            if joined.width <= width:
                found[-1] = joined
                continue
            label = f"{sign.strip()} {label}"
        found.append(Entry((plain,), label))
    return found


def _rows(entries: Sequence[Entry], width: float, taken: float) -> tuple[tuple[Entry, ...], ...]:
    rows: list[list[Entry]] = [[]]
    used = taken
    for entry in entries:
        if used + entry.width > width and (rows[-1] or used > 0):
            rows.append([])
            used = 0.0
        rows[-1].append(entry)
        used += entry.width + GAP
    return tuple(tuple(row) for row in rows)


def _groups(curves: Sequence[Curve], log: bool) -> list[tuple[list[int], bool]]:
    """Return numbers of curves that look the same, and whether they are, in order."""
    data = [curve.shown(log) for curve in curves]
    low, high = range_of(np.concatenate([y for _, y in data] or [np.zeros(0)]), 0.0)
    found: list[tuple[list[int], bool]] = []
    for k, (x, y) in enumerate(data):
        for n, (group, exact) in enumerate(found):
            other_x, other = data[group[0]]
            if not len(y) or len(y) != len(other) or not np.array_equal(x, other_x):
                continue
            apart = float(np.abs(y - other).max())
            if apart <= SAME * (high - low):
                found[n] = ([*group, k], exact and apart <= EXACT * (high - low))
                break
        else:
            found.append(([k], True))
    return found
