"""What the OpenAPI schemas say of fields beyond their types; kinematics checks it, in its words."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import Any

import msgspec

from kinematics.redundancy.methods import METHODS
from kinematics.task import TASKS

_COORDINATE = {"type": "number", "minimum": -1e6, "maximum": 1e6}
SEQUENCES = tuple(
    "".join(axes)
    for letters in ("XYZ", "xyz")
    for axes in product(letters, repeat=3)
    if axes[0] != axes[1] != axes[2]
)


def within(low: float, high: float) -> msgspec.Meta:
    """From ``low`` to ``high``, both included."""
    return msgspec.Meta(extra_json_schema={"minimum": low, "maximum": high})


def one_of(choices: Iterable[str], *, null: bool = False) -> msgspec.Meta:
    """One of some names; with ``null`` it may be left open."""
    return msgspec.Meta(extra_json_schema={"enum": [*choices, *([None] if null else [])]})


def items(least: int, most: int, item: dict[str, Any] | None = None) -> msgspec.Meta:
    """So many items, where there is a list."""
    told = {"minItems": least, "maxItems": most} | ({"items": item} if item else {})
    return msgspec.Meta(extra_json_schema=told)


def coordinates(least: int, most: int | None = None) -> msgspec.Meta:
    """So many numbers up to ±1e6, or null."""
    return items(least, most or least, _COORDINATE)


def batch_of(least: int, most: int | None = None) -> msgspec.Meta:
    """Rows of so many numbers up to ±1e6, or null."""
    row = {"type": "array", "items": _COORDINATE, "minItems": least, "maxItems": most or least}
    return msgspec.Meta(extra_json_schema={"items": row})


_MATRIX = {
    "type": "array",
    "items": {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4},
    "minItems": 4,
    "maxItems": 4,
}
MATRIX = msgspec.Meta(extra_json_schema={key: _MATRIX[key] for key in _MATRIX if key != "type"})
MATRICES = msgspec.Meta(extra_json_schema={"items": _MATRIX})
EULER = one_of(SEQUENCES, null=True)
SEQUENCE = one_of(SEQUENCES)
METHOD = one_of(METHODS)


def any_of(*choices: dict[str, Any]) -> msgspec.Meta:
    """One of several forms, besides what the type says."""
    return msgspec.Meta(extra_json_schema={"allOf": [{"anyOf": list(choices)}]})


TASK = any_of(
    {"enum": list(TASKS)},
    {
        "type": "array",
        "items": {"type": "integer", "enum": [0, 1]},
        "contains": {"const": 1},
        "minItems": 6,
        "maxItems": 6,
    },
)
