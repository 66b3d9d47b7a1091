"""twist and joint-velocities: differential kinematics both ways."""

from __future__ import annotations

from typing import Annotated, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields.field import LEFT_OUT
from app.fields.joints import Configuration, JointRates
from app.fields.names import Frame, ReferenceFrameChoice, TaskSpace
from app.fields.numbers import RankTolerance, within_query
from app.fields.vectors import Twist, angular_rows
from app.operations.operation import Answer, Context, Operation, check_size
from app.operations.shapes import (
    AnswerUnits,
    EachFlag,
    EachInteger,
    EachMatrix,
    EachText,
    EachVector,
    each,
    vector,
)
from app.operations.sizes import FLOAT, ROW_OBJECTS, encoded, rows_need, rows_of
from dh_to_urdf.messages import chained, say
from kinematics.configuration import joint_names
from kinematics.jacobian import peak_bytes
from kinematics.singularity import RANK_TOLERANCE
from kinematics.task import POSE, Task
from kinematics.velocity import JointVelocities, joint_velocities, joint_velocities_bytes, twist_of
from robots.robot import FloatArray, Robot


class TwistRequest(msgspec.Struct, kw_only=True):
    """Which motion."""

    q: Configuration
    qd: JointRates
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT


class TwistAnswer(TypedDict):
    """The twist; for a batch with a leading axis n."""

    units: AnswerUnits
    twist: Annotated[FloatArray, each(vector(6))]
    rows: list[str]
    frame: str
    reference_frame: str
    warnings: list[str]


class JointVelocitiesRequest(msgspec.Struct, kw_only=True):
    """Which twist to follow, and how."""

    q: Configuration
    twist: Twist
    task: TaskSpace = POSE
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT
    damping: Annotated[
        float,
        within_query(
            0,
            1e6,
            "λ of qd = Jᵀ (J Jᵀ + λ² I)⁻¹ twist; 0 (none), or 1e-12 up to 1e6.",
            "0 (none), or such as 0.01.",
        ),
    ] = 0.0
    tolerance: RankTolerance = RANK_TOLERANCE


class JointVelocitiesAnswer(TypedDict):
    """Joint velocities; for a batch every leaf but the names has a leading axis n.

    ``status``: ``exact``; ``damped``, as asked; or ``rank_deficient``: not every twist can be had
    here, and ``residual`` (what results less what was asked, measured on the model) tells how far
    this one is.
    """

    units: AnswerUnits
    status: EachText
    qd: EachVector
    residual: EachVector
    rank: EachInteger
    null_motions: EachMatrix
    within_velocity_limits: EachFlag
    rows: list[str]
    columns: list[str]
    frame: str
    task: str
    reference_frame: str
    damping: float
    tolerance: float
    warnings: list[str]


def _twist_memory(robot: Robot, request: TwistRequest, context: Context) -> Need:
    each = peak_bytes(robot.dof) + FLOAT * (2 * robot.dof + 12) + encoded(context.form, 6, 6)
    return rows_need(rows_of(request.q, request.qd), each, context.form, numbers=6 * robot.dof)


def _velocities_memory(robot: Robot, request: JointVelocitiesRequest, context: Context) -> Need:
    dof = robot.dof
    each = float(joint_velocities_bytes(dof) + FLOAT * dof**2 + ROW_OBJECTS)
    each += encoded(context.form, dof**2 + 2 * dof + 8, dof)
    return rows_need(
        rows_of(request.q, request.twist), each, context.form, numbers=6 * dof + dof**2
    )


def _twist(robot: Robot, request: TwistRequest, context: Context) -> Answer:
    frame = request.frame
    q = request.q
    check_size(q, 6 * robot.dof)
    twist = twist_of(robot, q, request.qd, frame, request.reference_frame)
    twist = context.units.rows_out(angular_rows(POSE), twist)
    answer: TwistAnswer = {
        "units": context.units.named_rates,
        "twist": twist,
        "rows": list(POSE.row_names),
        "frame": frame,
        "reference_frame": request.reference_frame.value,
        "warnings": context.warnings,
    }
    return Answer(answer, twist)


