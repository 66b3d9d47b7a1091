"""The declaration of a request field: what msgspec does not know of it.

A field of a request is an annotated type. The annotation carries a :class:`Field`, which says how
JSON, a query and npy give its value, and turns that value into what ``kinematics`` takes: arrays in
rad and m, tasks, reference frames. Bodies, query strings, the OpenAPI document and the pointers of
errors all read this declaration.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import msgspec

from app.fields.doubts import RequestDoubts
from app.http.units import Units
from app.settings import Settings
from dh_to_urdf.errors import Location
from robots.robot import Robot

KEY = "field"
"""Key of the declaration among the extras of ``msgspec.Meta``."""
LEFT_OUT: Any = None
"""Default of a field whose value depends on the robot where a request leaves it out."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What a value is read with.

    Attributes:
        robot: The robot of the request.
        units: The units of the request.
        settings: What the deployment chose.
        doubts: Collects what was accepted but is probably not meant, for the answer.
        given: The fields of the request that are read already, by name.
    """

    robot: Robot
    units: Units
    settings: Settings
    doubts: RequestDoubts
    given: dict[str, Any]


Text: TypeAlias = Callable[[str, str, Reading], Any]
"""Reads the text of a query parameter: its name, its text, and what it is read with."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of the GET form.

    Attributes:
        read: Turns its text into the value that JSON would give.
        description: One line for the documents.
        name: Its name, where it is not that of the field.
    """

    read: Text
    description: str
    name: str = ""


@dataclass(frozen=True)
class Field:
    """How a field is given and read.

    Attributes:
        parameters: What gives it in the GET form; empty where only a body does.
    """

    parameters: tuple[Parameter, ...] = ()

    @property
    def wire(self) -> Any:
        """The type that JSON is decoded to; None: the declared one."""
        return None

    @property
    def late(self) -> bool:
        """Whether the value is read after those of all short fields."""
        return False

    @property
    def large(self) -> bool:
        """Whether it may hold a batch of many rows."""
        return False

    def written(self, default: Any) -> Any:
        """Return a default of the request as JSON would give it."""
        return default

    def gathered(self, name: str, values: Mapping[str, Any]) -> Any:
        """Return the value that the parameters of a query give together, as JSON would."""
        return values[name]

    def resolve(self, value: Any, location: Location, reading: Reading) -> Any:
        """Return the value in the units of ``kinematics``.

        Args:
            value: As JSON, a query or npy gives it.
            location: The field's place in the request, for errors.
            reading: What it is read with.

        Raises:
            RequestProblem: The value cannot be read.
            KinematicsError: It does not fit the robot.
        """
        del location, reading
        return value


def declared(
    field: Field, description: str | None = None, schema: dict[str, Any] | None = None
) -> msgspec.Meta:
    """Return the annotation that makes a type a request field.

    Args:
        field: How it is given and read.
        description: Text for the documents.
        schema: What the JSON schema says beyond the type.
    """
    return msgspec.Meta(description=description, extra_json_schema=schema, extra={KEY: field})
