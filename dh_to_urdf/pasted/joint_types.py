"""Types of the joints of a pasted table: by a column, or by the cells of the joint variables."""

from __future__ import annotations

import re

from dh_to_urdf.cells.arithmetic import variable_of
from dh_to_urdf.documents.joint_types import TYPE_ALIASES
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.cells import ABSENT, MAX_RAW_CELL, CellReader
from dh_to_urdf.pasted.latex import plain_cell
from dh_to_urdf.pasted.raw_table import RawCell, RawRow
from dh_to_urdf.table import JointType

_SPELLINGS = {
    JointType.REVOLUTE: "0 rev rot rotational rotation rotary rotoid rotoïde rotoide pivot hinge",
    JointType.PRISMATIC: "1 glissière glissiere pris prism linear translation translational sliding"
    " prismatique",
    JointType.FIXED: "2 fixe",
}
_TIP = re.compile(
    r"(?:^|[^\w])(?:ee|e|g|t|tcp|tool|tip|hand|gripper|flange|end[ -]?effector)$", re.IGNORECASE
)
_TYPES = {
    spelling: type_ for type_, listed in _SPELLINGS.items() for spelling in listed.split()
} | TYPE_ALIASES


def joint_types(cells: CellReader, z_column: str) -> list[JointType]:
    """Return the type of each joint of a table.

    Args:
        cells: Reads the cells; receives faults and warnings.
        z_column: The column of the length along z, ``d`` or ``r``.

    Raises:
        DHError: A type cannot be read or is open.
    """
    raw = cells.raw
    cells.numbers = _variable_numbers(cells, z_column)
    named = {
        column
        for k, row in enumerate(raw.rows)
        for column in ("theta", z_column)
        if cells.variable(k, row.cells.get(column), column) is not None
    }
    types = [_type(cells, k, row, z_column, named) for k, row in enumerate(raw.rows)]
    cells.report.raise_if_any()
    unknown = [k for k, type_ in enumerate(types) if type_ is None]
    if unknown == [len(types) - 1] and named and _ends_chain(raw.rows[-1]):
        types[-1], unknown = JointType.FIXED, []
        cells.warnings.append(
            say(
                "joint {count} (line {line}): the last row has no joint variable and is"
                " read as one that does not move",
                count=len(types),
                line=raw.rows[-1].line,
            )
        )
    if unknown and len(unknown) < len(types):
        for k in unknown:
            cells.add(
                k,
                None,
                say(
                    "no cell holds the joint variable, so that its type is open; write"
                    " theta{k} or {z_column}{k} in its cell, or add a column type (R, P, or"
                    " F for a row that does not move)",
                    k=k + 1,
                    z_column=z_column,
                ),
            )
    cells.report.raise_if_any()
    if unknown and not raw.typed:
        cells.warnings.append(
            say(
                "no cell holds a joint variable and there is no column type: every"
                " joint is taken as revolute"
            )
        )
    return [type_ or JointType.REVOLUTE for type_ in types]


def _variable_numbers(cells: CellReader, z_column: str) -> list[int]:
    """Return the number of the variable of each row, from 1.

    Rows that a column says are fixed count only if the variables of the others count them.
    """
    rows = cells.raw.rows
    fixed = [_is_fixed(row) for row in rows]
    if not any(fixed):
        return list(range(1, len(rows) + 1))
    moving = [sum(not f for f in fixed[: k + 1]) for k in range(len(rows))]
    for k, row in enumerate(rows):
        if fixed[k] or moving[k] == k + 1:
            continue
        for column in ("theta", z_column, "variable"):
            cell = row.cells.get(column)
            if cell is None or len(cell.text) > MAX_RAW_CELL:
                continue
            found = cells.any_variable(cell, column)
            if found is not None and found == moving[k]:
                return moving
    return list(range(1, len(rows) + 1))


def _is_fixed(row: RawRow) -> bool:
    cell = row.cells.get("type")
    if cell is None:
        return False
    word = plain_cell(cell.text[:MAX_RAW_CELL]).strip("().").lower()
    return _TYPES.get(word) is JointType.FIXED


def _ends_chain(row: RawRow) -> bool:
    """Return whether the first column names the end of the arm, as ``6->EE`` does."""
    cell = row.cells.get("index") or row.cells.get("name")
    return cell is not None and _TIP.search(plain_cell(cell.text[:MAX_RAW_CELL])) is not None


def _type(
    cells: CellReader, k: int, row: RawRow, z_column: str, named: set[str]
) -> JointType | None:
    """Return the type that a row says, by its column or its variable; None if it says none."""
    cell = row.cells.get("type")
    if cell is not None and cell.text.strip() not in ABSENT:
        return _by_word(cells, k, cell)
    variable = row.cells.get("variable")
    if variable is not None and variable.text.strip() not in ABSENT:
        found = _by_variable(cells, k, variable)
        if found is not None:
            return found
    theta = cells.variable(k, row.cells.get("theta"), "theta")
    along = cells.variable(k, row.cells.get(z_column), z_column)
    if theta is not None and along is not None and along.variable == "q":
        cells.add(
            k,
            row.cells[z_column],
            say(
                "theta and this cell both hold a joint variable; a joint has one. Add a"
                " column type, or give the constant in values"
            ),
        )
        return None
    if theta is not None:
        return JointType.REVOLUTE
    if along is not None:
        return JointType.PRISMATIC
    for column, type_ in (("theta", JointType.REVOLUTE), (z_column, JointType.PRISMATIC)):
        own = row.cells.get(column)
        absent = own is not None and own.text.strip() in ABSENT
        # Where other rows name their variable, an empty cell is a row that does not move.
        if absent and column not in named:
            return type_
    if "theta" not in row.cells and z_column in row.cells:
        return JointType.REVOLUTE
    return JointType.REVOLUTE if cells.raw.typed else None


def _by_word(cells: CellReader, k: int, cell: RawCell) -> JointType:
    word = plain_cell(cell.text[:MAX_RAW_CELL]).strip("().").lower()
    found = _TYPES.get(word) or _TYPES.get(word.removesuffix(" joint"))
    if found is None:
        cells.add(
            k,
            cell,
            say("the type is {cell}; write R, P or F (or σ: 0, 1, 2)", cell=quoted(cell.text)),
        )
        return JointType.FIXED
    return found


def _by_variable(cells: CellReader, k: int, cell: RawCell) -> JointType | None:
    """Return the type by a variable in a column of its own; None for q, which says none."""
    text = plain_cell(cell.text[:MAX_RAW_CELL])
    letter, index = variable_of(text.lower()) or ("", None)
    number = cells.numbers[k]
    if not letter or index not in (None, number):
        cells.add(
            k,
            cell,
            say(
                "{cell} is not the variable of joint {number}",
                cell=quoted(cell.text),
                number=number,
            ),
        )
        return JointType.FIXED
    return {"theta": JointType.REVOLUTE, "q": None}.get(letter, JointType.PRISMATIC)
