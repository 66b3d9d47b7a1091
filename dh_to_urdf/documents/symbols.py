"""Names of lengths in a table: ``L1`` in a cell, or in the field ``symbols`` of a row."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from dh_to_urdf.cells.expressions import Cell
from dh_to_urdf.cells.values import Values
from dh_to_urdf.documents.checks import Report
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say

_SIGNED = re.compile(r"\s*([+\-−–]?)\s*([^\W\d_]\w{0,31})\s*")
RULE = say("give the name of a length, such as L1 or -L1")


def symbol_of(cell: Cell, values: Values, spellings: dict[str, str]) -> str:
    """Return the name that is all of a cell, with its sign; empty where it holds anything else.

    Args:
        cell: The cell.
        values: What names stand for.
        spellings: First spelling of each name, as ``L_1`` and ``L1`` are one; grows.
    """
    found = _SIGNED.fullmatch(cell.text)
    key = "" if found is None else found[2].replace("_", "")
    if found is None or key not in values:
        return ""
    name = spellings.setdefault(key, found[2])
    return name if found[1] in ("", "+") else f"-{name}"


def read_symbols(
    raw: object, columns: Mapping[str, str], location: Location, label: str, report: Report
) -> dict[str, str]:
    """Read the field ``symbols`` of a row: names by column, ``{"a": "L1"}``.

    Args:
        raw: The field.
        columns: What columns of the document are called in a row: ``r`` of khalil is ``d``.
        location: Where it stands.
        label: What messages call the row.
        report: Takes the faults.
    """
    if raw is None:
        return {}
    if not isinstance(raw, Mapping):
        report.add(
            location,
            say('{label}: symbols is {raw}; give {{"a": "L1"}}', label=label, raw=quoted(raw)),
        )
        return {}
    found: dict[str, str] = {}
    items: Mapping[Any, Any] = raw
    for key, name in items.items():
        if key not in columns:
            report.add(
                (*location, str(key)),
                say(
                    "{label}: symbols names {key}, which is no length of the table; give {columns}",
                    label=label,
                    key=quoted(key),
                    columns=", ".join(columns),
                ),
            )
        elif not isinstance(name, str) or _SIGNED.fullmatch(name) is None:
            report.add(
                (*location, str(key)),
                say(
                    "{label}: symbols.{key} is {name}; {rule}",
                    label=label,
                    key=key,
                    name=quoted(name),
                    rule=RULE,
                ),
            )
        else:
            found[columns[key]] = name.strip()
    return found
