"""joint-torques and wrench: statics both ways."""

from __future__ import annotations

from typing import TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields.field import LEFT_OUT
from app.fields.joints import Configuration, JointEfforts
from app.fields.names import Frame, ReferenceFrameChoice, TaskSpace
from app.fields.numbers import RankTolerance
from app.fields.vectors import Wrench
from app.operations.operation import Answer, Context, Operation, check_size
from app.operations.shapes import (
    AnswerUnits,
    EachFlag,
    EachInteger,
    EachMatrix,
    EachVector,
)
from app.operations.sizes import FLOAT, ROW_OBJECTS, encoded, rows_need, rows_of
from kinematics.configuration import joint_names
from kinematics.jacobian import peak_bytes
from kinematics.singularity import RANK_TOLERANCE
from kinematics.spatial_vectors import WRENCH_ROWS
from kinematics.statics import joint_torques, wrench_bytes, wrench_of
from kinematics.task import POSE
from robots.robot import Robot

_UNITS = {"angle": "rad", "length": "m", "force": "N", "torque": "N m"}


class JointTorquesRequest(msgspec.Struct, kw_only=True):
    """Which wrench to hold."""

    q: Configuration
    wrench: Wrench
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT


class JointTorquesAnswer(TypedDict):
    """Joint torques (forces of prismatic joints); for a batch with a leading axis n."""

    units: AnswerUnits
    tau: EachVector
    within_effort_limits: EachFlag
    columns: list[str]
    rows: list[str]
    frame: str
    reference_frame: str
    warnings: list[str]


class WrenchRequest(msgspec.Struct, kw_only=True):
    """Which torques, and in which rows there is a wrench."""

    q: Configuration
    tau: JointEfforts
    task: TaskSpace = POSE
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT
    tolerance: RankTolerance = RANK_TOLERANCE


class WrenchAnswer(TypedDict):
    """The wrench; for a batch every leaf but the names has a leading axis n.

    Where ``determined`` is false, multiples of ``lost_directions`` may be added: the structure
    carries them without torques. ``residual`` holds the torques that no wrench balances.
    """

    units: AnswerUnits
    wrench: EachVector
    determined: EachFlag
    rank: EachInteger
    residual: EachVector
    lost_directions: EachMatrix
    rows: list[str]
    columns: list[str]
    frame: str
    task: str
    reference_frame: str
    tolerance: float
    warnings: list[str]


def _torques_memory(robot: Robot, request: JointTorquesRequest, context: Context) -> Need:
    each = float(peak_bytes(robot.dof) + FLOAT * (2 * robot.dof + 12))
    each += encoded(context.form, robot.dof + 1, robot.dof)
    rows = rows_of(request.q, request.wrench)
    return rows_need(rows, each, context.form, numbers=6 * robot.dof)


def _wrench_memory(robot: Robot, request: WrenchRequest, context: Context) -> Need:
    each = wrench_bytes(robot.dof) + ROW_OBJECTS + encoded(context.form, robot.dof + 36, 6)
    rows, numbers = rows_of(request.q, request.tau), 6 * robot.dof + robot.dof**2
    return rows_need(rows, each, context.form, numbers=numbers)


def _joint_torques(robot: Robot, request: JointTorquesRequest, context: Context) -> Answer:
    frame = request.frame
    q = request.q
    check_size(q, 6 * robot.dof)
    check_size(request.wrench, robot.dof, "wrench")
    tau = joint_torques(robot, q, request.wrench, frame, request.reference_frame)
    limits = np.array([np.inf if j.effort is None else j.effort for j in robot.joints])
    answer: JointTorquesAnswer = {
        "units": _UNITS,
        "tau": tau,
        "within_effort_limits": np.all(np.abs(tau) <= limits, axis=-1).tolist(),
        "columns": list(joint_names(robot)),
        "rows": list(WRENCH_ROWS),
        "frame": frame,
        "reference_frame": request.reference_frame.value,
        "warnings": context.warnings,
    }
    return Answer(answer, tau)


def _wrench(robot: Robot, request: WrenchRequest, context: Context) -> Answer:
    task = request.task
    frame = request.frame
    q = request.q
    tau = request.tau
    check_size(tau if tau.ndim == 2 else q, 6 * robot.dof + robot.dof**2)
    found = wrench_of(
        robot, q, tau, task, frame, request.reference_frame, tolerance=request.tolerance
    )
    shape = found.wrench.shape[:-1]
    lost = found.lost_directions
    if shape and len(lost) == 1:
        lost *= shape[0]
    answer: WrenchAnswer = {
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
        "reference_frame": request.reference_frame.value,
        "tolerance": request.tolerance,
        "warnings": context.warnings,
    }
    return Answer(answer, found.wrench)


JOINT_TORQUES = Operation(
    name="joint-torques",
    summary="Wrench at a frame to joint torques",
    description="`τ = J(q)ᵀ w`: the torques (forces of prismatic joints) with which the arm, at"
    " rest and without weight, exerts the wrench w. The wrench is taken at the same point and in"
    " the same axes as the twist of that `reference_frame`. As npy: tau.",
    request=JointTorquesRequest,
    answer=JointTorquesAnswer,
    memory=_torques_memory,
    run=_joint_torques,
    example={"q": [0, 0.5, -1.2, 0, 0.6, 0], "wrench": [0, 0, 10, 0, 0, 1]},
    example_robot="puma560",
    npy_field="q",
)

WRENCH = Operation(
    name="wrench",
    summary="Joint torques to the wrench at a frame",
    description="The wrench that the arm exerts with given torques, at rest and without weight:"
    " `w` of `τ = J(q)ᵀ w`, where the torques determine it; else the one of least norm, and the"
    " directions that are open. As npy: the wrench.",
    request=WrenchRequest,
    answer=WrenchAnswer,
    memory=_wrench_memory,
    run=_wrench,
    example={"q": [0, 0.5, -1.2, 0, 0.6, 0], "tau": [1, -4, -3, 0.2, 0.5, 0.8]},
    example_robot="puma560",
    npy_field="q",
)
