"""Query strings: checked names, and the GET form of a computation as the body of its POST."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import orjson
from fastapi import Request

from app.http.pointers import escaped
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.units import Units
from dh_to_urdf.cells.expressions import CellError, Quantity, parse_cell
from robots.errors import hint
from robots.robot import Robot

COMMON = ("angle", "format")
MAX_QUERY_VALUES = 1024
MAX_VALUE = 1e15
_JOINTS = ("q", "qd", "z", "seed")
_TARGET = ("position", "rpy", "quaternion_xyzw", "euler", "phi", "direction", "matrix")


def check_query(request: Request, *allowed: str, common: tuple[str, ...] = COMMON) -> None:
    """Refuses parameters that would be ignored, and ones given twice.

    Raises:
        RequestProblem: With the names that are known.
    """
    known = (*allowed, *common)
    seen: set[str] = set()
    for name, _ in request.query_params.multi_items():
        if name not in known:
            raise RequestProblem(
                INVALID_REQUEST,
                f"query parameter {name[:64]!r} is unknown; {hint(name, known)}",
                f"/{escaped(name)}",
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


def body_from_query(request: Request, units: Units, robot: Robot, known: tuple[str, ...]) -> bytes:
    """The JSON body that a GET request's parameters stand for.

    Args:
        request: The request.
        units: Its units.
        robot: The robot.
        known: Parameters of the computation; one with ``position`` takes a target.

    Raises:
        RequestProblem: A number cannot be read.
    """
    body: dict[str, Any] = {}
    target: dict[str, Any] = {}
    inverse = "position" in known
    for name, text in request.query_params.items():
        if name in COMMON:
            continue
        if name in _JOINTS:
            value: Any = _joint_values(name, text, units, robot)
        elif name in _READERS:
            value = _READERS[name](name, text, units)
        else:
            value = text
        if name == "tolerance" and inverse:
            value = {"position": value, "orientation": value}
        if name in _TARGET and inverse:
            target[name] = value
        else:
            body[name] = value
    if target:
        body["target"] = target
    return orjson.dumps(body)


def number(name: str, text: str, units: Units, quantity: Quantity = Quantity.ANGLE) -> float:
    """A plain number, or an expression such as pi/2, 90deg or 300mm in the request's unit."""
    try:
        if "_" in text or not text.isascii():
            raise ValueError
        value = float(text)
    except ValueError:
        value = _expression(name, text, units, quantity)
    if not math.isfinite(value) or abs(value) > MAX_VALUE:
        raise RequestProblem(
            INVALID_REQUEST,
            f"{name} holds {text[:32]!r}; give finite numbers up to 1e15",
            f"/{name}",
        )
    return value


def _expression(name: str, text: str, units: Units, quantity: Quantity) -> float:
    degrees = units.degrees and quantity is Quantity.ANGLE
    if any(letter.isnumeric() and not letter.isascii() for letter in text):
        raise RequestProblem(
            INVALID_REQUEST, f"{name} holds {text[:32]!r}; write numbers as 0 to 9", f"/{name}"
        )
    try:
        cell = parse_cell(text, quantity, math.pi / 180 if degrees else 1.0)
    except CellError as error:
        plus = "; in a URL write + as %2B" if " " in text.strip() else ""
        raise RequestProblem(
            INVALID_REQUEST, f"{name}: a value {error}{plus}", f"/{name}"
        ) from None
    if cell.variable is not None:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} holds {text[:32]!r}; give numbers", f"/{name}"
        )
    return math.degrees(cell.value) if degrees else cell.value


def _joint_values(name: str, text: str, units: Units, robot: Robot) -> list[float]:
    parts = _split(name, text)
    quantities = [
        Quantity.ANGLE if is_revolute else Quantity.LENGTH for is_revolute in robot.is_revolute
    ]
    if len(parts) != len(quantities):
        quantities = [Quantity.ANGLE] * len(parts)
    return [number(name, part, units, q) for part, q in zip(parts, quantities, strict=True)]


def _split(name: str, text: str) -> list[str]:
    inside = text.strip()
    if inside[:1] == "[" and inside[-1:] == "]":
        inside = inside[1:-1]
    parts = inside.split(",")
    if len(parts) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} has over {MAX_QUERY_VALUES} values; send a body", f"/{name}"
        )
    return parts


