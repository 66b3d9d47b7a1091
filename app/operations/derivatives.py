"""jacobian-derivative, hessian and manipulability-gradient: how a Jacobian changes."""

from __future__ import annotations

import msgspec

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
from kinematics.configuration import joint_names
from kinematics.derivatives import hessian, jacobian_derivative
from kinematics.manipulability import manipulability_gradient
from kinematics.singularity import RANK_TOLERANCE, unit_warnings
from kinematics.task import ROWS, task_from
from robots.robot import Robot

# Derivatives are per rad and per m whatever ?angle= says, as the Jacobian is.
_UNITS = {"angle": "rad", "length": "m", "time": "s"}


class JacobianDerivativeRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Along which motion."""

    q: Configuration
    qd: Configuration
    frame: FrameField = None
    reference_frame: ReferenceFrameField = None


class JacobianDerivativeResponse(msgspec.Struct, kw_only=True):
    """dJ/dt, and dJ/dt qd; for a batch with a leading axis n."""

    units: UNITS_SCHEMA
    jacobian_derivative: Numbers
    bias_acceleration: Numbers
    rows: list[str]
    columns: list[str]
    frame: str
    reference_frame: str


class HessianRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Where."""

    q: Configuration
    frame: FrameField = None
    reference_frame: ReferenceFrameField = None


class HessianResponse(msgspec.Struct, kw_only=True):
    """``hessian[i][j][k] = ∂J[i][j]/∂q_k``; for a batch with a leading axis n."""

    units: UNITS_SCHEMA
    hessian: Numbers
    rows: list[str]
    columns: list[str]
    frame: str
    reference_frame: str


class ManipulabilityGradientRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Where, and of which task."""

    q: Configuration
    task: TaskField = "pose"
    frame: FrameField = None
    tolerance: RankToleranceField = RANK_TOLERANCE


class ManipulabilityGradientResponse(msgspec.Struct, kw_only=True):
    """w and ∂w/∂q; for a batch every leaf but the names has a leading axis n.

    At a singularity w has a kink: ``differentiable`` is false and ``gradient`` is zero there.
    ``determinant`` and its gradient are null where the task Jacobian is not square.
    """

    units: UNITS_SCHEMA
    manipulability: float | list[float]
    gradient: Numbers
    differentiable: bool | list[bool]
    determinant: float | list[float] | None
    determinant_gradient: Numbers | None
    columns: list[str]
    frame: str
    task: str
    tolerance: float
    warnings: list[str]


def _jacobian_derivative(
    robot: Robot, request: JacobianDerivativeRequest, context: Context
) -> Answer:
    reference_frame = read_reference_frame(request.reference_frame)
    frame = read_frame(request.frame, robot)
    q = read_configuration(request.q, robot, context)
    qd = read_configuration(request.qd, robot, context, "qd")
    check_size(qd if qd.ndim == 2 else q, 6 * robot.dof)
    Jd = jacobian_derivative(robot, q, qd, frame, reference_frame)
    payload = {
        "units": _UNITS,
        "jacobian_derivative": Jd,
        "bias_acceleration": (Jd @ qd[..., None])[..., 0],
        "rows": list(ROWS),
        "columns": list(joint_names(robot)),
        "frame": frame,
        "reference_frame": reference_frame.value,
    }
    return Answer(payload, Jd)


def _hessian(robot: Robot, request: HessianRequest, context: Context) -> Answer:
    reference_frame = read_reference_frame(request.reference_frame)
    frame = read_frame(request.frame, robot)
    q = read_configuration(request.q, robot, context)
    check_size(q, 6 * robot.dof**2)
    H = hessian(robot, q, frame, reference_frame)
    payload = {
        "units": {"angle": "rad", "length": "m"},
        "hessian": H,
        "rows": list(ROWS),
        "columns": list(joint_names(robot)),
        "frame": frame,
        "reference_frame": reference_frame.value,
    }
    return Answer(payload, H)


def _manipulability_gradient(
    robot: Robot, request: ManipulabilityGradientRequest, context: Context
) -> Answer:
    task = task_from(request.task)
    frame = read_frame(request.frame, robot)
    q = read_configuration(request.q, robot, context)
    check_size(q, 6 * robot.dof**2)
    found = manipulability_gradient(robot, q, task, frame, tolerance=request.tolerance)
    payload = {
        "units": {"angle": "rad", "length": "m"},
        "manipulability": found.manipulability,
        "gradient": found.gradient,
        "differentiable": found.differentiable.tolist(),
        "determinant": found.determinant,
        "determinant_gradient": found.determinant_gradient,
        "columns": list(joint_names(robot)),
        "frame": frame,
        "task": task.name,
        "tolerance": request.tolerance,
        "warnings": list(unit_warnings(robot, task)),
    }
    return Answer(payload, found.gradient)


JACOBIAN_DERIVATIVE = Operation(
    name="jacobian-derivative",
    summary="Time derivative of the Jacobian",
    description="dJ/dt along joint velocities `qd`, and the bias acceleration dJ/dt qd: what is"
    " left of the tip's acceleration J qdd + dJ/dt qd where the joints do not accelerate. In rad,"
    " m and s whatever `?angle=` says of q and qd. As npy: dJ/dt.",
    request=JacobianDerivativeRequest,
    response=JacobianDerivativeResponse,
    run=_jacobian_derivative,
    example={"q": [0.5, 0.3], "qd": [1, -1]},
    example_robot="planar_2r",
    query=("q", "qd", "frame", "reference_frame"),
    array_field="q",
)

HESSIAN = Operation(
    name="hessian",
    summary="Kinematic Hessian",
    description="`hessian[i][j][k]` = ∂J[i][j]/∂q_k, how column j changes with joint k; per rad and"
    " per m whatever `?angle=` says. As npy: shape (6, dof, dof) or (n, 6, dof, dof).",
    request=HessianRequest,
    response=HessianResponse,
    run=_hessian,
    example={"q": [0.5, 0.3]},
    example_robot="planar_2r",
    query=("q", "frame", "reference_frame"),
    array_field="q",
)

MANIPULABILITY_GRADIENT = Operation(
    name="manipulability-gradient",
    summary="Gradient of the manipulability",
    description="Yoshikawa's w of a `task` and ∂w/∂q, exact also near singularities; of a square"
    " task Jacobian also the determinant and its gradient. Per rad and per m whatever `?angle=`"
    " says. As npy: the gradient.",
    request=ManipulabilityGradientRequest,
    response=ManipulabilityGradientResponse,
    run=_manipulability_gradient,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "task": "position"},
    example_robot="pa10",
    query=("q", "task", "frame", "tolerance"),
    array_field="q",
)
