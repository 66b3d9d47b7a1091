"""The type of a joint in a row of a document: by its name or by SYMORO's sigma."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dh_to_urdf.documents.checks import Report, whole_number
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.table import Convention, JointType

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


def read_type(
    item: Mapping[Any, Any],
    convention: Convention,
    location: Location,
    label: str,
    report: Report,
) -> JointType | None:
    """Read ``type`` and, in the khalil convention, ``sigma`` of a row.

    Args:
        item: The row as written.
        convention: What the row means.
        location: Where the row stands in the document.
        label: What messages call the joint.
        report: Receives faults.

    Returns:
        The type, or None after reporting why not.
    """
    sigma_type = None
    if "sigma" in item and convention is Convention.KHALIL:
        sigma = whole_number(item["sigma"])
        sigma_type = _SIGMA.get(sigma) if sigma is not None else None
        if sigma_type is None:
            report.add(
                (*location, "sigma"),
                say(
                    "{label}: sigma is {item}; give 0 (revolute), 1 (prismatic) or 2 (fixed)",
                    label=label,
                    item=quoted(item["sigma"]),
                ),
            )
            return None
    raw = item.get("type")
    if raw is None:
        if sigma_type is None:
            report.add(
                (*location, "type"),
                say(
                    "{label}: type is missing; give revolute, prismatic, continuous or fixed",
                    label=label,
                ),
            )
        return sigma_type
    found = TYPE_ALIASES.get(raw.strip().lower()) if isinstance(raw, str) else None
    if found is None:
        report.add(
            (*location, "type"),
            say(
                "{label}: type is {raw}; give revolute, prismatic, continuous or fixed",
                label=label,
                raw=quoted(raw),
            ),
        )
    elif sigma_type is not None and (
        sigma_type is not found
        and not (sigma_type is JointType.REVOLUTE and found is JointType.CONTINUOUS)
    ):
        report.add(
            (*location, "sigma"),
            say(
                "{label}: sigma says {sigma_type} but type says {found}",
                label=label,
                sigma_type=sigma_type,
                found=found,
            ),
        )
        return None
    return found
