"""Targets of requests: one pose or many, in any one of their forms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import Annotated, Any, TypeAlias

import msgspec
import numpy as np

from app.fields import texts
from app.fields.bounds import batch_of, coordinates, within
from app.fields.doubts import RequestDoubts
from app.fields.field import Field, Parameter, Reading, declared
from app.fields.lengths import LENGTH, PLACED
from app.fields.names import SEQUENCE_SCHEMA
from app.http.pointers import json_pointer
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.strict_json import validation_problem
from app.http.units import Units
from dh_to_urdf.errors import Location
from dh_to_urdf.messages import chained, say
from kinematics.chain import chain_of
from kinematics.errors import InvalidTarget
from kinematics.inverse.target import Targets, mended, target_poses
from kinematics.orientation_formats import FORMATS
from kinematics.task import POSE, TASKS, Task
from robots.robot import FloatArray

_ROW = {"type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4}
_MATRIX = {"type": "array", "items": _ROW, "minItems": 4, "maxItems": 4}
_OWN = ("matrix", "position", "quaternion_xyzw", "rpy", "euler", "phi", "direction")
_FORMS = (*_OWN, *FORMATS)
_values_of = attrgetter(*_FORMS)
FEW_JOINTS = 3
"""Joints of an arm up to which a position alone says that the position is the task."""
_OF_FORMS = {
    (("position",), 3): "position",
    (("position",), 2): "xy",
    (("position", "phi"), 2): "xy_phi",
}
"""The task that a target without orientation gives."""
PLACED_ON_THE_ROBOT = ("tool", "base")
"""Placements that may well be shorter than a thousandth of the robot."""
LOOKED_AT = 100
"""Targets of a list that are looked at for angles in another unit."""
_SEQUENCE = msgspec.Meta(extra_json_schema=SEQUENCE_SCHEMA)


class EulerField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """An orientation as Euler angles."""

    sequence: Annotated[str, _SEQUENCE]
    angles: Annotated[list[float], coordinates(3)]


class OrientationFields(msgspec.Struct, kw_only=True):
    """One orientation in one of the ways that it is written."""

    quaternion_xyzw: Annotated[list[float] | None, coordinates(4)] = None
    rpy: Annotated[list[float] | None, coordinates(3)] = None
    euler: EulerField | None = None
    rotation_vector: Annotated[list[float] | None, coordinates(3)] = None
    quaternion_wxyz: Annotated[list[float] | None, coordinates(4)] = None
    kuka_abc: Annotated[list[float] | None, coordinates(3)] = None
    fanuc_wpr: Annotated[list[float] | None, coordinates(3)] = None
    abb_quaternion: Annotated[list[float] | None, coordinates(4)] = None
    ur_rotation_vector: Annotated[list[float] | None, coordinates(3)] = None
    staubli_rxryrz: Annotated[list[float] | None, coordinates(3)] = None
    yaskawa_rxryrz: Annotated[list[float] | None, coordinates(3)] = None
    kawasaki_oat: Annotated[list[float] | None, coordinates(3)] = None
    denso_rxryrz: Annotated[list[float] | None, coordinates(3)] = None
    comau_euler: Annotated[list[float] | None, coordinates(3)] = None


ORIENTATION_FIELDS = OrientationFields.__struct_fields__


class Orientations(OrientationFields, kw_only=True):
    """A matrix, or one orientation in one of the ways that it is written."""

    matrix: Annotated[
        list[list[float]] | None,
        msgspec.Meta(extra_json_schema={k: v for k, v in _MATRIX.items() if k != "type"}),
        PLACED,
    ] = None


class Target(Orientations, forbid_unknown_fields=True, kw_only=True):
    """A pose: a matrix, or a position with one orientation; what the task ignores may be left out.

    For the task xy the position may be [x, y]. phi is an angle about z: a frame that follows a
    path turns to it with whatever tilt it has. direction is that of the frame's z axis, for tasks
    that leave the turn about it open.
    """

    position: Annotated[list[float] | None, coordinates(2, 3), LENGTH] = None
    phi: Annotated[float | None, within(-1e6, 1e6)] = None
    direction: Annotated[list[float] | None, coordinates(3)] = None


class EulerBatch(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Orientations as Euler angles of one sequence."""

    sequence: Annotated[str, _SEQUENCE]
    angles: Annotated[list[list[float]], batch_of(3)]


