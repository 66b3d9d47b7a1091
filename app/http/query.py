"""Query strings: check the names of parameters, and read numbers and lists."""

from __future__ import annotations

import math

from fastapi import Request

from app.http.negotiation import CSV, LATEX, NPY, TEXT
from app.http.pointers import escaped
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.units import Units
from dh_to_urdf.cells.expressions import CellError, Quantity, parse_cell
from robots.errors import hint

COMMON = ("angle", "format")
COMPUTED = (*COMMON, "digits", "with")
"""Parameters of computations that are no fields of a request."""
MAX_DIGITS = 15
MAX_QUERY_VALUES = 1024
MAX_VALUE = 1e15


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


def flag_of(request: Request, name: str) -> bool:
    """What a parameter that is true or false says; default false.

    Raises:
        RequestProblem: Neither.
    """
    text = request.query_params.get(name, "false").lower()
    if text not in ("true", "false", "1", "0"):
        raise RequestProblem(
            INVALID_REQUEST, f"{name} is {text[:32]!r}; give true or false", f"/{name}"
        )
    return text in ("true", "1")


def digits_of(request: Request, wanted: str) -> int | None:
    """The decimals that ``?digits=`` asks for in text, CSV and LaTeX; None where it does not.

    Raises:
        RequestProblem: No number of decimals, or a form that holds all digits.
    """
    text = request.query_params.get("digits")
    if text is None:
        return None
    if wanted not in (TEXT, CSV, LATEX):
        raise RequestProblem(
            INVALID_REQUEST,
            "digits is for format=text, csv and latex; the others hold all digits",
            "/digits",
        )
    if not (text.isascii() and text.isdecimal() and len(text) <= 2 and int(text) <= MAX_DIGITS):
        raise RequestProblem(
            INVALID_REQUEST, f"digits is {text[:32]!r}; give 0 to {MAX_DIGITS}", "/digits"
        )
    return int(text)


def with_status(request: Request, wanted: str) -> bool:
    """Whether ``?with=status`` asks for the status of each row, in npy.

    Raises:
        RequestProblem: Another word, or a form that holds the statuses anyhow.
    """
    text = request.query_params.get("with")
    if text is None:
        return False
    if text != "status" or wanted != NPY:
        raise RequestProblem(
            INVALID_REQUEST,
            "with=status is for format=npy; the other forms hold each status"
            if text == "status"
            else f"with is {text[:32]!r}; give status",
            "/with",
        )
    return True


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


def split(name: str, text: str) -> list[str]:
    """Return the values of a list, with or without its brackets, separated by commas."""
    inside = text.strip()
    if inside[:1] == "[" and inside[-1:] == "]":
        inside = inside[1:-1]
    parts = inside.split(",")
    if len(parts) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST, f"{name} has over {MAX_QUERY_VALUES} values; send a body", f"/{name}"
        )
    return parts
