"""What JSON schemas say of fields beyond their types; kinematics checks it, in its words."""

from __future__ import annotations

from typing import Any

import msgspec

_COORDINATE = {"type": "number", "minimum": -1e6, "maximum": 1e6}


MAX_INTEGER = 10**300
"""An integer beyond it is no floating-point number."""


def is_number(value: object) -> bool:
    """Return whether a value of JSON is a number that floating-point numbers hold."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= MAX_INTEGER


def within(low: float, high: float) -> msgspec.Meta:
    """Return the annotation of a number from ``low`` to ``high``, both included."""
    return msgspec.Meta(extra_json_schema={"minimum": low, "maximum": high})


def items(least: int, most: int, item: dict[str, Any] | None = None) -> msgspec.Meta:
    """Return the annotation of a list of so many items."""
    told = {"minItems": least, "maxItems": most} | ({"items": item} if item else {})
    return msgspec.Meta(extra_json_schema=told)


def coordinates(least: int, most: int | None = None) -> msgspec.Meta:
    """Return the annotation of so many numbers up to ±1e6, or null."""
    return items(least, most or least, _COORDINATE)


def batch_of(least: int, most: int | None = None) -> msgspec.Meta:
    """Return the annotation of rows of so many numbers up to ±1e6, or null."""
    row = {"type": "array", "items": _COORDINATE, "minItems": least, "maxItems": most or least}
    return msgspec.Meta(extra_json_schema={"items": row})
