"""jacobian: geometric in three reference frames, or analytic; whole, or the rows of a task."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, NotRequired, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields.field import LEFT_OUT, declared
from app.fields.joints import Configuration
from app.fields.names import (
    TASK_IN_QUERY,
    TASK_SCHEMA,
    Frame,
    ReferenceFrameChoice,
    TaskName,
    euler_sequence,
)
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import SHEET_FORMS, Answer, Context, Operation, check_size
from app.operations.shapes import NUMBER, AnswerUnits, EachMatrix, each, or_null, rows
from app.operations.sizes import encoded, rows_need, rows_of
from app.sheets import columns, latex
from app.sheets.headings import Heading
from app.sheets.sheet import Column, Sheet
from dh_to_urdf.messages import say
from kinematics.chain import chain_of
from kinematics.configuration import joint_names
from kinematics.jacobian import (
    ReferenceFrame,
    analytic_jacobian,
    jacobian,
    peak_bytes,
    task_jacobian,
)
from kinematics.square_jacobian import SquareJacobian, square_jacobian
from kinematics.task import POSE, ROWS, Task
from robots.robot import FloatArray, Robot

SQUARE = 3_000
"""Bytes of the decomposition of a square Jacobian and what is made of it."""
EULER_ROWS = ("phi_dot", "theta_dot", "psi_dot")


class JacobianRequest(msgspec.Struct, kw_only=True):
    """Which Jacobian to compute."""

    q: Configuration
    frame: Frame = LEFT_OUT
    task: Annotated[
        Task | None,
        declared(
            TaskName((TASK_IN_QUERY,), optional=True),
            "The rows of a task: the 2x2 J of a planar 2R with xy, with its determinant and its"
            " inverse where J is square; default all six rows.",
            {"allOf": [{"anyOf": [TASK_SCHEMA, {"type": "null"}]}]},
        ),
    ] = None
    reference_frame: ReferenceFrameChoice = LEFT_OUT
    euler: Annotated[
        str | None, euler_sequence("An Euler sequence such as ZXZ: the analytic Jacobian.")
    ] = None


class JacobianAnswer(TypedDict):
    """The Jacobian.

    With a ``task`` whose rows are as many as the joints that move the frame (``square_columns``),
    ``determinant`` is that of these columns, and ``inverse`` has one row a joint of them and one
    column a row of J; null where J is singular.
    """

    units: AnswerUnits
    jacobian: EachMatrix
    rows: list[str]
    columns: list[str]
    frame: str
    task: NotRequired[str]
    reference_frame: str
    euler: str | None
    square_columns: NotRequired[list[str]]
    determinant: NotRequired[Annotated[float | FloatArray, each(NUMBER)]]
    inverse: NotRequired[Annotated[Any, each(or_null(rows()))]]
    warnings: list[str]


def _memory(robot: Robot, request: JacobianRequest, context: Context) -> Need:
    numbers = 6 * robot.dof
    each = peak_bytes(robot.dof) + encoded(context.form, numbers, numbers)
    if request.task is not None:
        # A decomposition of six rows at most, and the inverse.
        each += SQUARE + encoded(context.form, 37)
    return rows_need(rows_of(request.q), each, context.form, numbers=numbers)


def _run(robot: Robot, request: JacobianRequest, context: Context) -> Answer:
    q, frame, euler, task = request.q, request.frame, request.euler, request.task
    if euler is not None:
        _refuse_beside_euler(request)
    check_size(q, 6 * robot.dof * (1 if task is None else 2))
    if euler is not None:
        chosen = list((task or POSE).rows)
        J = analytic_jacobian(robot, q, euler, frame)[..., chosen, :]
        names: Sequence[str] = [(*ROWS[:3], *EULER_ROWS)[k] for k in chosen]
    elif task is not None:
        J, names = task_jacobian(robot, q, task, frame, request.reference_frame), task.row_names
    else:
        J, names = jacobian(robot, q, frame, request.reference_frame), ROWS
    joints = list(joint_names(robot))
    answer: JacobianAnswer = {
        # Columns are per rad and per m whatever ?angle= says: J is a derivative, not an angle.
        "units": {"angle": "rad", "length": "m"},
        "jacobian": J,
        "rows": list(names),
        "columns": joints,
        "frame": frame,
        **({} if task is None else {"task": task.name}),  # type: ignore[typeddict-item]
        "reference_frame": request.reference_frame.value,
        "euler": euler,
        "warnings": context.warnings,
    }
    moving = chain_of(robot, frame).columns
    square = square_jacobian(J[..., moving]) if task is not None else None
    if square is not None:
        answer["square_columns"] = [joints[k] for k in moving]
        answer["determinant"] = square.determinant if q.ndim == 2 else float(square.determinant)
        answer["inverse"] = _inverse_view(square)
    return Answer(
        answer,
        J,
        sheet=lambda: _sheet(robot, J, names, square),
        latex=lambda digits: _latex(J, square, digits),
    )


def _refuse_beside_euler(request: JacobianRequest) -> None:
    if request.reference_frame is not ReferenceFrame.LOCAL_WORLD_ALIGNED:
        raise RequestProblem(
            INVALID_REQUEST,
            say("an analytic Jacobian (euler) is in base axes; leave reference_frame out"),
            "/reference_frame",
        )
    if request.task is not None and len(request.task.rotations) not in (0, 3):
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "an analytic Jacobian (euler) has rates of Euler angles and no single"
                " row of rotation; leave euler out for the task {task}",
                task=request.task.name,
            ),
            "/task",
        )


def _inverse_view(square: SquareJacobian) -> Any:
    """Return the inverses, null where there is none."""
    if square.inverse.ndim == 2:
        return square.inverse if bool(square.invertible) else None
    if square.invertible.all():
        return square.inverse
    pairs = zip(square.inverse, square.invertible.tolist(), strict=True)
    return [one if invertible else None for one, invertible in pairs]


def _sheet(
    robot: Robot, J: FloatArray, names: Sequence[str], square: SquareJacobian | None
) -> Sheet:
    """Return one row a row of J, with its unit, the rows of the first q first."""
    every = J.reshape(-1, *J.shape[-2:])
    count, each_ = len(every), len(names)
    flat = every.reshape(-1, J.shape[-1])
    units = ["m" if name in ROWS[:3] else "rad" for name in names]
    found = [
        columns.samples(count, each_),
        Column(Heading.ROW, list(names) * count),
        Column(Heading.ROW_UNIT, units * count),
        *(
            Column(name, flat[:, k], f"1/{'rad' if turns else 'm'}")
            for k, (name, turns) in enumerate(
                zip(joint_names(robot), robot.is_revolute.tolist(), strict=True)
            )
        ),
    ]
    if square is not None:
        found.append(Column(Heading.DETERMINANT, np.repeat(square.determinant, each_)))
    return Sheet(tuple(found))


def _latex(J: FloatArray, square: SquareJacobian | None, digits: int | None) -> str:
    """Return J of each q, and where it is square its determinant and its inverse."""
    every = J.reshape(-1, *J.shape[-2:])
    numbers = [""] if J.ndim == 2 else [f"^{{({k})}}" for k in range(1, len(every) + 1)]
    text = latex.equations([f"J{number}" for number in numbers], every, digits)
    if square is None:
        return text
    determinants = np.atleast_1d(square.determinant).tolist()
    for number, value in zip(numbers, determinants, strict=True):
        text += f"\\[ \\det J{number} = {latex.number(value, digits)} \\]\n"
    inverses = square.inverse.reshape(-1, *square.inverse.shape[-2:])
    for k in np.flatnonzero(np.atleast_1d(square.invertible)).tolist():
        label = "J^{-1}" if J.ndim == 2 else f"\\left(J{numbers[k]}\\right)^{{-1}}"
        text += latex.equation(label, inverses[k], digits)
    return text


JACOBIAN = Operation(
    name="jacobian",
    summary="Jacobian of a frame",
    description="Geometric, or with `euler` analytic; with `task` the rows that a course calls J,"
    " with determinant and inverse where J is square. Linear rows first; columns per rad and per m"
    " whatever `?angle=` says. As npy: shape (rows, dof) or (n, rows, dof), six rows without a"
    " task. As csv: one row a row of J. As latex: matrices.",
    request=JacobianRequest,
    answer=JacobianAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], "reference_frame": "local_world_aligned"},
    example_robot="pa10",
    forms=SHEET_FORMS,
    npy_field="q",
)
