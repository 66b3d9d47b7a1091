"""Cells of a raw table -> rows of a document, with parsed cells."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from dh_to_urdf.cells.arithmetic import Variable
from dh_to_urdf.cells.expressions import Cell, Quantity
from dh_to_urdf.documents.checks import NAME
from dh_to_urdf.documents.limits import LIMIT_FIELDS
from dh_to_urdf.documents.rows import OWN_LETTERS
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.cells import (
    ABSENT,
    ANY_VARIABLE,
    LIMIT_TURNS,
    MAX_RAW_CELL,
    TURN,
    CellReader,
    foreign_variable,
)
from dh_to_urdf.pasted.headings import COLUMN_QUANTITIES
from dh_to_urdf.pasted.joint_types import joint_types
from dh_to_urdf.pasted.latex import plain_cell
from dh_to_urdf.pasted.raw_table import RawCell, RawRow
from dh_to_urdf.table import Convention, JointType


def document_rows(cells: CellReader, convention: Convention) -> list[dict[str, Any]]:
    """Return the rows of a document, whose cells are read already.

    Args:
        cells: Reads the cells; receives warnings.
        convention: What the rows mean.

    Raises:
        DHError: With all faults of cells.
    """
    z_column = "r" if convention is Convention.KHALIL else "d"
    types = joint_types(cells, z_column)
    rows = [
        _row(cells, k, row, type_, z_column)
        for k, (row, type_) in enumerate(zip(cells.raw.rows, types, strict=True))
    ]
    cells.report.raise_if_any()
    return rows


def _row(cells: CellReader, k: int, row: RawRow, type_: JointType, z_column: str) -> dict[str, Any]:
    own = "theta" if type_.is_revolute else z_column if type_ is JointType.PRISMATIC else None
    own_quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
    item: dict[str, Any] = {"type": type_.value}
    limits: dict[str, Any] = {}
    for key, cell in row.cells.items():
        if key in ("type", "variable") or cell.text.strip() in ABSENT:
            continue
        if key in ("index", "name"):
            _add_name(item, key, cell)
            continue
        if key in ("sign", "ant", "mu", "mimic", "coupling"):
            item[key] = plain_cell(cell.text[:MAX_RAW_CELL])
            continue
        if key == own and plain_cell(cell.text[:MAX_RAW_CELL]).lower() in ANY_VARIABLE:
            continue
        quantity = COLUMN_QUANTITIES.get(key, own_quantity)
        quantity = Quantity.NUMBER if key == "effort" else quantity
        values = cells.values
        if key == own:
            values = values.without_variable(OWN_LETTERS[key], cells.numbers[k])
        bare = LIMIT_TURNS if key in LIMIT_FIELDS else TURN
        parsed = cells.read(k, cell, quantity, values, bare, coupled=key == own)
        if parsed is None:
            continue
        if key == own and not row.own_constant and parsed.value != 0.0:
            cells.add(
                k,
                cell,
                say(
                    "{key} of a {type} joint is ignored by the Robotics Toolbox; write 0"
                    " there, and the constant as offset",
                    key=key,
                    type=type_,
                ),
            )
        if key == own and parsed.variable is not None and values is not cells.values:
            cells.add(
                k,
                cell,
                say(
                    "{cell} is the variable of this joint, and values gives it a number; a"
                    " joint variable takes none: leave it out of values, or write the"
                    " number in the cell",
                    cell=quoted(cell.text),
                ),
            )
            continue
        fault = foreign_variable(parsed, key, key == own, cells.numbers[k], cells.numbers)
        if fault:
            cells.add(k, cell, fault)
        elif key in LIMIT_FIELDS:
            limits[key] = parsed
        else:
            # Its number is checked; a document counts the rows that do not move, too.
            item[key] = replace(parsed, index=None, terms=_terms_of_rows(parsed, cells, k))
    if limits:
        item["limits"] = limits
    return item


def _terms_of_rows(parsed: Cell, cells: CellReader, k: int) -> tuple[tuple[Variable, float], ...]:
    """Return the variables of a cell with the numbers of their rows, its own without one."""
    own = cells.numbers[k]

    def row(index: int | None) -> int | None:
        if index is None or index == own:
            return None
        # Rows that do not move have the number of the one before: the first one is meant.
        return cells.numbers.index(index) + 1 if index in cells.numbers else index

    return tuple(((letter, row(index)), factor) for (letter, index), factor in parsed.terms)


def _add_name(item: dict[str, Any], key: str, cell: RawCell) -> None:
    """Add a name, or a text in the first column that can be one."""
    text = (
        plain_cell(cell.text[:MAX_RAW_CELL])
        if key == "index"
        else cell.text.strip().replace("\\_", "_")
    )
    if key == "name" or (NAME.fullmatch(text) and not text.isdecimal()):
        item["name"] = text
