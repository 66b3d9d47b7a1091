"""What the readers of documents share: names, units, and the report of what is wrong."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from dh_to_urdf.cells.doubts import Doubts
from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.errors import DHError, Fault, Location, quoted
from dh_to_urdf.messages import say

UNSEEN = (
    "[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164"
    "\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]"
)
"""Fillers, selectors and blanks that Unicode counts among letters, marks and signs."""
NAME = re.compile(rf"(?!.*{UNSEEN})\w(?:[\w .:+-]{{0,62}}[\w.+-])?", re.UNICODE)
NAME_RULE = say("use letters, digits and . _ - + : (at most 64, starting with a letter or digit)")


@dataclass(frozen=True)
class Units:
    """Units of the plain numbers of a document, as factors to rad and m."""

    angle: float = 1.0
    length: float = 1.0

    def of(self, quantity: Quantity) -> float:
        """Return the factor of one quantity to rad or m."""
        if quantity is Quantity.ANGLE:
            return self.angle
        return self.length if quantity is Quantity.LENGTH else 1.0


@dataclass
class Report:
    """Collects faults, so that one answer names several cells.

    Attributes:
        faults: What is refused.
        warnings: What was assumed.
        doubts: Values that are probably meant in another unit.
    """

    faults: list[Fault] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    doubts: Doubts = field(default_factory=Doubts)

    def add(self, location: Location, message: str) -> None:
        """Note one fault."""
        self.faults.append(Fault(location, message))

    def raise_if_any(self) -> None:
        """Raise where a fault was noted.

        Raises:
            DHError: With all faults so far.
        """
        if self.faults:
            raise DHError(self.faults)


def refuse_unknown(
    data: Mapping[Any, Any], known: tuple[str, ...], location: Location, where: str, report: Report
) -> None:
    """Report keys that would be ignored."""
    for key in data:
        if key not in known:
            report.add(
                (*location, str(key)),
                say(
                    "{where} has an unknown field {key}; known are {known}",
                    where=where,
                    key=quoted(key),
                    known=", ".join(known),
                ),
            )


def whole_number(raw: object) -> int | None:
    """Return an integer from 3, 3.0 or "3"; None for anything else."""
    if isinstance(raw, str) and re.fullmatch(r"\s*[+-]?[0-9]{1,6}\s*", raw):
        return int(raw)
    if isinstance(raw, bool) or not isinstance(raw, (int, float)):
        return None
    if isinstance(raw, float) and not raw.is_integer():
        return None
    return int(raw) if abs(raw) < 10**6 else None
