"""step: the differential step Δθ = J† ΔX + (I − J†J) Z, with every matrix in it."""

from __future__ import annotations

from typing import Annotated, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields import texts
from app.fields.bounds import items
from app.fields.field import LEFT_OUT, Field, Parameter, declared
from app.fields.joints import SingleConfiguration, optional_configuration
from app.fields.names import TASK_META, Frame, TaskSpace
from app.fields.numbers import within_query
from app.fields.vectors import angular_rows
from app.operations.operation import Answer, Context, Operation
from app.operations.shapes import AnswerUnits, Matrix, Vector, listed, shaped, vector
from app.operations.sizes import encoded, fixed_bytes
from dh_to_urdf.messages import say
from kinematics.configuration import joint_names
from kinematics.errors import InvalidOption
from kinematics.redundancy.step import StepTask, differential_step
from kinematics.task import POSE, Task, task_from
from robots.robot import FloatArray, Robot

MAX_SECONDARY = 16
DELTA_X = "Wanted motion, comma-separated, one value a task row."


class SecondaryStep(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """A motion of lower priority: of another frame, or in another task space."""

    delta_x: list[float]
    task: Annotated[str | list[int], TASK_META] = "pose"
    frame: str | None = None


class StepRequest(msgspec.Struct, kw_only=True):
    """Where the arm is, and which motion is asked of the frame."""

    q: SingleConfiguration
    delta_x: Annotated[
        list[float],
        declared(
            Field(
                (Parameter(texts.scalars, "Wanted motion, comma-separated, one value a task row."),)
            ),
            "Wanted motion, one value a task row: m, and rad (or degrees).",
        ),
    ]
    z: Annotated[
        FloatArray | None,
        optional_configuration(
            "Wanted joint motion, of which the part in the null space is added.",
            "Wanted joint motion; its part in the null space is added.",
            posture=False,
        ),
    ] = None
    task: TaskSpace = POSE
    frame: Frame = LEFT_OUT
    damping: Annotated[
        float,
        within_query(
            0,
            1e3,
            "λ of damped least squares; 0: the pseudo-inverse.",
            "0 (none), or such as 0.01.",
        ),
    ] = 0.0
    secondary: Annotated[
        list[SecondaryStep],
        msgspec.Meta(description="Tasks of lower priority, in strict order, instead of z."),
        items(0, MAX_SECONDARY),
    ] = []


class StepAnswer(TypedDict):
    """The step and its parts.

    ``delta_q`` is ``task_motion`` plus ``null_motion``, in the units of the answer, as z and q are.
    The matrices are in rad and m. ``residuals`` is what is missing of delta_x, of each task, in
    rad and the unit of lengths, in the linear model.
    """

    units: AnswerUnits
    task: str
    frame: str
    rows: list[str]
    columns: list[str]
    delta_q: Vector
    norm: float
    task_motion: Vector
    null_motion: Vector
    achieved: Vector
    residuals: Annotated[list[FloatArray], shaped(listed(vector()))]
    rank: int
    singular_values: Vector
    damping: float
    jacobian: Matrix
    jacobian_pinv: Matrix
    null_projector: Matrix
    warnings: list[str]


def _memory(robot: Robot, _: StepRequest, context: Context) -> Need:
    return Need(0.0, fixed=fixed_bytes(context.form) + int(encoded(context.form, 4 * robot.dof**2)))


def _run(robot: Robot, request: StepRequest, context: Context) -> Answer:
    task = request.task
    frame = request.frame
    q = request.q
    if len(request.secondary) > MAX_SECONDARY:
        raise InvalidOption(
            say("give at most {max_secondary} secondary tasks", max_secondary=MAX_SECONDARY),
            argument="secondary",
        )
    secondary = [_secondary(robot, one, k, context) for k, one in enumerate(request.secondary)]
    found = differential_step(
        robot,
        q,
        StepTask(_motion(request.delta_x, task, context), task, frame),
        z=request.z,
        secondary=secondary,
        damping=request.damping,
    )
    delta = context.units.joints_out(robot, found.delta_q)
    others = [one.task for one in secondary]
    answer: StepAnswer = {
        "units": context.units.named,
        "task": task.name,
        "frame": frame,
        "rows": list(task.row_names),
        "columns": list(joint_names(robot)),
        "delta_q": delta,
        "norm": float(np.linalg.norm(delta)),
        "task_motion": context.units.joints_out(robot, found.task_motion),
        "null_motion": context.units.joints_out(robot, found.null_motion),
        "achieved": _lengths_out(found.achieved, task, context),
        "residuals": [
            _lengths_out(one, of, context)
            for one, of in zip(found.residuals, (task, *others), strict=True)
        ],
        "rank": found.rank,
        "singular_values": found.singular_values,
        "damping": request.damping,
        "jacobian": found.J,
        "jacobian_pinv": found.J_pinv,
        "null_projector": found.N,
        "warnings": context.warnings,
    }
    return Answer(answer, delta)


def _secondary(robot: Robot, one: SecondaryStep, k: int, context: Context) -> StepTask:
    task = task_from(one.task, "secondary", (k, "task"))
    frame = robot.tip_frame if one.frame is None else one.frame
    robot.frame_id(frame, "secondary", (k, "frame"))
    return StepTask(_motion(one.delta_x, task, context), task, frame)


def _lengths_out(motion: FloatArray, task: Task, context: Context) -> FloatArray:
    """Return a motion with its lengths in the unit of the answer, and its angles in rad."""
    return np.where(angular_rows(task), motion, context.units.lengths_out(motion))


def _motion(values: list[float], task: Task, context: Context) -> FloatArray:
    """delta_x in m and rad."""
    dx = np.array(values, dtype=np.float64)
    angular = angular_rows(task)
    return dx if len(dx) != len(angular) else context.units.rows_in(angular, dx)


STEP = Operation(
    name="step",
    summary="Differential step of a redundant arm",
    description="Δθ = J† ΔX + (I − J†J) Z for a given ΔX and Z, with J, J† = Jᵀ(JJᵀ)⁻¹, its rank,"
    " N = I − J†J and the null motion; or with secondary tasks in strict priority. Where J has"
    " lost rank it is refused, with the rank; give damping then. As npy: delta_q.",
    request=StepRequest,
    answer=StepAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.5236, -0.7854, 1.0472], "delta_x": [0.01, 0], "task": "xy"},
    example_robot="planar_3r",
)
