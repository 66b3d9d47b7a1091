r"""Headings of D-H tables in their usual spellings: ``$\alpha_{i-1}$ [°]`` is alpha in degrees."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.latex import plain_cell

MAX_HEADING = 100
_SPELLINGS = {
    "index": "i j k n # no nr no. nr. num joint link axis row frame liaison links joints axes"
    " articulation axe corps"
    " gelenk",
    "name": "name nom jointname",
    "type": "type sigma σ jointtype kind",
    "alpha": "alpha α twist linktwist twistangle",
    "a": "a linklength length",
    "d": "d linkoffset",
    "r": "r",
    "theta": "theta θ th jointangle",
    "offset": "offset jointoffset qoffset",
    "variable": "q var variable jointvariable",
    "gamma": "gamma γ",
    "b": "b",
    "ant": "ant antecedent",
    "mu": "mu μ",
    "sign": "sign",
    "lower": "lower min qmin lowerlimit",
    "upper": "upper max qmax upperlimit",
    "velocity": "velocity",
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
    "cm": 1e-2,
    "mm": 1e-3,
}
_UNIT = (
    "degrees|degree|degrés|degré|deg|°|radians|radian|rad|mm|cm"
    "|meters|metres|meter|metre|mètres|mètre|m"
)
_WITH_UNIT = re.compile(
    rf"(?P<name>[^\[(/,°\s]+(?: [^\[(/,°\s]+)?)\s*(?:\(i(?:-1)?\)\s*)?"
    rf"(?:\(\s*(?P<u1>{_UNIT})\s*\)|\[\s*(?P<u2>{_UNIT})\s*\]|[/,]\s*(?P<u3>{_UNIT})"
    rf"|\s+(?:in )?(?P<u4>{_UNIT})|_(?P<u5>degrees|deg|rad|mm|cm)|(?P<u6>°))"
)
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
    if match and plain not in _KEYS:
        unit = next(unit for unit in match.groups()[1:] if unit)
        tail = plain[match.end("name") :]
        plain = match["name"] + ("(i-1)" if "(i-1)" in tail else "")
    name = plain.replace(" ", "")
    subscript = _SUBSCRIPT.fullmatch(name)
    key, sub = _KEYS.get(name), ""
    if key is None and subscript:
        key, sub = _KEYS.get(subscript["name"]), "i-1" if subscript["previous"] else "i"
        if key == "a" and khalil and not subscript["previous"]:
            key = "ant"
    if key is None:
        return None
    return Heading(key, shown, _UNITS[unit] if unit else None, sub)


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
