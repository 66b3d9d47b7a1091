"""Fields of every computation: base, tool and limits of the robot for this request only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

import msgspec

from app.fields import texts
from app.fields.bounds import coordinates, is_number
from app.fields.field import LEFT_OUT, Field, Parameter, Reading, declared
from app.fields.lengths import LENGTH, PLACED
from app.fields.targets import ORIENTATION_FIELDS, Orientations, Target, target_pose
from app.http.pointers import json_pointer
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.query import number
from app.http.strict_json import validation_problem
from dh_to_urdf.cells.expressions import Quantity
from dh_to_urdf.errors import Location, quoted
from dh_to_urdf.messages import say
from kinematics.errors import InvalidTarget
from kinematics.task import POSE
from robots.errors import hint
from robots.installation import BOUNDS, moving_joint
from robots.robot import FloatArray

NONE = {"lower": None, "upper": None}
"""What null in the place of a joint's limits stands for."""
MAX_LIMITS = 200
"""Joints that one request may limit."""


class Placement(Orientations, forbid_unknown_fields=True, kw_only=True):
    """A placement: a matrix, or a position (also called xyz) with one orientation.

    A position that is left out is 0, an orientation none.
    """

    position: Annotated[list[float] | None, coordinates(3), LENGTH] = None
    xyz: Annotated[list[float] | None, coordinates(3), LENGTH] = None


_BOUND = {"type": ["number", "null"]}
_LIMITS = {
    "type": "object",
    "additionalProperties": {
        "type": ["object", "null"],
        "properties": {
            "lower": _BOUND,
            "upper": _BOUND,
            **{name: {**_BOUND, "exclusiveMinimum": 0} for name in BOUNDS[2:]},
        },
        "additionalProperties": False,
    },
    "maxProperties": MAX_LIMITS,
}


@dataclass(frozen=True)
class PlacementField(Field):
    """A placement; in a query by its fields, each after the name of the placement."""

    @property
    def wire(self) -> Any:
        """An object, the four rows of a matrix, or nothing."""
        return Placement | Annotated[list[list[float]], PLACED] | None

    def gathered(self, name: str, values: Mapping[str, Any]) -> Any:
        """Return the placement of parameters such as ``tool_rpy``."""
        given = {key.removeprefix(f"{name}_"): value for key, value in values.items()}
        try:
            return msgspec.convert(given, Placement)
        except msgspec.ValidationError as error:
            raise validation_problem(error, f"/{name}") from None

    def resolve(self, value: Any, location: Location, reading: Reading) -> FloatArray | None:
        """Return the placement, shape (4, 4), m.

        Raises:
            RequestProblem: It is no rigid placement, or gives two forms.
        """
        if value is None:
            return None
        placement = Placement(matrix=value) if isinstance(value, list) else value
        name = str(location[-1])
        position = placement.position
        if placement.xyz is not None:
            if position is not None:
                message = say("{name} has position and xyz; give one of them", name=name)
                raise RequestProblem(INVALID_REQUEST, message, json_pointer(location))
            position = placement.xyz
        given = {
            form: one
            for form in ORIENTATION_FIELDS
            if (one := getattr(placement, form)) is not None
        }
        if placement.matrix is None:
            position = position or [0.0, 0.0, 0.0]
            if not given:
                given = {"rpy": [0.0, 0.0, 0.0]}
        target = Target(matrix=placement.matrix, position=position, **given)
        try:
            return target_pose(target, POSE, reading.doubts, location)
        except InvalidTarget as error:
            raise RequestProblem(
                INVALID_REQUEST, str(error), json_pointer(error.location)
            ) from None


@dataclass(frozen=True)
class LimitsField(Field):
    """Limits by joint name."""

    @property
    def wire(self) -> Any:
        """An object of objects, or nothing."""
        return dict[str, Any] | None

    def resolve(
        self, value: Any, location: Location, reading: Reading
    ) -> dict[str, dict[str, float | None]]:
        """Return the limits in rad, m and s, those that are given.

        Raises:
            RequestProblem: Too many, or no numbers.
            WrongLimits: They name no joint that moves.
        """
        if value is None:
            return {}
        if len(value) > MAX_LIMITS:
            message = say(
                "limits names {count} joints; give at most {most}",
                count=len(value),
                most=MAX_LIMITS,
            )
            raise RequestProblem(INVALID_REQUEST, message, json_pointer(location))
        found: dict[str, dict[str, float | None]] = {}
        for name, given in value.items():
            joint = moving_joint(reading.robot, name)
            bounds = NONE if given is None else given
            _check_bounds(name, bounds, location)
            units = reading.units
            inward = units.angle_in if joint.type.is_revolute else units.length_in
            found[name] = {key: None if one is None else inward(one) for key, one in bounds.items()}
        return found


