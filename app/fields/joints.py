"""Joint values of requests: one q, a batch, or values by joint name -> arrays in rad and m."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, TypeAlias

import msgspec
import numpy as np

from app.fields import texts
from app.fields.bounds import is_number
from app.fields.field import Field, Parameter, Reading, Text, declared
from app.http.pointers import json_pointer
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.strict_json import (
    PIECE,
    RowLengthError,
    decode_json,
    decode_numbers,
    decode_rows,
)
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.configuration import Given, configuration, configuration_by_name
from robots.robot import FloatArray

_ONE = {"type": "array", "items": {"type": "number"}}
_BY_NAME = {"type": "object", "additionalProperties": {"type": "number"}}
_BATCH = {"type": "array", "items": _ONE, "minItems": 1}


@dataclass(frozen=True)
class JointField(Field):
    """One value a joint, in the robot's order or by name.

    Attributes:
        many: Whether a batch is taken too, shape (n, dof).
        angular: Whether values of revolute joints are in the angle unit of the request.
        optional: Whether it may be left out or null.
        posture: Whether it says where the joints are, so that their limits matter.
        given: What the values are, for those of joints that follow others.
    """

    many: bool = True
    angular: bool = True
    optional: bool = False
    posture: bool = True
    given: Given = Given.VALUE

    @property
    def wire(self) -> Any:
        """The text itself, so that large batches are decoded piece by piece."""
        return msgspec.Raw

    @property
    def late(self) -> bool:
        """Batches may be large."""
        return True

    @property
    def large(self) -> bool:
        """Batches may be large."""
        return self.many

    def resolve(self, value: Any, location: Location, reading: Reading) -> FloatArray | None:
        """Return an array of shape (dof,) or (n, dof), rad and m; None where nothing is given.

        Raises:
            RequestProblem: Not numbers, more rows than one request may hold, or a batch where one
                list is taken.
            WrongConfiguration: It does not fit the robot.
        """
        raw = isinstance(value, msgspec.Raw)
        if value is None or (self.optional and raw and bytes(value) == b"null"):
            return None
        q = self._array(value, location, reading)
        if q.ndim != 1 and not self.many:
            message = say("{location} is a batch; give one list", location=location[-1])
            raise RequestProblem(INVALID_REQUEST, message, json_pointer(location))
        found = reading.units.joints_in(reading.robot, q) if self.angular else q
        if self.posture:
            reading.doubts.configuration(q, found, str(location[-1]))
        return found

    def _array(self, value: Any, location: Location, reading: Reading) -> FloatArray:
        most = reading.settings.max_batch
        name, *rest = location
        name, index = str(name), tuple(rest)
        if isinstance(value, msgspec.Raw):
            value = _from_json(bytes(value), location, reading, self.given)
        q = configuration(reading.robot, value, name, index)
        if q.ndim == 2 and not 1 <= len(q) <= most:
            message = say(
                "{location} holds {count} rows; give 1 to {most}",
                location=location[-1],
                count=len(q),
                most=most,
            )
            raise RequestProblem(INVALID_REQUEST, message, json_pointer(location))
        return q


def _from_json(text: bytes, location: Location, reading: Reading, given: Given) -> Any:
    pointer, name, robot = json_pointer(location), location[-1], reading.robot
    if text[:1] == b"{":
        return _by_name(text, location, reading, given)
    if text[:1] != b"[":
        shown = text[:32].decode(errors="replace")
        message = say(
            "{name} is {shown}; give a list of numbers, one a joint", name=name, shown=shown
        )
        raise RequestProblem(INVALID_REQUEST, message, pointer)
    if text[1:64].lstrip()[:1] == b"[":
        try:
            return decode_rows(text, pointer, robot.dof, reading.settings.max_batch)
        except RowLengthError as odd:
            return configuration(robot, odd.row, str(name), (odd.index,))
    return decode_numbers(text, pointer)


def _by_name(text: bytes, location: Location, reading: Reading, given: Given) -> FloatArray:
    pointer, name = json_pointer(location), location[-1]
    if len(text) > PIECE:
        message = say("{name} has {count} bytes; name each joint once", name=name, count=len(text))
        raise RequestProblem(INVALID_REQUEST, message, pointer)
    values = decode_json(text, dict[str, Any], pointer)
    for joint, value in values.items():
        if not is_number(value):
            raise RequestProblem(
                INVALID_REQUEST,
                say(
                    "{name} of joint {joint} is {value}; give a number",
                    name=name,
                    joint=joint[:64],
                    value=quoted(value),
                ),
                json_pointer((*location, joint)),
            )
    angle = float(np.pi / 180) if reading.units.degrees and given is not Given.EFFORT else 1.0
    return configuration_by_name(reading.robot, values, str(name), given=given, angle=angle)


def is_one(q: object) -> bool:
    """Return whether an array of joint values is one configuration, not a batch."""
    return isinstance(q, np.ndarray) and q.ndim == 1


_Q_TEXT = "Joint values, one a joint in the robot's order: a list, "
_UNITS = "rad and m, or degrees with ?angle=deg."
_MANY = f"{_Q_TEXT}a batch (list of lists), or an object {{joint name: value}}. {_UNITS}"
_SINGLE = f"{_Q_TEXT}or an object {{joint name: value}}. {_UNITS}"
_Q_QUERY = "Joint values, comma-separated, in the robot's order; pi/2 and 90deg are read too."


def _meta(
    query: str, text: str, field: JointField, read: Text = texts.joint_values
) -> msgspec.Meta:
    schemas: list[dict[str, Any]] = [_ONE, *([_BATCH] if field.many else []), _BY_NAME]
    if field.optional:
        schemas.append({"type": "null"})
    parameters = (Parameter(read, query),) if query else ()
    return declared(replace(field, parameters=parameters), text, {"anyOf": schemas})


def optional_configuration(query: str, text: str, *, posture: bool = True) -> msgspec.Meta:
    """Return the annotation of one q that may be left out, with its texts for the documents."""
    return _meta(query, text, JointField(many=False, optional=True, posture=posture))


Configuration: TypeAlias = Annotated[FloatArray, _meta(_Q_QUERY, _MANY, JointField())]
SingleConfiguration: TypeAlias = Annotated[
    FloatArray, _meta(_Q_QUERY, _SINGLE, JointField(many=False))
]
JointRates: TypeAlias = Annotated[
    FloatArray,
    _meta(
        "Joint velocities, comma-separated, in the robot's order.",
        _MANY,
        JointField(given=Given.RATE, posture=False),
    ),
]
JointEfforts: TypeAlias = Annotated[
    FloatArray,
    _meta(
        "Joint torques and forces, comma-separated, in N m and N.",
        f"{_Q_TEXT}a batch (list of lists), or an object {{joint name: value}}; N m and N.",
        JointField(angular=False, given=Given.EFFORT, posture=False),
        texts.scalars,
    ),
]
Seed: TypeAlias = Annotated[
    FloatArray | None,
    optional_configuration(
        "First start, comma-separated joint values.",
        "One q, as a list or an object {joint name: value}; may be left out.",
    ),
]
