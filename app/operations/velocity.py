"""twist and joint-velocities: differential kinematics both ways."""

from __future__ import annotations

from typing import Annotated

import msgspec
import numpy as np

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
from app.operations.schema import within
from app.operations.spatial import TwistField, angular_rows, read_vector
from kinematics.configuration import joint_names
from kinematics.singularity import RANK_TOLERANCE
from kinematics.task import POSE, Task, task_from
from kinematics.velocity import JointVelocities, joint_velocities, twist_of
from robots.robot import Robot


class TwistRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Which motion."""

    q: Configuration
    qd: Configuration
    frame: FrameField = None
    reference_frame: ReferenceFrameField = None


class TwistResponse(msgspec.Struct, kw_only=True):
    """The twist; for a batch with a leading axis n."""

    units: UNITS_SCHEMA
    twist: Numbers
    rows: list[str]
    frame: str
    reference_frame: str


class JointVelocitiesRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Which twist to follow, and how."""

    q: Configuration
    twist: TwistField
    task: TaskField = "pose"
    frame: FrameField = None
    reference_frame: ReferenceFrameField = None
    damping: Annotated[
        float,
        msgspec.Meta(
            description="λ of qd = Jᵀ (J Jᵀ + λ² I)⁻¹ twist; 0 (none), or 1e-12 up to 1e6."
        ),
        within(0, 1e6),
    ] = 0.0
    tolerance: RankToleranceField = RANK_TOLERANCE


class JointVelocitiesResponse(msgspec.Struct, kw_only=True):
    """Joint velocities; for a batch every leaf but the names has a leading axis n.

    ``status``: ``exact``; ``damped``, as asked; or ``rank_deficient``: not every twist can be had
    here, and ``residual`` (what results less what was asked, measured on the model) tells how far
    this one is.
    """

    units: UNITS_SCHEMA
    status: str | list[str]
    qd: Numbers
    residual: Numbers
    rank: int | list[int]
    null_motions: Numbers
    within_velocity_limits: bool | list[bool]
    rows: list[str]
    columns: list[str]
    frame: str
    task: str
    reference_frame: str
    damping: float
    tolerance: float
    warnings: list[str]


def _twist(robot: Robot, request: TwistRequest, context: Context) -> Answer:
    reference_frame = read_reference_frame(request.reference_frame)
    frame = read_frame(request.frame, robot)
    q = read_configuration(request.q, robot, context)
    check_size(q, 6 * robot.dof)
    qd = read_configuration(request.qd, robot, context, "qd")
    twist = twist_of(robot, q, qd, frame, reference_frame)
    twist = context.units.rows_out(angular_rows(POSE), twist)
    payload = {
        "units": context.units.named_rates,
        "twist": twist,
        "rows": list(POSE.row_names),
        "frame": frame,
        "reference_frame": reference_frame.value,
    }
    return Answer(payload, twist)


def _joint_velocities(robot: Robot, request: JointVelocitiesRequest, context: Context) -> Answer:
    task, units = task_from(request.task), context.units
    reference_frame = read_reference_frame(request.reference_frame)
    frame = read_frame(request.frame, robot)
    q = read_configuration(request.q, robot, context)
    twist = read_vector(request.twist, task.row_names, context, "twist")
    check_size(twist if twist.ndim == 2 else q, 6 * robot.dof + robot.dof**2)
    angular = angular_rows(task)
    found = joint_velocities(
        robot, q, units.rows_in(angular, twist), task, frame, reference_frame,
        damping=request.damping, tolerance=request.tolerance,
    )  # fmt: skip
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
    payload = {
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
        "reference_frame": reference_frame.value,
        "damping": request.damping,
        "tolerance": request.tolerance,
        "warnings": _warnings(robot, task, found, request.damping),
    }
    return Answer(payload, qd)


def _warnings(robot: Robot, task: Task, found: JointVelocities, damping: float) -> list[str]:
    warnings = []
    if not found.determined.all() and not damping:
        ranks = np.unique(found.rank[~found.determined])
        warnings.append(
            f"the rank is {' or '.join(map(str, ranks))} of {len(task.rows)}: not every twist can"
            " be had, qd is the least-squares solution of least norm; give damping, such as 0.01,"
            " for small joint velocities near here too"
        )
    if not np.all(found.within_velocity_limits):
        warnings.append("a joint would be faster than its limit; ask for a slower twist or damp")
    if robot.is_revolute.any() and not robot.is_revolute.all():
        warnings.append("the least norm weighs rad/s and m/s alike, as some joints turn and others"
                        " slide")  # fmt: skip
    return warnings


TWIST = Operation(
    name="twist",
    summary="Joint velocities to the twist of a frame",
    description="`[v; ω] = J(q) qd` of a frame against the base, in a `reference_frame`. q and qd"
    " may be batches of equal length, or one of them a batch. As npy: the twist.",
    request=TwistRequest,
    response=TwistResponse,
    run=_twist,
    example={
        "q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
        "qd": [0.1, 0, 0, 0.2, 0, 0, 0],
        "reference_frame": "local_world_aligned",
    },
    example_robot="pa10",
    query=("q", "qd", "frame", "reference_frame"),
    array_field="q",
)

JOINT_VELOCITIES = Operation(
    name="joint-velocities",
    summary="Twist of a frame to joint velocities",
    description="The joint velocities of least norm by the pseudo-inverse, or with `damping` by"
    " damped least squares; with the residual twist, the rank, and the null motions that may be"
    " added. Where the rank is deficient, `status` and `warnings` say so. As npy: qd.",
    request=JointVelocitiesRequest,
    response=JointVelocitiesResponse,
    run=_joint_velocities,
    example={
        "q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7],
        "twist": [0.1, 0, 0],
        "task": "position",
    },
    example_robot="pa10",
    query=("q", "twist", "task", "frame", "reference_frame", "damping", "tolerance"),
    array_field="q",
)