def _check_bounds(name: str, bounds: Any, location: Location) -> None:
    """Refuse what is no object of numbers, each by its place."""
    place = (*location, name)
    if not isinstance(bounds, dict):
        message = say(
            'limits of {name} are {shown}; give an object such as {{"lower": -1, "upper": 1}}',
            name=name,
            shown=quoted(bounds),
        )
        raise RequestProblem(INVALID_REQUEST, message, json_pointer(place))
    for key, one in bounds.items():
        if key not in BOUNDS:
            message = say(
                "limits of {name} have an unknown field {key}; {hint}",
                name=name,
                key=quoted(key),
                hint=hint(key, BOUNDS),
            )
            raise RequestProblem(INVALID_REQUEST, message, json_pointer((*place, key)))
        if one is not None and not is_number(one):
            message = say(
                "limits.{name}.{key} is {shown}; give a number, or null for none",
                name=name,
                key=key,
                shown=quoted(one),
            )
            raise RequestProblem(INVALID_REQUEST, message, json_pointer((*place, key)))


def _limits(name: str, value: str, reading: Reading) -> dict[str, Any]:
    """Return limits of a query, ``j1:-90deg:90deg,j2::2``; an empty one is the robot's own."""
    found: dict[str, dict[str, float]] = {}
    for part in value.split(",")[: MAX_LIMITS + 1]:
        joint, *ends = part.rsplit(":", 2)
        known = {one.name for one in reading.robot.moving}
        if len(ends) != 2 or (":" in joint and joint.strip() not in known):
            message = say(
                "{name} is {value!r}; write it as j1:-1:1,j2::2", name=name, value=value[:32]
            )
            raise RequestProblem(INVALID_REQUEST, message, f"/{name}")
        joint = joint.strip()
        if joint in found:
            message = say("{name} has joint {joint} twice; keep one", name=name, joint=joint)
            raise RequestProblem(INVALID_REQUEST, message, f"/{name}")
        turns = moving_joint(reading.robot, joint).type.is_revolute
        quantity = Quantity.ANGLE if turns else Quantity.LENGTH
        found[joint] = {
            key: number(name, text, reading.units, quantity)
            for key, text in zip(("lower", "upper"), ends, strict=True)
            if text.strip()
        }
    return found


def _placed(name: str, what: str) -> tuple[Parameter, ...]:
    return (
        Parameter(texts.lengths, f"{what}: x,y,z in m.", f"{name}_xyz"),
        Parameter(texts.angles, f"{what}: roll,pitch,yaw.", f"{name}_rpy"),
        Parameter(texts.scalars, f"{what}: quaternion x,y,z,w.", f"{name}_quaternion_xyzw"),
        Parameter(texts.matrix, f"{what}: matrix, 16 numbers row by row.", f"{name}_matrix"),
    )


BasePlacement: TypeAlias = Annotated[
    FloatArray | None,
    declared(
        PlacementField(_placed("base", "The robot's base frame in the world")),
        "Pose of the robot's base frame in the world; poses of request and answer are in the axes"
        " of the world then. For this request only.",
    ),
]
ToolPlacement: TypeAlias = Annotated[
    FloatArray | None,
    declared(
        PlacementField(_placed("tool", "The tool in the frame")),
        "Pose of a tool in the frame that is computed for, which the answer is about then. For"
        " this request only.",
    ),
]
JointLimits: TypeAlias = Annotated[
    Mapping[str, Mapping[str, float | None]],
    declared(
        LimitsField((Parameter(_limits, "Limits by joint: j1:-1:1,j2::2.", "limits"),)),
        'Limits by joint name, {"j1": {"lower": -1, "upper": 1}}, in the place of the robot\'s own'
        " (lower, upper, velocity, acceleration, jerk; null: none), in the units of the request."
        " For this request only.",
        {"anyOf": [_LIMITS, {"type": "null"}]},
    ),
]


class InstallationFields(msgspec.Struct, kw_only=True):
    """What every request may say of the robot that it is about."""

    base: BasePlacement = None
    tool: ToolPlacement = None
    limits: JointLimits = LEFT_OUT
