"""workspace and manipulability-map: what an arm can do, as numbers and as pictures."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec

from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.base import (
    UNITS_SCHEMA,
    Answer,
    Context,
    FrameField,
    Numbers,
    Operation,
    SingleConfiguration,
    TaskField,
    read_single,
)
from app.operations.schema import items, within
from app.pictures.map_figure import heat_figure, workspace_figure
from kinematics.manipulability_map import MAX_SAMPLES, MIN_SAMPLES, manipulability_map
from kinematics.task import task_from
from kinematics.workspace import MAX_POINTS, workspace
from robots.robot import Robot


class WorkspaceRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """How many points, and of which frame."""

    samples: Annotated[
        int, msgspec.Meta(description=f"Points, 1 to {MAX_POINTS}."), within(1, MAX_POINTS)
    ] = 20_000
    frame: FrameField = None
    random_seed: Annotated[
        int, msgspec.Meta(description="The same seed gives the same points.", ge=0)
    ] = 0


class WorkspaceResponse(msgspec.Struct, kw_only=True):
    """A cloud of reached positions in base axes, and the box around it."""

    units: UNITS_SCHEMA
    frame: str
    samples: int
    random_seed: int
    low: Numbers
    high: Numbers
    points: Numbers
    warnings: list[str]


class MapRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Over which joints, and in which task space."""

    q: SingleConfiguration
    joints: Annotated[
        list[str], msgspec.Meta(description="Names of the two joints that move."), items(2, 2)
    ]
    samples: Annotated[
        int,
        msgspec.Meta(description=f"Values of each, {MIN_SAMPLES} to {MAX_SAMPLES}."),
        within(MIN_SAMPLES, MAX_SAMPLES),
    ] = 100
    task: TaskField = "pose"
    frame: FrameField = None


class MapResponse(msgspec.Struct, kw_only=True):
    """Measures over a grid: rows by the second joint, columns by the first.

    ``inverse_condition``: smallest over largest singular value, 0 where singular.
    """

    units: UNITS_SCHEMA
    frame: str
    task: str
    joints: list[str]
    x: Numbers
    y: Numbers
    manipulability: Numbers
    inverse_condition: Numbers
    warnings: list[str]


def _workspace(robot: Robot, request: WorkspaceRequest, context: Context) -> Answer:
    cloud = workspace(robot, request.samples, request.frame, request.random_seed)
    frame = request.frame or robot.tip_frame
    payload: dict[str, Any] = {
        "units": context.units.named,
        "frame": frame,
        "samples": request.samples,
        "random_seed": request.random_seed,
        "low": cloud.low,
        "high": cloud.high,
        "points": cloud.points,
        "warnings": list(cloud.assumed),
    }
    title = f"{robot.name[:48]}: where {frame[:40]} gets"
    return Answer(payload, cloud.points, picture=lambda: workspace_figure(cloud.points, title))


def _map(robot: Robot, request: MapRequest, context: Context) -> Answer:
    q = read_single(request.q, robot, context)
    if len(request.joints) != 2:
        raise RequestProblem(
            INVALID_REQUEST, f"joints holds {len(request.joints)} names; give two", "/joints"
        )
    task = task_from(request.task)
    first, second = request.joints
    found = manipulability_map(robot, q, (first, second), request.samples, task, request.frame)
    is_revolute = {joint.name: joint.type.is_revolute for joint in robot.joints}
    units = context.units
    x, y = (
        units.angles_out(values) if is_revolute[name] else values
        for name, values in zip(found.joints, (found.x, found.y), strict=True)
    )
    frame = request.frame or robot.tip_frame
    payload: dict[str, Any] = {
        "units": units.named,
        "frame": frame,
        "task": task.name,
        "joints": list(found.joints),
        "x": x,
        "y": y,
        "manipulability": found.manipulability,
        "inverse_condition": found.inverse_condition,
        "warnings": list(found.assumed),
    }
    names = [
        f"{name[:40]} [{units.named['angle'] if is_revolute[name] else 'm'}]"
        for name in found.joints
    ]
    title = f"{robot.name[:40]}: manipulability, {task.name}"

    def picture() -> str:
        return heat_figure(x, y, found.manipulability, [*names, "w"], title)

    return Answer(payload, found.manipulability, picture=picture)


WORKSPACE = Operation(
    name="workspace",
    summary="Where the tip gets",
    description="Positions of a frame at joint values drawn evenly within the limits; joints that"
    " turn without limits go through a whole turn. As npy: shape (samples, 3). As SVG or PNG: how"
    " many points fall where.",
    request=WorkspaceRequest,
    response=WorkspaceResponse,
    run=_workspace,
    example={"samples": 1000},
    example_robot="panda",
    query=("samples", "frame", "random_seed"),
    quick=lambda *_: None,
    pictured=True,
)

MANIPULABILITY_MAP = Operation(
    name="manipulability-map",
    summary="Manipulability over two joints",
    description="Yoshikawa's w and the inverse condition number over the whole ranges of two"
    " joints; the others stay at q. As npy: w, shape (samples, samples), rows by the second joint."
    " As SVG or PNG: w as colours.",
    request=MapRequest,
    response=MapResponse,
    run=_map,
    example={"q": [0, 0.5, -0.5], "joints": ["j2", "j3"], "task": "xy", "samples": 50},
    example_robot="planar_3r",
    query=("q", "joints", "samples", "task", "frame"),
    quick=lambda *_: None,
    pictured=True,
)