class TargetBatch(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Many targets: every field with a leading axis n."""

    matrix: Annotated[
        list[list[list[float]]] | None, msgspec.Meta(extra_json_schema={"items": _MATRIX}), PLACED
    ] = None
    position: Annotated[list[list[float]] | None, batch_of(2, 3), LENGTH] = None
    quaternion_xyzw: Annotated[list[list[float]] | None, batch_of(4)] = None
    rpy: Annotated[list[list[float]] | None, batch_of(3)] = None
    euler: EulerBatch | None = None
    phi: list[float] | None = None
    direction: Annotated[list[list[float]] | None, batch_of(3)] = None
    rotation_vector: Annotated[list[list[float]] | None, batch_of(3)] = None
    quaternion_wxyz: Annotated[list[list[float]] | None, batch_of(4)] = None
    kuka_abc: Annotated[list[list[float]] | None, batch_of(3)] = None
    fanuc_wpr: Annotated[list[list[float]] | None, batch_of(3)] = None
    abb_quaternion: Annotated[list[list[float]] | None, batch_of(4)] = None
    ur_rotation_vector: Annotated[list[list[float]] | None, batch_of(3)] = None
    staubli_rxryrz: Annotated[list[list[float]] | None, batch_of(3)] = None
    yaskawa_rxryrz: Annotated[list[list[float]] | None, batch_of(3)] = None
    kawasaki_oat: Annotated[list[list[float]] | None, batch_of(3)] = None
    denso_rxryrz: Annotated[list[list[float]] | None, batch_of(3)] = None
    comau_euler: Annotated[list[list[float]] | None, batch_of(3)] = None


def target_pose(
    target: Target, task: Task, doubts: RequestDoubts, location: Location
) -> FloatArray:
    """Return the pose of one target, shape (4, 4), m.

    Args:
        target: The target.
        task: What of it counts.
        doubts: Has the units of the request, and takes what is doubtful.
        location: Where it stands in the request.

    Raises:
        InvalidTarget: The target is no pose, or lacks what the task needs.
    """
    pose: FloatArray = target_poses(_one(target, doubts, location), task)[0]
    if target.matrix is not None:
        what = say("the matrix of {location}", location=_named(location))
        doubts.mended(mended([target.matrix], pose[None]), what)
    if target.position is not None or target.matrix is not None:
        near = location[0] in PLACED_ON_THE_ROBOT
        doubts.place(
            pose[:3, 3], say("the {location}", location=_named(location)), may_be_near=near
        )
    return pose


def _task(reading: Reading, targets: Sequence[Target | TargetBatch]) -> Task:
    """Return the task of a request; where it is left out, what its targets and its arm give.

    An arm of three joints has no pose of its choice: a position alone is meant as one.
    """
    task: Task | None = reading.given["task"]
    if task is None:
        forms = {_forms(one) for one in targets}
        short = chain_of(reading.robot, reading.given["frame"]).dof <= FEW_JOINTS
        fitting = _OF_FORMS.get(forms.pop()) if len(forms) == 1 and short else None
        task = reading.given["task"] = TASKS[fitting] if fitting else POSE
    return task


def _forms(target: Target | TargetBatch) -> tuple[tuple[str, ...], int]:
    """Return the forms that a target gives, and the number of coordinates of its position."""
    values = zip(_FORMS, _values_of(target), strict=True)
    given = tuple(name for name, value in values if value is not None)
    rows = target.position if isinstance(target, TargetBatch) else [target.position]
    sizes = {len(row) for row in rows or () if row is not None}
    return given, sizes.pop() if len(sizes) == 1 else 0


def _named(location: Location) -> str:
    """Return what a place of the request is called."""
    return " ".join(str(part) for part in location)


def _one(target: Target, doubts: RequestDoubts, location: Location) -> Targets:
    euler, units, name = target.euler, doubts.units, _named(location)
    written = [(form, values) for form in FORMATS if (values := getattr(target, form)) is not None]
    for form, angles in (
        ("rpy", target.rpy),
        ("euler", None if euler is None else euler.angles),
        ("phi", None if target.phi is None else [target.phi]),
        *(one for one in written if FORMATS[one[0]].is_angular),
    ):
        if angles is not None:
            doubts.angles(angles, say("{form} of {name}", form=form, name=name))
    _refuse_two(written, location)
    return Targets(
        matrix=None if target.matrix is None else [target.matrix],
        position=None if target.position is None else [target.position],
        quaternion_xyzw=None if target.quaternion_xyzw is None else [target.quaternion_xyzw],
        rpy=None if target.rpy is None else [_in(target.rpy, units)],
        euler=None if euler is None else (euler.sequence, [_in(euler.angles, units)]),
        phi=None if target.phi is None else _in([target.phi], units),
        direction=None if target.direction is None else [target.direction],
        written=_written({form: [values] for form, values in written}, units),
        location=location,
    )


def _refuse_two(written: Sequence[tuple[str, Any]], location: Location) -> None:
    """Refuse two orientations of makers; others beside one are found with the rest.

    Raises:
        InvalidTarget: There are two.
    """
    if len(written) > 1:
        name, given = _named(location), [form for form, _ in written]
        message = say(
            "{name} has {given}; give one orientation",
            name=name,
            given=chained(say(" and "), given),
        )
        raise InvalidTarget(message, argument=str(location[0]), index=location[1:])


def _written(given: Mapping[str, Any], units: Units) -> tuple[str, Any] | None:
    """Return an orientation as a maker writes it, rad, with a leading axis."""
    for name, rows in given.items():
        angular = FORMATS[name].is_angular
        return name, [_in(row, units) for row in rows] if angular else rows
    return None


def _in(angles: Sequence[float], units: Units) -> list[float]:
    """Return angles of a request, rad."""
    return [math.radians(angle) for angle in angles] if units.degrees else list(angles)


@dataclass(frozen=True)
class OneTarget(Field):
    """One target, in a query by the fields of its form; it goes with a field ``task``.

    Attributes:
        optional: Whether it may be left out.
    """

    optional: bool = False

    @property
    def wire(self) -> Any:
        """An object, or nothing."""
        return Target | None if self.optional else Target

    @property
    def late(self) -> bool:
        """The task says what a target must give."""
        return True

    def gathered(self, name: str, values: Mapping[str, Any]) -> Target:
        """Return the target that the parameters give.

        Raises:
            RequestProblem: A value has the wrong form.
        """
        try:
            return msgspec.convert(values, Target)
        except msgspec.ValidationError as error:
            raise validation_problem(error, f"/{name}") from None

    def resolve(self, value: Any, location: Location, reading: Reading) -> FloatArray | None:
        """Return the pose, shape (4, 4), m.

        Raises:
            InvalidTarget: It is no pose, or lacks what the task needs.
        """
        if value is None:
            return None
        return target_pose(value, _task(reading, [value]), reading.doubts, location)


@dataclass(frozen=True)
class PathTarget(OneTarget):
    """One target, whose pose is read with what else a path needs."""

    def resolve(self, value: Any, location: Location, reading: Reading) -> Target | None:  # type: ignore[override]
        """Return the target as it is given."""
        del location, reading
        found: Target | None = value
        return found


@dataclass(frozen=True)
class ManyTargets(Field):
    """Many targets: a list, one object with leading axes, or an array of npy."""

    @property
    def wire(self) -> Any:
        """A list or an object."""
        return list[Target] | TargetBatch | None

    @property
    def late(self) -> bool:
        """They may be many, and the task says what they must give."""
        return True

    def resolve(self, value: Any, location: Location, reading: Reading) -> FloatArray | None:
        """Return the poses, shape (n, 4, 4); of an array with two axes the one, shape (4, 4).

        Raises:
            RequestProblem: Too many, none, or fields of unequal lengths.
            InvalidTarget: One is no pose, or lacks what the task needs.
        """
        if value is None:
            reading.given["task"] = reading.given["task"] or POSE
            return None
        if isinstance(value, np.ndarray):
            task = _task(reading, ())
            array = reading.units.poses_in(value if value.ndim == 3 else value[None])
            _check_count(len(array), location, reading)
            targets = Targets(matrix=array, location=location, many=True, by_field=True)
            poses = target_poses(targets, task)
            reading.doubts.mended(mended(array, poses), say("a target's matrix"))
            reading.doubts.place(poses[:, :3, 3], say("a target"), may_be_near=False)
            return poses if value.ndim == 3 else poses[0]
        task = _task(reading, [value] if isinstance(value, TargetBatch) else value)
        if isinstance(value, TargetBatch):
            poses = target_poses(_by_field(value, location, reading), task)
            if value.matrix is not None:
                reading.doubts.mended(mended(value.matrix, poses), "a target's matrix")
        else:
            _check_count(len(value), location, reading)
            groups = _listed(value, location, reading)
            poses = np.concatenate([target_poses(group, task) for group in groups])
            rows = [k for k, one in enumerate(value) if one.matrix is not None]
            if rows:
                given = [value[k].matrix for k in rows]
                reading.doubts.mended(mended(given, poses[rows]), say("a target's matrix"))
        reading.doubts.place(poses[:, :3, 3], say("a target"), may_be_near=False)
        return poses


def _listed(targets: Sequence[Target], location: Location, reading: Reading) -> tuple[Targets, ...]:
    """Return targets of one form together, others one by one."""
    forms = {
        tuple(
            value.sequence if isinstance(value, EulerField) else value is not None
            for value in _values_of(one)
        )
        for one in targets
    }
    if len(forms) > 1:
        return tuple(_one(one, reading.doubts, (*location, k)) for k, one in enumerate(targets))
    columns = {
        name: [getattr(one, name) for one in targets]
        for name in _FORMS
        if getattr(targets[0], name) is not None
    }
    return (_together(columns, location, reading, len(targets), by_field=False),)


def _by_field(batch: TargetBatch, location: Location, reading: Reading) -> Targets:
    columns: dict[str, Any] = {
        name: value for name in _FORMS if (value := getattr(batch, name)) is not None
    }
    if isinstance(batch.euler, EulerBatch):
        sequence = batch.euler.sequence
        columns["euler"] = [
            EulerField(sequence=sequence, angles=angles) for angles in batch.euler.angles
        ]
    lengths = {name: len(value) for name, value in columns.items()}
    if len(set(lengths.values())) != 1:
        found = ", ".join(f"{name} {length}" for name, length in lengths.items()) or say("nothing")
        message = say(
            "{location} has fields of unequal lengths ({found})", location=location[-1], found=found
        )
        raise RequestProblem(INVALID_REQUEST, message, json_pointer(location))
    count = next(iter(lengths.values()))
    _check_count(count, location, reading)
    return _together(columns, location, reading, count, by_field=True)


def _together(
    columns: Mapping[str, Any], location: Location, reading: Reading, count: int, *, by_field: bool
) -> Targets:
    units = reading.units
    rpy, phi = columns.get("rpy"), columns.get("phi")
    euler: list[EulerField] | None = columns.get("euler")
    written = {name: rows for name, rows in columns.items() if name in FORMATS}
    _refuse_two(tuple(written.items()), location)
    for name, angles in (
        ("rpy", rpy),
        ("euler", None if euler is None else [one.angles for one in euler]),
        ("phi", phi),
        *((name, rows) for name, rows in written.items() if FORMATS[name].is_angular),
    ):
        if angles is not None:
            looked_at = np.ravel(angles[:LOOKED_AT]).tolist()
            reading.doubts.angles(
                looked_at, say("{name} of {location}", name=name, location=location[-1])
            )
    return Targets(
        matrix=columns.get("matrix"),
        position=columns.get("position"),
        quaternion_xyzw=columns.get("quaternion_xyzw"),
        rpy=None if rpy is None else [_in(row, units) for row in rpy],
        euler=None
        if euler is None
        else (euler[0].sequence, [_in(one.angles, units) for one in euler]),
        phi=None if phi is None else _in(phi, units),
        direction=columns.get("direction"),
        written=_written(written, units),
        count=count,
        location=location,
        many=True,
        by_field=by_field,
    )


def _check_count(count: int, location: Location, reading: Reading) -> None:
    limit = reading.settings.max_ik_batch
    if not 1 <= count <= limit:
        message = say(
            "{location} holds {count}; give 1 to {limit}",
            location=location[-1],
            count=count,
            limit=limit,
        )
        raise RequestProblem(INVALID_REQUEST, message, json_pointer(location))


_PARAMETERS = (
    Parameter(texts.lengths, "Target x,y,z in m.", "position"),
    Parameter(texts.angles, "Target roll,pitch,yaw.", "rpy"),
    Parameter(texts.scalars, "Target quaternion x,y,z,w.", "quaternion_xyzw"),
    Parameter(
        texts.euler, "Euler sequence such as ZXZ; for ik with angles: ZXZ:10,20,30.", "euler"
    ),
    Parameter(texts.angle, "Target angle about z.", "phi"),
    Parameter(texts.scalars, "Target direction of the frame's z axis, x,y,z.", "direction"),
    Parameter(texts.matrix, "Target matrix, 16 numbers row by row.", "matrix"),
    *(
        Parameter(
            texts.angles if one.is_angular else texts.scalars,
            f"Target orientation: {one.description}.",
            one.name,
        )
        for one in FORMATS.values()
    ),
)
RequiredTarget: TypeAlias = Annotated[FloatArray, declared(OneTarget(_PARAMETERS))]
OptionalTarget: TypeAlias = Annotated[
    FloatArray | None, declared(OneTarget(_PARAMETERS, optional=True))
]
TargetList: TypeAlias = Annotated[
    FloatArray | None,
    declared(ManyTargets(), "Many targets: a list, or one object with leading axes n."),
]
PathEnd: TypeAlias = Annotated[
    Target | None,
    declared(PathTarget(_PARAMETERS, optional=True), "End of a straight line; turns by SLERP."),
]
