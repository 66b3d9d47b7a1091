"""jacobian: geometric in three reference frames, or analytic."""

from __future__ import annotations

from typing import Annotated, TypedDict

import msgspec

from app.admission.need import Need
from app.fields.field import LEFT_OUT
from app.fields.joints import Configuration
from app.fields.names import Frame, ReferenceFrameChoice, euler_sequence
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import Answer, Context, Operation, check_size
from app.operations.shapes import AnswerUnits, EachJacobian
from app.operations.sizes import encoded, rows_need, rows_of
from kinematics.configuration import joint_names
from kinematics.jacobian import ReferenceFrame, analytic_jacobian, jacobian, peak_bytes
from kinematics.task import ROWS
from robots.robot import Robot

EULER_ROWS = ("phi_dot", "theta_dot", "psi_dot")


class JacobianRequest(msgspec.Struct, kw_only=True):
    """Which Jacobian to compute."""

    q: Configuration
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT
    euler: Annotated[
        str | None, euler_sequence("An Euler sequence such as ZXZ: the analytic Jacobian.")
    ] = None


class JacobianAnswer(TypedDict):
    """The Jacobian."""

    units: AnswerUnits
    jacobian: EachJacobian
    rows: list[str]
    columns: list[str]
    frame: str
    reference_frame: str
    euler: str | None
    warnings: list[str]


def _memory(robot: Robot, request: JacobianRequest, context: Context) -> Need:
    numbers = 6 * robot.dof
    each = peak_bytes(robot.dof) + encoded(context.form, numbers, numbers)
    return rows_need(rows_of(request.q), each, context.form, numbers=numbers)


def _run(robot: Robot, request: JacobianRequest, context: Context) -> Answer:
    q, frame, euler = request.q, request.frame, request.euler
    if euler is not None and request.reference_frame is not ReferenceFrame.LOCAL_WORLD_ALIGNED:
        raise RequestProblem(
            INVALID_REQUEST,
            "an analytic Jacobian (euler) is in base axes; leave reference_frame out",
            "/reference_frame",
        )
    check_size(q, 6 * robot.dof)
    if euler is not None:
        J, rows = analytic_jacobian(robot, q, euler, frame), (*ROWS[:3], *EULER_ROWS)
    else:
        J, rows = jacobian(robot, q, frame, request.reference_frame), ROWS
    answer: JacobianAnswer = {
        # Columns are per rad and per m whatever ?angle= says: J is a derivative, not an angle.
        "units": {"angle": "rad", "length": "m"},
        "jacobian": J,
        "rows": list(rows),
        "columns": list(joint_names(robot)),
        "frame": frame,
        "reference_frame": request.reference_frame.value,
        "euler": euler,
        "warnings": context.warnings,
    }
    return Answer(answer, J)


JACOBIAN = Operation(
    name="jacobian",
    summary="Jacobian of a frame",
    description="Geometric, or with `euler` analytic. Linear rows first; columns per rad and per m"
    " whatever `?angle=` says. As npy: shape (6, dof) or (n, 6, dof).",
    request=JacobianRequest,
    answer=JacobianAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "reference_frame": "local_world_aligned"},
    example_robot="pa10",
    npy_field="q",
)
