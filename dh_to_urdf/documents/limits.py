"""The limits of a joint in a row of a document -> :class:`Limits`, in rad, m, N and N m."""

from __future__ import annotations

from collections.abc import Mapping

from dh_to_urdf.cells.expressions import CellError, Quantity, parse_cell
from dh_to_urdf.cells.values import Values
from dh_to_urdf.documents.checks import Report, Units, refuse_unknown
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.table import JointType, Limits

LIMIT_FIELDS = ("lower", "upper", "velocity", "effort")


def read_limits(
    raw: object,
    type_: JointType,
    units: Units,
    values: Values,
    location: Location,
    label: str,
    report: Report,
) -> Limits:
    """Read ``{"lower", "upper", "velocity", "effort"}``; None is no limits.

    Args:
        raw: The value in the document.
        type_: How the joint moves.
        units: Units of plain numbers.
        values: What names in the cells stand for.
        location: Where it stands in the document.
        label: What messages call the joint.
        report: Receives faults.

    Returns:
        The limits, without those that are at fault.
    """
    if raw is None:
        return Limits()
    if not isinstance(raw, Mapping):
        report.add(
            location,
            say("{label}: limits is {raw}; give lower and upper", label=label, raw=quoted(raw)),
        )
        return Limits()
    refuse_unknown(raw, LIMIT_FIELDS, location, say("{label}: limits", label=label), report)
    quantity = Quantity.LENGTH if type_ is JointType.PRISMATIC else Quantity.ANGLE
    found: dict[str, float | None] = {}
    for key in LIMIT_FIELDS:
        found[key] = None
        if raw.get(key) is None:
            continue
        of = Quantity.NUMBER if key == "effort" else quantity
        try:
            cell = parse_cell(raw[key], of, units.of(of), values, units.angle)
        except CellError as error:
            report.add(
                (*location, key),
                say("{label}: limits.{key} {error}", label=label, key=key, error=error),
            )
            continue
        if cell.variable is not None:
            report.add(
                (*location, key),
                say("{label}: limits.{key} holds a joint variable", label=label, key=key),
            )
        elif key in ("velocity", "effort") and cell.value < 0:
            report.add(
                (*location, key), say("{label}: limits.{key} is negative", label=label, key=key)
            )
        found[key] = cell.value
        if key in ("lower", "upper"):
            report.doubts.cell(
                cell, of, say("{key} limit of {label}", key=key, label=label), limit=True
            )
    _check_range(raw, found, type_, location, label, report)
    return Limits(**found)


def _check_range(
    raw: Mapping[str, object],
    found: Mapping[str, float | None],
    type_: JointType,
    location: Location,
    label: str,
    report: Report,
) -> None:
    """Report lower and upper where one is missing, they are swapped, or the type has none."""
    if (raw.get("lower") is None) != (raw.get("upper") is None):
        missing = "lower" if raw.get("lower") is None else "upper"
        report.add(
            (*location, missing),
            say(
                "{label}: limits.{missing} is missing; give both or none",
                label=label,
                missing=missing,
            ),
        )
    lower, upper = found["lower"], found["upper"]
    if lower is None or upper is None:
        return
    if type_ in (JointType.CONTINUOUS, JointType.FIXED):
        report.add(
            location,
            say(
                "{label}: a {type} joint has no lower and upper limits; use revolute",
                label=label,
                type=type_,
            ),
        )
    elif lower > upper:
        report.add(
            (*location, "lower"),
            say(
                "{label}: limits.lower {raw} is above upper {raw_2}; swap them",
                label=label,
                raw=quoted(raw["lower"]),
                raw_2=quoted(raw["upper"]),
            ),
        )
