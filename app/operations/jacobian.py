"""jacobian: geometric in three reference frames, or analytic."""

from __future__ import annotations

from typing import Annotated

import msgspec

from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.base import (
    UNITS_SCHEMA,
    Answer,
    Configuration,
    Context,
    FrameField,
    Numbers,
    Operation,
    ReferenceFrameField,
    check_size,
    read_configuration,
    read_frame,
    read_reference_frame,
)
from app.operations.schema import EULER
from kinematics.configuration import joint_names
from kinematics.jacobian import ReferenceFrame, analytic_jacobian, jacobian
from kinematics.orientation import parse_sequence
from kinematics.task import ROWS
from robots.robot import Robot

EULER_ROWS = ("phi_dot", "theta_dot", "psi_dot")


class JacobianRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Which Jacobian to compute."""

    q: Configuration
    frame: FrameField = None
    reference_frame: ReferenceFrameField = None
    euler: Annotated[
        str | None,
        msgspec.Meta(description="An Euler sequence such as ZXZ: the analytic Jacobian."),
        EULER,
    ] = None


class JacobianResponse(msgspec.Struct, kw_only=True):
    """The Jacobian; for a batch with a leading axis n."""

    units: UNITS_SCHEMA
    jacobian: Numbers
    rows: list[str]
    columns: list[str]
    frame: str
    reference_frame: str
    euler: str | None


def _run(robot: Robot, request: JacobianRequest, context: Context) -> Answer:
    frame = read_frame(request.frame, robot)
    reference_frame = read_reference_frame(request.reference_frame)
    if request.euler is not None:
        parse_sequence(request.euler)
        if reference_frame is not ReferenceFrame.LOCAL_WORLD_ALIGNED:
            raise RequestProblem(
                INVALID_REQUEST,
                "an analytic Jacobian (euler) is in base axes; leave reference_frame out",
                "/reference_frame",
            )
    q = read_configuration(request.q, robot, context)
    check_size(q, 6 * robot.dof)
    if request.euler is not None:
        J, rows = analytic_jacobian(robot, q, request.euler, frame), (*ROWS[:3], *EULER_ROWS)
    else:
        J, rows = jacobian(robot, q, frame, reference_frame), ROWS
    payload = {
        # Columns are per rad and per m whatever ?angle= says: J is a derivative, not an angle.
        "units": {"angle": "rad", "length": "m"},
        "jacobian": J,
        "rows": list(rows),
        "columns": list(joint_names(robot)),
        "frame": frame,
        "reference_frame": reference_frame.value,
        "euler": request.euler,
    }
    return Answer(payload, J)


JACOBIAN = Operation(
    name="jacobian",
    summary="Jacobian of a frame",
    description="Geometric, or with `euler` analytic. Linear rows first; columns per rad and per m"
    " whatever `?angle=` says. As npy: shape (6, dof) or (n, 6, dof).",
    request=JacobianRequest,
    response=JacobianResponse,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "reference_frame": "local_world_aligned"},
    example_robot="pa10",
    query=("q", "frame", "reference_frame", "euler"),
    array_field="q",
)
