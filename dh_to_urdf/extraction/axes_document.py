"""Joint axes as measured on a drawing -> :class:`SerialChain`.

``{"joints": [{"name", "type", "point": [x, y, z], "direction": [x, y, z], "limits"}], "tip"}``,
everything at q = 0 in base axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.cells.values import Values
from dh_to_urdf.documents.checks import NAME, NAME_RULE, Report, Units, refuse_unknown
from dh_to_urdf.documents.mapping import DEFAULT_NAME, read_units
from dh_to_urdf.documents.placements import read_placement, read_vector
from dh_to_urdf.documents.rows import RowReader
from dh_to_urdf.documents.topology import check_names
from dh_to_urdf.errors import DHError, Location, quoted
from dh_to_urdf.extraction.axes import AxisLine, SerialChain, chain_from_lines
from dh_to_urdf.messages import say
from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, JointType

MAX_AXES = 64
SHORTEST = 1e-9
_FIELDS = ("name", "units", "joints", "tip", "title", "description", "source")


def read_axes(data: object) -> SerialChain:
    """Read a document of joint axes.

    Args:
        data: The mapping. ``point`` in the document's length unit; ``direction`` of any length
            but zero; ``type`` revolute, prismatic or continuous; ``name`` and ``limits`` as in a
            table; ``tip`` a pose as in a table's ``tool``, default the last point with z along
            the last axis.

    Returns:
        The chain from the base to the tip.

    Raises:
        DHError: With the location of each of the first ten faults.
    """
    if not isinstance(data, Mapping):
        raise DHError.single((), say("the document is not a mapping with joints"))
    report = Report()
    refuse_unknown(data, _FIELDS, (), say("the document"), report)
    name = data.get("name", DEFAULT_NAME)
    if not isinstance(name, str) or NAME.fullmatch(name) is None:
        report.add(
            ("name",), say("name is {name}; {name_rule}", name=quoted(name), name_rule=NAME_RULE)
        )
    units = read_units(data.get("units"), report)
    joints = data.get("joints")
    if not isinstance(joints, list) or not joints:
        report.add(
            ("joints",), say("joints is missing or empty; give a list with one entry a joint")
        )
        joints = []
    if len(joints) > MAX_AXES:
        raise DHError.single(
            ("joints",),
            say(
                "joints has {count} entries; at most {max_axes} are read",
                count=len(joints),
                max_axes=MAX_AXES,
            ),
        )
    reader = RowReader(Convention.MODIFIED, units, report, None, Values())
    lines = [_line(k, item, reader, units, report) for k, item in enumerate(joints)]
    tip = None
    if data.get("tip") is not None:
        tip = read_placement(
            data["tip"],
            ("tip",),
            units.angle,
            units.length,
            report.add,
            report.warnings,
            report.doubts,
        )
    report.raise_if_any()
    found = [line for line, _ in (pair for pair in lines if pair is not None)]
    check_names([row for _, row in (pair for pair in lines if pair is not None)], report)
    report.raise_if_any()
    if tip is None:
        report.warnings.append(
            say("no tip is given; it is put at the last point, z along the last axis")
        )
        tip = _default_tip(found[-1])
    told = (*report.doubts.sentences(), *report.warnings)
    return chain_from_lines(str(name), found, tip, told)


def _line(
    k: int, item: object, reader: RowReader, units: Units, report: Report
) -> tuple[AxisLine, DHRow] | None:
    known = len(report.faults)
    if not isinstance(item, Mapping):
        report.add(
            ("joints", k),
            say(
                "joint {k} is {item}; give a mapping with point, direction",
                k=k + 1,
                item=quoted(item),
            ),
        )
        return None
    location, label = ("joints", k), say("joint {k}", k=k + 1)
    refuse_unknown(item, ("name", "type", "point", "direction", "limits"), location, label, report)
    geometry = ("alpha", "a", "d", "theta")
    rest = {key: item[key] for key in ("name", "type", "limits") if key in item}
    row = reader.read(k, {**dict.fromkeys(geometry, 0), **rest})
    if row is not None and row.type is JointType.FIXED:
        report.add(
            (*location, "type"),
            say("{label}: a fixed joint has no axis; leave it out", label=label),
        )
    point = _vector(item, "point", Quantity.LENGTH, units.length, location, label, report)
    direction = _vector(item, "direction", Quantity.NUMBER, 1.0, location, label, report)
    norm = float(np.linalg.norm(direction))
    if len(report.faults) == known and norm < SHORTEST:
        report.add(
            (*location, "direction"),
            say("{label}: direction is zero; give one such as [0, 0, 1]", label=label),
        )
    if len(report.faults) > known or row is None:
        return None
    return AxisLine(row.name, row.type, point, direction / norm, row.limits), row


def _vector(
    item: Mapping[Any, Any],
    key: str,
    quantity: Quantity,
    unit: float,
    location: Location,
    label: str,
    report: Report,
) -> Matrix:
    if key not in item:
        report.add(
            (*location, key), say("{label}: {key} is missing; give [x, y, z]", label=label, key=key)
        )
        return np.zeros(3)
    try:
        return np.array(read_vector(item[key], key, 3, quantity, unit))
    except ValueError as error:
        report.add((*location, key), say("{label}: {error}", label=label, error=error))
        return np.zeros(3)


def _default_tip(line: AxisLine) -> Matrix:
    """Return the last point with z along the last axis, x nearest to the base's x (else y)."""
    z = line.direction
    helper = np.eye(3)[0 if abs(z[0]) < 0.9 else 1]
    x = helper - (helper @ z) * z
    x /= np.linalg.norm(x)
    tip = np.eye(4)
    tip[:3, 0], tip[:3, 1], tip[:3, 2], tip[:3, 3] = x, np.cross(z, x), z, line.point
    return tip
