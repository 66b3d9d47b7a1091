"""DHTable -> LaTeX, Markdown, TSV and MATLAB text, which ``read_pasted`` reads.

Every digit is written. Inertias are not; base and tool are written beside the table as
``tool = [4x4]``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from dh_to_urdf.cells.notation import angle_text, in_degrees, number_text, variable_cell
from dh_to_urdf.errors import DHError
from dh_to_urdf.messages import say
from dh_to_urdf.par.writer import table_to_par
from dh_to_urdf.pasted.cells import LIMIT_TURNS, NO_LIMIT
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType

_TYPE_LETTERS = {
    JointType.REVOLUTE: "R",
    JointType.PRISMATIC: "P",
    JointType.CONTINUOUS: "C",
    JointType.FIXED: "F",
}
_LIMITS = ("lower", "upper", "velocity", "effort")
_IDENTITY = np.eye(4)
_GREEK = {"alpha": "α", "gamma": "γ", "theta": "θ"}
_FRACTION = re.compile(r"(?:(\d+)\*)?pi/(\d+)")
_INDEXED = re.compile(r"theta(\d+)|(?<![a-z])([dr])(\d+)")


class TableText(NamedTuple):
    """A written form of a table.

    Attributes:
        media_type: Its media type.
        write: From a table to the text, in rad.
        write_degrees: The same in degrees; None where the programs that read it want rad.
    """

    media_type: str
    write: Callable[[DHTable], str]
    write_degrees: Callable[[DHTable], str] | None = None


def table_to_markdown(table: DHTable, *, degrees: bool = False) -> str:
    """Write a pipe table with Greek letters."""
    heading, *rows = _grid(table, degrees)
    rows = [
        [cell if key == "name" else _unicode(cell) for key, cell in zip(heading, row, strict=True)]
        for row in rows
    ]
    heading = [_unicode(cell) for cell in heading]
    body = [heading, ["---"] * len(heading), *rows]
    text = [f"**{table.name}** ({table.convention})", ""]
    text += ["| " + " | ".join(line) + " |" for line in body]
    notes = _placements(table)
    return "\n".join([*text, *([""] if notes else []), *notes, ""])


def table_to_tsv(table: DHTable, *, degrees: bool = False) -> str:
    """Write columns between tabs, for a spreadsheet."""
    lines = ["\t".join(line) for line in _grid(table, degrees)]
    return "\n".join([*lines, *(f"# {note}" for note in _placements(table)), ""])


def table_to_latex(table: DHTable, *, degrees: bool = False) -> str:
    """Write a ``tabular`` environment."""
    heading, *rows = _grid(table, degrees)
    head = " & ".join(_latex_heading(cell) for cell in heading)
    lines = [f"% {table.name}, {table.convention}", f"\\begin{{tabular}}{{{'c' * len(heading)}}}"]
    lines += ["\\hline", f"{head} \\\\ \\hline"]
    for row in rows:
        cells = (_latex(cell, key) for key, cell in zip(heading, row, strict=True))
        lines.append(" & ".join(cells) + " \\\\")
    lines += ["\\hline", "\\end{tabular}"]
    return "\n".join([*lines, *(f"% {note}" for note in _placements(table)), ""])


def table_to_matlab(table: DHTable) -> str:
    """Write links of the Robotics Toolbox for MATLAB.

    Raises:
        DHError: A fixed row or a tree, for which the Toolbox has no links.
    """
    modified = table.convention is not Convention.STANDARD
    lines = []
    for k, row in enumerate(table.rows, start=1):
        if row.type is JointType.FIXED:
            raise DHError.single(
                ("joints", k - 1),
                say(
                    "joint {k} ({row}) is fixed, and the Robotics Toolbox has no fixed"
                    " links; fold it into a neighbour or into the tool",
                    k=k,
                    row=row.name,
                ),
            )
        if row.parent != k - 1 or row.gamma or row.b:
            raise DHError.single(
                ("joints", k - 1),
                say(
                    "joint {k} ({row}) branches (ant, gamma, b), and a robot of the"
                    " Robotics Toolbox is a serial chain",
                    k=k,
                    row=row.name,
                ),
            )
        if row.mimic is not None or row.coupling:
            raise DHError.single(
                ("joints", k - 1),
                say(
                    "joint {k} ({row}) depends on other joints, and the links of the"
                    " Robotics Toolbox are independent; write json, yaml, csv or urdf",
                    k=k,
                    row=row.name,
                ),
            )
        lines.append(f"L({k}) = Link({', '.join(_link(row, modified))});")
    lines.append(f"robot = SerialLink(L, 'name', '{table.name}');")
    lines += [f"robot.{note};" for note in _placements(table)]
    return "\n".join([*lines, ""])


TABLE_TEXTS = {
    "par": TableText("text/x-symoro", table_to_par),
    "latex": TableText(
        "application/x-latex", table_to_latex, partial(table_to_latex, degrees=True)
    ),
    "markdown": TableText(
        "text/markdown", table_to_markdown, partial(table_to_markdown, degrees=True)
    ),
    "tsv": TableText(
        "text/tab-separated-values", table_to_tsv, partial(table_to_tsv, degrees=True)
    ),
    "matlab": TableText("text/x-matlab", table_to_matlab),
}
"""The forms by name."""


def _link(row: DHRow, modified: bool) -> list[str]:
    is_revolute = row.type.is_revolute
    constant = ("d", number_text(row.d)) if is_revolute else ("theta", angle_text(row.theta))
    offset = angle_text(row.offset) if is_revolute else number_text(row.offset)
    numbers = [constant, ("a", number_text(row.a)), ("alpha", angle_text(row.alpha))]
    parts = [f"'{'revolute' if is_revolute else 'prismatic'}'"]
    parts += [f"'{key}', {text}" for key, text in numbers]
    if offset != "0":
        parts.append(f"'offset', {offset}")
    if row.limits.lower is not None and row.limits.upper is not None:
        write = _wide_angle if is_revolute else number_text
        parts.append(f"'qlim', [{write(row.limits.lower)} {write(row.limits.upper)}]")
    if row.sign < 0:
        parts.append("'flip'")
    return [*parts, *(["'modified'"] if modified else [])]


def _wide_angle(limit: float) -> str:
    """Write a limit of a joint that turns; one that looks like degrees as a multiple of pi."""
    if not LIMIT_TURNS < abs(limit) < NO_LIMIT:
        return number_text(limit)
    near = limit / math.pi
    for factor in (near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf)):
        if factor * math.pi == limit:
            return f"{number_text(factor)}*pi"
    return number_text(limit)


def _grid(table: DHTable, degrees: bool) -> list[list[str]]:
    """Return the heading and the rows, in the ASCII that ``expressions`` reads."""
    unit = "deg" if degrees else "rad"

    def turned(angle: float) -> str:
        return number_text(in_degrees(angle)) if degrees else angle_text(angle)

    khalil = table.convention is Convention.KHALIL
    before = "(i-1)" if table.convention is Convention.MODIFIED else ""
    x_column, z_column = ("d", "r") if khalil else (f"a{before}", "d")
    named = any(row.name != f"j{k}" for k, row in enumerate(table.rows, start=1))
    tree = any(row.parent != k or row.gamma or row.b for k, row in enumerate(table.rows))
    limits = [key for key in _LIMITS if any(getattr(r.limits, key) is not None for r in table.rows)]
    heading = ["i", *(["name"] if named else []), "type"]
    heading += ["ant", f"gamma [{unit}]", "b [m]"] if tree else []
    heading += [
        f"alpha{before} [{unit}]",
        f"{x_column} [m]",
        f"{z_column} [m]",
        f"theta [{unit}]",
        *limits,
    ]
    lines = [heading]
    for k, row in enumerate(table.rows, start=1):
        along, theta = number_text(row.d), turned(row.theta)
        slide = "r" if khalil else "d"
        if row.type.is_revolute:
            theta = variable_cell(table, k - 1, "theta", slide, degrees=degrees)
        elif row.type is JointType.PRISMATIC:
            along = variable_cell(table, k - 1, "theta", slide)
        line = [str(k), *([row.name] if named else []), _TYPE_LETTERS[row.type]]
        line += [str(row.parent), turned(row.gamma), number_text(row.b)] if tree else []
        line += [turned(row.alpha), number_text(row.a), along, theta]
        lines.append(line + [_limit(row, key, degrees) for key in limits])
    return lines


def _limit(row: DHRow, key: str, degrees: bool) -> str:
    value = getattr(row.limits, key)
    if value is None:
        return "-"
    if key == "effort":
        return number_text(value)
    if row.type is JointType.PRISMATIC:
        return f"{number_text(value)} m"
    return f"{number_text(in_degrees(value))} deg" if degrees else f"{number_text(value)} rad"


def _placements(table: DHTable) -> list[str]:
    placed = (("base", table.base), ("tool", table.tool))
    return [f"{key} = {_matrix(T)}" for key, T in placed if not np.array_equal(T, _IDENTITY)]


def _matrix(T: Matrix) -> str:
    rows = (" ".join(number_text(float(value)) for value in row) for row in T)
    return f"[{'; '.join(rows)}]"


def _unicode(cell: str) -> str:
    for name, letter in _GREEK.items():
        cell = re.sub(rf"\b{name}(?![a-z])", letter, cell)
    return re.sub(r"\*?\bpi\b", "π", cell)


def _latex_heading(cell: str) -> str:
    name, _, unit = cell.partition(" [")
    base, before, _ = name.partition("(i-1)")
    symbol = f"\\{base}" if base in _GREEK else base
    if base in (*_GREEK, "a", "d", "r", "b"):
        symbol = f"${symbol}_{{{'i-1' if before else 'i'}}}$"
    return f"{symbol} [{unit}" if unit else symbol


def _latex(cell: str, heading: str) -> str:
    if heading == "name":
        return cell.replace("_", "\\_")
    if re.fullmatch(r"[RPCF-]|\d+", cell):
        return cell
    text = _FRACTION.sub(lambda m: f"\\frac{{{m[1] or ''}\\pi}}{{{m[2]}}}", cell)
    text = re.sub(r"\*?(?<!\\)\bpi\b", r"\\pi", text)
    text = _INDEXED.sub(lambda m: f"\\theta_{{{m[1]}}}" if m[1] else f"{m[2]}_{{{m[3]}}}", text)
    return f"${re.sub(r' (rad|deg|m)$', lambda m: f'{chr(92)},{chr(92)}mathrm{{{m[1]}}}', text)}$"