def _joint_velocities(robot: Robot, request: JointVelocitiesRequest, context: Context) -> Answer:
    task, units = request.task, context.units
    frame = request.frame
    q = request.q
    twist = request.twist
    check_size(twist if twist.ndim == 2 else q, 6 * robot.dof + robot.dof**2)
    angular = angular_rows(task)
    found = joint_velocities(
        robot,
        q,
        twist,
        task,
        frame,
        request.reference_frame,
        damping=request.damping,
        tolerance=request.tolerance,
    )
    batch = found.qd.ndim == 2
    null_motions = [units.directions_out(robot.is_revolute, basis) for basis in found.null_motions]
    qd = units.joints_out(robot, found.qd)
    if request.damping:
        status = np.full(found.determined.shape, "damped")
    else:
        status = np.where(found.determined, "exact", "rank_deficient")
    rank, status = (np.broadcast_to(x, found.qd.shape[:-1]) for x in (found.rank, status))
    if batch and len(null_motions) == 1:
        null_motions *= len(qd)
    answer: JointVelocitiesAnswer = {
        "units": units.named_rates,
        "status": status.tolist(),
        "qd": qd,
        "residual": units.rows_out(angular, found.residual),
        "rank": rank.tolist(),
        "null_motions": null_motions if batch else null_motions[0],
        "within_velocity_limits": found.within_velocity_limits.tolist(),
        "rows": list(task.row_names),
        "columns": list(joint_names(robot)),
        "frame": frame,
        "task": task.name,
        "reference_frame": request.reference_frame.value,
        "damping": request.damping,
        "tolerance": request.tolerance,
        "warnings": [*context.warnings, *_warnings(robot, task, found, request.damping)],
    }
    return Answer(answer, qd)


def _warnings(robot: Robot, task: Task, found: JointVelocities, damping: float) -> list[str]:
    warnings: list[str] = []
    if not found.determined.all() and not damping:
        ranks = np.unique(found.rank[~found.determined])
        warnings.append(
            say(
                "the rank is {ranks} of {count}: not every twist can be had, qd is the"
                " least-squares solution of least norm; give damping, such as 0.01, for"
                " small joint velocities near here too",
                ranks=chained(say(" or "), map(str, ranks)),
                count=len(task.rows),
            )
        )
    if not np.all(found.within_velocity_limits):
        warnings.append(
            say("a joint would be faster than its limit; ask for a slower twist or damp")
        )
    if robot.is_revolute.any() and not robot.is_revolute.all():
        warnings.append(
            say("the least norm weighs rad/s and m/s alike, as some joints turn and others slide")
        )
    return warnings


TWIST = Operation(
    name="twist",
    summary="Joint velocities to the twist of a frame",
    description="`[v; ω] = J(q) qd` of a frame against the base, in a `reference_frame`. q and qd"
    " may be batches of equal length, or one of them a batch. As npy: the twist.",
    request=TwistRequest,
    answer=TwistAnswer,
    memory=_twist_memory,
    run=_twist,
    example={
        "q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
        "qd": [0.1, 0, 0, 0.2, 0, 0, 0],
        "reference_frame": "local_world_aligned",
    },
    example_robot="pa10",
    npy_field="q",
)

JOINT_VELOCITIES = Operation(
    name="joint-velocities",
    summary="Twist of a frame to joint velocities",
    description="The joint velocities of least norm by the pseudo-inverse, or with `damping` by"
    " damped least squares; with the residual twist, the rank, and the null motions that may be"
    " added. Where the rank is deficient, `status` and `warnings` say so. As npy: qd.",
    request=JointVelocitiesRequest,
    answer=JointVelocitiesAnswer,
    memory=_velocities_memory,
    run=_joint_velocities,
    example={
        "q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
        "twist": [0.1, 0, 0],
        "task": "position",
    },
    example_robot="pa10",
    npy_field="q",
)
