"""Tables pasted as text -> :class:`DHTable`: LaTeX, MATLAB, Python, Markdown, tabs, columns.

Every refusal names the line and the column as they stand in the text.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from dh_to_urdf.cells.arithmetic import variable_of
from dh_to_urdf.cells.expressions import Cell, CellError, Quantity, parse_cell
from dh_to_urdf.cells.notation import rounding_warnings
from dh_to_urdf.cells.values import Values, read_values
from dh_to_urdf.documents.checks import NAME, Report
from dh_to_urdf.documents.mapping import CONVENTION_ALIASES, DEFAULT_NAME, MAX_ROWS, read_mapping
from dh_to_urdf.documents.rows import LIMIT_FIELDS, OWN_LETTERS, TYPE_ALIASES
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.pasted.headings import COLUMN_QUANTITIES
from dh_to_urdf.pasted.latex import plain_cell
from dh_to_urdf.pasted.placement_notes import placement_notes
from dh_to_urdf.pasted.program import is_program, table_from_program
from dh_to_urdf.pasted.raw_table import RawCell, RawRow, RawTable, table_from_grid
from dh_to_urdf.table import Convention, DHTable, JointType

MAX_PASTED_LENGTH = 100_000
MAX_RAW_CELL = 300
TURN = 2 * math.pi
LIMIT_TURNS = 20.0
"""Bare angles beyond these (rad) look like degrees: 6.28 in the table, 20 as limits."""

_ANGLES = {"rad": 1.0, "deg": math.pi / 180}
_LENGTHS = {"m": 1.0, "mm": 1e-3}
LONG = 20.0
"""Bare lengths beyond this (m) look like millimetres."""
_ABSENT = {"", "-", "–", "—", "−", "--", "---"}
_ANY_VARIABLE = {"*", "var", "var.", "variable"}
_TYPES = {
    "0": JointType.REVOLUTE, "1": JointType.PRISMATIC, "2": JointType.FIXED,
    "rev": JointType.REVOLUTE, "rot": JointType.REVOLUTE, "rotational": JointType.REVOLUTE,
    "rotation": JointType.REVOLUTE, "rotary": JointType.REVOLUTE, "rotoid": JointType.REVOLUTE,
    "rotoïde": JointType.REVOLUTE, "rotoide": JointType.REVOLUTE, "pivot": JointType.REVOLUTE,
    "hinge": JointType.REVOLUTE, "glissière": JointType.PRISMATIC, "glissiere": JointType.PRISMATIC,
    "pris": JointType.PRISMATIC, "prism": JointType.PRISMATIC, "linear": JointType.PRISMATIC,
    "translation": JointType.PRISMATIC, "translational": JointType.PRISMATIC,
    "sliding": JointType.PRISMATIC, "prismatique": JointType.PRISMATIC,
    "fixe": JointType.FIXED, **TYPE_ALIASES,
}  # fmt: skip


def read_pasted(
    text: str | bytes,
    convention: str | None,
    name: str | None = None,
    angle: str | None = None,
    length: str = "m",
    values: Mapping[str, Any] | None = None,
    columns: str | None = None,
    default_name: str | None = DEFAULT_NAME,
) -> DHTable:
    r"""Reads a table that was copied from a paper, a script or a spreadsheet.

    Joint variables may stand in their cells (``\theta_1``, ``q2 - 90°``, ``d3``) and then tell
    revolute joints from prismatic ones; so does a column ``type`` or ``σ``.

    Args:
        text: The text, UTF-8 if bytes.
        convention: What the rows mean; required.
        name: Name of the robot, instead of one in the text.
        angle: Unit of angles without one: ``rad``, ``deg``, or None for rad where no angle looks
            like degrees (a bare 90 is refused then).
        length: Unit of lengths without one, ``m`` or ``mm``.
        values: Numbers for the names in the cells, such as ``l1``.
        columns: ``theta,d,a,alpha``: the columns of a table without a heading.
        default_name: Name for a text that gives none; None requires one.

    Raises:
        DHError: With the line and column of each of the first ten faults.
    """
    text = _decoded(text)
    meaning = CONVENTION_ALIASES.get(convention.strip().lower()) if convention else None
    if meaning is None or angle not in (None, *_ANGLES) or length not in _LENGTHS:
        units = {"angle": angle or "rad", "length": length}
        empty: dict[str, Any] = {"units": units, "joints": [{}]}
        if convention is not None:
            empty["convention"] = convention
        read_mapping(empty)
        raise DHError.single((), "the table cannot be read")
    text, placements = placement_notes(text, program=is_program(text))
    listed = [part for part in re.split(r"[,\s]+", columns) if part] if columns else None
    raw = (
        table_from_program(text, meaning, listed)
        if is_program(text)
        else table_from_grid(text, meaning, listed)
    )
    if len(raw.rows) > MAX_ROWS:
        raise DHError.single((), f"the text has {len(raw.rows)} rows; at most {MAX_ROWS} are read")
    given = read_values(values)
    reader = _Reader(raw, meaning, angle, length, _with_assigned(given, raw.assigned))
    rows = reader.rows()
    document: dict[str, Any] = {
        "convention": convention,
        "joints": rows,
        "values": given,
        **placements,
    }
    robot_name = name or raw.name
    if robot_name:
        document["name"] = robot_name
    table = read_mapping(document, default_name)
    warnings = (*table.warnings, *raw.warnings, *reader.warnings, *rounding_warnings(table))
    return replace(table, warnings=warnings)


def _decoded(text: str | bytes) -> str:
    if len(text) > MAX_PASTED_LENGTH:
        raise DHError.single((), f"the text is longer than {MAX_PASTED_LENGTH} characters")
    if isinstance(text, str):
        return text.lstrip("\ufeff")
    try:
        return text.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise DHError.single((), "the text is not UTF-8") from None


def _with_assigned(given: Values, assigned: Sequence[tuple[str, str]]) -> Values:
    """The values, and those that the text itself gives; the former win.

    A name that the text gives two values stands for none: which one holds where is not known.
    """
    values, doubtful = given, set[str]()
    for name, text in assigned:
        key = name.replace("_", "")
        if key in given or key in doubtful:
            continue
        try:
            sums = read_values({name: text}, values)
        except DHError:
            sums = None
        if key in values and (sums is None or sums.get(key) != values.get(key)):
            doubtful.add(key)
            values = values.without(key)
        else:
            values = sums or values
    return values


class _Reader:
    """Cells of a raw table -> rows of a document, with parsed cells."""

    def __init__(
        self, raw: RawTable, convention: Convention, angle: str | None, length: str, values: Values
    ) -> None:
        self.raw = raw
        self.convention = convention
        self.angle = angle
        self.units = {
            Quantity.ANGLE: _ANGLES[angle or "rad"],
            Quantity.LENGTH: _LENGTHS[length],
            Quantity.NUMBER: 1.0,
        }
        self.values = values
        self.report = Report()
        self.warnings: list[str] = []
        self.z_column = "r" if convention is Convention.KHALIL else "d"
        self.named: set[str] = set()

    def rows(self) -> list[dict[str, Any]]:
        """The rows of the document.

        Raises:
            DHError: With all faults of cells.
        """
        self.named = {
            column
            for k, row in enumerate(self.raw.rows)
            for column in ("theta", self.z_column)
            if self._holds_variable(k, row.cells.get(column), column) is not None
        }
        types = [self._type(k, row) for k, row in enumerate(self.raw.rows)]
        self.report.raise_if_any()
        unknown = [k for k, type_ in enumerate(types) if type_ is None]
        if unknown and len(unknown) < len(types):
            for k in unknown:
                self._add(
                    k, None, "no cell holds the joint variable, so that its type is open; write"
                    f" theta{k + 1} or {self.z_column}{k + 1} in its cell, or add a column type"
                    " (R, P, or F for a row that does not move)"
                )  # fmt: skip
        self.report.raise_if_any()
        if unknown and not self.raw.typed:
            self.warnings.append(
                "no cell holds a joint variable and there is no column type: every joint is taken"
                " as revolute"
            )
        rows = [
            self._row(k, row, type_ or JointType.REVOLUTE)
            for k, (row, type_) in enumerate(zip(self.raw.rows, types, strict=True))
        ]
        self.report.raise_if_any()
        return rows

    def _add(self, k: int, cell: RawCell | None, message: str) -> None:
        line = cell.line if cell else self.raw.rows[k].line
        column = f", column {cell.column or '1'}" if cell else ""
        self.report.add(("joints", k), f"joint {k + 1} (line {line}{column}): {message}")

    def _cell(
        self, k: int, cell: RawCell, quantity: Quantity, values: Values, bare: float | None = None
    ) -> Cell | None:
        """One cell; None after reporting why not."""
        if len(cell.text) > MAX_RAW_CELL:
            self._add(k, cell, f"the cell is longer than {MAX_RAW_CELL} characters")
            return None
        text = plain_cell(cell.text)
        unit = cell.unit if cell.unit is not None else self.units[quantity]
        try:
            parsed = parse_cell(text, quantity, unit, values, self.units[Quantity.ANGLE])
        except CellError as error:
            shown = "" if text == cell.text.strip() else f"{quoted(cell.text)} "
            self._add(k, cell, f"{shown}{error}")
            return None
        undecided = self.angle is None and cell.unit is None and quantity is Quantity.ANGLE
        if undecided and bare is not None and abs(parsed.plain) > bare:
            self._add(
                k,
                cell,
                f"{quoted(cell.text)} has no unit and is no angle in rad as people write them;"
                " write 90° or pi/2, or give angle=deg (or angle=rad if it is meant)",
            )
            return None
        if bare == TURN and unit == _ANGLES["deg"] and abs(parsed.plain) > 360.0:
            self._add(
                k,
                cell,
                f"{quoted(cell.text)} is more than a turn: a 90° that lost its ° reads 900; write"
                " the angle within ±360, or with its unit (900°) if it is meant",
            )
            return None
        if quantity is Quantity.LENGTH and cell.unit is None and unit == 1.0:
            self._warn_if_long(k, cell, parsed)
        return parsed

    def _warn_if_long(self, k: int, cell: RawCell, parsed: Cell) -> None:
        if abs(parsed.plain) > LONG and not any("length=mm" in text for text in self.warnings):
            self.warnings.append(
                f"joint {k + 1} (line {cell.line}, column {cell.column or '1'}):"
                f" {quoted(cell.text)} has no unit and is taken as metres; if it is in"
                " millimetres, give length=mm"
            )

    def _holds_variable(self, k: int, cell: RawCell | None, column: str) -> Cell | None:
        """The cell, if it holds the variable that its column may have."""
        if cell is None or len(cell.text) > MAX_RAW_CELL:
            return None
        text = plain_cell(cell.text)
        if text.lower() in _ANY_VARIABLE:
            return Cell(0.0, "q", text=text)
        letters = OWN_LETTERS[column]
        quantity = Quantity.ANGLE if column == "theta" else Quantity.LENGTH
        try:
            parsed = parse_cell(text, quantity, 1.0, self.values)
        except CellError:
            return None
        return parsed if parsed.variable in letters and parsed.index in (None, k + 1) else None

    def _type(self, k: int, row: RawRow) -> JointType | None:
        """The type that a row says, by its column or by its variable; None if it says none."""
        cell = row.cells.get("type")
        if cell is not None and cell.text.strip() not in _ABSENT:
            word = plain_cell(cell.text[:MAX_RAW_CELL]).strip("().").lower()
            found = _TYPES.get(word) or _TYPES.get(word.removesuffix(" joint"))
            if found is None:
                self._add(
                    k, cell, f"the type is {quoted(cell.text)}; write R, P or F (or σ: 0, 1, 2)"
                )
                return JointType.FIXED
            return found
        variable = row.cells.get("variable")
        if variable is not None and variable.text.strip() not in _ABSENT:
            found = self._type_by_variable(k, variable)
            if found is not None:
                return found
        theta = self._holds_variable(k, row.cells.get("theta"), "theta")
        along = self._holds_variable(k, row.cells.get(self.z_column), self.z_column)
        if theta is not None and along is not None and along.variable == "q":
            self._add(
                k,
                row.cells[self.z_column],
                "theta and this cell both hold a joint variable; a joint has one. Add a column"
                " type, or give the constant in values",
            )
            return None
        if theta is not None:
            return JointType.REVOLUTE
        if along is not None:
            return JointType.PRISMATIC
        for column, type_ in (("theta", JointType.REVOLUTE), (self.z_column, JointType.PRISMATIC)):
            own = row.cells.get(column)
            absent = own is not None and own.text.strip() in _ABSENT
            # Where other rows name their variable, an empty cell is a row that does not move.
            if absent and column not in self.named:
                return type_
        if "theta" not in row.cells and self.z_column in row.cells:
            return JointType.REVOLUTE
        return JointType.REVOLUTE if self.raw.typed else None

    def _type_by_variable(self, k: int, cell: RawCell) -> JointType | None:
        """The type by the joint variable in a column of its own; None for q, which says none."""
        text = plain_cell(cell.text[:MAX_RAW_CELL])
        letter, index = variable_of(text.lower()) or ("", None)
        if not letter or index not in (None, k + 1):
            self._add(k, cell, f"{quoted(cell.text)} is not the variable of joint {k + 1}")
            return JointType.FIXED
        return {"theta": JointType.REVOLUTE, "q": None}.get(letter, JointType.PRISMATIC)

    def _row(self, k: int, row: RawRow, type_: JointType) -> dict[str, Any]:
        is_revolute = type_.is_revolute
        own = "theta" if is_revolute else self.z_column if type_ is JointType.PRISMATIC else None
        own_quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
        item: dict[str, Any] = {"type": type_.value}
        limits: dict[str, Any] = {}
        for key, cell in row.cells.items():
            if key in ("type", "variable") or cell.text.strip() in _ABSENT:
                continue
            if key in ("index", "name"):
                self._name(item, key, cell)
                continue
            if key in ("sign", "ant", "mu"):
                item[key] = plain_cell(cell.text[:MAX_RAW_CELL])
                continue
            if key == own and plain_cell(cell.text[:MAX_RAW_CELL]).lower() in _ANY_VARIABLE:
                continue
            quantity = COLUMN_QUANTITIES.get(key, own_quantity)
            quantity = Quantity.NUMBER if key == "effort" else quantity
            values = self.values
            if key == own:
                values = values.without_variable(OWN_LETTERS[key], k + 1)
            bare = LIMIT_TURNS if key in LIMIT_FIELDS else TURN
            parsed = self._cell(k, cell, quantity, values, bare)
            if parsed is None:
                continue
            if key == own and not row.own_constant and parsed.value != 0.0:
                self._add(
                    k,
                    cell,
                    f"{key} of a {type_} joint is ignored by the Robotics Toolbox; write 0 there,"
                    " and the constant as offset",
                )
            problem = _foreign(parsed, key, key == own, k)
            if problem:
                self._add(k, cell, problem)
            elif key in LIMIT_FIELDS:
                limits[key] = parsed
            else:
                item[key] = parsed
        if limits:
            item["limits"] = limits
        return item

    def _name(self, item: dict[str, Any], key: str, cell: RawCell) -> None:
        """A name, or a text in the first column that can be one."""
        text = (
            plain_cell(cell.text[:MAX_RAW_CELL])
            if key == "index"
            else cell.text.strip().replace("\\_", "_")
        )
        if key == "name" or (NAME.fullmatch(text) and not text.isdecimal()):
            item["name"] = text


def _foreign(cell: Cell, column: str, own: bool, k: int) -> str | None:
    """Why a joint variable cannot stand in a cell, if it cannot."""
    if cell.variable is None:
        return None
    if not own or cell.variable not in OWN_LETTERS[column]:
        return (
            f"{quoted(cell.text)} holds {cell.name}, which is not the joint variable of this"
            f" column; if it is a constant, give values {cell.name}:0.5"
        )
    if cell.index not in (None, k + 1):
        return f"{quoted(cell.text)} is the variable of joint {cell.index}, not {k + 1}"
    return None
