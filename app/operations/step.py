"""step: the differential step Δθ = J† ΔX + (I − J†J) Z, with every matrix in it."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec
import numpy as np

from app.operations.base import (
    NOT_GIVEN,
    UNITS_SCHEMA,
    Answer,
    Context,
    Numbers,
    Operation,
    OptionalConfiguration,
    SingleConfiguration,
    TaskField,
    not_given,
    read_frame,
    read_single,
)
from app.operations.schema import items, within
from kinematics.configuration import joint_names
from kinematics.errors import InvalidOption
from kinematics.redundancy.step import StepTask, differential_step
from kinematics.task import Task, task_from
from robots.robot import FloatArray, Robot

MAX_SECONDARY = 16


class SecondaryStep(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """A motion of lower priority: of another frame, or in another task space."""

    delta_x: list[float]
    task: TaskField = "pose"
    frame: str | None = None


class StepRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Where the arm is, and which motion is asked of the frame."""

    q: SingleConfiguration
    delta_x: Annotated[
        list[float],
        msgspec.Meta(description="Wanted motion, one value a task row: m, and rad (or degrees)."),
    ]
    z: Annotated[
        OptionalConfiguration,
        msgspec.Meta(description="Wanted joint motion; its part in the null space is added."),
    ] = msgspec.field(default_factory=not_given)
    task: TaskField = "pose"
    frame: Annotated[str | None, msgspec.Meta(description="Frame name; default the tip.")] = None
    damping: Annotated[
        float,
        msgspec.Meta(description="λ of damped least squares; 0: the pseudo-inverse."),
        within(0, 1e3),
    ] = 0.0
    secondary: Annotated[
        list[SecondaryStep],
        msgspec.Meta(description="Tasks of lower priority, in strict order, instead of z."),
        items(0, MAX_SECONDARY),
    ] = []


class StepResponse(msgspec.Struct, kw_only=True):
    """The step and its parts.

    ``delta_q`` is ``task_motion`` plus ``null_motion``, in the units of the answer, as z and q are.
    The matrices are in rad and m. ``residuals`` is what is missing of delta_x, of each task, in
    m and rad, in the linear model.
    """

    units: UNITS_SCHEMA
    task: str
    frame: str
    rows: list[str]
    columns: list[str]
    delta_q: list[float]
    norm: float
    task_motion: list[float]
    null_motion: list[float]
    achieved: list[float]
    residuals: Numbers
    rank: int
    singular_values: list[float]
    damping: float
    jacobian: Numbers
    jacobian_pinv: Numbers
    null_projector: Numbers


def _run(robot: Robot, request: StepRequest, context: Context) -> Answer:
    task = task_from(request.task)
    frame = read_frame(request.frame, robot)
    q = read_single(request.q, robot, context)
    given = bytes(request.z) != NOT_GIVEN
    if len(request.secondary) > MAX_SECONDARY:
        raise InvalidOption(f"give at most {MAX_SECONDARY} secondary tasks", "/secondary")
    found = differential_step(
        robot,
        q,
        StepTask(_motion(request.delta_x, task, context), task, frame),
        z=read_single(request.z, robot, context, "/z") if given else None,
        secondary=[_secondary(robot, one, k, context) for k, one in enumerate(request.secondary)],
        damping=request.damping,
    )
    delta = context.units.joints_out(robot, found.delta_q)
    payload: dict[str, Any] = {
        "units": context.units.named,
        "task": task.name,
        "frame": frame,
        "rows": list(task.row_names),
        "columns": list(joint_names(robot)),
        "delta_q": delta,
        "norm": float(np.linalg.norm(delta)),
        "task_motion": context.units.joints_out(robot, found.task_motion),
        "null_motion": context.units.joints_out(robot, found.null_motion),
        "achieved": found.achieved,
        "residuals": list(found.residuals),
        "rank": found.rank,
        "singular_values": found.singular_values,
        "damping": request.damping,
        "jacobian": found.J,
        "jacobian_pinv": found.J_pinv,
        "null_projector": found.N,
    }
    return Answer(payload, delta)


def _secondary(robot: Robot, one: SecondaryStep, k: int, context: Context) -> StepTask:
    task = task_from(one.task, f"/secondary/{k}/task")
    frame = robot.tip_frame if one.frame is None else one.frame
    robot.frame_id(frame, "secondary", (k, "frame"))
    return StepTask(_motion(one.delta_x, task, context), task, frame)


def _motion(values: list[float], task: Task, context: Context) -> FloatArray:
    """delta_x in m and rad."""
    dx = np.array(values, dtype=np.float64)
    angular = np.array([row >= 3 for row in task.rows])
    if len(dx) != len(angular):
        return dx
    return np.where(angular, context.units.angles_in(dx), dx)


STEP = Operation(
    name="step",
    summary="Differential step of a redundant arm",
    description="Δθ = J† ΔX + (I − J†J) Z for a given ΔX and Z, with J, J† = Jᵀ(JJᵀ)⁻¹, its rank,"
    " N = I − J†J and the null motion; or with secondary tasks in strict priority. Where J has"
    " lost rank it is refused, with the rank; give damping then. As npy: delta_q.",
    request=StepRequest,
    response=StepResponse,
    run=_run,
    example={"q": [0.5236, -0.7854, 1.0472], "delta_x": [0.01, 0], "task": "xy"},
    example_robot="planar_3r",
    query=("q", "delta_x", "z", "task", "frame", "damping"),
)
