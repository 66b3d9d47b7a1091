"""Documents -> :class:`DHTable`: JSON, YAML and CSV texts, and the mapping that all share.

Every refusal carries a JSON pointer to the cell, the joint's name and what to write instead.
"""

from __future__ import annotations

import csv
import json
import math
import re
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.events import AliasEvent, CollectionEndEvent, CollectionStartEvent

from dh_to_urdf.errors import DHError, DHSyntaxError, Problem, escaped, quoted
from dh_to_urdf.expressions import MAX_MAGNITUDE, Cell, CellError, Quantity, parse_cell
from dh_to_urdf.placements import read_inertial, read_placement
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, Inertial, JointType, Limits

MAX_ROWS = 300
MAX_COLUMNS = 32
MAX_YAML_BYTES = 64_000
MAX_YAML_DEPTH = 16
DEFAULT_NAME = "robot"
NAME = re.compile(r"\w(?:[\w .:+-]{0,62}[\w.+-])?", re.UNICODE)
NAME_RULE = "use letters, digits and . _ - + : (at most 64, starting with a letter or digit)"

CONVENTION_ALIASES = {
    "standard": Convention.STANDARD,
    "dh": Convention.STANDARD,
    "sdh": Convention.STANDARD,
    "distal": Convention.STANDARD,
    "paul": Convention.STANDARD,
    "modified": Convention.MODIFIED,
    "mdh": Convention.MODIFIED,
    "craig": Convention.MODIFIED,
    "proximal": Convention.MODIFIED,
    "khalil": Convention.KHALIL,
    "khalil-kleinfinger": Convention.KHALIL,
}
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
_ANGLE_UNITS = {"rad": 1.0, "deg": math.pi / 180}
_LENGTH_UNITS = {"m": 1.0, "mm": 1e-3}

_TABLE_FIELDS = ("name", "convention", "units", "base", "tool", "joints")
_NOTE_FIELDS = ("title", "description", "source")
_COMMON = ("name", "type", "alpha", "d", "theta", "offset", "sign", "limits", "inertial", "visual")
_ROW_FIELDS = {
    Convention.STANDARD: (*_COMMON, "a"),
    Convention.MODIFIED: (*_COMMON, "a"),
    Convention.KHALIL: (*_COMMON, "r", "ant", "sigma", "mu", "gamma", "b"),
}
_CSV_LIMITS = ("lower", "upper", "velocity", "effort")


@dataclass(frozen=True)
class Units:
    """Units of the plain numbers of a document, as factors to rad and m."""

    angle: float = 1.0
    length: float = 1.0

    def of(self, quantity: Quantity) -> float:
        """Factor for one quantity."""
        if quantity is Quantity.ANGLE:
            return self.angle
        return self.length if quantity is Quantity.LENGTH else 1.0


@dataclass
class _Report:
    """Collects problems, so that one answer names several cells."""

    problems: list[Problem] = field(default_factory=list)

    def add(self, pointer: str, message: str) -> None:
        self.problems.append(Problem(pointer, message))

    def raise_if_any(self) -> None:
        if self.problems:
            raise DHError(self.problems)


def read_json(text: str | bytes, default_name: str | None = DEFAULT_NAME) -> DHTable:
    """Reads a table from JSON.

    Args:
        text: The JSON text.
        default_name: Name for a table that gives none; None requires one.

    Raises:
        DHError: Not JSON, or not a usable table.
    """
    try:
        data = json.loads(text, object_pairs_hook=_no_duplicates)
    except DHError:
        raise
    except (ValueError, RecursionError) as error:
        reason = (
            str(error)
            if isinstance(error, json.JSONDecodeError)
            else "it is nested too deeply"
            if isinstance(error, RecursionError)
            else "it holds a text or number that cannot be read"
        )
        raise DHSyntaxError.single("", f"the text is not JSON: {reason}") from None
    return read_mapping(data, default_name)