def _numbers(name: str, text: str, units: Units) -> list[float]:
    return [number(name, part, units) for part in _split(name, text)]


def _lengths(name: str, text: str, units: Units) -> list[float]:
    return [number(name, part, units, Quantity.LENGTH) for part in _split(name, text)]


def _plain(name: str, text: str, units: Units) -> list[float]:
    return [number(name, part, units, Quantity.NUMBER) for part in _split(name, text)]


def _twist(name: str, text: str, units: Units) -> list[float]:
    """Six values are three lengths and three angles a second; of others the rows are unknown."""
    parts = _split(name, text)
    quantities = [Quantity.LENGTH] * 3 + [Quantity.ANGLE] * 3
    if len(parts) != len(quantities):
        return _plain(name, text, units)
    return [number(name, part, units, q) for part, q in zip(parts, quantities, strict=True)]


def _matrix(name: str, text: str, units: Units) -> list[list[float]]:
    values = _plain(name, text, units)
    if len(values) != 16:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} has {len(values)} values; give 16, row by row", f"/{name}"
        )
    return [values[k : k + 4] for k in range(0, 16, 4)]


def _frames(name: str, text: str, units: Units) -> list[str] | str:  # noqa: ARG001
    if text in ("all", ""):
        return "all" if text else []
    names = [part.strip() for part in text.split(",")]
    if not all(names) or len(names) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} is {text[:32]!r}; give names, separated by commas", f"/{name}"
        )
    return names


def _names(name: str, text: str, units: Units) -> dict[str, str]:  # noqa: ARG001
    """``a2:L1,a3:L2``."""
    pairs = [part.partition(":") for part in text.split(",")]
    if any(not colon for _, colon, _ in pairs) or len(pairs) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} is {text[:32]!r}; write it as a2:L1,a3:L2", f"/{name}"
        )
    return {key.strip(): value.strip() for key, _, value in pairs}


def _task(name: str, text: str, units: Units) -> list[int] | str:
    if "," not in text:
        return text
    return [int(value) if value in (0.0, 1.0) else 2 for value in _numbers(name, text, units)]


def _scalar(name: str, text: str, units: Units) -> float:
    return number(name, text, units, Quantity.NUMBER)


def _length(name: str, text: str, units: Units) -> float:
    return number(name, text, units, Quantity.LENGTH)


def _euler(name: str, text: str, units: Units) -> dict[str, Any] | str:
    """``ZXZ``, or with angles ``ZXZ:10,20,30``."""
    sequence, colon, angles = text.partition(":")
    if not colon:
        return sequence
    return {"sequence": sequence, "angles": _numbers(name, angles, units)}


def _integer(name: str, text: str, units: Units) -> int:
    value = number(name, text, units, Quantity.NUMBER)
    if not value.is_integer():
        raise RequestProblem(
            INVALID_REQUEST, f"{name} is {text[:32]!r}; give an integer", f"/{name}"
        )
    return int(value)


def _flag(name: str, text: str, units: Units) -> bool:  # noqa: ARG001
    if text not in ("true", "false"):
        raise RequestProblem(
            INVALID_REQUEST, f"{name} is {text[:32]!r}; give true or false", f"/{name}"
        )
    return text == "true"


_READERS: dict[str, Callable[[str, str, Units], Any]] = {
    "position": _lengths,
    "rpy": _numbers,
    "quaternion_xyzw": _plain,
    "matrix": _matrix,
    "phi": number,
    "direction": _plain,
    "tolerance": _scalar,
    "damping": _scalar,
    "characteristic_length": _length,
    "twist": _twist,
    "wrench": _plain,
    "tau": _plain,
    "time_budget_ms": _scalar,
    "max_iterations": _integer,
    "delta_x": _plain,
    "tf": _scalar,
    "samples": _integer,
    "methods": _frames,
    "joints": _frames,
    "labels": _flag,
    "width": _integer,
    "height": _integer,
    "max_restarts": _integer,
    "random_seed": _integer,
    "frames": _frames,
    "task": _task,
    "quantities": _frames,
    "symbols": _names,
    "euler": _euler,
}
