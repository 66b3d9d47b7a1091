"""DHTable -> the mapping of a document, with all digits, in rad and m."""

from __future__ import annotations

from typing import Any

import numpy as np

from dh_to_urdf.poses import Matrix
from dh_to_urdf.table import Convention, DHRow, DHTable, JointType


def table_to_mapping(table: DHTable) -> dict[str, Any]:
    """Write the document of a table; ``read_mapping`` gives the same table, bit for bit.

    Args:
        table: The table.

    Returns:
        Plain dicts, lists, strings and floats, in the shape of a JSON or YAML table.
    """
    document: dict[str, Any] = {
        "name": table.name,
        "convention": table.convention.value,
        "units": {"angle": "rad", "length": "m"},
    }
    for key, placement in (("base", table.base), ("tool", table.tool)):
        if not np.array_equal(placement, np.eye(4)):
            document[key] = {"matrix": _plain(placement)}
    document["joints"] = [_row(k, row, table.convention) for k, row in enumerate(table.rows)]
    return document


def _row(k: int, row: DHRow, convention: Convention) -> dict[str, Any]:
    x_column, z_column = ("d", "r") if convention is Convention.KHALIL else ("a", "d")
    mapping: dict[str, Any] = {"name": row.name, "type": row.type.value}
    if row.parent != k:
        mapping["ant"] = row.parent
    if row.gamma or row.b:
        mapping.update(gamma=row.gamma, b=row.b)
    mapping.update({"alpha": row.alpha, x_column: row.a, z_column: row.d, "theta": row.theta})
    if row.type is not JointType.FIXED:
        mapping.update(offset=row.offset, sign=row.sign)
    limits = {
        key: value
        for key in ("lower", "upper", "velocity", "effort")
        if (value := getattr(row.limits, key)) is not None
    }
    if limits:
        mapping["limits"] = limits
    if row.mimic is not None:
        mapping["mimic"] = {
            "joint": row.mimic.joint,
            "multiplier": row.mimic.multiplier,
            "offset": row.mimic.offset,
        }
    if row.coupling:
        mapping["coupling"] = dict(row.coupling)
    if row.symbols:
        letters = {"a": x_column, "d": z_column}
        mapping["symbols"] = {letters.get(key, key): name for key, name in row.symbols}
    if row.inertial is not None:
        mapping["inertial"] = {
            "mass": row.inertial.mass,
            "com": list(row.inertial.com),
            "inertia": [list(line) for line in row.inertial.inertia],
        }
    if not row.visual:
        mapping["visual"] = False
    return mapping


def _plain(matrix: Matrix) -> list[list[float]]:
    return [[float(value) for value in row] for row in matrix]
