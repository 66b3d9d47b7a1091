"""Types of the joints of a pasted table: by a column, or by the cells of the joint variables."""

from __future__ import annotations

import re
from collections.abc import Sequence

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
    r"(?:^|[^\w])(?:ee|e|g|h|t|tcp|tool|tip|hand|gripper|flange|end[ _-]?eff(?:ector)?|wrist"
    r"|outil|ot|organe terminal|effecteur|pince|bride|préhenseur"
    r"|(?:tool|hand|end|tip) (?:frame|point|link)|werkzeug|flansch)$",
    re.IGNORECASE,
)
_BASE = re.compile(
    r"^(?:b|base|world|w|socle|bâti|ground|mount|base[ _]link|base frame|repère base|basis)\s*"
    r"(?:$|[-–—→>]+\s*(?:0|1)$)",
    re.IGNORECASE,
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
    moving = moving_rows(cells, z_column)
    cells.numbers = _variable_numbers(cells, z_column, moving)
    named = {
        column
        for k, row in enumerate(raw.rows)
        for column in ("theta", z_column)
        if cells.variable(k, row.cells.get(column), column) is not None
    }
    types = [_type(cells, k, row, z_column, named) for k, row in enumerate(raw.rows)]
    cells.report.raise_if_any()
    unknown = [k for k, type_ in enumerate(types) if type_ is None]
    for k in [k for k in unknown if not moving[k]]:
        types[k] = JointType.FIXED
        unknown.remove(k)
        cells.warnings.append(
            say(
                "joint {count} (line {line}): the row has no joint variable and is"
                " read as one that does not move",
                count=k + 1,
                line=raw.rows[k].line,
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


def _variable_numbers(cells: CellReader, z_column: str, moving: list[bool]) -> list[int]:
    """Return the number of the variable of each row, from 1, or from 0 where the text counts so.

    Rows that do not move count only if the variables of the others count them.
    """
    rows = cells.raw.rows
    counted = [sum(moving[: k + 1]) for k in range(len(rows))]
    found = [_own_numbers(cells, row, z_column) for row in rows]
    numbered = [(k, numbers) for k, numbers in enumerate(found) if moving[k] and numbers]
    plain, by_order = list(range(1, len(rows) + 1)), counted
    from_zero = [count - 1 for count in counted]
    if numbered and all(from_zero[k] in own for k, own in numbered):
        return from_zero
    matches = [sum(numbers[k] in own for k, own in numbered) for numbers in (plain, by_order)]
    return by_order if matches[1] and matches[1] >= matches[0] else plain


def _own_numbers(cells: CellReader, row: RawRow, z_column: str) -> set[int]:
    """Return the numbers of the variables in the cells of a row that may hold its own."""
    found: set[int] = set()
    for column in ("theta", z_column, "variable"):
        numbers = cells.variables(row.cells.get(column), column)
        found |= {number for number in numbers or () if number is not None}
    return found


def moving_rows(cells: CellReader, z_column: str) -> list[bool]:
    """Return whether each row moves, as far as a column of types or the variables say.

    A row without variable between rows with numbered ones does not move where the numbers leave it
    out, and at the ends of the table where they count up to those of the others, or where the first
    column names the base or the end of the arm. Other rows are taken to move.
    """
    rows = cells.raw.rows
    moves = [not _is_fixed(row) for row in rows]
    if any("type" in row.cells for row in rows):
        return moves
    held = [_held(cells, row, z_column) for row in rows]
    with_variable = [k for k, numbers in enumerate(held) if numbers]
    if not with_variable or None in held:
        return moves
    still = [
        k
        for k, numbers in enumerate(held)
        if numbers == () and all(_is_given(rows[k], column) for column in ("theta", z_column))
    ]
    order = [_own_numbers(cells, rows[k], z_column) for k in with_variable]
    counts = any(all(first + n in numbers for n, numbers in enumerate(order)) for first in (0, 1))
    for k in still:
        at_base, at_tip = k < with_variable[0], k > with_variable[-1]
        if at_base:
            ends = counts or _starts_chain(rows, k)
        elif at_tip:
            ends = _ends_chain(rows[k]) or (counts and not _label(rows[k]))
        else:
            ends = counts
        if ends:
            moves[k] = False
    return moves


def _is_given(row: RawRow, column: str) -> bool:
    cell = row.cells.get(column)
    return cell is not None and cell.text.strip() not in ABSENT


def _held(cells: CellReader, row: RawRow, z_column: str) -> tuple[int | None, ...] | None:
    """Return the variables of a row; None where a cell that may hold one cannot be read."""
    found: tuple[int | None, ...] = ()
    for column in ("theta", z_column, "variable"):
        numbers = cells.variables(row.cells.get(column), column)
        if numbers is None:
            return None
        found += numbers
    return found


def _is_fixed(row: RawRow) -> bool:
    cell = row.cells.get("type")
    if cell is None:
        return False
    word = plain_cell(cell.text[:MAX_RAW_CELL]).strip("().").lower()
    return _TYPES.get(word) is JointType.FIXED


def _label(row: RawRow) -> str:
    cell = row.cells.get("index") or row.cells.get("name")
    return plain_cell(cell.text[:MAX_RAW_CELL]).strip() if cell is not None else ""


def _ends_chain(row: RawRow) -> bool:
    """Return whether the first column names the end of the arm, as ``6->EE`` does."""
    return _TIP.search(_label(row)) is not None


def _starts_chain(rows: Sequence[RawRow], k: int) -> bool:
    """Return whether the first column names the base, or numbers the row 0 before a row 1."""
    label = _label(rows[k])
    if _BASE.search(label):
        return True
    return label == "0" and k + 1 < len(rows) and _label(rows[k + 1]) == "1"


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
