"""Writers of tables: YAML, CSV and aligned text."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from typing import Any

import numpy as np
from ruamel.yaml import YAML
from ruamel.yaml.representer import SafeRepresenter

from dh_to_urdf.cells.notation import DEGREES, in_degrees, number_text, sum_text
from dh_to_urdf.couplings import coefficient_in
from dh_to_urdf.documents.limits import LIMIT_FIELDS
from dh_to_urdf.documents.writing import table_to_mapping
from dh_to_urdf.extraction.explanation import explain
from dh_to_urdf.extraction.extract import Extraction
from dh_to_urdf.languages import ENGLISH, Language
from dh_to_urdf.messages import Message, chained, say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType

_TITLES = {
    Convention.STANDARD: say("standard: Rz(theta) Tz(d) Tx(a) Rx(alpha)"),
    Convention.MODIFIED: say("modified: Tx(a) Rx(alpha) Rz(theta) Tz(d)"),
    Convention.KHALIL: say("khalil: Rz(gamma) Tz(b) Rx(alpha) Tx(d) Rz(theta) Tz(r)"),
}


def document(
    found: Extraction | DHTable, *, degrees: bool = False, explained: bool = False
) -> dict[str, Any]:
    """Write a table as the mapping of a document, with residual and steps where known.

    Args:
        found: A table, or an extraction, whose residual is added.
        degrees: True for angles in degrees.
        explained: True adds the steps of an extraction.

    Returns:
        A mapping that ``read_mapping`` reads back.
    """
    table = found if isinstance(found, DHTable) else found.table
    mapping = table_to_mapping(table)
    if degrees:
        mapping["units"]["angle"] = "deg"
        mapping["joints"] = [
            _degrees(item, row, table)
            for item, row in zip(mapping["joints"], table.rows, strict=True)
        ]
    if isinstance(found, Extraction):
        residual = found.residual
        mapping["residual"] = {
            "position": residual.position,
            "orientation": in_degrees(residual.orientation) if degrees else residual.orientation,
            "configurations": residual.configurations,
        }
    if table.warnings:
        mapping["warnings"] = list(table.warnings)
    if explained and isinstance(found, Extraction):
        mapping["explanation"] = [
            {
                "frame": step.frame,
                "axes": list(step.axes),
                "case": None if step.case is None else step.case.value,
                "angle": in_degrees(step.angle) if degrees and step.angle else step.angle,
                "distance": step.distance,
                "foot_on_first": _plain(step.foot_on_first),
                "foot_on_second": _plain(step.foot_on_second),
                "x": _plain(step.x),
                "words": step.words,
            }
            for step in explain(found)
        ]
    return mapping


def to_yaml(mapping: dict[str, Any]) -> str:
    """Write a document as YAML, one line a joint."""
    stream = io.StringIO()
    yaml = YAML(typ="safe", pure=True)
    yaml.default_flow_style = None
    yaml.width = 10_000
    yaml.sort_base_mapping_type_on_output = False  # type: ignore[assignment]
    # After the choices above, which the first use of the representer takes over.
    yaml.representer.add_representer(Message, SafeRepresenter.represent_str)
    yaml.dump(mapping, stream)
    return stream.getvalue()


def to_csv(
    table: DHTable,
    *,
    degrees: bool = False,
    language: Language = ENGLISH,
    commas: bool = False,
) -> str:
    """Write the rows as CSV; base and tool become fixed rows.

    Args:
        table: The table.
        degrees: Whether angles are in degrees.
        language: Of the names of columns and joint types.
        commas: Whether numbers have decimal commas, and cells semicolons between them.
    """
    table = with_fixed_rows(table)
    columns = [*_columns(table), "offset", "sign", *LIMIT_FIELDS, *_dependences(table)]
    stream = io.StringIO()
    writer = csv.writer(stream, delimiter=";" if commas else ",", lineterminator="\n")
    writer.writerow([language.heading(column) for column in columns])
    for item in _items(table, degrees):
        cells = {**item, **item.get("limits", {}), "type": language.word("type", item["type"])}
        texts = [_exact(cells.get(column)) for column in columns]
        if commas:
            floats = [isinstance(cells.get(column), float) for column in columns]
            pairs = zip(texts, floats, strict=True)
            texts = [text.replace(".", ",") if is_float else text for text, is_float in pairs]
        writer.writerow(texts)
    return stream.getvalue()


def to_text(found: Extraction | DHTable, *, degrees: bool = False, explained: bool = False) -> str:
    """Write a table for a terminal: aligned columns, base, tool, residual, steps."""
    table = found if isinstance(found, DHTable) else found.table
    angle = "deg" if degrees else "rad"
    columns = [*_columns(table), "offset", "sign", "lower", "upper", *_dependences(table)]
    rows = [columns]
    for item in _items(table, degrees):
        cells = {**item, **item.get("limits", {})}
        rows.append([_short(cells.get(column)) for column in columns])
    lines: list[str] = [
        say("{name}, {convention}", name=table.name, convention=_TITLES[table.convention]),
        say("angles in {angle}, lengths in m", angle=angle),
        "",
    ]
    lines += _aligned(rows)
    for name, placement in (("base", table.base), ("tool", table.tool)):
        if np.array_equal(placement, np.eye(4)):
            lines.append(say("{name}: identity", name=name))
        else:
            matrix = [[f"{round(value, 9) + 0.0:.9f}" for value in row] for row in placement]
            lines += [f"{name}:", *("  " + line for line in _aligned(matrix, right=True))]
    mapping = document(found, degrees=degrees, explained=explained)
    if "residual" in mapping:
        residual = mapping["residual"]
        lines.append(
            say(
                "residual: {residual:.1e} m, {residual_2:.1e} {angle} over {residual_3} random q",
                residual=residual["position"],
                residual_2=residual["orientation"],
                angle=angle,
                residual_3=residual["configurations"],
            )
        )
    lines += [say("warning: {warning}", warning=warning) for warning in table.warnings]
    if "explanation" in mapping:
        lines += ["", say("How it was found:")]
        lines += [
            say("{frame}. {words}", frame=step["frame"], words=step["words"])
            for step in mapping["explanation"]
        ]
    return chained("\n", lines) + "\n"


def with_fixed_rows(table: DHTable) -> DHTable:
    """Return the same chain with identity base and tool, which become fixed rows."""
    names = {row.name for row in table.rows}
    before = _fixed_rows(table.base, table.convention, "base", names)
    after = _fixed_rows(table.tool, table.convention, "tool", names)
    shift, tip = len(before), table.tip_row
    rows = [replace(row, parent=n) for n, row in enumerate(before)]
    rows += [replace(row, parent=row.parent + shift) for row in table.rows]
    end = len(rows)
    for n, row in enumerate(after):
        rows.append(replace(row, parent=end + n if n else tip + shift))
    return replace(table, rows=tuple(rows), base=np.eye(4), tool=np.eye(4))


def _fixed_rows(T: Matrix, convention: Convention, name: str, names: set[str]) -> list[DHRow]:
    """Return fixed rows whose product is T: origin in cylinder coordinates, then ZXZ angles."""
    if np.array_equal(T, np.eye(4)):
        return []
    phi = math.atan2(T[1, 3], T[0, 3])
    rho = math.hypot(T[0, 3], T[1, 3])
    phi = phi if rho else 0.0
    across = math.hypot(T[0, 2], T[1, 2])
    first = math.atan2(T[0, 2], -T[1, 2]) if across else 0.0
    tilt = math.atan2(across, T[2, 2])
    # Computed from the remaining rotation, so that it is exact for a small tilt of z too.
    cos, sin = math.cos(first), math.sin(first)
    x = np.array([cos, sin, 0.0])
    y = np.array([-sin * math.cos(tilt), cos * math.cos(tilt), math.sin(tilt)])
    last = math.atan2(float(y @ T[:3, 0]), float(x @ T[:3, 0]))
    turns, lengths = (phi, first - phi, last), (float(T[2, 3]), 0.0, 0.0)
    steps = ((rho, 0.0), (0.0, tilt))
    shifted = (
        ((0.0, 0.0), *steps) if convention is not Convention.STANDARD else (*steps, (0.0, 0.0))
    )
    rows = []
    for n, (theta, d, (a, alpha)) in enumerate(zip(turns, lengths, shifted, strict=True), start=1):
        label = f"{name}_{n}"
        while label in names:
            label += "_"
        names.add(label)
        rows.append(DHRow(label, JointType.FIXED, alpha, a, d, theta, 0))
    kept = [row for row in rows if row.theta or row.d or row.a or row.alpha]
    return kept or rows[:1]


def _columns(table: DHTable) -> list[str]:
    if table.convention is not Convention.KHALIL:
        return ["name", "type", "alpha", "a", "d", "theta"]
    tree = any(row.gamma or row.b or row.parent != n for n, row in enumerate(table.rows))
    branch = ["ant", "gamma", "b"] if tree else []
    return ["name", "type", *branch, "alpha", "d", "theta", "r"]


def _items(table: DHTable, degrees: bool) -> list[dict[str, Any]]:
    items = []
    for item, row in zip(table_to_mapping(table)["joints"], table.rows, strict=True):
        cells = _degrees(item, row, table) if degrees else item
        cells = {"ant": row.parent, "gamma": 0.0, "b": 0.0, **cells}
        if "mimic" in cells:
            mimic = cells["mimic"]
            leader = _variable(table, mimic["joint"])
            constant = number_text(mimic["offset"])
            cells["mimic"] = sum_text([(leader, mimic["multiplier"])], constant)
        if "coupling" in cells:
            terms = [(_variable(table, name), c) for name, c in cells["coupling"].items()]
            cells["coupling"] = sum_text(terms)
        items.append(cells)
    return items


def _dependences(table: DHTable) -> list[str]:
    """Return the columns that say what joints depend on, where one does."""
    found = []
    if any(row.mimic is not None for row in table.rows):
        found.append("mimic")
    if any(row.coupling for row in table.rows):
        found.append("coupling")
    return found


def _variable(table: DHTable, name: str) -> str:
    return f"q{next(k for k, row in enumerate(table.rows, start=1) if row.name == name)}"


def _degrees(item: dict[str, Any], row: DHRow, table: DHTable) -> dict[str, Any]:
    """Return a row of a document with its angles in degrees."""
    turns = {other.name: other.type.is_revolute for other in table.rows}

    def per_degree(coefficient: float, leader: str) -> float:
        return coefficient_in(
            DEGREES,
            coefficient,
            turns=row.type.is_revolute,
            leader_turns=turns[leader],
        )

    angles = {"alpha", "theta", "gamma"} | ({"offset"} if row.type.is_revolute else set())
    turned = {key: in_degrees(x) if key in angles else x for key, x in item.items()}
    if "limits" in item and row.type.is_revolute:
        turned["limits"] = {
            key: x if key == "effort" else in_degrees(x) for key, x in item["limits"].items()
        }
    if row.mimic is not None:
        offset = row.mimic.offset
        turned["mimic"] = {
            "joint": row.mimic.joint,
            "multiplier": per_degree(row.mimic.multiplier, row.mimic.joint),
            "offset": in_degrees(offset) if row.type.is_revolute else offset,
        }
    if row.coupling:
        turned["coupling"] = {name: per_degree(c, name) for name, c in row.coupling}
    return turned


def _plain(vector: Matrix) -> list[float]:
    return [0.0 if abs(value) < 1e-15 else float(value) for value in vector]


def _exact(value: object) -> str:
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def _short(value: object) -> str:
    if value is None:
        return "-"
    return f"{0.0 if abs(value) < 5e-13 else value:.9g}" if isinstance(value, float) else str(value)


def _aligned(rows: list[list[str]], *, right: bool = False) -> list[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    pad = str.rjust if right else str.ljust
    padded = [[pad(cell, w) for cell, w in zip(row, widths, strict=True)] for row in rows]
    return ["  ".join(cells).rstrip() for cells in padded]
