"""Readers of query parameters: the text of one -> the value that JSON would give."""

from __future__ import annotations

from typing import Any

from app.fields.field import Reading
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import MAX_QUERY_VALUES, number, split
from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.messages import say


def text(name: str, value: str, reading: Reading) -> str:
    """Return the text itself."""
    del name, reading
    return value


def angle(name: str, value: str, reading: Reading) -> float:
    """Return an angle in the unit of the request."""
    return number(name, value, reading.units)


def length(name: str, value: str, reading: Reading) -> float:
    """Return a length, m."""
    return number(name, value, reading.units, Quantity.LENGTH)


def scalar(name: str, value: str, reading: Reading) -> float:
    """Return a number without a unit."""
    return number(name, value, reading.units, Quantity.NUMBER)


def integer(name: str, value: str, reading: Reading) -> int:
    """Return an integer."""
    found = scalar(name, value, reading)
    if not found.is_integer():
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} is {value!r}; give an integer", name=name, value=value[:32]),
            f"/{name}",
        )
    return int(found)


def flag(name: str, value: str, reading: Reading) -> bool:
    """Return true or false."""
    del reading
    if value not in ("true", "false"):
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} is {value!r}; give true or false", name=name, value=value[:32]),
            f"/{name}",
        )
    return value == "true"


def angles(name: str, value: str, reading: Reading) -> list[float]:
    """Return angles in the unit of the request."""
    return [number(name, part, reading.units) for part in split(name, value)]


def lengths(name: str, value: str, reading: Reading) -> list[float]:
    """Return lengths, m."""
    return [number(name, part, reading.units, Quantity.LENGTH) for part in split(name, value)]


def scalars(name: str, value: str, reading: Reading) -> list[float]:
    """Return numbers without a unit."""
    return [number(name, part, reading.units, Quantity.NUMBER) for part in split(name, value)]


def joint_values(name: str, value: str, reading: Reading) -> list[float]:
    """Return one value a joint: angles in the unit of the request, lengths in m."""
    parts = split(name, value)
    quantities = [Quantity.ANGLE if one else Quantity.LENGTH for one in reading.robot.is_revolute]
    if len(parts) != len(quantities):
        quantities = [Quantity.ANGLE] * len(parts)
    return [number(name, part, reading.units, q) for part, q in zip(parts, quantities, strict=True)]


def twist(name: str, value: str, reading: Reading) -> list[float]:
    """Return a twist: of six values three lengths and three angles a second, else plain numbers."""
    parts = split(name, value)
    quantities = [Quantity.LENGTH] * 3 + [Quantity.ANGLE] * 3
    if len(parts) != len(quantities):
        return scalars(name, value, reading)
    return [number(name, part, reading.units, q) for part, q in zip(parts, quantities, strict=True)]


def matrix(name: str, value: str, reading: Reading) -> list[list[float]]:
    """Return a 4x4 matrix, given row by row."""
    values = scalars(name, value, reading)
    if len(values) != 16:
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} has {count} values; give 16, row by row", name=name, count=len(values)),
            f"/{name}",
        )
    return [values[k : k + 4] for k in range(0, 16, 4)]


def names(name: str, value: str, reading: Reading) -> list[str] | str:
    """Return names, or ``all``."""
    del reading
    if value in ("all", ""):
        return "all" if value else []
    found = [part.strip() for part in value.split(",")]
    if not all(found) or len(found) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "{name} is {value!r}; give names, separated by commas", name=name, value=value[:32]
            ),
            f"/{name}",
        )
    return found


def renamings(name: str, value: str, reading: Reading) -> dict[str, str]:
    """Return names by name, from ``a2:L1,a3:L2``."""
    del reading
    pairs = [part.partition(":") for part in value.split(",")]
    if any(not colon for _, colon, _ in pairs) or len(pairs) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} is {value!r}; write it as a2:L1,a3:L2", name=name, value=value[:32]),
            f"/{name}",
        )
    return {key.strip(): named.strip() for key, _, named in pairs}


def task(name: str, value: str, reading: Reading) -> list[int] | str:
    """Return the name of a task space, or a mask of six 0 or 1."""
    if "," not in value:
        return value
    return [int(one) if one in (0.0, 1.0) else 2 for one in angles(name, value, reading)]


def euler(name: str, value: str, reading: Reading) -> dict[str, Any] | str:
    """Return an Euler sequence; with angles, ``ZXZ:10,20,30``, the sequence and its angles."""
    sequence, colon, given = value.partition(":")
    if not colon:
        return sequence
    return {"sequence": sequence, "angles": angles(name, given, reading)}
