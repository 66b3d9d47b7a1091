"""Fields that name something of the robot or of kinematics: frames, tasks, Euler sequences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import product
from typing import Annotated, Any, TypeAlias

import msgspec

from app.fields import texts
from app.fields.field import Field, Parameter, Reading, declared
from app.http.pointers import json_pointer
from app.http.problems import INVALID_REQUEST, RequestProblem
from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.jacobian import ReferenceFrame
from kinematics.orientation import parse_sequence
from kinematics.task import TASKS, Task, task_from

SEQUENCES = tuple(
    "".join(axes)
    for letters in ("XYZ", "xyz")
    for axes in product(letters, repeat=3)
    if axes[0] != axes[1] != axes[2]
)
SEQUENCE_SCHEMA = {"pattern": f"^({'|'.join(SEQUENCES)})$"}
"""The sequences as a pattern: their names differ only in case, which generated enums cannot."""


@dataclass(frozen=True)
class FrameName(Field):
    """A frame of the robot; by default its tip."""

    @property
    def wire(self) -> Any:
        """A text, or nothing."""
        return str | None

    def resolve(self, value: Any, location: Location, reading: Reading) -> str:
        """Return the name.

        Raises:
            UnknownFrame: The robot has no such frame.
        """
        if value is None:
            return reading.robot.tip_frame
        reading.robot.frame_id(value, str(location[0]), location[1:])
        return str(value)


@dataclass(frozen=True)
class TaskName(Field):
    """A task space by name or mask.

    Attributes:
        optional: Whether it may be null.
    """

    optional: bool = False

    @property
    def wire(self) -> Any:
        """A text or a list."""
        return str | list[int] | None if self.optional else str | list[int]

    def written(self, default: Any) -> Any:
        """Return the name of a task."""
        return default.name if isinstance(default, Task) else default

    def resolve(self, value: Any, location: Location, reading: Reading) -> Task | None:
        """Return the task.

        Raises:
            UnknownTask: There is none of this name, or the mask is no mask.
        """
        del reading
        if value is None or isinstance(value, Task):
            return value
        return task_from(value, str(location[0]), location[1:])


@dataclass(frozen=True)
class ReferenceFrameName(Field):
    """The reference frame of a Jacobian, a twist or a wrench."""

    @property
    def wire(self) -> Any:
        """A text, or nothing."""
        return str | None

    def resolve(self, value: Any, location: Location, reading: Reading) -> ReferenceFrame:
        """Return the reference frame.

        Raises:
            RequestProblem: There is no such one.
        """
        del reading
        if value is None:
            return ReferenceFrame.LOCAL_WORLD_ALIGNED
        if value not in list(ReferenceFrame):
            raise RequestProblem(
                INVALID_REQUEST,
                say(
                    "reference_frame is {value!r}; give {referenceframe}",
                    value=value[:32],
                    referenceframe=", ".join(ReferenceFrame),
                ),
                json_pointer(location),
            )
        return ReferenceFrame(value)


@dataclass(frozen=True)
class SequenceName(Field):
    """An Euler sequence, or none."""

    def resolve(self, value: Any, location: Location, reading: Reading) -> str | None:
        """Return the sequence.

        Raises:
            UnknownSequence: Three letters that are none.
        """
        del reading
        if value is None:
            return None
        parse_sequence(value, str(location[0]), location[1:])
        return str(value)


@dataclass(frozen=True)
class FrameNames(Field):
    """Several frames of the robot; by default its tip."""

    @property
    def wire(self) -> Any:
        """Names, one name, or nothing."""
        return list[str] | str | None

    def resolve(self, value: Any, location: Location, reading: Reading) -> Sequence[str]:
        """Return the names, each once.

        Raises:
            RequestProblem: The list is empty.
        """
        robot = reading.robot
        if value is None:
            return (robot.tip_frame,)
        if value == "all":
            return robot.frames
        if not value:
            raise RequestProblem(
                INVALID_REQUEST,
                say('frames is empty; name frames, give "all" or leave it out'),
                json_pointer(location),
            )
        return [value] if isinstance(value, str) else list(dict.fromkeys(value))


def one_of(choices: Sequence[str] | type[StrEnum], *, null: bool = False) -> dict[str, Any]:
    """Return the schema of one of some names; with ``null`` it may be left open."""
    return {"enum": [*choices, *([None] if null else [])]}


TASK_SCHEMA: dict[str, Any] = {
    "anyOf": [
        {"enum": list(TASKS)},
        {
            "type": "array",
            "items": {"type": "integer", "enum": [0, 1]},
            "contains": {"const": 1},
            "minItems": 6,
            "maxItems": 6,
        },
    ]
}
TASK_TEXT = (
    "pose, position, orientation, xy, xz, yz, x, y, z, xy_phi, xyz_phi, direction (of the frame's"
    " z axis), position_direction, or a mask of six 0 or 1 for vx, vy, vz, wx, wy, wz."
)
TASK_META = msgspec.Meta(description=TASK_TEXT, extra_json_schema={"allOf": [TASK_SCHEMA]})
"""The annotation of a task within a nested object, read with what it belongs to."""
TASK_IN_QUERY = Parameter(texts.task, "Task space by name, or six 0 or 1.")
FRAME_IN_QUERY = Parameter(texts.text, "Frame name; default the tip.")

TaskSpace: TypeAlias = Annotated[
    Task, declared(TaskName((TASK_IN_QUERY,)), TASK_TEXT, {"allOf": [TASK_SCHEMA]})
]
TargetTaskSpace: TypeAlias = Annotated[
    Task,
    declared(
        TaskName((TASK_IN_QUERY,), optional=True),
        TASK_TEXT + " Default pose; for a target without orientation and at most three joints what"
        " it gives: position, xy or xy_phi.",
        {"anyOf": [TASK_SCHEMA, {"type": "null"}]},
    ),
]
"""The task of a target, which is read with the target where it is left out."""
Frame: TypeAlias = Annotated[
    str, declared(FrameName((FRAME_IN_QUERY,)), "Frame name; default the tip.")
]
Frames: TypeAlias = Annotated[
    Sequence[str],
    declared(
        FrameNames(
            (Parameter(texts.names, "Frame names, comma-separated, or all; default the tip."),)
        ),
        'Frame names, or "all"; default the tip.',
    ),
]
ReferenceFrameChoice: TypeAlias = Annotated[
    ReferenceFrame,
    declared(
        ReferenceFrameName((Parameter(texts.text, "local_world_aligned, world or local."),)),
        "local_world_aligned (default): at the frame's origin in base axes. world: of the body"
        " point at the base's origin, in base axes. local: at the frame's origin, in the frame's"
        " own axes.",
        one_of(ReferenceFrame, null=True),
    ),
]


def euler_sequence(text: str) -> msgspec.Meta:
    """Return the annotation of an Euler sequence that may be left out."""
    parameter = Parameter(
        texts.text, "Euler sequence such as ZXZ; for ik with angles: ZXZ:10,20,30."
    )
    return declared(SequenceName((parameter,)), text, SEQUENCE_SCHEMA)
