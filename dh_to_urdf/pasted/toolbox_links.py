"""Links of Corke's Robotics Toolbox, as MATLAB and Python write them.

``Link('d', 0.3, 'a', 0, 'alpha', pi/2)``, ``Link([theta d a alpha sigma offset])``,
``RevoluteMDH(d=0.3)``: a parameter that is not given is 0.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.pasted.raw_table import RawCell
from dh_to_urdf.pasted.source_tokens import Token, arguments, closing, matrix_rows, text_of

LINKS = {
    "Link": (None, None),
    "DHLink": (None, None),
    "Revolute": ("R", False),
    "Prismatic": ("P", False),
    "RevoluteDH": ("R", False),
    "PrismaticDH": ("P", False),
    "RevoluteMDH": ("R", True),
    "PrismaticMDH": ("P", True),
}
"""Type and whether modified, of each class; None where the arguments say it."""
ORDER = ("theta", "d", "a", "alpha", "sigma", "offset")
PARAMETERS = ("theta", "d", "a", "alpha", "offset")
_DYNAMIC = {"m", "r", "I", "Jm", "G", "B", "Tc", "jm", "g", "tc", "mesh", "i", "b"}
_FLAGS = {
    "modified": ("modified", True),
    "mdh": ("modified", True),
    "standard": ("modified", False),
    "std": ("modified", False),
    "revolute": ("type", "R"),
    "prismatic": ("type", "P"),
    "flip": ("flip", True),
}
_TRUE, _FALSE = {"true", "1"}, {"false", "0"}


@dataclass
class Link:
    """One call of a link class, or one row of a matrix that a robot is made of."""

    line: int
    cells: dict[str, RawCell]
    type: str | None
    modified: bool | None
    target: str


def read_link(name: str, line: int, inside: list[Token], target: str, warnings: list[str]) -> Link:
    """Reads the arguments of a link class.

    Args:
        name: The class.
        line: Where it stands.
        inside: The tokens between its parentheses.
        target: What it is assigned to.
        warnings: Receives what is left out.

    Raises:
        DHError: An argument that is not read.
    """
    type_, modified = LINKS[name]
    link = Link(line, {}, type_, modified, target)
    listed = arguments(inside)
    position = 0
    while position < len(listed):
        argument = listed[position]
        position += 1
        first = argument[0]
        if first.text == "[" and position == 1:
            _vector(link, argument)
            continue
        if first.kind == "word" and len(argument) > 2 and argument[1].text == "=":
            _parameter(link, first.text, argument[2:], warnings)
            continue
        if first.kind == "string" and len(argument) == 1:
            flag = _FLAGS.get(first.text.lower())
            if flag is not None:
                _flag(link, flag)
                continue
            if position < len(listed):
                _parameter(link, first.text, listed[position], warnings)
                position += 1
                continue
        raise DHError.single(
            (),
            f"line {first.line}: {name} has an argument {quoted(text_of(argument))} that is not"
            " read; write 'd', 0.3, 'a', 0, 'alpha', pi/2 or d=0.3, a=0, alpha=pi/2",
        )
    return _settled(link, name)


def _vector(link: Link, argument: list[Token]) -> None:
    rows = matrix_rows(argument[1 : closing(argument, 0)])
    if len(rows) != 1 or not 4 <= len(rows[0]) <= 6:
        raise DHError.single(
            (), f"line {link.line}: a vector of a link has 4 to 6 numbers: {', '.join(ORDER)}"
        )
    fill_from_vector(link, rows[0])


def fill_from_vector(link: Link, row: list[list[Token]]) -> None:
    """Fills a link from theta, d, a, alpha and perhaps sigma and offset."""
    for key, element in zip(ORDER, row, strict=False):
        _parameter(link, key, element, [])
    link.type = link.type or "R"
    own = "theta" if link.type == "R" else "d"
    cell = link.cells.get(own)
    if cell is not None and re.fullmatch(r"0*\.?0*|NaN", cell.text):
        del link.cells[own]


def _flag(link: Link, flag: tuple[str, object]) -> None:
    what, value = flag
    if what == "modified":
        link.modified = bool(value)
    elif what == "type":
        link.type = str(value)
    else:
        link.cells["sign"] = RawCell("-1", "flip", link.line)


def _parameter(link: Link, key: str, value: list[Token], warnings: list[str]) -> None:
    text = text_of(value)
    lowered = key.lower() if key not in _DYNAMIC else key
    if lowered in PARAMETERS:
        if lowered in link.cells:
            raise DHError.single((), f"line {link.line}: {key} of the link stands twice; keep one")
        link.cells[lowered] = RawCell(text, key, value[0].line if value else link.line)
    elif lowered == "sigma":
        link.type = {"0": "R", "1": "P"}.get(text, text)
    elif lowered == "qlim":
        _limits(link, value)
    elif lowered in ("mdh", "modified", "flip") and text.lower() in _TRUE | _FALSE:
        if lowered == "flip":
            sign = "-1" if text.lower() in _TRUE else "1"
            link.cells["sign"] = RawCell(sign, "flip", link.line)
        else:
            link.modified = text.lower() in _TRUE
    elif lowered == "name":
        link.cells["name"] = RawCell(text, "name", link.line)
    elif lowered == "convention" and text.lower() in ("standard", "modified"):
        link.modified = text.lower() == "modified"
    elif lowered in ("jointtype", "type") and text.lower()[:1] in ("r", "p"):
        link.type = text[0].upper()
    elif key in _DYNAMIC:
        warning = "masses, inertias and motors of the links are left out"
        if warning not in warnings:
            warnings.append(warning)
    else:
        raise DHError.single(
            (),
            f"line {link.line}: the link has an unknown parameter {quoted(key)}; known are"
            " theta, d, a, alpha, offset, qlim, sigma, flip, modified",
        )


def _limits(link: Link, value: list[Token]) -> None:
    """``[-1 1]``, ``[-60 60]*pi/180``, ``deg2rad([-60 60])``, ``np.array([-1, 1])``."""
    text = text_of(value)
    start = next((i for i, t in enumerate(value) if t.kind == "symbol" and t.text == "["), None)
    if start is not None:
        end = closing(value, start)
        rows = matrix_rows(value[start + 1 : end])
        elements = [text_of(element) for row in rows for element in row]
        before, after = text_of(value[:start]), text_of(value[end + 1 :])
        if before.startswith("array"):
            before, after = "", after.removeprefix(")")
        if len(elements) == 2:
            for key, element in zip(("lower", "upper"), elements, strict=True):
                whole = f"{before}({element}){after}" if before or after else element
                link.cells[key] = RawCell(whole, "qlim", value[0].line)
            return
    if text not in ("None", "[]"):
        raise DHError.single((), f"line {link.line}: qlim is {quoted(text)}; write [lower upper]")


def _settled(link: Link, name: str) -> Link:
    """The type as the Toolbox finds it: a given theta makes a prismatic joint."""
    cells = link.cells
    if link.type is None and "theta" in cells and "d" in cells and name == "Link":
        raise DHError.single(
            (),
            f"line {link.line}: the link has theta and d; give the one that is constant, or"
            " 'revolute' or 'prismatic'",
        )
    link.type = link.type or ("P" if "theta" in cells and "d" not in cells else "R")
    if link.type not in ("R", "P"):
        raise DHError.single(
            (), f"line {link.line}: sigma is {quoted(link.type)}; give 0 (R) or 1 (P)"
        )
    return link
