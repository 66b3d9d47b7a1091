"""joint-torques and wrench: statics both ways."""

from __future__ import annotations

import msgspec
import numpy as np

from app.http.units import Units
from app.operations.base import (
    UNITS_SCHEMA,
    Answer,
    Configuration,
    Context,
    FrameField,
    Numbers,
    Operation,
    RankToleranceField,
    ReferenceFrameField,
    TaskField,
    check_size,
    read_configuration,
    read_frame,
    read_reference_frame,
)
from app.operations.spatial import WrenchField, read_vector
from kinematics.configuration import joint_names
from kinematics.singularity import RANK_TOLERANCE
from kinematics.spatial_vectors import WRENCH_ROWS
from kinematics.statics import joint_torques, wrench_of
from kinematics.task import task_from
from robots.robot import Robot

_UNITS = {"angle": "rad", "length": "m", "force": "N", "torque": "N m"}


class JointTorquesRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Which wrench to hold."""

    q: Configuration
    wrench: WrenchField
    frame: FrameField = None
    reference_frame: ReferenceFrameField = None


class JointTorquesResponse(msgspec.Struct, kw_only=True):
    """Joint torques (forces of prismatic joints); for a batch with a leading axis n."""

    units: UNITS_SCHEMA
    tau: Numbers
    within_effort_limits: bool | list[bool]
    columns: list[str]
    rows: list[str]
    frame: str
    reference_frame: str


class WrenchRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Which torques, and in which rows there is a wrench."""

    q: Configuration
    tau: Configuration
    task: TaskField = "pose"
    frame: FrameField = None
    reference_frame: ReferenceFrameField = None
    tolerance: RankToleranceField = RANK_TOLERANCE


class WrenchResponse(msgspec.Struct, kw_only=True):
    """The wrench; for a batch every leaf but the names has a leading axis n.

    Where ``determined`` is false, multiples of ``lost_directions`` may be added: the structure
    carries them without torques. ``residual`` holds the torques that no wrench balances.
    """

    units: UNITS_SCHEMA
    wrench: Numbers
    determined: bool | list[bool]
    rank: int | list[int]
    residual: Numbers
    lost_directions: Numbers
    rows: list[str]
    columns: list[str]
    frame: str
    task: str
    reference_frame: str
    tolerance: float


def _joint_torques(robot: Robot, request: JointTorquesRequest, context: Context) -> Answer:
    reference_frame = read_reference_frame(request.reference_frame)
    frame = read_frame(request.frame, robot)
    q = read_configuration(request.q, robot, context)
    check_size(q, 6 * robot.dof)
    wrench = read_vector(request.wrench, WRENCH_ROWS, context, "wrench")
    check_size(wrench, robot.dof, "/wrench")
    tau = joint_torques(robot, q, wrench, frame, reference_frame)
    limits = np.array([np.inf if j.effort is None else j.effort for j in robot.joints])
    payload = {
        "units": _UNITS,
        "tau": tau,
        "within_effort_limits": np.all(np.abs(tau) <= limits, axis=-1).tolist(),
        "columns": list(joint_names(robot)),
        "rows": list(WRENCH_ROWS),
        "frame": frame,
        "reference_frame": reference_frame.value,
    }
    return Answer(payload, tau)


def _wrench(robot: Robot, request: WrenchRequest, context: Context) -> Answer:
    task = task_from(request.task)
    reference_frame = read_reference_frame(request.reference_frame)
    frame = read_frame(request.frame, robot)
    q = read_configuration(request.q, robot, context)
    # Torques are no angles: ?angle=deg leaves them alone.
    tau = read_configuration(request.tau, robot, Context(Units(), context.settings), "tau")
    check_size(tau if tau.ndim == 2 else q, 6 * robot.dof + robot.dof**2)
    found = wrench_of(
        robot, q, tau, task, frame, reference_frame, tolerance=request.tolerance
    )  # fmt: skip
    shape = found.wrench.shape[:-1]
    lost = found.lost_directions
    if shape and len(lost) == 1:
        lost *= shape[0]
    payload = {
        "units": _UNITS,
        "wrench": found.wrench,
        "determined": np.broadcast_to(found.determined, shape).tolist(),
        "rank": np.broadcast_to(found.rank, shape).tolist(),
        "residual": found.residual,
        "lost_directions": lost if shape else lost[0],
        "rows": [WRENCH_ROWS[row] for row in task.rows],
        "columns": list(joint_names(robot)),
        "frame": frame,
        "task": task.name,
        "reference_frame": reference_frame.value,
        "tolerance": request.tolerance,
    }
    return Answer(payload, found.wrench)


JOINT_TORQUES = Operation(
    name="joint-torques",
    summary="Wrench at a frame to joint torques",
    description="`τ = J(q)ᵀ w`: the torques (forces of prismatic joints) with which the arm, at"
    " rest and without weight, exerts the wrench w. The wrench is taken at the same point and in"
    " the same axes as the twist of that `reference_frame`. As npy: tau.",
    request=JointTorquesRequest,
    response=JointTorquesResponse,
    run=_joint_torques,
    example={"q": [0, 0.5, -1.2, 0, 0.6, 0], "wrench": [0, 0, 10, 0, 0, 1]},
    example_robot="puma560",
    query=("q", "wrench", "frame", "reference_frame"),
    array_field="q",
)

WRENCH = Operation(
    name="wrench",
    summary="Joint torques to the wrench at a frame",
    description="The wrench that the arm exerts with given torques, at rest and without weight:"
    " `w` of `τ = J(q)ᵀ w`, where the torques determine it; else the one of least norm, and the"
    " directions that are open. As npy: the wrench.",
    request=WrenchRequest,
    response=WrenchResponse,
    run=_wrench,
    example={"q": [0, 0.5, -1.2, 0, 0.6, 0], "tau": [1, -4, -3, 0.2, 0.5, 0.8]},
    example_robot="puma560",
    query=("q", "tau", "task", "frame", "reference_frame", "tolerance"),
    array_field="q",
)