def read_yaml(text: str | bytes, default_name: str | None = DEFAULT_NAME) -> DHTable:
    """Reads a table from YAML 1.2; duplicate keys, tags and several documents are refused.

    Args:
        text: The YAML text.
        default_name: Name for a table that gives none; None requires one.

    Raises:
        DHError: Not YAML, or not a usable table.
    """
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise DHSyntaxError.single("", "the text is not YAML: it is not UTF-8") from None
    try:
        _refuse_costly_yaml(text)
        data = YAML(typ="safe", pure=True).load(text)
    except DHError:
        raise
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f" at line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        problem = (error.problem or "malformed").splitlines()[0][:120]
        raise DHSyntaxError.single("", f"the text is not YAML: {problem}{place}") from None
    except Exception:  # tags and escapes make the constructor raise whatever int() or chr() do
        raise DHSyntaxError.single("", "the text is not YAML of plain keys and values") from None
    return read_mapping(data, default_name)


def _refuse_costly_yaml(text: str) -> None:
    """Refuses what takes the parser exponential time and no table needs: aliases, deep nesting.

    The events are read one by one, so that a deep text is given up where it becomes too deep.
    """
    if len(text) > MAX_YAML_BYTES:
        raise DHError.single("", f"the YAML text is longer than {MAX_YAML_BYTES} characters")
    depth = 0
    for event in YAML(typ="safe", pure=True).parse(text):
        if isinstance(event, AliasEvent):
            raise DHSyntaxError.single("", "the YAML text has an alias (*name); write it out")
        if isinstance(event, CollectionStartEvent):
            depth += 1
        elif isinstance(event, CollectionEndEvent):
            depth -= 1
        if depth > MAX_YAML_DEPTH:
            raise DHSyntaxError.single("", "the YAML text is nested too deeply")


def read_csv(
    text: str | bytes,
    convention: str | None,
    name: str | None = None,
    angle: str = "rad",
    length: str = "m",
) -> DHTable:
    """Reads a table from CSV with a header line and one line a joint.

    Columns: ``name,type,alpha,a,d,theta,offset,sign,lower,upper,velocity,effort``; in khalil
    ``ant,sigma,mu,gamma,b,alpha,d,theta,r``. Separated by commas, semicolons or tabs.

    Args:
        text: The CSV text, UTF-8 if bytes.
        convention: What the rows mean; required.
        name: Name of the robot.
        angle: Unit of plain angles, ``rad`` or ``deg``.
        length: Unit of plain lengths, ``m`` or ``mm``.

    Raises:
        DHError: Not a usable table.
    """
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise DHError.single("", "the CSV text is not UTF-8") from None
    lines = [line for line in text.lstrip("\ufeff").splitlines() if line.strip()]
    if not lines:
        raise DHError.single("", "the CSV text is empty; its first line names the columns")
    separator = max(",;\t", key=lines[0].count)
    try:
        header, *records = csv.reader(
            lines, delimiter=separator, strict=True, skipinitialspace=True
        )
    except csv.Error as error:
        raise DHSyntaxError.single("", f"the text is not CSV: {error}") from None
    columns = [column.strip().lower() for column in header]
    if len(columns) > MAX_COLUMNS:
        raise DHError.single("", f"the CSV header has {len(columns)} columns; see README for them")
    twice, count = Counter(columns).most_common(1)[0]
    if count > 1:
        raise DHError.single("", f"the CSV header names {quoted(twice)} twice")
    rows = []
    for number, record in enumerate(records):
        if len(record) != len(columns):
            raise DHError.single(
                f"/joints/{number}",
                f"line {number + 2} has {len(record)} cells under {len(columns)} columns; quote a"
                " cell with a decimal comma, or separate cells by semicolons",
            )
        cells = zip(columns, (cell.strip() for cell in record), strict=True)
        row: dict[str, Any] = {column: cell for column, cell in cells if cell != ""}
        limits = {key: row.pop(key) for key in _CSV_LIMITS if key in row}
        if limits:
            row["limits"] = limits
        rows.append(row)
    document: dict[str, Any] = {"units": {"angle": angle, "length": length}, "joints": rows}
    if convention is not None:
        document["convention"] = convention
    if name:
        document["name"] = name
    return read_mapping(document, None if name == "" else DEFAULT_NAME, tuple(columns))


