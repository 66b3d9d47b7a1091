"""singularity/nearest: the nearest singular configuration."""

from __future__ import annotations

from typing import TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields.field import LEFT_OUT
from app.fields.joints import SingleConfiguration
from app.fields.names import Frame, TaskSpace
from app.fields.numbers import RankTolerance
from app.operations.operation import Answer, Context, Operation, Runs, check_size
from app.operations.shapes import AnswerUnits, Vector
from app.operations.sizes import fixed_bytes
from kinematics.configuration import joint_names
from kinematics.derivatives import hessian_bytes
from kinematics.nearest_singularity import SingularAlongJoint, nearest_singularity
from kinematics.singularity import RANK_TOLERANCE
from kinematics.task import POSE
from robots.robot import FloatArray, Robot


class NearestSingularityRequest(msgspec.Struct, kw_only=True):
    """Near what, and in which task space."""

    q: SingleConfiguration
    task: TaskSpace = POSE
    frame: Frame = LEFT_OUT
    tolerance: RankTolerance = RANK_TOLERANCE


class SingularAlongJointView(TypedDict):
    """Where one joint alone makes the arm singular; nulls where it cannot within its limits.

    ``values``: all such values within the limits and a turn of q. ``singular_value``: the smallest
    one of the task Jacobian at ``value``, measured.
    """

    joint: str
    value: float | None
    distance: float | None
    values: list[float]
    singular_value: float | None


class NearestView(TypedDict):
    """A singular configuration, and its Euclidean distance in the units of the answer."""

    q: Vector
    distance: float
    singular_value: float


class NearestSingularityAnswer(TypedDict):
    """Along each joint alone, and the nearest with all joints moving that was found."""

    units: AnswerUnits
    singular: bool
    nearest: NearestView | None
    joints: list[SingularAlongJointView]
    columns: list[str]
    frame: str
    task: str
    tolerance: float
    warnings: list[str]


def _memory(robot: Robot, _: NearestSingularityRequest, context: Context) -> Need:
    return Need(0.0, fixed=fixed_bytes(context.form) + hessian_bytes(robot.dof) * 8)


def _run(robot: Robot, request: NearestSingularityRequest, context: Context) -> Answer:
    task, units = request.task, context.units
    frame = request.frame
    q = request.q
    check_size(q, robot.dof)
    found = nearest_singularity(robot, q, task, frame, tolerance=request.tolerance)
    here = units.joints_out(robot, q)
    nearest: NearestView | None = None
    array: FloatArray | None = None
    if found.q is not None and found.singular_value is not None:
        array = units.joints_out(robot, found.q)
        nearest = {
            "q": array,
            "distance": float(np.linalg.norm(array - here)),
            "singular_value": found.singular_value,
        }
    answer: NearestSingularityAnswer = {
        "units": units.named,
        "singular": found.singular,
        "nearest": nearest,
        "joints": [_view(robot, one, context) for one in found.joints],
        "columns": list(joint_names(robot)),
        "frame": frame,
        "task": task.name,
        "tolerance": request.tolerance,
        "warnings": context.warnings,
    }
    return Answer(answer, array)


def _view(robot: Robot, one: SingularAlongJoint, context: Context) -> SingularAlongJointView:
    units, turns = context.units, robot.is_revolute[one.column]
    scale = units.angle_out(1.0) if turns else units.length_out(1.0)
    return {
        "joint": robot.joints[one.column].name,
        "value": None if one.value is None else one.value * scale,
        "distance": None if one.distance is None else one.distance * scale,
        "values": [value * scale for value in one.values],
        "singular_value": one.singular_value,
    }


NEAREST_SINGULARITY = Operation(
    name="singularity/nearest",
    summary="The nearest singular configuration",
    description="For each joint alone all values within its limits that make the arm singular in a"
    " `task` (roots of the determinant's trigonometric polynomial), the nearest of them and how far"
    " it is; and the nearest singular q with all joints moving, by descent from there: a local"
    " minimum of the distance. Each is checked on the model. As npy: that q.",
    request=NearestSingularityRequest,
    answer=NearestSingularityAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.1, 0.5, -1.2, 0.3, 0.6, 0.2]},
    example_robot="puma560",
    runs=Runs.THREAD,
)
