"""Placements and inertials of a document -> matrices and :class:`Inertial`, in m, rad and kg."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeGuard

import numpy as np

from dh_to_urdf.cells.doubts import Doubts, Note
from dh_to_urdf.cells.expressions import CellError, Quantity, parse_cell
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from dh_to_urdf.poses import (
    Matrix,
    from_xyz_quaternion,
    from_xyz_rpy,
    is_mended,
    rigid_transform,
)
from dh_to_urdf.table import Inertial

AddFault = Callable[[Location, str], None]

_INERTIA_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
INERTIAL_FIELDS = ("mass", "com", "inertia")


def read_placement(
    raw: object,
    location: Location,
    angle: float,
    length: float,
    add: AddFault,
    warnings: list[str],
    doubts: Doubts,
) -> Matrix:
    """Read ``{"matrix": …}``, ``{"xyz", "rpy"}`` or ``{"xyz", "quaternion_xyzw"}``.

    Args:
        raw: The value in the document; None is the identity.
        location: Where it stands in the document.
        angle: Factor of the document's angles to rad.
        length: Factor of the document's lengths to m; it applies to a matrix' last column too.
        add: Receives faults.
        warnings: Receives what had to be mended.
        doubts: Receives values that are probably meant in another unit.

    Returns:
        A 4x4 matrix, the identity where there is a fault.
    """
    name = str(location[-1])
    if raw is None:
        return np.eye(4)
    forms = say('give {{"xyz": [x, y, z], "rpy": [r, p, y]}} or {{"matrix": 4x4}}')
    if isinstance(raw, list):
        raw = {"matrix": raw}
    if not isinstance(raw, Mapping):
        add(location, say("{name} is {raw}; {forms}", name=name, raw=quoted(raw), forms=forms))
        return np.eye(4)
    unknown = [key for key in raw if key not in ("matrix", "xyz", "rpy", "quaternion_xyzw")]
    if unknown:
        add(
            location,
            say(
                "{name} has an unknown field {unknown}; {forms}",
                name=name,
                unknown=quoted(unknown[0]),
                forms=forms,
            ),
        )
        return np.eye(4)
    if "matrix" in raw and len(raw) > 1:
        add(
            location,
            say(
                "{name} has a matrix and {count} other field(s); give one form",
                name=name,
                count=len(raw) - 1,
            ),
        )
        return np.eye(4)
    if "rpy" in raw and "quaternion_xyzw" in raw:
        add(location, say("{name} has rpy and quaternion_xyzw; give one of them", name=name))
        return np.eye(4)
    try:
        if "matrix" in raw:
            return _from_matrix(raw["matrix"], location, length, warnings, doubts)

        def note(quantity: Quantity, names: tuple[str, str, str]) -> Note:
            # A base may stand far off in its hall.
            far = quantity is Quantity.LENGTH and name == "base"
            return lambda k, cell: doubts.cell(
                cell, quantity, say("{name} of {name_2}", name=names[k], name_2=name), limit=far
            )

        xyz = read_vector(
            raw.get("xyz", [0, 0, 0]),
            "xyz",
            3,
            Quantity.LENGTH,
            length,
            note(Quantity.LENGTH, ("x", "y", "z")),
        )
        if "quaternion_xyzw" in raw:
            quaternion = read_vector(
                raw["quaternion_xyzw"], "quaternion_xyzw", 4, Quantity.NUMBER, 1.0
            )
            return from_xyz_quaternion(xyz, quaternion)
        rpy = read_vector(
            raw.get("rpy", [0, 0, 0]),
            "rpy",
            3,
            Quantity.ANGLE,
            angle,
            note(Quantity.ANGLE, ("roll", "pitch", "yaw")),
        )
        return from_xyz_rpy(xyz, rpy)
    except ValueError as error:
        add(location, say("{name}: {error}", name=name, error=error))
        return np.eye(4)


def _from_matrix(
    raw: object, location: Location, length: float, warnings: list[str], doubts: Doubts
) -> Matrix:
    if not (isinstance(raw, list) and len(raw) == 4 and all(isinstance(r, list) for r in raw)):
        raise ValueError(say("matrix is not four rows of four numbers"))
    rows = [read_vector(row, "matrix", 4, Quantity.NUMBER, 1.0) for row in raw]
    matrix = np.array(rows) + 0.0
    if length != 1.0:
        matrix[:3, 3] /= round(1.0 / length)
    name = str(location[-1])
    for axis, value in zip("xyz", matrix[:3, 3].tolist(), strict=True):
        doubts.length(
            value,
            say("{axis} of {name}", axis=axis, name=name),
            limit=name == "base",
            in_mm=length != 1.0,
        )
    try:
        T = rigid_transform(matrix)
    except ValueError as error:
        raise ValueError(say("matrix {error}", error=error)) from None
    if is_mended(matrix):
        change = float(np.abs(T - matrix).max())
        warnings.append(
            say(
                "{name}: the matrix is rounded; its nearest rotation is used ({change:.1e})",
                name=name,
                change=change,
            )
        )
    return T


def read_vector(
    raw: object,
    what: str,
    size: int,
    quantity: Quantity,
    unit: float,
    note: Note | None = None,
) -> list[float]:
    """Read a list of numbers, or of texts such as ``pi/2``.

    Args:
        raw: The value in the document.
        what: Its name, for the message.
        size: How many numbers it must hold.
        quantity: What they measure.
        unit: Factor of the document's unit to rad or m.
        note: Takes each cell with its place.

    Raises:
        ValueError: Not such a list.
    """
    if not isinstance(raw, list) or len(raw) != size:
        raise ValueError(say("{what} is not a list of {size} numbers", what=what, size=size))
    values = []
    for k, item in enumerate(raw):
        try:
            cell = parse_cell(item, quantity, unit)
        except CellError as error:
            raise ValueError(say("{what} {error}", what=what, error=error)) from None
        if cell.variable is not None:
            raise ValueError(say("{what} holds a joint variable; give numbers", what=what))
        values.append(cell.value)
        if note is not None:
            note(k, cell)
    return values


def is_inertial(raw: object) -> TypeGuard[Mapping[str, object]]:
    """Return whether a value has the fields of an inertial."""
    return isinstance(raw, Mapping) and "mass" in raw and not set(raw) - set(INERTIAL_FIELDS)


def read_inertial(
    raw: Mapping[str, object], location: Location, length: float, add: AddFault
) -> Inertial | None:
    """Read ``{"mass": kg, "com": [x, y, z], "inertia": {"ixx": …} or 3x3}``.

    ``com`` is in the document's length unit, ``inertia`` always in kg m², about the centre of
    mass; both in the axes of frame k.

    Returns:
        The inertial, or None where there is a fault.
    """
    try:
        mass = read_vector([raw["mass"]], "mass", 1, Quantity.NUMBER, 1.0)[0]
        com = read_vector(raw.get("com", [0, 0, 0]), "com", 3, Quantity.LENGTH, length)
        inertia = _inertia(raw.get("inertia"))
    except ValueError as error:
        add(location, str(error))
        return None
    if mass < 0:
        add((*location, "mass"), say("mass is negative"))
        return None
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] < -1e-12 or moments[2] > (moments[0] + moments[1]) * (1 + 1e-6) + 1e-12:
        add(
            (*location, "inertia"),
            say(
                "no body has this inertia (its principal moments must be ≥ 0 and none above the"
                " sum of the others)"
            ),
        )
        return None
    rows = [tuple(float(value) for value in row) for row in inertia]
    return Inertial(mass, (com[0], com[1], com[2]), ((*rows[0],), (*rows[1],), (*rows[2],)))  # type: ignore[arg-type]


def _inertia(raw: object) -> Matrix:
    if raw is None:
        return np.zeros((3, 3))
    if isinstance(raw, Mapping):
        unknown = [key for key in raw if key not in _INERTIA_KEYS]
        if unknown:
            raise ValueError(
                say("inertia has an unknown field {unknown}", unknown=quoted(unknown[0]))
            )
        values = {
            key: read_vector(
                [raw.get(key, 0)], say("inertia.{key}", key=key), 1, Quantity.NUMBER, 1.0
            )[0]
            for key in _INERTIA_KEYS
        }
        return np.array([[values["i" + "".join(sorted(r + c))] for c in "xyz"] for r in "xyz"])
    if isinstance(raw, list) and len(raw) == 3:
        matrix = np.array([read_vector(row, "inertia", 3, Quantity.NUMBER, 1.0) for row in raw])
        if np.abs(matrix - matrix.T).max() > 1e-12:
            raise ValueError(say("inertia is not symmetric"))
        return matrix
    raise ValueError(say("inertia is neither a 3x3 matrix nor ixx, ixy, ixz, iyy, iyz, izz"))
