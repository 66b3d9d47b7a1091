"""Values that are read as they stand and are probably meant in another unit.

A plain number is in the unit of its place. Where it is hardly an angle in rad (90), hardly one in
degrees (1.5708) or hardly a length in m (300), it is read all the same, and a sentence says what
was read and how to write what was probably meant.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from statistics import median

from dh_to_urdf.cells.expressions import Cell, Quantity
from dh_to_urdf.messages import say

TURN = 2 * math.pi
SLICE = math.pi / 12
ROUNDED = 2e-3
"""Distance, rad, from a multiple of 15° below which an angle is meant in rad."""
MOST_RADIANS = 48.5 * SLICE
"""Digits of angles beyond two turns are not looked for."""
FINE, COARSE = 6e-5, 6e-4
"""Distances of digits from those of a multiple of 15° and of 90° in rad, written in degrees."""
LIMIT, NO_LIMIT = 20.0, 1000.0
"""Limits of an angle between these, rad, look like degrees; beyond, they stand for none."""
LONG, LONG_TRAVEL = 20.0, 50.0
"""Lengths and limits of slides beyond this, m, look like millimetres."""
ODD, ODD_RATIO = 5.0, 20.0
"""A length beyond both, in m and relative to the others, looks like millimetres."""
SHORT = 5.0
"""Lengths in mm of which none reaches this look like metres."""


class Kind(Enum):
    """What a value was probably meant as, though it was read in the other unit."""

    DEGREES = "degrees"
    RADIANS = "radians"
    MILLIMETRES = "millimetres"
    METRES = "metres"


def is_like_degrees(angle: float) -> bool:
    """Return whether an angle, rad, is over a turn and no multiple of 15°, as 90 is."""
    if abs(angle) <= TURN + ROUNDED:
        return False
    return abs(math.remainder(angle, SLICE)) > ROUNDED


def is_like_radians(angle: float) -> bool:
    """Return whether an angle, degrees, has the digits of one in rad, as 1.5708 has."""
    size = abs(angle)
    if not SLICE / 2 < size < MOST_RADIANS:
        return False
    parts, hundredths = round(size / SLICE), size * 100
    off = abs(size - parts * SLICE)
    if abs(hundredths - round(hundredths)) < 1e-9:
        return parts % 6 == 0 and off < 5e-3 and parts <= 24
    return off < (COARSE if parts % 6 == 0 else FINE)


def is_like_degree_limit(angle: float) -> bool:
    """Return whether a limit, rad, is hardly one in rad, as 180 is."""
    return LIMIT < abs(angle) < NO_LIMIT and is_like_degrees(angle)


_UNITS = {
    Kind.DEGREES: say("degrees"),
    Kind.RADIANS: say("radians"),
    Kind.MILLIMETRES: say("millimetres"),
    Kind.METRES: say("metres"),
}


@dataclass(frozen=True, slots=True)
class Remedies:
    """What to write for what was probably meant, as the end of a sentence.

    Attributes:
        degrees: For angles in degrees that were read in rad.
        radians: For angles in rad that were read in degrees.
        millimetres: For lengths in mm that were read in m.
        metres: For lengths in m that were read in mm.
    """

    degrees: str
    radians: str
    millimetres: str
    metres: str


IN_TABLE = Remedies(
    say("then give angle=deg (in JSON and YAML units: {{angle: deg}})"),
    say("then give angle=rad (in JSON and YAML units: {{angle: rad}})"),
    say("then give length=mm (in JSON and YAML units: {{length: mm}})"),
    say("then give length=m (in JSON and YAML units: {{length: m}})"),
)


@dataclass(frozen=True, slots=True)
class Length:
    """A length that was looked at.

    Attributes:
        value: Its magnitude, m.
        what: What it is of.
        written: The number as it stands in the document.
        in_mm: Whether it was read in mm.
    """

    value: float
    what: str
    written: float
    in_mm: bool

    @property
    def text(self) -> str:
        """Return the length in words, without unit."""
        return say("{what} is {written:g}", what=self.what, written=self.written)


@dataclass
class Doubts:
    """Collects doubtful values; one sentence a kind, the first of its values in full.

    Attributes:
        remedies: What to write instead.
        found: Descriptions of the values, by kind.
        lengths: The lengths that were looked at.
    """

    remedies: Remedies = IN_TABLE
    found: dict[Kind, list[str]] = field(default_factory=dict)
    lengths: list[Length] = field(default_factory=list)

    def add(self, kind: Kind, value: str) -> None:
        """Note a value, such as "alpha of joint j1 is 90 rad, 14 turns"."""
        self.found.setdefault(kind, []).append(value)

    def cell(self, cell: Cell, quantity: Quantity, what: str, *, limit: bool = False) -> None:
        """Look at a cell that was read: its plain number says in which unit.

        Args:
            cell: The cell.
            quantity: What it measures.
            what: What it is, such as "alpha of joint j1".
            limit: Whether it is a limit of a joint.
        """
        plain, value = cell.plain, cell.value
        if plain == 0.0:
            return
        if quantity is Quantity.ANGLE:
            if value == plain:
                self.angle(value, what, limit=limit)
            elif math.isclose(value, math.radians(plain), rel_tol=1e-12):
                self.degrees(plain, what)
        elif quantity is Quantity.LENGTH:
            in_mm = math.isclose(value, plain / 1000, rel_tol=1e-12)
            if value == plain or in_mm:
                self.length(value, what, limit=limit, in_mm=in_mm)

    def angle(self, value: float, what: str, *, limit: bool = False) -> None:
        """Look at an angle that was read in rad."""
        if is_like_degree_limit(value) if limit else is_like_degrees(value):
            self.add(Kind.DEGREES, say("{what} is {value}", what=what, value=in_turns(value)))

    def degrees(self, value: float, what: str) -> None:
        """Look at an angle that was read in degrees."""
        if is_like_radians(value):
            self.add(Kind.RADIANS, say("{what} is {value}", what=what, value=as_radians(value)))

    def length(self, value: float, what: str, *, limit: bool = False, in_mm: bool = False) -> None:
        """Look at a length, m."""
        if limit and not in_mm:
            if LONG_TRAVEL < abs(value) < NO_LIMIT:
                self.add(Kind.MILLIMETRES, say("{what} is {value:g} m", what=what, value=value))
        elif not limit and value:
            written = value * 1000 if in_mm else value
            self.lengths.append(Length(abs(value), what, written, in_mm))

    def sentences(self) -> tuple[str, ...]:
        """Return a sentence for each kind that was found."""
        found = {kind: list(self.found.get(kind, ())) for kind in Kind}
        for kind, values in _of_lengths(self.lengths):
            found[kind][:0] = values
        return tuple(self._sentence(kind, values) for kind, values in found.items() if values)

    def _sentence(self, kind: Kind, values: list[str]) -> str:
        more = say(" (and {count} more like it)", count=len(values) - 1) if len(values) > 1 else ""
        return say(
            "{value}{more}; {unit}? {remedy}",
            value=values[0],
            more=more,
            unit=_UNITS[kind],
            remedy=getattr(self.remedies, kind.value),
        )


def in_turns(angle: float) -> str:
    """Write an angle, rad, over a turn: "90 rad, which is 14 turns"."""
    turns = abs(angle) / TURN
    return say(
        "{angle:g} rad, which is {turns} turns",
        angle=angle,
        turns=f"{turns:.{(0 if turns >= 2 else 1)}f}",
    )


def as_radians(angle: float) -> str:
    """Write an angle, degrees, whose digits are those of one in rad."""
    parts = round(angle / SLICE)
    return say("{angle:g} degrees, the digits of {parts}° in rad", angle=angle, parts=parts * 15)


def _of_lengths(lengths: Sequence[Length]) -> Iterable[tuple[Kind, list[str]]]:
    in_m = [one for one in lengths if not one.in_mm]
    in_mm = [one for one in lengths if one.in_mm]
    values = [one.value for one in in_m]

    def is_long(value: float) -> bool:
        if value > LONG or value <= ODD:
            return value > LONG
        others = [one for one in values if one != value]
        return bool(others) and value > ODD_RATIO * median(others)

    yield Kind.MILLIMETRES, [say("{text} m", text=one.text) for one in in_m if is_long(one.value)]
    if in_mm and max(one.value * 1000 for one in in_mm) < SHORT and not in_m:
        yield Kind.METRES, [say("{text} mm", text=one.text) for one in in_mm]


Note = Callable[[int, Cell], None]
"""Takes each cell of a list with its place."""
