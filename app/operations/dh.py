"""dh-matrices: what a D-H table says by itself, A_k, 0A_k and T."""

from __future__ import annotations

from typing import Annotated, TypedDict

import msgspec

from app.admission.need import Need
from app.fields.joints import Configuration
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import Answer, Context, Operation, check_size
from app.operations.shapes import AnswerUnits, EachPose, Pose, each, listed, rows
from app.operations.sizes import FLOAT, encoded, rows_need, rows_of
from dh_to_urdf import dh_matrices
from robots.robot import FloatArray, Robot


class DHMatricesRequest(msgspec.Struct, kw_only=True):
    """Where to evaluate the table."""

    q: Configuration


class DHMatricesAnswer(TypedDict):
    """Link matrices A_k, partial products 0A_k (in frame 0), and T = base 0A_n tool."""

    units: AnswerUnits
    convention: str
    joints: list[str]
    A: Annotated[FloatArray, each(listed(rows(4, 4)))]
    T0: Annotated[FloatArray, each(listed(rows(4, 4)))]
    base: Pose
    tool: Pose
    T: EachPose
    warnings: list[str]


def _memory(robot: Robot, request: DHMatricesRequest, context: Context) -> Need:
    numbers = 32 * (0 if robot.table is None else len(robot.table.rows)) + 16
    each = FLOAT * (2 * robot.dof + 1.5 * numbers) + encoded(context.form, numbers, 16)
    return rows_need(rows_of(request.q), each, context.form, numbers=numbers)


def _run(robot: Robot, request: DHMatricesRequest, context: Context) -> Answer:
    if robot.table is None:
        raise RequestProblem(
            INVALID_REQUEST, "this robot was made from a URDF and has no D-H table; use fk instead"
        )
    q = request.q
    check_size(q, 32 * len(robot.table.rows))
    matrices = dh_matrices(robot.table, q)
    answer: DHMatricesAnswer = {
        "units": context.units.named,
        "convention": robot.table.convention.value,
        "joints": [row.name for row in robot.table.rows],
        "A": matrices.A,
        "T0": matrices.T0,
        "base": robot.table.base,
        "tool": robot.table.tool,
        "T": matrices.T,
        "warnings": context.warnings,
    }
    return Answer(answer, matrices.T)


DH_MATRICES = Operation(
    name="dh-matrices",
    summary="The matrices of a D-H table",
    description="Link matrices `A` (one a row), partial products `T0` = 0A_k in frame 0, and"
    " `T` = base 0A_n tool. As npy: T.",
    request=DHMatricesRequest,
    answer=DHMatricesAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]},
    example_robot="pa10",
    npy_field="q",
)
