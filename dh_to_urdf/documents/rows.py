"""Rows of a document -> :class:`DHRow`, with every fault at its cell."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from dh_to_urdf.cells.expressions import MAX_MAGNITUDE, Cell, CellError, Quantity, parse_cell
from dh_to_urdf.cells.values import Values
from dh_to_urdf.documents.checks import NAME, NAME_RULE, Report, Units, refuse_unknown
from dh_to_urdf.documents.placements import read_inertial
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.table import Convention, DHRow, Inertial, JointType, Limits

TYPE_ALIASES = {
    "revolute": JointType.REVOLUTE,
    "r": JointType.REVOLUTE,
    "prismatic": JointType.PRISMATIC,
    "p": JointType.PRISMATIC,
    "continuous": JointType.CONTINUOUS,
    "c": JointType.CONTINUOUS,
    "fixed": JointType.FIXED,
    "f": JointType.FIXED,
}
_SIGMA = {0: JointType.REVOLUTE, 1: JointType.PRISMATIC, 2: JointType.FIXED}
_COMMON = ("name", "type", "alpha", "d", "theta", "offset", "sign", "limits", "inertial", "visual")
_ROW_FIELDS = {
    Convention.STANDARD: (*_COMMON, "a"),
    Convention.MODIFIED: (*_COMMON, "a"),
    Convention.KHALIL: (*_COMMON, "r", "ant", "sigma", "mu", "gamma", "b"),
}
OWN_LETTERS = {"theta": ("q", "theta"), "d": ("q", "d"), "r": ("q", "r", "d")}
"""Letters of the joint variable in its own column."""
LIMIT_FIELDS = ("lower", "upper", "velocity", "effort")


class RowReader:
    """Reads the rows of one table; faults go to the report."""

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

    def read(self, k: int, item: object) -> DHRow | None:
        """Reads row k (from 0), or gives None after reporting why not."""
        location = ("joints", k)
        if not isinstance(item, Mapping):
            self.report.add(
                location, f"joint {k + 1} is {quoted(item)}; give a mapping of its columns"
            )
            return None
        label = f"joint {k + 1}"
        name = item.get("name", f"j{k + 1}")
        if isinstance(name, str) and NAME.fullmatch(name):
            label += f" ({name})" if "name" in item else ""
        else:
            self.report.add((*location, "name"), f"{label}: name is {quoted(name)}; {NAME_RULE}")
            name = f"j{k + 1}"
        self._refuse_foreign(item, location, label)
        known = len(self.report.faults)
        type_ = self._type(item, location, label)
        if type_ is None:
            return None
        row = self._cells(k, item, name, type_, location, label)
        return row if len(self.report.faults) == known else None

    def _refuse_foreign(self, item: Mapping[Any, Any], location: Location, label: str) -> None:
        khalil = self.convention is Convention.KHALIL
        if not khalil and "r" in item:
            self.report.add(
                (*location, "r"),
                f"{label}: r is a column of the khalil convention only (some texts use r for a);"
                " write a for the length along x and d for the length along z",
            )
            item = {key: item[key] for key in item if key != "r"}
        if khalil and "a" in item:
            self.report.add(
                (*location, "a"),
                f"{label}: khalil has no column a; d is the length along x and r the one along z",
            )
            item = {key: item[key] for key in item if key != "a"}
        refuse_unknown(item, _ROW_FIELDS[self.convention], location, label, self.report)

    def _type(self, item: Mapping[Any, Any], location: Location, label: str) -> JointType | None:
        sigma_type = None
        if "sigma" in item and self.convention is Convention.KHALIL:
            sigma = _integer(item["sigma"])
            sigma_type = _SIGMA.get(sigma) if sigma is not None else None
            if sigma_type is None:
                self.report.add(
                    (*location, "sigma"),
                    f"{label}: sigma is {quoted(item['sigma'])};"
                    " give 0 (revolute), 1 (prismatic) or 2 (fixed)",
                )
                return None
        raw = item.get("type")
        if raw is None:
            if sigma_type is None:
                self.report.add(
                    (*location, "type"),
                    f"{label}: type is missing; give revolute, prismatic, continuous or fixed",
                )
            return sigma_type
        found = TYPE_ALIASES.get(raw.strip().lower()) if isinstance(raw, str) else None
        if found is None:
            self.report.add(
                (*location, "type"),
                f"{label}: type is {quoted(raw)}; give revolute, prismatic, continuous or fixed",
            )
        elif sigma_type is not None and (
            sigma_type is not found
            and not (sigma_type is JointType.REVOLUTE and found is JointType.CONTINUOUS)
        ):
            self.report.add(
                (*location, "sigma"), f"{label}: sigma says {sigma_type} but type says {found}"
            )
            return None
        return found

    def _cells(
        self,
        k: int,
        item: Mapping[Any, Any],
        name: str,
        type_: JointType,
        location: Location,
        label: str,
    ) -> DHRow:
        khalil = self.convention is Convention.KHALIL
        x_column, z_column = ("d", "r") if khalil else ("a", "d")
        own = "theta" if type_.is_revolute else z_column if type_ is JointType.PRISMATIC else None

        def cell(column: str, quantity: Quantity, *, optional: bool = False) -> Cell:
            return self._cell(k, item, column, quantity, location, label, own == column, optional)

        alpha = cell("alpha", Quantity.ANGLE)
        a = cell(x_column, Quantity.LENGTH)
        d = cell(z_column, Quantity.LENGTH, optional=own == z_column)
        theta = cell("theta", Quantity.ANGLE, optional=own == "theta")
        own_quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
        offset = cell("offset", own_quantity, optional=True).value
        sign = self._sign(item, location, label)
        variable = theta if own == "theta" else d if own else None
        if variable is not None:
            offset += variable.value
            if variable.variable is not None:
                if "sign" in item and sign != variable.sign:
                    self.report.add(
                        (*location, "sign"),
                        f"{label}: sign is {sign} but the {own} cell has the variable with sign"
                        f" {variable.sign}; keep one of the two",
                    )
                sign = variable.sign
        if abs(offset) > MAX_MAGNITUDE:
            self.report.add(
                (*location, "offset"), f"{label}: offset and {own} add up beyond ±{MAX_MAGNITUDE:g}"
            )
        if type_ is JointType.FIXED and offset != 0.0:
            self.report.warnings.append(
                f"{label}: its offset is ignored, since a fixed joint has no variable"
            )
            offset = 0.0
        gamma = cell("gamma", Quantity.ANGLE, optional=True).value if khalil else 0.0
        b = cell("b", Quantity.LENGTH, optional=True).value if khalil else 0.0
        visual = item.get("visual", True)
        if not isinstance(visual, bool):
            self.report.add((*location, "visual"), f"{label}: visual must be true or false")
        return DHRow(
            name=name,
            type=type_,
            alpha=alpha.value,
            a=a.value,
            d=0.0 if own == z_column else d.value,
            theta=0.0 if own == "theta" else theta.value,
            parent=self._parent(k, item, type_, location, label),
            offset=offset,
            sign=sign,
            limits=self._limits(item.get("limits"), type_, location, label),
            gamma=gamma,
            b=b,
            inertial=self._inertial(item.get("inertial"), location, label),
            visual=bool(visual),
        )

    def _cell(
        self,
        k: int,
        item: Mapping[Any, Any],
        column: str,
        quantity: Quantity,
        location: Location,
        label: str,
        own: bool,
        optional: bool,
    ) -> Cell:
        where = (*location, column)
        if column not in item:
            if not optional:
                missing = self.columns is not None and column not in self.columns
                what = f"column {column} is missing" if missing else f"{column} is missing"
                self.report.add(where, f"{label}: {what}; give it, 0 if it is zero")
            return Cell(0.0)
        letters = OWN_LETTERS.get(column, ())
        values = self.values.without_variable(letters, k + 1) if own else self.values
        try:
            cell = parse_cell(
                item[column], quantity, self.units.of(quantity), values, self.units.angle
            )
        except CellError as error:
            self.report.add(where, f"{label}: {column} {error}")
            return Cell(0.0)
        if cell.variable is not None:
            if not own or cell.variable not in letters:
                self.report.add(
                    where,
                    f"{label}: {column} is {quoted(cell.text)}, but the joint variable belongs"
                    " in theta (revolute) or in the length along z (prismatic); if it is a"
                    f" constant, give values {cell.name}:0.5",
                )
            elif cell.index is not None and cell.index != k + 1:
                self.report.add(
                    where, f"{label}: {column} has the variable of joint {cell.index}, not {k + 1}"
                )
        return cell

    def _sign(self, item: Mapping[Any, Any], location: Location, label: str) -> int:
        raw = item.get("sign", 1)
        sign = _integer(raw)
        if sign not in (1, -1):
            self.report.add((*location, "sign"), f"{label}: sign is {quoted(raw)}; give 1 or -1")
            return 1
        return sign

    def _parent(
        self, k: int, item: Mapping[Any, Any], type_: JointType, location: Location, label: str
    ) -> int:
        if self.convention is Convention.KHALIL and "mu" in item:
            mu = _integer(item["mu"])
            if mu not in (0, 1):
                self.report.add(
                    (*location, "mu"), f"{label}: mu is {quoted(item['mu'])}; give 1 (moved) or 0"
                )
            elif mu == 0 and type_ is not JointType.FIXED:
                self.report.add(
                    (*location, "mu"),
                    f"{label}: mu = 0 is a passive joint, which belongs to a closed loop; closed"
                    " loops are not computed. Give mu = 1 to treat the joint as independent",
                )
        if "ant" not in item:
            return k
        parent = _integer(item["ant"])
        if parent is None or parent < 0:
            self.report.add(
                (*location, "ant"),
                f"{label}: ant is {quoted(item['ant'])}; give the number of the preceding frame,"
                " 0 for the base",
            )
            return k
        return parent

    def _limits(self, raw: object, type_: JointType, location: Location, label: str) -> Limits:
        if raw is None:
            return Limits()
        where = (*location, "limits")
        if not isinstance(raw, Mapping):
            self.report.add(where, f"{label}: limits is {quoted(raw)}; give lower and upper")
            return Limits()
        refuse_unknown(raw, LIMIT_FIELDS, where, f"{label}: limits", self.report)
        quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
        values: dict[str, float | None] = {}
        for key in LIMIT_FIELDS:
            values[key] = None
            if raw.get(key) is None:
                continue
            of = Quantity.NUMBER if key == "effort" else quantity
            try:
                cell = parse_cell(raw[key], of, self.units.of(of), self.values, self.units.angle)
            except CellError as error:
                self.report.add((*where, key), f"{label}: limits.{key} {error}")
                continue
            if cell.variable is not None:
                self.report.add((*where, key), f"{label}: limits.{key} holds a joint variable")
            elif key in ("velocity", "effort") and cell.value < 0:
                self.report.add((*where, key), f"{label}: limits.{key} is negative")
            values[key] = cell.value
        lower, upper = values["lower"], values["upper"]
        if (raw.get("lower") is None) != (raw.get("upper") is None):
            missing = "lower" if raw.get("lower") is None else "upper"
            self.report.add(
                (*where, missing), f"{label}: limits.{missing} is missing; give both or none"
            )
        if lower is not None and upper is not None:
            if type_ in (JointType.CONTINUOUS, JointType.FIXED):
                self.report.add(
                    where, f"{label}: a {type_} joint has no lower and upper limits; use revolute"
                )
            elif lower > upper:
                self.report.add(
                    (*where, "lower"),
                    f"{label}: limits.lower {quoted(raw['lower'])} is above upper"
                    f" {quoted(raw['upper'])}; swap them",
                )
        return Limits(**values)

    def _inertial(self, raw: object, location: Location, label: str) -> Inertial | None:
        if raw is None:
            return None
        return read_inertial(
            raw, (*location, "inertial"), label, self.units.length, self.report.add
        )


def _integer(raw: object) -> int | None:
    """An integer from 3, 3.0 or "3"; None for anything else."""
    if isinstance(raw, str) and re.fullmatch(r"\s*[+-]?[0-9]{1,6}\s*", raw):
        return int(raw)
    if isinstance(raw, bool) or not isinstance(raw, (int, float)):
        return None
    if isinstance(raw, float) and not raw.is_integer():
        return None
    return int(raw) if abs(raw) < 10**6 else None


def check_names(rows: list[DHRow], report: Report) -> None:
    """Reports joints that share a name."""
    first: dict[str, int] = {}
    for k, row in enumerate(rows):
        if row.name in first:
            report.add(
                ("joints", k, "name"),
                f"joint {k + 1}: the name {quoted(row.name)} is taken by joint"
                f" {first[row.name] + 1}; give each joint its own",
            )
        first.setdefault(row.name, k)


def check_tree(rows: list[DHRow], report: Report) -> None:
    """Reports antecedents that form no tree whose rows follow their parents."""
    for k, row in enumerate(rows):
        if row.parent > len(rows):
            report.add(
                ("joints", k, "ant"),
                f"joint {k + 1} ({row.name}): ant is {row.parent}, but the last frame is"
                f" {len(rows)}",
            )
        elif row.parent == k + 1:
            report.add(
                ("joints", k, "ant"),
                f"joint {k + 1} ({row.name}): ant is the joint itself; closed loops are not"
                " computed",
            )
        elif row.parent > k + 1:
            report.add(
                ("joints", k, "ant"),
                f"joint {k + 1} ({row.name}): ant is {row.parent}, a later row; list each joint"
                " after its antecedent. If none of them can come first, the table describes a"
                " closed loop, which is not computed",
            )
