"""Twists, wrenches and small motions of requests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.fields import texts
from app.fields.field import Field, Parameter, Reading, declared
from app.http.pointers import json_pointer
from app.http.strict_json import RowLengthError, decode_numbers, decode_rows
from dh_to_urdf.errors import Location
from kinematics.spatial_vectors import WRENCH_ROWS, spatial_vector
from kinematics.task import Task
from robots.robot import FloatArray

_ROWS = {"type": "array", "items": {"type": "number"}}
_SCHEMA = {"anyOf": [_ROWS, {"type": "array", "items": _ROWS, "minItems": 1}]}


@dataclass(frozen=True)
class SpatialVectors(Field):
    """One value a row, or a batch.

    Attributes:
        rows: Names of the rows; empty: those of the field ``task``, of which the angular ones are
            in the angle unit of the request.
    """

    rows: tuple[str, ...] = ()

    @property
    def wire(self) -> Any:
        """The text itself, so that large batches are decoded piece by piece."""
        return msgspec.Raw

    @property
    def late(self) -> bool:
        """Batches may be large, and the task says how many rows there are."""
        return True

    @property
    def large(self) -> bool:
        """Batches may be large."""
        return True

    def resolve(self, value: Any, location: Location, reading: Reading) -> FloatArray:
        """Return an array of shape (m,) or (n, m), SI units.

        Raises:
            RequestProblem: Not numbers, or more rows than one request may hold.
            WrongVector: Not one value a row, or not finite.
        """
        task: Task | None = None if self.rows else reading.given["task"]
        rows = self.rows if task is None else task.row_names
        vectors = _vectors(value, rows, location, reading)
        return vectors if task is None else reading.units.rows_in(angular_rows(task), vectors)


def _vectors(value: Any, rows: Sequence[str], location: Location, reading: Reading) -> FloatArray:
    pointer, name = json_pointer(location), str(location[0])
    if not isinstance(value, msgspec.Raw):
        return spatial_vector(value, rows, name)
    text = bytes(value)
    if text[:1] == b"[" and text[1:64].lstrip()[:1] == b"[":
        try:
            batch = decode_rows(text, pointer, len(rows), reading.settings.max_batch)
        except RowLengthError as odd:
            place = (odd.index,) if odd.index else ()
            return spatial_vector(odd.row, rows, name, place)
        return spatial_vector(batch, rows, name)
    return spatial_vector(decode_numbers(text, pointer), rows, name)


def angular_rows(task: Task) -> NDArray[np.bool_]:
    """Return which rows of a task are angular."""
    return np.array([row >= 3 for row in task.rows])


Twist: TypeAlias = Annotated[
    FloatArray,
    declared(
        SpatialVectors((Parameter(texts.twist, "vx,vy,vz,wx,wy,wz, or one value a task row."),)),
        "One value a row of the task (pose: vx, vy, vz, wx, wy, wz), or a list of such lists. m/s"
        " and rad/s, or degrees with ?angle=deg.",
        _SCHEMA,
    ),
]
Wrench: TypeAlias = Annotated[
    FloatArray,
    declared(
        SpatialVectors(
            (Parameter(texts.scalars, "fx,fy,fz,mx,my,mz, in N and N m."),), rows=WRENCH_ROWS
        ),
        "fx, fy, fz, mx, my, mz that the frame exerts, or a list of such lists; N and N m.",
        _SCHEMA,
    ),
]
