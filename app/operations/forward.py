"""fk: poses of frames in every representation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import msgspec
import numpy as np

from app.http.negotiation import JSON
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.units import Units
from app.operations.base import (
    UNITS_SCHEMA,
    Answer,
    Configuration,
    Context,
    Numbers,
    Operation,
    check_size,
    read_configuration,
)
from app.operations.schema import EULER
from kinematics.forward import fk, poses
from kinematics.orientation import euler_angles, parse_sequence, quaternion_xyzw, rpy
from robots.robot import FloatArray, Robot

NUMBERS_A_POSE = 32


class FKRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """What to compute poses of."""

    q: Configuration
    frames: Annotated[
        list[str] | str | None,
        msgspec.Meta(description='Frame names, or "all"; default the tip.'),
    ] = None
    euler: Annotated[
        str | None,
        msgspec.Meta(
            description="Also Euler angles of this sequence: ZXZ, ZYX (moving axes), xyz …"
        ),
        EULER,
    ] = None


class EulerView(msgspec.Struct, kw_only=True):
    """Both triples of an Euler sequence."""

    sequence: str
    solutions: Numbers
    degenerate: bool | list[bool]


class PoseView(msgspec.Struct, kw_only=True, omit_defaults=True):
    """One pose in every representation, in the axes of the robot's base frame."""

    matrix: Numbers
    position: Numbers
    quaternion_xyzw: Numbers
    rpy: Numbers
    euler: EulerView | None = None


class FKResponse(msgspec.Struct, kw_only=True):
    """Poses by frame name; for a batch every leaf has a leading axis n."""

    units: UNITS_SCHEMA
    poses: dict[str, PoseView]


def pose_view(T: FloatArray, units: Units, sequence: str | None) -> dict[str, Any]:
    """A pose, shape (..., 4, 4), in every representation."""
    R = T[..., :3, :3]
    view: dict[str, Any] = {
        "matrix": T,
        "position": T[..., :3, 3],
        "quaternion_xyzw": quaternion_xyzw(R),
        "rpy": units.angles_out(rpy(R)),
    }
    if sequence is not None:
        angles = euler_angles(R, sequence)
        degenerate = angles.degenerate
        view["euler"] = {
            "sequence": sequence,
            "solutions": units.angles_out(angles.solutions),
            "degenerate": bool(degenerate) if degenerate.ndim == 0 else degenerate,
        }
    return view


def _frames(robot: Robot, asked: list[str] | str | None) -> Sequence[str]:
    if asked is None:
        return [robot.tip_frame]
    if asked == "all":
        return robot.frames
    if not asked:
        raise RequestProblem(
            INVALID_REQUEST, 'frames is empty; name frames, give "all" or leave it out', "/frames"
        )
    return [asked] if isinstance(asked, str) else list(dict.fromkeys(asked))


def _plain(
    robot: Robot, q: FloatArray, frames: Sequence[str], context: Context
) -> dict[str, dict[str, Any]]:
    """Poses at one q, of which JSON can be written at once."""
    units = context.units
    return {
        name: {
            "matrix": pose.matrix,
            "position": pose.position,
            "quaternion_xyzw": pose.quaternion_xyzw,
            "rpy": units.angles_out(np.array(pose.rpy)) if units.degrees else pose.rpy,
        }
        for name, pose in poses(robot, q, frames).items()
    }


def _run(robot: Robot, request: FKRequest, context: Context) -> Answer:
    frames = _frames(robot, request.frames)
    if request.euler is not None:
        parse_sequence(request.euler)
    q = read_configuration(request.q, robot, context)
    check_size(q, NUMBERS_A_POSE * len(frames))
    if q.ndim == 1 and request.euler is None and context.form == JSON:
        return Answer({"units": context.units.named, "poses": _plain(robot, q, frames, context)})
    found = fk(robot, q, frames)
    views = {name: pose_view(T, context.units, request.euler) for name, T in found.items()}
    array = next(iter(found.values())) if len(found) == 1 else np.stack(list(found.values()), -3)
    return Answer({"units": context.units.named, "poses": views}, array)


FK = Operation(
    name="fk",
    summary="Forward kinematics",
    description="Poses of frames at one q or a batch. As npy: matrices, shape (4, 4) or (n, 4, 4);"
    " several frames add an axis before the last two.",
    request=FKRequest,
    response=FKResponse,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "euler": "ZXZ"},
    example_robot="pa10",
    query=("q", "frames", "euler"),
    array_field="q",
)
