r"""Headings of D-H tables in their usual spellings: ``$\alpha_{i-1}$ [°]`` is alpha in degrees."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.heading_words import key_of_words, symbol_among_words
from dh_to_urdf.pasted.latex import plain_cell

MAX_COLUMNS = 32
MAX_HEADING = 100
_SPELLINGS = {
    "index": "i j k n # no nr no. nr. num joint link axis row frame liaison links joints axes"
    " articulation axe corps"
    " gelenk",
    "name": "name nom jointname",
    "type": "type sigma σ jointtype kind",
    "alpha": "alpha α twist linktwist twistangle",
    "a": "a linklength",
    "d": "d linkoffset",
    "r": "r",
    "theta": "theta θ th jointangle",
    "offset": "offset jointoffset qoffset décalage decalage",
    "variable": "q var variable jointvariable",
    "gamma": "gamma γ",
    "b": "b",
    "ant": "ant antecedent",
    "mu": "mu μ",
    "sign": "sign signe",
    "mimic": "mimic suit",
    "coupling": "coupling couplage",
    "lower": "lower min qmin θmin thetamin lowerlimit",
    "upper": "upper max qmax θmax thetamax upperlimit",
    "velocity": "velocity vitesse",
    "effort": "effort",
}
_KEYS = {spelling: key for key, listed in _SPELLINGS.items() for spelling in listed.split()}
KNOWN = say(
    "i, name, type, alpha, a, d, theta, offset, lower, upper (khalil: ant, gamma, b, r too)"
)
COLUMN_QUANTITIES = {
    "alpha": Quantity.ANGLE,
    "theta": Quantity.ANGLE,
    "gamma": Quantity.ANGLE,
    "a": Quantity.LENGTH,
    "d": Quantity.LENGTH,
    "r": Quantity.LENGTH,
    "b": Quantity.LENGTH,
}
_DEGREE = math.pi / 180
_UNITS = {
    **dict.fromkeys(("deg", "degree", "degrees", "degré", "degrés", "°"), _DEGREE),
    **dict.fromkeys(("rad", "radian", "radians"), 1.0),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres", "mètre", "mètres"), 1.0),
    **dict.fromkeys(("cm", "centimeters", "centimetres", "centimètres"), 1e-2),
    **dict.fromkeys(("mm", "millimeters", "millimetres", "millimètres", "millimeter"), 1e-3),
}
_ANGLE_UNITS = {unit for unit in _UNITS if unit.startswith(("deg", "dég", "rad", "°"))}
_UNIT = "|".join(sorted(_UNITS, key=len, reverse=True))
_WITH_UNIT = re.compile(
    rf"(?P<name>[^\[(/,°\s]+(?: [^\[(/,°\s]+){{0,5}}?)\s*(?:\(i(?:-1)?\)\s*)?"
    rf"(?:\(\s*(?:in |en )?(?P<u1>{_UNIT})\s*\)|\[\s*(?:in |en )?(?P<u2>{_UNIT})\s*\]"
    rf"|[/,]\s*(?:in |en )?(?P<u3>{_UNIT})"
    rf"|\s+(?:in |en )?(?P<u4>{_UNIT})|_(?P<u5>degrees|deg|rad|mm|cm)|(?P<u6>°))"
)
UNIT = re.compile(rf"[\[(]?\s*(?:in |en )?({_UNIT})\.?\s*[\])]?")
"""A cell that is a unit."""
_UNIT_AT_END = re.compile(rf"(.*\S)\s*[\[(]\s*(?:in |en )?({_UNIT})\s*[\])]")
_SUBSCRIPT = re.compile(r"(?P<name>[^\W\d_]+)_?\(?(?P<sub>[ijkn](?P<previous>-1)?)\)?")


@dataclass(frozen=True, slots=True)
class Heading:
    """A column.

    Attributes:
        key: Which column of a D-H table.
        text: As the user wrote it.
        unit: Factor of its plain numbers to rad or m, None if it names no unit.
        subscript: ``i`` or ``i-1`` where there is one.
    """

    key: str
    text: str
    unit: float | None = None
    subscript: str = ""


def read_heading(text: str, *, khalil: bool = False) -> Heading | None:
    """Return the column that a heading names, None for an unknown one.

    Args:
        text: The heading.
        khalil: Whether ``a(j)`` is the antecedent.
    """
    shown = " ".join(text.split())
    if len(text) > MAX_HEADING:
        return None
    text = text.replace("q⁻", "qmin").replace("q⁺", "qmax")
    plain = plain_cell(text).lower().replace("−", "-").strip("* :")
    if not plain:
        return Heading("index", shown)
    unit = None
    match = _WITH_UNIT.fullmatch(plain)
    bracket = _UNIT_AT_END.fullmatch(plain)
    if match and plain not in _KEYS:
        unit = next(unit for unit in match.groups()[1:] if unit)
        tail = plain[match.end("name") :]
        plain = match["name"] + ("(i-1)" if "(i-1)" in tail else "")
    elif bracket:
        plain, unit = bracket[1], bracket[2]
    name = plain.replace(" ", "")
    subscript = _SUBSCRIPT.fullmatch(name)
    key, sub = _KEYS.get(name), ""
    if key is None and subscript:
        key, sub = _KEYS.get(subscript["name"]), "i-1" if subscript["previous"] else "i"
        if key == "a" and khalil and not subscript["previous"]:
            key = "ant"
    if key is None:
        key = key_of_words(plain)
    if key is None:
        symbol = symbol_among_words(plain)
        inner = read_heading(symbol, khalil=khalil) if symbol is not None else None
        if inner is None:
            return None
        key, sub = inner.key, inner.subscript
    if (
        unit
        and key in COLUMN_QUANTITIES
        and is_angle_unit(unit) != (COLUMN_QUANTITIES[key] is Quantity.ANGLE)
    ):
        return None
    return Heading(key, shown, _UNITS[unit] if unit else None, sub)


def is_heading(cells: Sequence[str], least: int = 2) -> bool:
    """Return whether cells are a heading: each names a column, and of a table alpha and another.

    Args:
        cells: The cells.
        least: Number of columns that must be named, besides those of numbers and names.
    """
    if len(cells) > MAX_COLUMNS:
        return False
    named: set[str] = set()
    for cell in cells:
        heading = read_heading(cell)
        if heading is None:
            return False
        named.add(heading.key)
    named -= {"index", "name", "ignored"}
    return len(named) >= least and (least < 2 or "alpha" in named or len(named) > 2)


def unit_of(cell: str) -> str | None:
    """Return the unit that a cell is, ``""`` for an empty one, None for another."""
    plain = plain_cell(cell).lower() if len(cell) < MAX_HEADING else "?"
    if plain.strip("-–— ") == "":
        return ""
    found = UNIT.fullmatch(plain)
    return found[1] if found else None


def is_units(cells: Sequence[str]) -> bool:
    """Return whether cells are a row of units."""
    found = [unit_of(cell) for cell in cells]
    return None not in found and any(found)


def is_angle_unit(unit: str) -> bool:
    """Return whether a unit is one of angles."""
    return unit in _ANGLE_UNITS


def unit_factor(unit: str) -> float:
    """Return the factor of a unit to rad or m."""
    return _UNITS[unit]


def heading_problem(headings: list[Heading], convention: str) -> tuple[str, str]:
    """Return a fault between headings and convention, and a warning; empty if none."""
    for heading in headings:
        if heading.key in ("a", "alpha") and heading.subscript == "i-1":
            if convention == "standard":
                return (
                    say(
                        "column {heading} is of the modified convention (row i holds a and"
                        " alpha of i-1), but convention says standard; give"
                        " convention=modified, or write the columns without i-1",
                        heading=quoted(heading.text),
                    ),
                    "",
                )
        elif heading.key in ("a", "alpha") and heading.subscript and convention == "modified":
            return "", (
                say(
                    "column {heading}: row i is read as a and alpha of i-1, as the modified"
                    " convention has them",
                    heading=quoted(heading.text),
                )
            )
    return "", ""
