"""fk: poses of frames in every representation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, NotRequired, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields.field import LEFT_OUT
from app.fields.joints import Configuration
from app.fields.names import Frames, euler_sequence
from app.http.negotiation import CSV, JSON
from app.http.units import Units
from app.operations.joint_values import joint_values_view, joints_shown
from app.operations.operation import SHEET_FORMS, Answer, Context, Operation, check_size
from app.operations.shapes import (
    AnswerUnits,
    EachFlag,
    EachNumber,
    EachPose,
    EachPosition,
    EachQuaternion,
    each,
    rows,
)
from app.operations.sizes import FLOAT, encoded, rows_need, rows_of
from app.sheets import columns, latex
from app.sheets.headings import Heading
from app.sheets.sheet import Column, Sheet
from kinematics.forward import fk, peak_bytes, poses
from kinematics.orientation import euler_angles, is_locked, quaternion_xyzw, rpy
from kinematics.orientation_formats import FORMATS
from robots.robot import FloatArray, Robot

NUMBERS_A_POSE = 32


class FKRequest(msgspec.Struct, kw_only=True):
    """What to compute poses of."""

    q: Configuration
    frames: Frames = LEFT_OUT
    euler: Annotated[
        str | None,
        euler_sequence("Also Euler angles of this sequence: ZXZ, ZYX (moving axes), xyz …"),
    ] = None


class EulerView(TypedDict):
    """Both triples of an Euler sequence."""

    sequence: str
    solutions: Annotated[FloatArray, each(rows(2, 3))]
    degenerate: EachFlag


class PoseView(TypedDict):
    """One pose in every representation, in the axes of the robot's base frame.

    ``rpy_degenerate`` is there where it is true, of a batch for one pose at least: at a pitch of
    ±90° only roll ± yaw is determined, and yaw is 0, as in the sequence xyz. One of the ways that
    makers write orientations is there where ``?orientation=`` names it;
    ``orientation_degenerate`` where other values would mean the same.
    """

    matrix: EachPose
    position: EachPosition
    quaternion_xyzw: EachQuaternion
    rpy: EachPosition
    rpy_degenerate: NotRequired[EachFlag]
    euler: NotRequired[EulerView]
    rotation_vector: NotRequired[EachPosition]
    quaternion_wxyz: NotRequired[EachQuaternion]
    kuka_abc: NotRequired[EachPosition]
    fanuc_wpr: NotRequired[EachPosition]
    abb_quaternion: NotRequired[EachQuaternion]
    ur_rotation_vector: NotRequired[EachPosition]
    staubli_rxryrz: NotRequired[EachPosition]
    yaskawa_rxryrz: NotRequired[EachPosition]
    kawasaki_oat: NotRequired[EachPosition]
    denso_rxryrz: NotRequired[EachPosition]
    comau_euler: NotRequired[EachPosition]
    orientation_degenerate: NotRequired[EachFlag]


class FKAnswer(TypedDict):
    """Poses by frame name; of a robot whose joints depend on others, the values of all of them."""

    units: AnswerUnits
    poses: dict[str, PoseView]
    joint_values: NotRequired[dict[str, EachNumber]]
    warnings: list[str]


def pose_view(T: FloatArray, units: Units, sequence: str | None) -> PoseView:
    """Return a pose, shape (..., 4, 4), in every representation."""
    R = T[..., :3, :3]
    view: PoseView = {
        "matrix": units.poses_out(T),
        "position": units.lengths_out(T[..., :3, 3]),
        "quaternion_xyzw": quaternion_xyzw(R),
        "rpy": units.angles_out(rpy(R)),
    }
    locked = is_locked(R)
    if locked.any():
        view["rpy_degenerate"] = locked.tolist()
    if sequence is not None:
        angles = euler_angles(R, sequence)
        view["euler"] = {
            "sequence": sequence,
            "solutions": units.angles_out(angles.solutions),
            "degenerate": angles.degenerate.tolist(),
        }
    if units.orientation:
        written = FORMATS[units.orientation]
        values = written.values(R)
        view[written.name] = units.angles_out(values) if written.is_angular else values  # type: ignore[literal-required]
        locked = written.is_degenerate(R)
        if locked.any():
            view["orientation_degenerate"] = locked.tolist()
    return view


def _views_at(
    robot: Robot, q: FloatArray, frames: Sequence[str], units: Units
) -> dict[str, PoseView]:
    """Return poses at one q as plain numbers, of which JSON is written fastest."""
    views: dict[str, PoseView] = {}
    for name, pose in poses(robot, q, frames).items():
        views[name] = {
            "matrix": pose.matrix,
            "position": pose.position,
            "quaternion_xyzw": pose.quaternion_xyzw,
            "rpy": units.angles_out(np.array(pose.rpy)) if units.degrees else pose.rpy,
        }
        if pose.is_locked:
            views[name]["rpy_degenerate"] = True
    return views


def _memory(robot: Robot, request: FKRequest, context: Context) -> Need:
    frames = len(request.frames)
    numbers = frames * (NUMBERS_A_POSE if request.euler else NUMBERS_A_POSE - 6)
    each = peak_bytes(robot.dof, frames) + FLOAT * numbers * 1.5
    each += encoded(context.form, numbers + joints_shown(robot), 16 * frames)
    if context.form == CSV:
        # Beside each pose stands its q.
        each += encoded(CSV, frames * (robot.dof + joints_shown(robot)))
    return rows_need(rows_of(request.q), each, context.form, numbers=NUMBERS_A_POSE * frames)


def _run(robot: Robot, request: FKRequest, context: Context) -> Answer:
    q, frames, units = request.q, request.frames, context.units
    check_size(q, NUMBERS_A_POSE * len(frames))
    plain = request.euler is None and not units.orientation and not units.millimetres
    if q.ndim == 1 and plain and context.form == JSON:
        return Answer(_answer(robot, q, _views_at(robot, q, frames, units), context))
    found = fk(robot, q, frames)
    views = {name: pose_view(T, units, request.euler) for name, T in found.items()}
    array = next(iter(found.values())) if len(found) == 1 else np.stack(list(found.values()), -3)
    return Answer(
        _answer(robot, q, views, context),
        units.poses_out(array),
        sheet=lambda: _sheet(robot, request, found, units),
        latex=lambda digits: _latex(found, units, digits),
    )


def _sheet(
    robot: Robot, request: FKRequest, found: Mapping[str, FloatArray], units: Units
) -> Sheet:
    """Return one row a pose: the frames of the first q, then those of the next."""
    q, names = np.atleast_2d(request.q), list(found)
    T = np.stack([np.reshape(one, (-1, 4, 4)) for one in found.values()], axis=1).reshape(-1, 4, 4)
    repeated = np.repeat(q, len(names), axis=0)
    R = T[:, :3, :3]
    return Sheet(
        (
            columns.samples(len(q), len(names)),
            *columns.joints(robot, repeated, units),
            *columns.joint_values(robot, repeated, units),
            Column(Heading.FRAME, names * len(q)),
            *columns.position(T[:, :3, 3], units),
            *columns.orientation(R, units),
            *columns.written(R, units),
            *(
                ()
                if request.euler is None
                else columns.euler(euler_angles(R, request.euler), request.euler, units)
            ),
        )
    )


def _latex(found: Mapping[str, FloatArray], units: Units, digits: int | None) -> str:
    """Return the matrices of all frames, of each q."""
    labels, poses_ = [], []
    for name, T in found.items():
        every = np.reshape(units.poses_out(T), (-1, 4, 4))
        number = "" if T.ndim == 2 else "^{{({k})}}"
        labels += [
            f"T_{{\\text{{{latex.escaped(name)}}}}}{number.format(k=k)}"
            for k in range(1, len(every) + 1)
        ]
        poses_.append(every)
    return latex.equations(labels, np.concatenate(poses_), digits)


def _answer(
    robot: Robot, q: FloatArray, views: dict[str, PoseView], context: Context
) -> Mapping[str, object]:
    answer: FKAnswer = {
        "units": context.units.named,
        "poses": views,
        **joint_values_view(robot, q, context.units),
        "warnings": context.warnings,
    }
    return answer


FK = Operation(
    name="fk",
    summary="Forward kinematics",
    description="Poses of frames at one q or a batch. As npy: matrices, shape (4, 4) or (n, 4, 4);"
    " several frames add an axis before the last two. As csv: one row a pose. As latex: matrices.",
    request=FKRequest,
    answer=FKAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "euler": "ZXZ"},
    forms=SHEET_FORMS,
    example_robot="pa10",
    npy_field="q",
    orientations=True,
)
