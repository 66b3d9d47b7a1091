"""Numbers of a program -> cells of a raw table."""

from __future__ import annotations

from dh_to_urdf.cells.arithmetic import Sum
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.latex import plain_cell
from dh_to_urdf.pasted.programs.refusals import refused
from dh_to_urdf.pasted.programs.values import Opaque, Placed, Scalar, Unresolved
from dh_to_urdf.pasted.raw_table import RawCell


def raw_cell(placed: Placed, column: str, unit: float | None = None) -> RawCell:
    """Return the cell of a number.

    Args:
        placed: The number, with its line.
        column: What messages call the column.
        unit: Factor of plain numbers to rad or m, None for that of the table.

    Raises:
        DHError: The number is not known.
    """
    value, line = placed.value, placed.line
    if isinstance(value, Opaque):
        raise refused(
            line,
            say(
                "{column} is not known ({why}, line {line})",
                column=column,
                why=value.why,
                line=value.line,
            ),
        )
    if isinstance(value, Unresolved):
        if plain_cell(value.name) != value.name:
            # The name of an unknown factor must not be read as the whole cell.
            raise refused(
                line, say("{column} has an unknown name {name}", column=column, name=value.name)
            )
        return RawCell(value.name, column, line, unit)
    return RawCell(text_of(value), column, line, unit, value)


def text_of(value: Scalar) -> str:
    """Return a number as messages show it."""
    if not isinstance(value, Sum):
        return getattr(value, "name", "?")
    constant = value.plain + value.angle + value.length
    if value.variable is None:
        return f"{constant:.12g}"
    letter, index = value.variable
    coefficient = value.terms[0][1]
    sign = "-" if coefficient < 0 else ""
    factor = f"{abs(coefficient):g}*" if abs(coefficient) != 1 else ""
    name = f"{sign}{factor}{letter}{'' if index is None else index}"
    return f"{name} {constant:+.12g}" if constant else name
