"""dh-matrices: what a D-H table says by itself, A_k, 0A_k and T."""

from __future__ import annotations

from typing import Annotated, Any, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields.joints import Configuration
from app.http.negotiation import LATEX
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import ARRAY_FORMS, Answer, Context, Operation, check_size
from app.operations.shapes import AnswerUnits, EachPose, Pose, each, listed, rows
from app.operations.sizes import FLOAT, encoded, rows_need, rows_of
from app.sheets import latex
from dh_to_urdf import DHMatrices, dh_matrices
from dh_to_urdf.messages import say
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
            INVALID_REQUEST,
            say("this robot was made from a URDF and has no D-H table; use fk instead"),
        )
    q, units = request.q, context.units
    check_size(q, 32 * len(robot.table.rows))
    found = dh_matrices(robot.table, q)
    matrices = DHMatrices(*(units.poses_out(T) for T in (found.A, found.T0, found.T)))
    answer: DHMatricesAnswer = {
        "units": context.units.named,
        "convention": robot.table.convention.value,
        "joints": [row.name for row in robot.table.rows],
        "A": matrices.A,
        "T0": matrices.T0,
        "base": units.poses_out(robot.table.base),
        "tool": units.poses_out(robot.table.tool),
        "T": matrices.T,
        "warnings": context.warnings,
    }
    return Answer(
        answer,
        matrices.T,
        text={**answer, **_numbered(matrices, answer["joints"])},
        latex=lambda digits: _latex(matrices, digits),
    )


def _numbered(matrices: DHMatrices, joints: list[str]) -> dict[str, Any]:
    """Return A_1 … A_n and 0A_1 … 0A_n in the place of the lists, for a terminal."""
    found = {}
    for key, label, stacked in (("A", "A_{}", matrices.A), ("T0", "0A_{}", matrices.T0)):
        found[key] = {
            f"{label.format(k)} ({name})": stacked[..., k - 1, :, :]
            for k, name in enumerate(joints, start=1)
        }
    return found


def _latex(matrices: DHMatrices, digits: int | None) -> str:
    """Return A_1 … A_n, 0A_1 … 0A_n and T of each q."""
    count = matrices.A.shape[-3]
    A, T0 = (one.reshape(-1, count, 4, 4) for one in (matrices.A, matrices.T0))
    T = matrices.T.reshape(-1, 4, 4)
    labels, every = [], []
    for n in range(len(A)):
        number = "" if matrices.T.ndim == 2 else f"^{{({n + 1})}}"
        labels += [f"A_{{{k}}}{number}" for k in range(1, count + 1)]
        labels += [f"{{}}^{{0}}A_{{{k}}}{number}" for k in range(1, count + 1)]
        labels.append(f"T{number}")
        every += [A[n], T0[n], T[n : n + 1]]
    return latex.equations(labels, np.concatenate(every), digits)


DH_MATRICES = Operation(
    name="dh-matrices",
    summary="The matrices of a D-H table",
    description="Link matrices `A` (one a row: A_1 to A_n), partial products `T0` = 0A_k in frame"
    " 0, and `T` = base 0A_n tool. As npy: T. As latex: all of them, numbered. A_i in symbols:"
    " `GET /v1/dh-matrices?convention=standard`.",
    request=DHMatricesRequest,
    answer=DHMatricesAnswer,
    memory=_memory,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]},
    example_robot="pa10",
    forms=(*ARRAY_FORMS, LATEX),
    npy_field="q",
)
