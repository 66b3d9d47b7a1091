"""Units that the words beside a table state: ``angles in degrees``, ``[mm, deg]``."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.latex import plain_cell

_DEGREES, _RADIANS = "deg", "rad"
_WORDS = {
    **dict.fromkeys(("deg", "degs", "degree", "degrees", "degré", "degrés", "°"), _DEGREES),
    **dict.fromkeys(("rad", "rads", "radian", "radians"), _RADIANS),
    **dict.fromkeys(("mm", "millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
    **dict.fromkeys(("millimètre", "millimètres"), "mm"),
    **dict.fromkeys(("cm", "centimeters", "centimetres", "centimètres"), "cm"),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres", "mètre", "mètres"), "m"),
}
FACTORS = {"deg": math.pi / 180, "rad": 1.0, "mm": 1e-3, "cm": 1e-2, "m": 1.0}
_UNIT = "|".join(sorted(_WORDS, key=len, reverse=True))
_BEFORE = (
    r"\b(?:in|en|units?|unités?|unit[eé]s?|are|is|as|angles?|lengths?|longueurs?|distances?)"
    r"(?:\s*(?::|=|\b(?:of|are|is|in|en))\s*|\s+)|[\[(,;/:=]\s*|\b(?:and|et)\s+(?:in\s+|en\s+)?"
)
_STATED = re.compile(
    rf"(?:{_BEFORE})(?P<unit>{_UNIT})(?![\w°])(?!\s*(?:/|of freedom|de liberté|per\b|par\b))",
    re.IGNORECASE,
)
_ONE_ANGLE = re.compile(r"\b(?:theta|alpha|twist|offset)\b|[θα]", re.IGNORECASE)
_ONE_LENGTH = re.compile(r"\b[adr]_?[ijkn]?\b(?=\s*(?:,|\band\b|\bet\b|\b(?:is|are|in|en)\b))")
MAX_NOTES = 20_000


@dataclass(frozen=True)
class StatedUnits:
    """Units that hold for a table.

    Attributes:
        angle: ``deg`` or ``rad``; None where none is stated.
        length: ``mm``, ``cm`` or ``m``; None where none is stated.
    """

    angle: str | None = None
    length: str | None = None

    def factor(self, quantity: Quantity) -> float | None:
        """Return the factor to rad or m, None where none is stated."""
        unit = {Quantity.ANGLE: self.angle, Quantity.LENGTH: self.length}.get(quantity)
        return None if unit is None else FACTORS[unit]


def stated_units(notes: str, angle: str | None, length: str | None) -> StatedUnits:
    """Read the units that words beside a table state.

    Args:
        notes: The words: title, caption, what stands below.
        angle: The unit of angles that the user gives, which wins.
        length: That of lengths.

    Raises:
        DHError: Two units of one kind are stated, or one that holds for a column only, and the
            user gives none.
    """
    if len(notes) > MAX_NOTES:
        return StatedUnits(angle, length)
    found: dict[str, list[str]] = {"angle": [], "length": []}
    partial: dict[str, bool] = {"angle": False, "length": False}
    for line in notes.splitlines():
        text = plain_cell(line) if len(line) < 1000 else ""
        start = 0
        for match in _STATED.finditer(text):
            unit = _WORDS[match["unit"].lower()]
            kind = "angle" if unit in (_DEGREES, _RADIANS) else "length"
            clause = text[start : match.end()]
            start = match.end()
            columns = _ONE_ANGLE if kind == "angle" else _ONE_LENGTH
            named = {one[0].lower() for one in columns.finditer(clause)}
            partial[kind] = partial[kind] or len(named) == 1
            found[kind].append(unit)
    given = {"angle": angle, "length": length}
    for kind, units in found.items():
        if given[kind] is not None or not units:
            continue
        several = list(dict.fromkeys(units))
        if len(several) > 1 or partial[kind]:
            raise DHError.single(
                (),
                say(
                    "the words beside the table say {units} of some values only; write the units"
                    " in the headings, such as alpha [deg] or a [mm], or give {kind}={unit}",
                    units=", ".join(several),
                    kind=kind,
                    unit=several[0] if several[0] != "cm" else "mm",
                ),
            )
        given[kind] = several[0]
    return StatedUnits(given["angle"], given["length"])
