"""Twists and wrenches of requests."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.http.pointers import json_pointer
from app.http.strict_json import RowLengthError, decode_numbers, decode_rows
from app.operations.base import Context
from kinematics.spatial_vectors import spatial_vector
from kinematics.task import Task
from robots.robot import FloatArray

_ROWS = {"type": "array", "items": {"type": "number"}}
_SCHEMA = {"anyOf": [_ROWS, {"type": "array", "items": _ROWS, "minItems": 1}]}

TwistField = Annotated[
    msgspec.Raw,
    msgspec.Meta(
        description="One value a row of the task (pose: vx, vy, vz, wx, wy, wz), or a list of such"
        " lists. m/s and rad/s, or degrees with ?angle=deg.",
        extra_json_schema=_SCHEMA,
    ),
]
WrenchField = Annotated[
    msgspec.Raw,
    msgspec.Meta(
        description="fx, fy, fz, mx, my, mz that the frame exerts, or a list of such lists; N and"
        " N m.",
        extra_json_schema=_SCHEMA,
    ),
]


def read_vector(
    raw: msgspec.Raw, rows: Sequence[str], context: Context, argument: str
) -> FloatArray:
    """A twist or wrench of a request, shape (m,) or (n, m), in the units of the request.

    Raises:
        RequestProblem: Not numbers, or more rows than one request may hold.
        WrongVector: Not one value a row, or not finite.
    """
    text, pointer = bytes(raw), json_pointer((argument,))
    if text[:1] == b"[" and text[1:64].lstrip()[:1] == b"[":
        try:
            batch = decode_rows(text, pointer, len(rows), context.settings.max_batch)
        except RowLengthError as odd:
            return spatial_vector(odd.row, rows, argument, (odd.index,) if odd.index else ())
        return spatial_vector(batch, rows, argument)
    return spatial_vector(decode_numbers(text, pointer), rows, argument)


def angular_rows(task: Task) -> NDArray[np.bool_]:
    """True for the rows of a task that are angular."""
    return np.array([row >= 3 for row in task.rows])
