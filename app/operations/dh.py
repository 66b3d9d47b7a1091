"""dh-matrices: what a D-H table says by itself, A_k, 0A_k and T."""

from __future__ import annotations

import msgspec

from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.base import (
    UNITS_SCHEMA,
    Answer,
    Configuration,
    Context,
    Numbers,
    Operation,
    check_size,
    read_configuration,
)
from dh_to_urdf import dh_matrices
from robots.robot import Robot


class DHMatricesRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Where to evaluate the table."""

    q: Configuration


class DHMatricesResponse(msgspec.Struct, kw_only=True):
    """Link matrices A_k, partial products 0A_k (in frame 0), and T = base 0A_n tool."""

    units: UNITS_SCHEMA
    convention: str
    joints: list[str]
    A: Numbers
    T0: Numbers
    base: Numbers
    tool: Numbers
    T: Numbers


def _run(robot: Robot, request: DHMatricesRequest, context: Context) -> Answer:
    if robot.table is None:
        raise RequestProblem(
            INVALID_REQUEST, "this robot was made from a URDF and has no D-H table; use fk instead"
        )
    q = read_configuration(request.q, robot, context)
    check_size(q, 32 * len(robot.table.rows))
    matrices = dh_matrices(robot.table, q)
    payload = {
        "units": context.units.named,
        "convention": robot.table.convention.value,
        "joints": [row.name for row in robot.table.rows],
        "A": matrices.A,
        "T0": matrices.T0,
        "base": robot.table.base,
        "tool": robot.table.tool,
        "T": matrices.T,
    }
    return Answer(payload, matrices.T)


DH_MATRICES = Operation(
    name="dh-matrices",
    summary="The matrices of a D-H table",
    description="Link matrices `A` (one a row), partial products `T0` = 0A_k in frame 0, and"
    " `T` = base 0A_n tool. As npy: T.",
    request=DHMatricesRequest,
    response=DHMatricesResponse,
    run=_run,
    example={"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]},
    example_robot="pa10",
    query=("q",),
    array_field="q",
)