def read_mapping(
    data: object,
    default_name: str | None = DEFAULT_NAME,
    columns: tuple[str, ...] | None = None,
) -> DHTable:
    """Reads a table from the mapping that JSON and YAML documents hold.

    Args:
        data: The mapping; README and the OpenAPI schema ``DHTable`` describe it.
        default_name: Name for a table that gives none; None requires one.
        columns: Column names of a CSV document, to tell a missing column from an empty cell.

    Returns:
        The table, in SI units.

    Raises:
        DHError: With a pointer to each of the first ten problems.
    """
    if not isinstance(data, Mapping):
        raise DHError.single("", "the document is not a mapping with convention and joints")
    report = _Report()
    _refuse_unknown(data, (*_TABLE_FIELDS, *_NOTE_FIELDS), "", "the table", report)
    name = data.get("name", default_name)
    if name is None:
        report.add("/name", f"name is missing; {NAME_RULE}")
        name = DEFAULT_NAME
    elif not isinstance(name, str) or NAME.fullmatch(name) is None:
        report.add("/name", f"name is {quoted(name)}; {NAME_RULE}")
        name = DEFAULT_NAME
    convention = _convention(data, report)
    for key in _NOTE_FIELDS:
        if not isinstance(data.get(key, ""), str):
            report.add(f"/{key}", f"{key} is {quoted(data[key])}; give a text")
    units = _units(data.get("units"), report)
    warnings: list[str] = []
    base = read_placement(
        data.get("base"), "/base", units.angle, units.length, report.add, warnings
    )
    tool = read_placement(
        data.get("tool"), "/tool", units.angle, units.length, report.add, warnings
    )
    joints = data.get("joints")
    if not isinstance(joints, list) or not joints:
        report.add("/joints", "joints is missing or empty; give a list with one entry a joint")
        joints = []
    if len(joints) > MAX_ROWS:
        raise DHError.single(
            "/joints", f"joints has {len(joints)} rows; at most {MAX_ROWS} are read"
        )
    report.raise_if_any()
    assert convention is not None
    reader = _RowReader(convention, units, report, columns)
    rows = [row for k, item in enumerate(joints) if (row := reader.read(k, item)) is not None]
    _check_names(rows, report)
    report.raise_if_any()
    rows = _in_tree_order(rows, report)
    report.raise_if_any()
    return DHTable(name, convention, tuple(rows), base, tool, tuple(warnings))


def _no_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) != len(pairs):
        twice = Counter(key for key, _ in pairs).most_common(1)[0][0]
        raise DHError.single("", f"the key {quoted(twice)} stands twice in one object; keep one")
    return mapping


def _refuse_unknown(
    data: Mapping[Any, Any], known: tuple[str, ...], pointer: str, where: str, report: _Report
) -> None:
    for key in data:
        if key not in known:
            report.add(
                f"{pointer}/{escaped(key)}",
                f"{where} has an unknown field {quoted(key)}; known are {', '.join(known)}",
            )


def _convention(data: Mapping[Any, Any], report: _Report) -> Convention | None:
    raw = data.get("convention")
    choices = "standard (distal, Paul), modified (proximal, Craig) or khalil (Khalil-Kleinfinger)"
    if raw is None:
        report.add("/convention", f"convention is missing; give {choices}")
        return None
    convention = CONVENTION_ALIASES.get(raw.strip().lower()) if isinstance(raw, str) else None
    if convention is None:
        report.add("/convention", f"convention {quoted(raw)} is unknown; give {choices}")
    return convention


def _units(raw: object, report: _Report) -> Units:
    if raw is None:
        return Units()
    if not isinstance(raw, Mapping):
        report.add("/units", 'units is not a mapping; give {"angle": "deg", "length": "mm"}')
        return Units()
    _refuse_unknown(raw, ("angle", "length"), "/units", "units", report)
    found = []
    for key, choices in (("angle", _ANGLE_UNITS), ("length", _LENGTH_UNITS)):
        unit = raw.get(key, next(iter(choices)))
        if not isinstance(unit, str) or unit not in choices:
            report.add(
                f"/units/{key}", f"units.{key} is {quoted(unit)}; give {' or '.join(choices)}"
            )
            unit = next(iter(choices))
        found.append(choices[unit])
    return Units(*found)


