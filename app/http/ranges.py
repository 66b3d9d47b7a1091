"""Headers that list what a client accepts, with weights."""

from __future__ import annotations

import re

MAX_RANGES = 32
"""Entries of an Accept or Accept-Language header that are read."""
_WEIGHT = re.compile(r"0(\.\d{0,3})?|1(\.0{0,3})?", re.ASCII)


def accepted_ranges(accept: str) -> dict[str, tuple[float, int]]:
    """Ranges of such a header, each with its negative weight and its position.

    A weight that is none counts as 0; an empty header accepts everything.
    """
    ranges: dict[str, tuple[float, int]] = {}
    for position, item in enumerate(accept.lower().split(",")[:MAX_RANGES]):
        name, *parameters = (part.strip() for part in item.split(";"))
        if not name:
            continue
        weights = [one[2:] for one in parameters if one.startswith("q=")]
        weight = 1.0
        if weights:
            weight = float(weights[0]) if _WEIGHT.fullmatch(weights[0]) else 0.0
        ranges.setdefault(name, (-weight, position))
    return ranges or {"*/*": (-1.0, 0)}
