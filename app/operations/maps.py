"""workspace and manipulability-map: what an arm can do, as numbers and as pictures."""

from __future__ import annotations

from typing import Annotated, TypedDict

import msgspec

from app.admission.need import Need
from app.fields import texts
from app.fields.field import LEFT_OUT, Field, Parameter, declared
from app.fields.joints import SingleConfiguration
from app.fields.names import Frame, TaskSpace
from app.fields.numbers import within_query
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import (
    ARRAY_FORMS,
    PICTURES,
    Answer,
    Context,
    Operation,
    Runs,
)
from app.operations.shapes import AnswerUnits, Matrix, Position, Vector, rows, shaped
from app.operations.sizes import encoded, fixed_bytes
from app.pictures.map_figure import heat_figure, workspace_figure
from dh_to_urdf.messages import say
from kinematics.manipulability_map import SAMPLES as MAP_SAMPLES
from kinematics.manipulability_map import manipulability_map
from kinematics.manipulability_map import peak_bytes as map_bytes
from kinematics.task import POSE
from kinematics.workspace import SAMPLES as POINTS
from kinematics.workspace import peak_bytes as workspace_bytes
from kinematics.workspace import workspace
from robots.robot import FloatArray, Robot

SAMPLES = "Number of samples, the start included."


class WorkspaceRequest(msgspec.Struct, kw_only=True):
    """How many points, and of which frame."""

    samples: Annotated[
        int,
        within_query(
            POINTS.lower,
            POINTS.upper,
            f"Points, {POINTS.lower} to {POINTS.upper}.",
            SAMPLES,
            texts.integer,
        ),
    ] = 20_000
    frame: Frame = LEFT_OUT
    random_seed: Annotated[
        int,
        declared(
            Field((Parameter(texts.integer, "Seed of the random starts."),)),
            "The same seed gives the same points.",
        ),
        msgspec.Meta(ge=0),
    ] = 0


class WorkspaceAnswer(TypedDict):
    """A cloud of reached positions in base axes, and the box around it."""

    units: AnswerUnits
    frame: str
    samples: int
    random_seed: int
    low: Position
    high: Position
    points: Annotated[FloatArray, shaped(rows(columns=3))]
    warnings: list[str]


class MapRequest(msgspec.Struct, kw_only=True):
    """Over which joints, and in which task space."""

    q: SingleConfiguration
    joints: Annotated[
        list[str],
        declared(
            Field((Parameter(texts.names, "Names of two joints, comma-separated."),)),
            "Names of the two joints that move.",
            {"minItems": 2, "maxItems": 2},
        ),
    ]
    samples: Annotated[
        int,
        within_query(
            MAP_SAMPLES.lower,
            MAP_SAMPLES.upper,
            f"Values of each, {MAP_SAMPLES.lower} to {MAP_SAMPLES.upper}.",
            SAMPLES,
            texts.integer,
        ),
    ] = 100
    task: TaskSpace = POSE
    frame: Frame = LEFT_OUT


class MapAnswer(TypedDict):
    """Measures over a grid: rows by the second joint, columns by the first.

    ``inverse_condition``: smallest over largest singular value, 0 where singular.
    """

    units: AnswerUnits
    frame: str
    task: str
    joints: list[str]
    x: Vector
    y: Vector
    manipulability: Matrix
    inverse_condition: Matrix
    warnings: list[str]


def _workspace_memory(_: Robot, request: WorkspaceRequest, context: Context) -> Need:
    each = workspace_bytes(1) - workspace_bytes(0) + encoded(context.form, 3, 3)
    fixed = fixed_bytes(context.form) + workspace_bytes(0)
    return Need(each, request.samples, fixed, "samples", "samples")


def _map_memory(_: Robot, request: MapRequest, context: Context) -> Need:
    each = map_bytes(1) - map_bytes(0) + encoded(context.form, 2, 1)
    fixed = fixed_bytes(context.form) + map_bytes(0)
    return Need(each, request.samples, fixed, "samples", "samples", squared=True)


def _workspace(robot: Robot, request: WorkspaceRequest, context: Context) -> Answer:
    cloud = workspace(robot, request.samples, request.frame, request.random_seed)
    frame, units = request.frame, context.units
    answer: WorkspaceAnswer = {
        "units": context.units.named,
        "frame": frame,
        "samples": request.samples,
        "random_seed": request.random_seed,
        "low": units.lengths_out(cloud.low),
        "high": units.lengths_out(cloud.high),
        "points": units.lengths_out(cloud.points),
        "warnings": [*context.warnings, *cloud.assumed],
    }
    title = say("{robot}: where {frame} gets", robot=robot.name[:48], frame=frame[:40])
    points = units.lengths_out(cloud.points)
    return Answer(answer, points, picture=lambda: workspace_figure(cloud.points, title))


def _map(robot: Robot, request: MapRequest, context: Context) -> Answer:
    q = request.q
    if len(request.joints) != 2:
        raise RequestProblem(
            INVALID_REQUEST,
            say("joints holds {count} names; give two", count=len(request.joints)),
            "/joints",
        )
    task = request.task
    first, second = request.joints
    found = manipulability_map(robot, q, (first, second), request.samples, task, request.frame)
    is_revolute = {joint.name: joint.type.is_revolute for joint in robot.joints}
    units = context.units
    x, y = (
        units.angles_out(values) if is_revolute[name] else units.lengths_out(values)
        for name, values in zip(found.joints, (found.x, found.y), strict=True)
    )
    frame = request.frame
    answer: MapAnswer = {
        "units": units.named,
        "frame": frame,
        "task": task.name,
        "joints": list(found.joints),
        "x": x,
        "y": y,
        "manipulability": found.manipulability,
        "inverse_condition": found.inverse_condition,
        "warnings": [*context.warnings, *found.assumed],
    }
    names = [
        f"{name[:40]} [{units.named['angle'] if is_revolute[name] else units.length}]"
        for name in found.joints
    ]
    title = say("{robot}: manipulability, {task}", robot=robot.name[:40], task=task.name)

    def picture() -> str:
        return heat_figure(x, y, found.manipulability, [*names, "w"], title)

    return Answer(answer, found.manipulability, picture=picture)


WORKSPACE = Operation(
    name="workspace",
    summary="Where the tip gets",
    description="Positions of a frame at joint values drawn evenly within the limits; joints that"
    " turn without limits go through a whole turn. As npy: shape (samples, 3). As SVG or PNG: how"
    " many points fall where.",
    request=WorkspaceRequest,
    answer=WorkspaceAnswer,
    memory=_workspace_memory,
    run=_workspace,
    example={"samples": 1000},
    example_robot="panda",
    runs=Runs.THREAD,
    forms=(*ARRAY_FORMS, *PICTURES),
)

MANIPULABILITY_MAP = Operation(
    name="manipulability-map",
    summary="Manipulability over two joints",
    description="Yoshikawa's w and the inverse condition number over the whole ranges of two"
    " joints; the others stay at q. As npy: w, shape (samples, samples), rows by the second joint."
    " As SVG or PNG: w as colours.",
    request=MapRequest,
    answer=MapAnswer,
    memory=_map_memory,
    run=_map,
    example={"q": [0, 0.5, -0.5], "joints": ["j2", "j3"], "task": "xy", "samples": 50},
    example_robot="planar_3r",
    runs=Runs.THREAD,
    forms=(*ARRAY_FORMS, *PICTURES),
)
