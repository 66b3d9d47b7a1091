"""singularity: rank, singular values, lost directions and null motions in a task space."""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated, Any

import msgspec
import numpy as np

from app.operations.base import (
    UNITS_SCHEMA,
    Answer,
    Configuration,
    Context,
    Numbers,
    Operation,
    TaskField,
    check_size,
    read_configuration,
)
from kinematics.configuration import joint_names
from kinematics.errors import InvalidOption
from kinematics.jacobian import task_jacobian
from kinematics.singularity import RANK_TOLERANCE, SingularityReport, report_on
from kinematics.task import task_from
from robots.robot import Robot


class SingularityRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Where to look, and in which task space."""

    q: Configuration
    task: TaskField = "pose"
    frame: Annotated[str | None, msgspec.Meta(description="Frame name; default the tip.")] = None
    tolerance: Annotated[
        float,
        msgspec.Meta(
            description="Singular values below tolerance * max(1, largest) count as zero."
        ),
    ] = RANK_TOLERANCE


class SingularityResponse(msgspec.Struct, kw_only=True):
    """The report; for a batch every leaf has a leading axis n."""

    units: UNITS_SCHEMA
    task: str
    rows: list[str]
    columns: list[str]
    frame: str
    rank: int | list[int]
    singular_values: Numbers
    condition_number: float | list[float | None] | None
    manipulability: float | list[float]
    lost_directions: Numbers
    null_motions: Numbers
    singular: bool | list[bool]
    tolerance: float
    warnings: list[str]


_LEAVES = (
    "rank",
    "singular_values",
    "condition_number",
    "manipulability",
    "lost_directions",
    "null_motions",
    "singular",
)


def _run(robot: Robot, request: SingularityRequest, context: Context) -> Answer:
    task = task_from(request.task)
    if not 0 <= request.tolerance < 1:
        raise InvalidOption(
            f"tolerance is {request.tolerance:g}; give 0 up to below 1", "/tolerance"
        )
    frame = robot.tip_frame if request.frame is None else request.frame
    q = read_configuration(request.q, robot, context)
    check_size(q, 6 * robot.dof + robot.dof**2)
    J = task_jacobian(robot, q, task, frame)
    batch = [report_on(one, robot, task, request.tolerance) for one in (J if q.ndim == 2 else [J])]
    first = batch[0]
    leaves = _stacked(batch) if q.ndim == 2 else {name: getattr(first, name) for name in _LEAVES}
    payload = {
        "units": {"angle": "rad", "length": "m"},
        "task": task.name,
        "rows": list(task.row_names),
        "columns": list(joint_names(robot)),
        "frame": frame,
        **leaves,
        "tolerance": first.tolerance,
        "warnings": list(first.warnings),
    }
    values = np.array([report.singular_values for report in batch])
    return Answer(payload, values if q.ndim == 2 else values[0])


def _stacked(batch: list[SingularityReport]) -> dict[str, Any]:
    assert set(_LEAVES) <= {field.name for field in fields(SingularityReport)}
    return {name: [getattr(report, name) for report in batch] for name in _LEAVES}


SINGULARITY = Operation(
    name="singularity",
    summary="Singularity report",
    description="Rank, singular values, condition number (null where infinite), manipulability,"
    " task directions that are lost and joint motions that do nothing. Choose a task that fits the"
    " arm: a planar arm is only seen as singular in `xy` or `xy_phi`. As npy: singular values.",
    request=SingularityRequest,
    response=SingularityResponse,
    run=_run,
    example={"q": [0.5236, 0.0], "task": "xy"},
    example_robot="planar_2r",
    query=("q", "task", "frame", "tolerance"),
    array_field="q",
)
