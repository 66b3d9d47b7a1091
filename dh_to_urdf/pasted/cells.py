"""Cells of pasted text -> numbers in SI units, with checks of numbers without unit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from dh_to_urdf.cells.decimal_commas import are_decimal, with_points
from dh_to_urdf.cells.expressions import Cell, CellError, Quantity, cell_of_sum, parse_cell
from dh_to_urdf.cells.values import Values
from dh_to_urdf.documents.checks import Report
from dh_to_urdf.documents.rows import OWN_LETTERS
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from dh_to_urdf.pasted.latex import plain_cell
from dh_to_urdf.pasted.raw_table import RawCell, RawTable
from dh_to_urdf.pasted.stated_units import FACTORS, StatedUnits

MAX_RAW_CELL: Final = 300
TURN: Final = 2 * math.pi
"""Bare angles of a table beyond this (rad) look like degrees."""
LIMIT_TURNS: Final = 20.0
"""Bare limits beyond this (rad) look like degrees."""
NO_LIMIT: Final = 36_000.0
"""Bare limits from this on (rad) say that there is none, such as ±999999."""
ABSENT: Final = frozenset({"", "-", "–", "—", "−", "--", "---"})
"""Texts of cells that hold nothing."""
ANY_VARIABLE: Final = frozenset({"*", "var", "var.", "variable"})
"""Texts that stand for the joint variable, whatever its name."""
ANGLES: Final = ("rad", "deg")
LENGTHS: Final = ("m", "mm")


class CellReader:
    """Reads the cells of one table.

    Attributes:
        raw: The table.
        values: What names in the cells stand for.
        report: Receives faults.
        warnings: What was assumed.
    """

    def __init__(self, raw: RawTable, units: StatedUnits, values: Values) -> None:
        self.raw = raw
        self.values = values
        self.report = Report()
        self.warnings: list[str] = []
        self.numbers = list(range(1, len(raw.rows) + 1))
        """Number of the variable of each row; rows that do not move have none of their own."""
        self._angle = units.angle
        self._decimal_commas = are_decimal(
            cell.text[:MAX_RAW_CELL]
            for row in raw.rows
            for key, cell in row.cells.items()
            if cell.total is None and key not in ("index", "name", "type")
        )
        self._units = {quantity: units.factor(quantity) or 1.0 for quantity in Quantity}

    def add(self, k: int, cell: RawCell | None, message: str) -> None:
        """Note a fault of joint k (from 0), in a cell or in its row."""
        line = cell.line if cell else self.raw.rows[k].line
        column = say(", column {column}", column=cell.column or "1") if cell else ""
        self.report.add(
            ("joints", k),
            say(
                "joint {k} (line {line}{column}): {message}",
                k=k + 1,
                line=line,
                column=column,
                message=message,
            ),
        )

    def read(
        self,
        k: int,
        cell: RawCell,
        quantity: Quantity,
        values: Values,
        bare: float | None = None,
        *,
        coupled: bool = False,
    ) -> Cell | None:
        """Read one cell; return None after reporting why not.

        Args:
            k: Number of the joint, from 0.
            cell: The cell.
            quantity: What it measures.
            values: What names in it stand for.
            bare: An angle without unit beyond this is refused, rad; None for no check.
            coupled: Whether there may be several joint variables, with any coefficients.
        """
        if len(cell.text) > MAX_RAW_CELL:
            self.add(
                k,
                cell,
                say("the cell is longer than {max_raw_cell} characters", max_raw_cell=MAX_RAW_CELL),
            )
            return None
        text = cell.text if cell.total is not None else plain_cell(cell.text)
        if self._decimal_commas:
            text = with_points(text)
        unit = cell.unit if cell.unit is not None else self._units[quantity]
        try:
            if cell.total is not None:
                parsed = cell_of_sum(cell.total, quantity, unit, text, coupled=coupled)
            else:
                angle = self._units[Quantity.ANGLE]
                parsed = parse_cell(text, quantity, unit, values, angle, coupled=coupled)
        except CellError as error:
            shown = "" if text == cell.text.strip() else f"{quoted(cell.text)} "
            self.add(k, cell, say("{shown}{error}", shown=shown, error=error))
            return None
        undecided = self._angle is None and cell.unit is None and quantity is Quantity.ANGLE
        looks_like_degrees = bare is not None and bare < abs(parsed.plain)
        if bare == LIMIT_TURNS and abs(parsed.plain) >= NO_LIMIT:
            looks_like_degrees = False
        if undecided and looks_like_degrees:
            self.add(
                k,
                cell,
                say(
                    "{cell} has no unit and is no angle in rad as people write them; write"
                    " 90° or pi/2, or give angle=deg (or angle=rad if it is meant)",
                    cell=quoted(cell.text),
                ),
            )
            return None
        if bare == TURN and unit == FACTORS["deg"] and abs(parsed.plain) > 360.0:
            self.add(
                k,
                cell,
                say(
                    "{cell} is more than a turn: a 90° that lost its ° reads 900; write the"
                    " angle within ±360, or with its unit (900°) if it is meant",
                    cell=quoted(cell.text),
                ),
            )
            return None
        return parsed

    def variable(self, k: int, cell: RawCell | None, column: str) -> Cell | None:
        """Return the cell if it holds a variable that its column may have, else None."""
        if cell is None or len(cell.text) > MAX_RAW_CELL:
            return None
        text = cell.text if cell.total is not None else plain_cell(cell.text)
        if text.lower() in ANY_VARIABLE:
            return Cell(0.0, "q", text=text)
        letters = OWN_LETTERS[column]
        quantity = Quantity.ANGLE if column == "theta" else Quantity.LENGTH
        try:
            if cell.total is not None:
                parsed = cell_of_sum(cell.total, quantity, 1.0, text, coupled=True)
            else:
                parsed = parse_cell(text, quantity, 1.0, self.values, coupled=True)
        except CellError:
            return None
        mine = [(v, c) for v, c in parsed.terms if v[1] in (None, self.numbers[k])]
        if any(letter not in letters or abs(c) != 1.0 for (letter, _), c in mine):
            return None
        known = all(index is None or index in self.numbers for (_, index), _ in parsed.terms)
        found = any(letter in letters for (letter, _), _ in parsed.terms)
        return parsed if found and known else None

    def variables(self, cell: RawCell | None, column: str) -> tuple[int | None, ...] | None:
        """Return the numbers of the joint variables in a cell, None for one without number.

        Args:
            cell: The cell.
            column: Its column: ``theta``, ``variable``, or that of the length along z.

        Returns:
            Empty for a cell without variable; None for one that cannot be read.
        """
        if cell is None or cell.text.strip() in ABSENT:
            return ()
        if len(cell.text) > MAX_RAW_CELL:
            return None
        text = cell.text if cell.total is not None else plain_cell(cell.text)
        if text.lower() in ANY_VARIABLE:
            return (None,)
        letters = OWN_LETTERS["theta"] + OWN_LETTERS["d"] if column == "variable" else None
        quantity = Quantity.LENGTH if column in ("d", "r") else Quantity.ANGLE
        try:
            if cell.total is not None:
                parsed = cell_of_sum(cell.total, quantity, 1.0, text, coupled=True)
            else:
                parsed = parse_cell(text, quantity, 1.0, self.values, coupled=True)
        except CellError:
            return None
        known = OWN_LETTERS[column] if letters is None else letters
        return tuple(index for (letter, index), _ in parsed.terms if letter in known)


def foreign_variable(
    cell: Cell, column: str, own: bool, number: int, numbers: Sequence[int]
) -> str | None:
    """Say why a joint variable cannot stand in a cell; None where it can, or there is none.

    Args:
        cell: The cell.
        column: Its column.
        own: Whether the column is that of the joint's variable.
        number: Number of the joint's variable, from 1.
        numbers: Those of all rows.
    """
    if cell.variable is None:
        return None
    letters = OWN_LETTERS[column] if own else ()
    mine = [(letter, c) for (letter, index), c in cell.terms if index in (None, number)]
    if not own or any(letter not in letters for letter, _ in mine):
        return say(
            "{cell} holds {cell_2}, which is not the joint variable of this column;"
            " if it is a constant, give values {cell_2}:0.5",
            cell=quoted(cell.text),
            cell_2=cell.name,
        )
    for (_, index), _ in cell.terms:
        if index is not None and index not in numbers:
            return say(
                "{cell} is the variable of joint {index}, not {number}",
                cell=quoted(cell.text),
                index=index,
                number=number,
            )
    if any(abs(c) != 1.0 for _, c in mine):
        return say(
            "is {cell}; the joint variable must have coefficient +1 or -1", cell=quoted(cell.text)
        )
    return None
