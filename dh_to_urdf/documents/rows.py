"""Rows of a document -> :class:`DHRow`, with every fault at its cell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from dh_to_urdf.cells.expressions import MAX_MAGNITUDE, Cell, CellError, Quantity, parse_cell
from dh_to_urdf.cells.values import Values
from dh_to_urdf.documents.checks import (
    NAME,
    NAME_RULE,
    Report,
    Units,
    refuse_unknown,
    whole_number,
)
from dh_to_urdf.documents.dependence import FIELDS, Dependence, of_cell, of_fields
from dh_to_urdf.documents.joint_types import read_type
from dh_to_urdf.documents.limits import read_limits
from dh_to_urdf.documents.placements import is_inertial, read_inertial
from dh_to_urdf.documents.symbols import read_symbols, symbol_of
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.table import Convention, DHRow, Inertial, JointType

_COMMON = (
    *("name", "type", "alpha", "d", "theta", "offset", "sign", "limits", "inertial", "visual"),
    *FIELDS,
    "symbols",
)
_ROW_FIELDS = {
    Convention.STANDARD: (*_COMMON, "a"),
    Convention.MODIFIED: (*_COMMON, "a"),
    Convention.KHALIL: (*_COMMON, "r", "ant", "sigma", "mu", "gamma", "b"),
}
OWN_LETTERS = {"theta": ("q", "theta"), "d": ("q", "d"), "r": ("q", "r", "d")}
"""Letters of the joint variable in its own column."""


@dataclass(frozen=True, slots=True)
class _Item:
    """A row as written.

    Attributes:
        k: Its number, from 0.
        fields: Its columns by name.
        location: Where it stands in the document.
        label: What messages call it.
    """

    k: int
    fields: Mapping[Any, Any]
    location: Location
    label: str

    def at(self, field: str) -> Location:
        """Return where a column of the row stands in the document."""
        return (*self.location, field)


class RowReader:
    """Reads the rows of one table; faults go to the report.

    Attributes:
        dependences: What rows depend on, by their number from 0, as far as it was read.
    """

    def __init__(
        self,
        convention: Convention,
        units: Units,
        report: Report,
        columns: tuple[str, ...] | None,
        values: Values,
    ) -> None:
        self.convention = convention
        self.units = units
        self.report = report
        self.columns = columns
        self.values = values
        self.dependences: dict[int, Dependence] = {}
        self._spellings: dict[str, str] = {}

    def read(self, k: int, fields: object) -> DHRow | None:
        """Read row k (from 0); return None after reporting why not."""
        location, label = ("joints", k), say("joint {k}", k=k + 1)
        if not isinstance(fields, Mapping):
            self.report.add(
                location,
                say(
                    "{label} is {fields}; give a mapping of its columns",
                    label=label,
                    fields=quoted(fields),
                ),
            )
            return None
        name = fields.get("name", f"j{k + 1}")
        if isinstance(name, str) and NAME.fullmatch(name):
            label += f" ({name})" if "name" in fields else ""
        else:
            self.report.add(
                (*location, "name"),
                say(
                    "{label}: name is {name}; {name_rule}",
                    label=label,
                    name=quoted(name),
                    name_rule=NAME_RULE,
                ),
            )
            name = f"j{k + 1}"
        item = _Item(k, fields, location, label)
        self._refuse_foreign(item)
        known = len(self.report.faults)
        type_ = read_type(fields, self.convention, location, label, self.report)
        if type_ is None:
            return None
        row = self._row(item, name, type_)
        return row if len(self.report.faults) == known else None

    def _refuse_foreign(self, item: _Item) -> None:
        """Report columns that the convention does not have."""
        khalil = self.convention is Convention.KHALIL
        foreign = "a" if khalil else "r"
        if foreign in item.fields:
            explanation = (
                say("khalil has no column a; d is the length along x and r the one along z")
                if khalil
                else say(
                    "r is a column of the khalil convention only (some texts use r for a);"
                    " write a for the length along x and d for the length along z"
                )
            )
            self.report.add(
                item.at(foreign),
                say("{label}: {explanation}", label=item.label, explanation=explanation),
            )
        others = {key: value for key, value in item.fields.items() if key != foreign}
        fields = _ROW_FIELDS[self.convention]
        refuse_unknown(others, fields, item.location, item.label, self.report)

    def _row(self, item: _Item, name: str, type_: JointType) -> DHRow:
        khalil = self.convention is Convention.KHALIL
        x_column, z_column = ("d", "r") if khalil else ("a", "d")
        own = "theta" if type_.is_revolute else z_column if type_ is JointType.PRISMATIC else None

        def cell(column: str, quantity: Quantity, *, optional: bool = False) -> Cell:
            return self._cell(item, column, quantity, own == column, optional)

        alpha = cell("alpha", Quantity.ANGLE)
        a = cell(x_column, Quantity.LENGTH)
        d = cell(z_column, Quantity.LENGTH, optional=own == z_column)
        theta = cell("theta", Quantity.ANGLE, optional=own == "theta")
        own_quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
        offset = cell("offset", own_quantity, optional=True).value
        variable = theta if own == "theta" else d if own else None
        offset, sign = self._motion(item, type_, own, variable, offset)
        self._dependence(item, type_, own, variable)
        gamma = cell("gamma", Quantity.ANGLE, optional=True).value if khalil else 0.0
        b = cell("b", Quantity.LENGTH, optional=True) if khalil else Cell(0.0)
        lengths = {"a": a, "b": b} | ({} if own == z_column else {"d": d})
        named = {x_column: "a", z_column: "d"} | ({"b": "b"} if khalil else {})
        told = read_symbols(
            item.fields.get("symbols"), named, item.at("symbols"), item.label, self.report
        )
        symbols = {
            key: symbol_of(one, self.values, self._spellings) for key, one in lengths.items()
        }
        symbols = told | {key: name for key, name in symbols.items() if name}
        visual = item.fields.get("visual", True)
        if not isinstance(visual, bool):
            self.report.add(
                item.at("visual"), say("{label}: visual must be true or false", label=item.label)
            )
        return DHRow(
            name=name,
            type=type_,
            alpha=alpha.value,
            a=a.value,
            d=0.0 if own == z_column else d.value,
            theta=0.0 if own == "theta" else theta.value,
            parent=self._parent(item, type_),
            offset=offset,
            sign=sign,
            limits=read_limits(
                item.fields.get("limits"),
                type_,
                self.units,
                self.values,
                item.at("limits"),
                item.label,
                self.report,
            ),
            gamma=gamma,
            b=b.value,
            inertial=self._inertial(item),
            visual=bool(visual),
            symbols=tuple(symbols.items()),
        )

    def _motion(
        self, item: _Item, type_: JointType, own: str | None, variable: Cell | None, offset: float
    ) -> tuple[float, int]:
        """Return offset (rad or m) and sign of a joint from its columns and its own cell."""
        sign = self._sign(item)
        if variable is not None:
            offset += variable.value
            if variable.variable is not None and own is not None:
                _, turned = of_cell(variable, own, OWN_LETTERS[own], item.k)
                if "sign" in item.fields and sign != turned:
                    self.report.add(
                        item.at("sign"),
                        say(
                            "{label}: sign is {sign} but the {own} cell has the variable with sign"
                            " {turned}; keep one of the two",
                            label=item.label,
                            sign=sign,
                            own=own,
                            turned=turned,
                        ),
                    )
                sign = turned
        if abs(offset) > MAX_MAGNITUDE:
            self.report.add(
                item.at("offset"),
                say(
                    "{label}: offset and {own} add up beyond ±{max_magnitude:g}",
                    label=item.label,
                    own=own,
                    max_magnitude=MAX_MAGNITUDE,
                ),
            )
        if type_ is JointType.FIXED and offset != 0.0:
            self.report.warnings.append(
                say(
                    "{label}: its offset is ignored, since a fixed joint has no variable",
                    label=item.label,
                )
            )
            offset = 0.0
        return offset, sign

    def _dependence(
        self, item: _Item, type_: JointType, own: str | None, variable: Cell | None
    ) -> None:
        """Note what a joint depends on, by its fields or its own cell."""
        found = of_fields(
            item.fields,
            item.k,
            type_,
            self.units,
            self.values,
            item.location,
            item.label,
            self.report,
        )
        by_cell = None
        if variable is not None and own is not None:
            by_cell, _ = of_cell(variable, own, OWN_LETTERS[own], item.k)
        if len(found) == 2:  # it follows one joint and is moved by others besides
            mimic, coupling = found
            found = (replace(mimic, terms=(*mimic.terms, *coupling.terms)),)
        if by_cell is not None:
            found = (*found, by_cell)
        if len(found) > 1:
            self.report.add(
                item.at(found[1].field),
                say(
                    "{label}: {field} and {field_2} both say what the joint depends on; keep one",
                    label=item.label,
                    field=found[0].field,
                    field_2=found[1].field,
                ),
            )
        elif found:
            self.dependences[item.k] = found[0]

    def _cell(
        self, item: _Item, column: str, quantity: Quantity, own: bool, optional: bool
    ) -> Cell:
        """Read one cell; report a missing one unless it is optional."""
        label = item.label
        if column not in item.fields:
            if not optional:
                missing = self.columns is not None and column not in self.columns
                what = (
                    say("column {column} is missing", column=column)
                    if missing
                    else say("{column} is missing", column=column)
                )
                self.report.add(
                    item.at(column),
                    say("{label}: {what}; give it, 0 if it is zero", label=label, what=what),
                )
            return Cell(0.0)
        letters = OWN_LETTERS.get(column, ())
        values = self.values.without_variable(letters, item.k + 1) if own else self.values
        try:
            cell = parse_cell(
                item.fields[column],
                quantity,
                self.units.of(quantity),
                values,
                self.units.angle,
                coupled=own,
            )
        except CellError as error:
            self.report.add(
                item.at(column),
                say("{label}: {column} {error}", label=label, column=column, error=error),
            )
            return Cell(0.0)
        fault = _foreign_variable(cell, column, own=own, k=item.k)
        if fault is not None:
            self.report.add(item.at(column), say("{label}: {fault}", label=item.label, fault=fault))
        self.report.doubts.cell(
            cell, quantity, say("{column} of {label}", column=column, label=item.label)
        )
        return cell

    def _sign(self, item: _Item) -> int:
        raw = item.fields.get("sign", 1)
        sign = whole_number(raw)
        if sign not in (1, -1):
            self.report.add(
                item.at("sign"),
                say("{label}: sign is {raw}; give 1 or -1", label=item.label, raw=quoted(raw)),
            )
            return 1
        return sign

    def _parent(self, item: _Item, type_: JointType) -> int:
        """Return the number of the preceding frame, from 1; 0 for the base."""
        if self.convention is Convention.KHALIL and "mu" in item.fields:
            raw = item.fields["mu"]
            mu = whole_number(raw)
            if mu not in (0, 1):
                self.report.add(
                    item.at("mu"),
                    say(
                        "{label}: mu is {raw}; give 1 (moved) or 0",
                        label=item.label,
                        raw=quoted(raw),
                    ),
                )
            elif mu == 0 and type_ is not JointType.FIXED:
                self.report.warnings.append(
                    say(
                        "{label}: mu = 0 is a passive joint; a table without closed loops has"
                        " none, and the joint is taken as independent (mu = 1)",
                        label=item.label,
                    )
                )
        if "ant" not in item.fields:
            return item.k
        parent = whole_number(item.fields["ant"])
        if parent is None or parent < 0:
            self.report.add(
                item.at("ant"),
                say(
                    "{label}: ant is {field}; give the number of the preceding frame, 0 for"
                    " the base",
                    label=item.label,
                    field=quoted(item.fields["ant"]),
                ),
            )
            return item.k
        return parent

    def _inertial(self, item: _Item) -> Inertial | None:
        raw = item.fields.get("inertial")
        if raw is None:
            return None
        location, length = item.at("inertial"), self.units.length
        if not is_inertial(raw):
            self.report.add(
                location,
                say(
                    "{label}: inertial is not a mapping with mass, com and inertia",
                    label=item.label,
                ),
            )
            return None

        def add(at: Location, fault: str) -> None:
            self.report.add(at, say("{label}: inertial: {fault}", label=item.label, fault=fault))

        return read_inertial(raw, location, length, add)


def _foreign_variable(cell: Cell, column: str, *, own: bool, k: int) -> str | None:
    """Return why a joint variable cannot stand in a cell; None where it can, or there is none.

    Args:
        cell: The cell.
        column: Its column.
        own: Whether the column is that of the joint's variable.
        k: Number of the row, from 0.
    """
    if cell.variable is None:
        return None
    misplaced = say(
        "{column} is {cell}, but the joint variable belongs in theta (revolute)"
        " or in the length along z (prismatic); if it is a constant, give"
        " values {cell_2}:0.5",
        column=column,
        cell=quoted(cell.text),
        cell_2=cell.name,
    )
    if not own:
        return misplaced
    letters = OWN_LETTERS[column]
    for (letter, index), coefficient in cell.terms:
        if index in (None, k + 1) and letter not in letters:
            return misplaced
        if index in (None, k + 1) and abs(coefficient) != 1.0:
            return say(
                "{column} is {cell}; the joint variable must have coefficient +1 or -1",
                column=column,
                cell=quoted(cell.text),
            )
    return None
