"""The mapping that JSON, YAML and CSV documents hold -> :class:`DHTable`.

Every fault carries the location of the cell, the joint's name and what to write instead.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from dh_to_urdf.cells.values import read_values, refuse_unused
from dh_to_urdf.documents.checks import NAME, NAME_RULE, Report, Units, refuse_unknown
from dh_to_urdf.documents.dependence import resolved
from dh_to_urdf.documents.placements import read_placement
from dh_to_urdf.documents.rows import RowReader
from dh_to_urdf.documents.topology import check_names, check_tree
from dh_to_urdf.errors import DHError, quoted
from dh_to_urdf.look_alikes import look_alikes
from dh_to_urdf.messages import chained, say
from dh_to_urdf.table import Convention, DHTable

MAX_ROWS = 300
DEFAULT_NAME = "robot"

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
_ANGLE_UNITS = {"rad": 1.0, "deg": math.pi / 180}
_LENGTH_UNITS = {"m": 1.0, "mm": 1e-3}
_TABLE_FIELDS = ("name", "convention", "units", "base", "tool", "joints", "values")
_NOTE_FIELDS = ("title", "description", "source")
_FINDING_FIELDS = ("residual", "warnings", "explanation")
"""Fields that an extraction adds; accepted and not read, so that its table can be sent back."""


def read_mapping(
    data: object,
    default_name: str | None = DEFAULT_NAME,
    columns: tuple[str, ...] | None = None,
) -> DHTable:
    """Read a table from the mapping that JSON and YAML documents hold.

    Args:
        data: The mapping; docs/tables.md and the OpenAPI schema ``DHTable`` describe it.
        default_name: Name for a table that gives none; None requires one.
        columns: Column names of a CSV document, to tell a missing column from an empty cell.

    Returns:
        The table, in SI units.

    Raises:
        DHError: With the location of each of the first ten faults.
    """
    if not isinstance(data, Mapping):
        raise DHError.single((), say("the document is not a mapping with convention and joints"))
    report = Report()
    refuse_unknown(
        data, (*_TABLE_FIELDS, *_NOTE_FIELDS, *_FINDING_FIELDS), (), say("the table"), report
    )
    name = data.get("name", default_name)
    if name is None:
        report.add(("name",), say("name is missing; {name_rule}", name_rule=NAME_RULE))
        name = DEFAULT_NAME
    elif not isinstance(name, str) or NAME.fullmatch(name) is None:
        report.add(
            ("name",), say("name is {name}; {name_rule}", name=quoted(name), name_rule=NAME_RULE)
        )
        name = DEFAULT_NAME
    convention = _convention(data, report)
    for key in _NOTE_FIELDS:
        if not isinstance(data.get(key, ""), str):
            report.add((key,), say("{key} is {data}; give a text", key=key, data=quoted(data[key])))
    units = read_units(data.get("units"), report)
    warnings = report.warnings
    base, tool = (
        read_placement(
            data.get(key), (key,), units.angle, units.length, report.add, warnings, report.doubts
        )
        for key in ("base", "tool")
    )
    values = read_values(data.get("values"))
    joints = data.get("joints")
    if not isinstance(joints, list) or not joints:
        report.add(
            ("joints",), say("joints is missing or empty; give a list with one entry a joint")
        )
        joints = []
    if len(joints) > MAX_ROWS:
        raise DHError.single(
            ("joints",),
            say(
                "joints has {count} rows; at most {max_rows} are read",
                count=len(joints),
                max_rows=MAX_ROWS,
            ),
        )
    report.raise_if_any()
    assert convention is not None
    reader = RowReader(convention, units, report, columns, values)
    rows = [row for k, item in enumerate(joints) if (row := reader.read(k, item)) is not None]
    check_names(rows, report)
    report.raise_if_any()
    check_tree(rows, report)
    report.raise_if_any()
    rows = resolved(rows, reader.dependences, units, report)
    report.raise_if_any()
    refuse_unused(values, report)
    report.raise_if_any()
    doubts = report.doubts.sentences()
    told = (*doubts, *look_alikes(say("joints"), [row.name for row in rows]), *warnings)
    return DHTable(name, convention, tuple(rows), base, tool, told, doubts)


def _convention(data: Mapping[Any, Any], report: Report) -> Convention | None:
    raw = data.get("convention")
    choices = say(
        "standard (distal, Paul), modified (proximal, Craig) or khalil (Khalil-Kleinfinger)"
    )
    if raw is None:
        report.add(("convention",), say("convention is missing; give {choices}", choices=choices))
        return None
    convention = CONVENTION_ALIASES.get(raw.strip().lower()) if isinstance(raw, str) else None
    if convention is None:
        report.add(
            ("convention",),
            say("convention {raw} is unknown; give {choices}", raw=quoted(raw), choices=choices),
        )
    return convention


def read_units(raw: object, report: Report) -> Units:
    """Read ``{"angle": "rad" | "deg", "length": "m" | "mm"}``; faults go to the report."""
    if raw is None:
        return Units()
    if not isinstance(raw, Mapping):
        report.add(
            ("units",), say('units is not a mapping; give {{"angle": "deg", "length": "mm"}}')
        )
        return Units()
    refuse_unknown(raw, ("angle", "length"), ("units",), "units", report)
    found = []
    for key, choices in (("angle", _ANGLE_UNITS), ("length", _LENGTH_UNITS)):
        unit = raw.get(key, next(iter(choices)))
        if not isinstance(unit, str) or unit not in choices:
            report.add(
                ("units", key),
                say(
                    "units.{key} is {unit}; give {choices}",
                    key=key,
                    unit=quoted(unit),
                    choices=chained(say(" or "), choices),
                ),
            )
            unit = next(iter(choices))
        found.append(choices[unit])
    return Units(*found)