class _RowReader:
    """Reads the rows of one table; problems go to the report."""

    def __init__(
        self,
        convention: Convention,
        units: Units,
        report: _Report,
        columns: tuple[str, ...] | None,
    ) -> None:
        self.convention = convention
        self.units = units
        self.report = report
        self.columns = columns

    def read(self, k: int, item: object) -> DHRow | None:
        pointer = f"/joints/{k}"
        if not isinstance(item, Mapping):
            self.report.add(
                pointer, f"joint {k + 1} is {quoted(item)}; give a mapping of its columns"
            )
            return None
        label = f"joint {k + 1}"
        name = item.get("name", f"j{k + 1}")
        if isinstance(name, str) and NAME.fullmatch(name):
            label += f" ({name})" if "name" in item else ""
        else:
            self.report.add(f"{pointer}/name", f"{label}: name is {quoted(name)}; {NAME_RULE}")
            name = f"j{k + 1}"
        self._refuse_foreign(item, pointer, label)
        known = len(self.report.problems)
        type_ = self._type(item, pointer, label)
        if type_ is None:
            return None
        row = self._cells(k, item, name, type_, pointer, label)
        return row if len(self.report.problems) == known else None

    def _refuse_foreign(self, item: Mapping[Any, Any], pointer: str, label: str) -> None:
        khalil = self.convention is Convention.KHALIL
        if not khalil and "r" in item:
            self.report.add(
                f"{pointer}/r",
                f"{label}: r is a column of the khalil convention only (some texts use r for a);"
                " write a for the length along x and d for the length along z",
            )
            item = {key: item[key] for key in item if key != "r"}
        if khalil and "a" in item:
            self.report.add(
                f"{pointer}/a",
                f"{label}: khalil has no column a; d is the length along x and r the one along z",
            )
            item = {key: item[key] for key in item if key != "a"}
        _refuse_unknown(item, _ROW_FIELDS[self.convention], pointer, label, self.report)

    def _type(self, item: Mapping[Any, Any], pointer: str, label: str) -> JointType | None:
        sigma_type = None
        if "sigma" in item and self.convention is Convention.KHALIL:
            sigma = _integer(item["sigma"])
            sigma_type = _SIGMA.get(sigma) if sigma is not None else None
            if sigma_type is None:
                self.report.add(
                    f"{pointer}/sigma",
                    f"{label}: sigma is {quoted(item['sigma'])};"
                    " give 0 (revolute), 1 (prismatic) or 2 (fixed)",
                )
                return None
        raw = item.get("type")
        if raw is None:
            if sigma_type is None:
                self.report.add(
                    f"{pointer}/type",
                    f"{label}: type is missing; give revolute, prismatic, continuous or fixed",
                )
            return sigma_type
        found = TYPE_ALIASES.get(raw.strip().lower()) if isinstance(raw, str) else None
        if found is None:
            self.report.add(
                f"{pointer}/type",
                f"{label}: type is {quoted(raw)}; give revolute, prismatic, continuous or fixed",
            )
        elif sigma_type is not None and (
            sigma_type is not found
            and not (sigma_type is JointType.REVOLUTE and found is JointType.CONTINUOUS)
        ):
            self.report.add(
                f"{pointer}/sigma", f"{label}: sigma says {sigma_type} but type says {found}"
            )
            return None
        return found

    def _cells(
        self,
        k: int,
        item: Mapping[Any, Any],
        name: str,
        type_: JointType,
        pointer: str,
        label: str,
    ) -> DHRow:
        khalil = self.convention is Convention.KHALIL
        x_column, z_column = ("d", "r") if khalil else ("a", "d")
        own = "theta" if type_.turns else z_column if type_ is JointType.PRISMATIC else None

        def cell(column: str, quantity: Quantity, *, optional: bool = False) -> Cell:
            return self._cell(k, item, column, quantity, pointer, label, own == column, optional)

        alpha = cell("alpha", Quantity.ANGLE)
        a = cell(x_column, Quantity.LENGTH)
        d = cell(z_column, Quantity.LENGTH, optional=own == z_column)
        theta = cell("theta", Quantity.ANGLE, optional=own == "theta")
        own_quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
        offset = cell("offset", own_quantity, optional=True).value
        sign = self._sign(item, pointer, label)
        variable = theta if own == "theta" else d if own else None
        if variable is not None:
            offset += variable.value
            if variable.variable is not None:
                if "sign" in item and sign != variable.sign:
                    self.report.add(
                        f"{pointer}/sign",
                        f"{label}: sign is {sign} but the {own} cell has the variable with sign"
                        f" {variable.sign}; keep one of the two",
                    )
                sign = variable.sign
        if abs(offset) > MAX_MAGNITUDE:
            self.report.add(
                f"{pointer}/offset", f"{label}: offset and {own} add up beyond ±{MAX_MAGNITUDE:g}"
            )
        if type_ is JointType.FIXED and offset != 0.0:
            self.report.add(
                f"{pointer}/offset",
                f"{label}: a fixed joint has no variable to offset; add it to theta or to the"
                " length along z",
            )
        gamma = cell("gamma", Quantity.ANGLE, optional=True).value if khalil else 0.0
        b = cell("b", Quantity.LENGTH, optional=True).value if khalil else 0.0
        visual = item.get("visual", True)
        if not isinstance(visual, bool):
            self.report.add(f"{pointer}/visual", f"{label}: visual must be true or false")
        return DHRow(
            name=name,
            type=type_,
            alpha=alpha.value,
            a=a.value,
            d=0.0 if own == z_column else d.value,
            theta=0.0 if own == "theta" else theta.value,
            parent=self._parent(k, item, type_, pointer, label),
            offset=offset,
            sign=sign,
            limits=self._limits(item.get("limits"), type_, pointer, label),
            gamma=gamma,
            b=b,
            inertial=self._inertial(item.get("inertial"), pointer, label),
            visual=bool(visual),
        )

    def _cell(
        self,
        k: int,
        item: Mapping[Any, Any],
        column: str,
        quantity: Quantity,
        pointer: str,
        label: str,
        own: bool,
        optional: bool,
    ) -> Cell:
        where = f"{pointer}/{column}"
        if column not in item:
            if not optional:
                missing = self.columns is not None and column not in self.columns
                what = f"column {column} is missing" if missing else f"{column} is missing"
                self.report.add(where, f"{label}: {what}; give it, 0 if it is zero")
            return Cell(0.0)
        try:
            cell = parse_cell(item[column], quantity, self.units.of(quantity))
        except CellError as error:
            self.report.add(where, f"{label}: {column} {error}")
            return Cell(0.0)
        if cell.variable is not None:
            letters = {"theta": ("q", "theta"), "d": ("q", "d"), "r": ("q", "r", "d")}
            if not own or cell.variable not in letters.get(column, ()):
                self.report.add(
                    where,
                    f"{label}: {column} is {quoted(item[column])}, but the joint variable belongs"
                    " in theta (revolute) or in the length along z (prismatic)",
                )
            elif cell.index is not None and cell.index != k + 1:
                self.report.add(
                    where, f"{label}: {column} has the variable of joint {cell.index}, not {k + 1}"
                )
        return cell

    def _sign(self, item: Mapping[Any, Any], pointer: str, label: str) -> int:
        raw = item.get("sign", 1)
        sign = _integer(raw)
        if sign not in (1, -1):
            self.report.add(f"{pointer}/sign", f"{label}: sign is {quoted(raw)}; give 1 or -1")
            return 1
        return sign

    def _parent(
        self, k: int, item: Mapping[Any, Any], type_: JointType, pointer: str, label: str
    ) -> int:
        if self.convention is Convention.KHALIL and "mu" in item:
            mu = _integer(item["mu"])
            if mu not in (0, 1):
                self.report.add(
                    f"{pointer}/mu", f"{label}: mu is {quoted(item['mu'])}; give 1 (moved) or 0"
                )
            elif mu == 0 and type_ is not JointType.FIXED:
                self.report.add(
                    f"{pointer}/mu",
                    f"{label}: mu = 0 is a passive joint, which belongs to a closed loop; closed"
                    " loops are not computed. Give mu = 1 to treat the joint as independent",
                )
        if "ant" not in item:
            return k
        parent = _integer(item["ant"])
        if parent is None or parent < 0:
            self.report.add(
                f"{pointer}/ant",
                f"{label}: ant is {quoted(item['ant'])}; give the number of the preceding frame,"
                " 0 for the base",
            )
            return k
        return parent

    def _limits(self, raw: object, type_: JointType, pointer: str, label: str) -> Limits:
        if raw is None:
            return Limits()
        where = f"{pointer}/limits"
        if not isinstance(raw, Mapping):
            self.report.add(where, f"{label}: limits is {quoted(raw)}; give lower and upper")
            return Limits()
        _refuse_unknown(raw, _CSV_LIMITS, where, f"{label}: limits", self.report)
        quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
        values: dict[str, float | None] = {}
        for key in _CSV_LIMITS:
            values[key] = None
            if raw.get(key) is None:
                continue
            of = Quantity.NUMBER if key == "effort" else quantity
            try:
                cell = parse_cell(raw[key], of, self.units.of(of))
            except CellError as error:
                self.report.add(f"{where}/{key}", f"{label}: limits.{key} {error}")
                continue
            if cell.variable is not None:
                self.report.add(f"{where}/{key}", f"{label}: limits.{key} holds a joint variable")
            elif key in ("velocity", "effort") and cell.value < 0:
                self.report.add(f"{where}/{key}", f"{label}: limits.{key} is negative")
            values[key] = cell.value
        lower, upper = values["lower"], values["upper"]
        if (raw.get("lower") is None) != (raw.get("upper") is None):
            missing = "lower" if raw.get("lower") is None else "upper"
            self.report.add(
                f"{where}/{missing}", f"{label}: limits.{missing} is missing; give both or none"
            )
        if lower is not None and upper is not None:
            if type_ in (JointType.CONTINUOUS, JointType.FIXED):
                self.report.add(
                    where, f"{label}: a {type_} joint has no lower and upper limits; use revolute"
                )
            elif lower > upper:
                self.report.add(
                    f"{where}/lower",
                    f"{label}: limits.lower {raw['lower']} is above upper {raw['upper']}; swap"
                    " them",
                )
        return Limits(**values)

    def _inertial(self, raw: object, pointer: str, label: str) -> Inertial | None:
        if raw is None:
            return None
        return read_inertial(raw, f"{pointer}/inertial", label, self.units.length, self.report.add)


