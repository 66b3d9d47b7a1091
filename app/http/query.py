"""Query strings: check the names of parameters, and read numbers and lists."""

from __future__ import annotations

import math

from fastapi import Request

from app.http.csv_table import CsvForm
from app.http.language import language_of
from app.http.negotiation import CSV, LATEX, NPY, TEXT
from app.http.pointers import escaped
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.units import Units
from dh_to_urdf.cells.expressions import CellError, Quantity, parse_cell
from dh_to_urdf.languages import ENGLISH, codes
from dh_to_urdf.messages import say
from kinematics.orientation_formats import FORMATS
from robots.errors import hint

COMMON = ("angle", "format", "lang")
COMPUTED = (*COMMON, "digits", "decimal", "with", "orientation", "length")
"""Parameters of computations that are no fields of a request."""
SHOWN = ("rpy", "quaternion_xyzw")
"""Ways to write an orientation that answers have anyhow."""
ORIENTATIONS = (*SHOWN, *FORMATS)
LANG_TEXT = f"Language of messages, {', '.join(codes())}; default by Accept-Language."
DECIMAL_TEXT = "CSV: point (default) or comma; with comma, semicolons between the cells."
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
                say(
                    "query parameter {name!r} is unknown; {hint}",
                    name=name[:64],
                    hint=hint(name, _suggested(name, known)),
                ),
                f"/{escaped(name)}",
            )
        if name in seen:
            raise RequestProblem(
                INVALID_REQUEST, say("{name} is given twice; keep one", name=name), f"/{name}"
            )
        seen.add(name)
    named = request.query_params.get("lang")
    if named is not None and named not in codes():
        raise RequestProblem(
            INVALID_REQUEST,
            say("lang is {named!r}; give {codes}", named=named[:32], codes=", ".join(codes())),
            "/lang",
        )


def _suggested(name: str, known: tuple[str, ...]) -> tuple[str, ...]:
    """The names to choose from: of ``length`` and ``angle``, ``lang`` is no misspelling."""
    return known if name.lower().startswith("la") else tuple(n for n in known if n != "lang")


def units_of(request: Request, *, lengths: bool = False) -> Units:
    """The units that ``?angle=``, ``?orientation=`` and ``?length=`` ask for; default rad and m.

    Args:
        request: The request.
        lengths: Whether ``length`` is the unit of its values, not of a document that it holds.

    Raises:
        RequestProblem: Neither rad nor deg, neither m nor mm, or no way to write an orientation.
    """
    angle = request.query_params.get("angle", "rad")
    if angle not in ("rad", "deg"):
        raise RequestProblem(
            INVALID_REQUEST, say("angle is {angle!r}; give rad or deg", angle=angle[:32]), "/angle"
        )
    written = request.query_params.get("orientation", "")
    if written and written not in ORIENTATIONS:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "orientation is {written!r}; give {known}",
                written=written[:32],
                known=", ".join(ORIENTATIONS),
            ),
            "/orientation",
        )
    length = request.query_params.get("length", "m") if lengths else "m"
    if length not in ("m", "mm"):
        raise RequestProblem(
            INVALID_REQUEST,
            say("length is {length!r}; give m or mm", length=length[:32]),
            "/length",
        )
    return Units(angle == "deg", "" if written in SHOWN else written, length == "mm")


def flag_of(request: Request, name: str) -> bool:
    """What a parameter that is true or false says; default false.

    Raises:
        RequestProblem: Neither.
    """
    text = request.query_params.get(name, "false").lower()
    if text not in ("true", "false", "1", "0"):
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} is {text!r}; give true or false", name=name, text=text[:32]),
            f"/{name}",
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
            say("digits is for format=text, csv and latex; the others hold all digits"),
            "/digits",
        )
    if not (text.isascii() and text.isdecimal() and len(text) <= 2 and int(text) <= MAX_DIGITS):
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "digits is {text!r}; give 0 to {max_digits}", text=text[:32], max_digits=MAX_DIGITS
            ),
            "/digits",
        )
    return int(text)


def csv_form_of(request: Request, wanted: str, digits: int | None) -> CsvForm | None:
    """How ``?lang=`` and ``?decimal=`` want CSV; None for other forms.

    A heading is in another language where ``lang`` asks for it, not where the browser prefers it,
    since programs read these tables too.

    Raises:
        RequestProblem: Neither point nor comma, or a form that has no such choice.
    """
    decimal = request.query_params.get("decimal")
    if decimal is not None and (decimal not in ("point", "comma") or wanted != CSV):
        raise RequestProblem(
            INVALID_REQUEST,
            say("decimal is for format=csv; the other forms have decimal points")
            if decimal in ("point", "comma")
            else say("decimal is {decimal!r}; give point or comma", decimal=decimal[:32]),
            "/decimal",
        )
    if wanted != CSV:
        return None
    spoken = language_of(request) if "lang" in request.query_params else ENGLISH
    return CsvForm(spoken, digits, commas=decimal == "comma")


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
            say("with=status is for format=npy; the other forms hold each status")
            if text == "status"
            else say("with is {text!r}; give status", text=text[:32]),
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
            say("{name} holds {text!r}; give finite numbers up to 1e15", name=name, text=text[:32]),
            f"/{name}",
        )
    return value


def _expression(name: str, text: str, units: Units, quantity: Quantity) -> float:
    degrees = units.degrees and quantity is Quantity.ANGLE
    if any(letter.isnumeric() and not letter.isascii() for letter in text):
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} holds {text!r}; write numbers as 0 to 9", name=name, text=text[:32]),
            f"/{name}",
        )
    try:
        unit = units.length_in(1.0) if quantity is Quantity.LENGTH else 1.0
        cell = parse_cell(text, quantity, math.pi / 180 if degrees else unit)
    except CellError as error:
        plus = say("; in a URL write + as %2B") if " " in text.strip() else ""
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name}: a value {error}{plus}", name=name, error=error, plus=plus),
            f"/{name}",
        ) from None
    if cell.variable is not None:
        raise RequestProblem(
            INVALID_REQUEST,
            say("{name} holds {text!r}; give numbers", name=name, text=text[:32]),
            f"/{name}",
        )
    if quantity is Quantity.LENGTH:
        return units.length_out(cell.value)
    return math.degrees(cell.value) if degrees else cell.value


def split(name: str, text: str) -> list[str]:
    """Return the values of a list, with or without its brackets, separated by commas."""
    inside = text.strip()
    if inside[:1] == "[" and inside[-1:] == "]":
        inside = inside[1:-1]
    parts = inside.split(",")
    if len(parts) > MAX_QUERY_VALUES:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "{name} has over {max_query_values} values; send a body",
                name=name,
                max_query_values=MAX_QUERY_VALUES,
            ),
            f"/{name}",
        )
    return parts
