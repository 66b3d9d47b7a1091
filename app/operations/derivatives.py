"""jacobian-derivative, hessian and manipulability-gradient: how a Jacobian changes."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, TypedDict

import msgspec

from app.admission.need import Need
from app.fields.field import LEFT_OUT
from app.fields.joints import Configuration, JointRates
from app.fields.names import Frame, ReferenceFrameChoice, TaskSpace
from app.fields.numbers import RankTolerance
from app.operations.operation import Answer, Context, Operation, check_size
from app.operations.shapes import (
    NUMBER,
    AnswerUnits,
    EachFlag,
    EachJacobian,
    EachNumber,
    EachVector,
    each,
    each_or_none,
    listed,
    rows,
    vector,
)
from app.operations.sizes import encoded, rows_need, rows_of
from kinematics.configuration import joint_names
from kinematics.derivatives import (
    hessian,
    hessian_bytes,
    jacobian_derivative,
    jacobian_derivative_bytes,
)
from kinematics.manipulability import manipulability_gradient, peak_bytes
from kinematics.singularity import RANK_TOLERANCE, unit_warnings
from kinematics.slices import SLICE_BYTES
from kinematics.task import POSE, ROWS
from robots.robot import FloatArray, Robot

# Derivatives are per rad and per m whatever ?angle= says, as the Jacobian is.
_UNITS = {"angle": "rad", "length": "m", "time": "s"}


class JacobianDerivativeRequest(msgspec.Struct, kw_only=True):
    """Along which motion."""

    q: Configuration
    qd: JointRates
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT


class JacobianDerivativeAnswer(TypedDict):
    """dJ/dt, and dJ/dt qd; for a batch with a leading axis n."""

    units: AnswerUnits
    jacobian_derivative: EachJacobian
    bias_acceleration: Annotated[FloatArray, each(vector(6))]
    rows: list[str]
    columns: list[str]
    frame: str
    reference_frame: str
    warnings: list[str]


class HessianRequest(msgspec.Struct, kw_only=True):
    """Where."""

    q: Configuration
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT


class HessianAnswer(TypedDict):
    """``hessian[i][j][k] = ∂J[i][j]/∂q_k``; for a batch with a leading axis n."""

    units: AnswerUnits
    hessian: Annotated[FloatArray, each(listed(rows(), 6))]
    rows: list[str]
    columns: list[str]
    frame: str
    reference_frame: str
    warnings: list[str]


class ManipulabilityGradientRequest(msgspec.Struct, kw_only=True):
    """Where, and of which task."""

    q: Configuration
    task: TaskSpace = POSE
    frame: Frame = LEFT_OUT
    tolerance: RankTolerance = RANK_TOLERANCE


class ManipulabilityGradientAnswer(TypedDict):
    """w and ∂w/∂q; for a batch every leaf but the names has a leading axis n.

    At a singularity w has a kink: ``differentiable`` is false and ``gradient`` is zero there.
    ``determinant`` and its gradient are null where the task Jacobian is not square.
    """

    units: AnswerUnits
    manipulability: EachNumber
    gradient: EachVector
    differentiable: EachFlag
    determinant: Annotated[float | FloatArray | None, each_or_none(NUMBER)]
    determinant_gradient: Annotated[FloatArray | None, each_or_none(vector())]
    columns: list[str]
    frame: str
    task: str
    tolerance: float
    warnings: list[str]


def _derivative_memory(robot: Robot, request: JacobianDerivativeRequest, context: Context) -> Need:
    numbers = 6 * robot.dof
    each = jacobian_derivative_bytes(robot.dof) + encoded(context.form, numbers + 6, numbers)
    need = rows_need(rows_of(request.q, request.qd), each, context.form, numbers=numbers)
    return replace(need, fixed=need.fixed + SLICE_BYTES)


def _hessian_memory(robot: Robot, request: HessianRequest, context: Context) -> Need:
    numbers = 6 * robot.dof**2
    each = hessian_bytes(robot.dof) + encoded(context.form, numbers, numbers)
    need = rows_need(rows_of(request.q), each, context.form, numbers=numbers)
    return replace(need, fixed=need.fixed + SLICE_BYTES)


def _gradient_memory(
    robot: Robot, request: ManipulabilityGradientRequest, context: Context
) -> Need:
    each = peak_bytes(robot.dof) + encoded(context.form, 2 * robot.dof + 4, robot.dof)
    need = rows_need(rows_of(request.q), each, context.form, numbers=6 * robot.dof**2)
    return replace(need, fixed=need.fixed + SLICE_BYTES)


def _jacobian_derivative(
    robot: Robot, request: JacobianDerivativeRequest, context: Context
) -> Answer:
    frame = request.frame
    q = request.q
    qd = request.qd
    check_size(qd if qd.ndim == 2 else q, 6 * robot.dof)
    Jd = jacobian_derivative(robot, q, qd, frame, request.reference_frame)
    answer: JacobianDerivativeAnswer = {
        "units": _UNITS,
        "jacobian_derivative": Jd,
        "bias_acceleration": (Jd @ qd[..., None])[..., 0],
        "rows": list(ROWS),
        "columns": list(joint_names(robot)),
        "frame": frame,
        "reference_frame": request.reference_frame.value,
        "warnings": context.warnings,
    }
    return Answer(answer, Jd)


def _hessian(robot: Robot, request: HessianRequest, context: Context) -> Answer:
    frame = request.frame
    q = request.q
    check_size(q, 6 * robot.dof**2)
    H = hessian(robot, q, frame, request.reference_frame)
    answer: HessianAnswer = {
        "units": {"angle": "rad", "length": "m"},
        "hessian": H,
        "rows": list(ROWS),
        "columns": list(joint_names(robot)),
        "frame": frame,
        "reference_frame": request.reference_frame.value,
        "warnings": context.warnings,
    }
    return Answer(answer, H)


def _manipulability_gradient(
    robot: Robot, request: ManipulabilityGradientRequest, context: Context
) -> Answer:
    task = request.task
    frame = request.frame
    q = request.q
    check_size(q, 6 * robot.dof**2)
    found = manipulability_gradient(robot, q, task, frame, tolerance=request.tolerance)
    answer: ManipulabilityGradientAnswer = {
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
        "warnings": [*context.warnings, *unit_warnings(robot, task)],
    }
    return Answer(answer, found.gradient)


JACOBIAN_DERIVATIVE = Operation(
    name="jacobian-derivative",
    summary="Time derivative of the Jacobian",
    description="dJ/dt along joint velocities `qd`, and the bias acceleration dJ/dt qd: what is"
    " left of the tip's acceleration J qdd + dJ/dt qd where the joints do not accelerate. In rad,"
    " m and s whatever `?angle=` says of q and qd. As npy: dJ/dt.",
    request=JacobianDerivativeRequest,
    answer=JacobianDerivativeAnswer,
    memory=_derivative_memory,
    run=_jacobian_derivative,
    example={"q": [0.5, 0.3], "qd": [1, -1]},
    example_robot="planar_2r",
    npy_field="q",
)

HESSIAN = Operation(
    name="hessian",
    summary="Kinematic Hessian",
    description="`hessian[i][j][k]` = ∂J[i][j]/∂q_k, how column j changes with joint k; per rad and"
    " per m whatever `?angle=` says. As npy: shape (6, dof, dof) or (n, 6, dof, dof).",
    request=HessianRequest,
    answer=HessianAnswer,
    memory=_hessian_memory,
    run=_hessian,
    example={"q": [0.5, 0.3]},
    example_robot="planar_2r",
    npy_field="q",
)

MANIPULABILITY_GRADIENT = Operation(
    name="manipulability-gradient",
    summary="Gradient of the manipulability",
    description="Yoshikawa's w of a `task` and ∂w/∂q, exact also near singularities; of a square"
    " task Jacobian also the determinant and its gradient. Per rad and per m whatever `?angle=`"
    " says. As npy: the gradient.",
    request=ManipulabilityGradientRequest,
    answer=ManipulabilityGradientAnswer,
    memory=_gradient_memory,
    run=_manipulability_gradient,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "task": "position"},
    example_robot="pa10",
    npy_field="q",
)
