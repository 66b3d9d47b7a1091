"""Query strings: checked names, and the GET form of a computation as the body of its POST."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import orjson
from fastapi import Request

from app.problems import INVALID_REQUEST, RequestProblem
from app.units import Units
from dh_to_urdf.expressions import CellError, Quantity, parse_cell
from robots.errors import hint

COMMON = ("angle", "format")
MAX_QUERY_VALUES = 1024
_TARGET = ("position", "rpy", "quaternion_xyzw", "euler", "phi", "matrix")


def check_query(request: Request, *allowed: str) -> None:
    """Refuses parameters that would be ignored, and ones given twice.

    Raises:
        RequestProblem: With the names that are known.
    """
    known = (*allowed, *COMMON)
    seen: set[str] = set()
    for name, _ in request.query_params.multi_items():
        if name not in known:
            raise RequestProblem(
                INVALID_REQUEST,
                f"query parameter {name[:64]!r} is unknown; {hint(name, known)}",
                f"/{name[:64]}",
            )
        if name in seen:
            raise RequestProblem(INVALID_REQUEST, f"{name} is given twice; keep one", f"/{name}")
        seen.add(name)


def units_of(request: Request) -> Units:
    """The units that ``?angle=`` asks for; default rad.

    Raises:
        RequestProblem: Neither rad nor deg.
    """
    angle = request.query_params.get("angle", "rad")
    if angle not in ("rad", "deg"):
        raise RequestProblem(INVALID_REQUEST, f"angle is {angle[:32]!r}; give rad or deg", "/angle")
    return Units(angle == "deg")


def body_from_query(request: Request, units: Units) -> bytes:
    """The JSON body that a GET request's parameters stand for.

    Raises:
        RequestProblem: A number cannot be read.
    """
    body: dict[str, Any] = {}
    target: dict[str, Any] = {}
    for name, text in request.query_params.items():
        if name in COMMON:
            continue
        read = _READERS.get(name)
        value = read(name, text, units) if read else text
        if name in _TARGET and "q" not in request.query_params:
            target[name] = value
        else:
            body[name] = value
    if target:
        body["target"] = target
    return orjson.dumps(body)


def number(name: str, text: str, units: Units) -> float:
    """A plain number, or an expression such as pi/2 or 90deg in the request's unit."""
    try:
        value = float(text)
        if "_" in text:
            raise ValueError
    except ValueError:
        unit = math.pi / 180 if units.degrees else 1.0
        try:
            cell = parse_cell(text, Quantity.ANGLE, unit)
        except CellError as error:
            raise RequestProblem(INVALID_REQUEST, f"{name}: a value {error}", f"/{name}") from None
        if cell.variable is not None:
            raise RequestProblem(
                INVALID_REQUEST, f"{name} holds {text[:32]!r}; give numbers", f"/{name}"
            ) from None
        value = math.degrees(cell.value) if units.degrees else cell.value
    if not math.isfinite(value):
        raise RequestProblem(
            INVALID_REQUEST, f"{name} holds {text[:32]!r}; give finite numbers", f"/{name}"
        )
    return value


def _numbers(name: str, text: str, units: Units) -> list[float]:
    parts = text.strip().strip("[]").split(",")
    if len(parts) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} has over {MAX_QUERY_VALUES} values; send a body", f"/{name}"
        )
    return [number(name, part, units) for part in parts]


def _matrix(name: str, text: str, units: Units) -> list[list[float]]:
    values = _numbers(name, text, units)
    if len(values) != 16:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} has {len(values)} values; give 16, row by row", f"/{name}"
        )
    return [values[k : k + 4] for k in range(0, 16, 4)]


def _frames(name: str, text: str, units: Units) -> list[str] | str:  # noqa: ARG001
    return "all" if text == "all" else text.split(",")


def _task(name: str, text: str, units: Units) -> list[int] | str:
    if "," not in text:
        return text
    return [int(value) if value in (0.0, 1.0) else 2 for value in _numbers(name, text, units)]


def _euler(name: str, text: str, units: Units) -> dict[str, Any] | str:
    """``ZXZ``, or with angles ``ZXZ:10,20,30``."""
    sequence, colon, angles = text.partition(":")
    if not colon:
        return sequence
    return {"sequence": sequence, "angles": _numbers(name, angles, units)}


def _integer(name: str, text: str, units: Units) -> int:
    value = number(name, text, units)
    if not value.is_integer():
        raise RequestProblem(
            INVALID_REQUEST, f"{name} is {text[:32]!r}; give an integer", f"/{name}"
        )
    return int(value)


_READERS: dict[str, Callable[[str, str, Units], Any]] = {
    "q": _numbers,
    "seed": _numbers,
    "position": _numbers,
    "rpy": _numbers,
    "quaternion_xyzw": _numbers,
    "matrix": _matrix,
    "phi": number,
    "tolerance": number,
    "time_budget_ms": number,
    "max_restarts": _integer,
    "random_seed": _integer,
    "frames": _frames,
    "task": _task,
    "euler": _euler,
}