def _integer(raw: object) -> int | None:
    """An integer from 3, 3.0 or "3"; None for anything else."""
    if isinstance(raw, str) and re.fullmatch(r"\s*[+-]?\d{1,6}\s*", raw):
        return int(raw)
    if isinstance(raw, bool) or not isinstance(raw, (int, float)):
        return None
    if isinstance(raw, float) and not raw.is_integer():
        return None
    return int(raw) if abs(raw) < 10**6 else None


def _check_names(rows: list[DHRow], report: _Report) -> None:
    first: dict[str, int] = {}
    for k, row in enumerate(rows):
        if row.name in first:
            report.add(
                f"/joints/{k}/name",
                f"joint {k + 1}: the name {quoted(row.name)} is taken by joint"
                f" {first[row.name] + 1}; give each joint its own",
            )
        first.setdefault(row.name, k)


def _in_tree_order(rows: list[DHRow], report: _Report) -> list[DHRow]:
    """Checks that the antecedents form a tree whose rows follow their parents."""
    for k, row in enumerate(rows):
        if row.parent > len(rows):
            report.add(
                f"/joints/{k}/ant",
                f"joint {k + 1} ({row.name}): ant is {row.parent}, but the last frame is"
                f" {len(rows)}",
            )
        elif row.parent == k + 1:
            report.add(
                f"/joints/{k}/ant",
                f"joint {k + 1} ({row.name}): ant is the joint itself; closed loops are not"
                " computed",
            )
        elif row.parent > k + 1:
            report.add(
                f"/joints/{k}/ant",
                f"joint {k + 1} ({row.name}): ant is {row.parent}, a later row; list each joint"
                " after its antecedent. If none of them can come first, the table describes a"
                " closed loop, which is not computed",
            )
    return rows


READERS: dict[str, Callable[[str | bytes], DHTable]] = {"json": read_json, "yaml": read_yaml}
"""Readers of texts that say everything themselves; CSV needs a convention besides."""

__all__ = [
    "CONVENTION_ALIASES",
    "MAX_ROWS",
    "READERS",
    "Matrix",
    "read_csv",
    "read_json",
    "read_mapping",
    "read_yaml",
]
