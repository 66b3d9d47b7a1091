"""symbolic: A_k, 0A_k, T, position, Jacobian and its determinant as formulas or source code."""

from __future__ import annotations

import time
from typing import Annotated, Any

import msgspec

from app.http.negotiation import C_SOURCE, JSON, LATEX, PYTHON_SOURCE, TEXT
from app.operations.base import UNITS_SCHEMA, Answer, Context, Operation, TaskField
from app.operations.schema import any_of, one_of
from dh_to_urdf import Convention, extract
from kinematics import symbolic
from kinematics.symbolic.request import (
    DEFAULT_BUDGET,
    Notation,
    Quantity,
    notation_from,
    quantity_from,
)
from kinematics.task import task_from
from robots.chains import chain_of_robot
from robots.robot import Robot

_NOTATIONS = {LATEX: Notation.LATEX, PYTHON_SOURCE: Notation.PYTHON, C_SOURCE: Notation.C}


class SymbolicRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """What to write down, and how."""

    quantities: Annotated[
        list[str] | str,
        msgspec.Meta(
            description="Of A (link matrices), T0 (products 0A_k), T, position, rotation,"
            ' jacobian, det_jacobian; or "all". Default T.',
        ),
        any_of({"enum": ["all", *Quantity]}, {"type": "array", "items": {"enum": list(Quantity)}}),
    ] = msgspec.field(default_factory=lambda: ["T"])
    parameters: Annotated[
        str,
        msgspec.Meta(
            description="numeric (default): lengths as numbers; symbolic: by name, a2 and d4, in"
            " khalil D2 and R4, of the base xb yb zb, of the tool xt yt zt."
        ),
        one_of(("numeric", "symbolic")),
    ] = "numeric"
    symbols: Annotated[
        dict[str, str],
        msgspec.Meta(
            description='Other names for lengths: {"a2": "L1"}. With numeric, only these are named.'
        ),
    ] = msgspec.field(default_factory=dict)
    frame: Annotated[
        str | None, msgspec.Meta(description="tool (default) or frame_k, without the tool.")
    ] = None
    base: Annotated[
        str | None, msgspec.Meta(description="base_link (default) or frame_0, without the base.")
    ] = None
    expressed_in: Annotated[
        str | None,
        msgspec.Meta(description="Frame in whose axes the Jacobian is written; default the base."),
    ] = None
    task: Annotated[
        TaskField | None,
        msgspec.Meta(
            description="Rows of the determinant: a task or a mask; default the rows that do not"
            " vanish, or vx, vy, vz."
        ),
    ] = None
    format: Annotated[
        str,
        msgspec.Meta(description="How expressions are written: text, latex, python or c."),
        one_of(Notation),
    ] = "text"
    time_budget_ms: Annotated[
        float,
        msgspec.Meta(
            description="For simplification, milliseconds.",
            extra_json_schema={"exclusiveMinimum": 0},
        ),
    ] = DEFAULT_BUDGET * 1e3


class JacobianForms(msgspec.Struct, kw_only=True):
    """The Jacobian as expressions."""

    matrix: list[list[str]]
    rows: list[str]
    columns: list[str]


class FactorForm(msgspec.Struct, kw_only=True):
    """A factor of a determinant."""

    factor: str
    exponent: int


class UnsolvedDeterminant(msgspec.Struct, kw_only=True):
    """A matrix whose determinant is meant; columns of parallel axes are differences."""

    matrix: list[list[str]]
    expressed_in: str
    at_origin_of: str


class DeterminantForm(msgspec.Struct, kw_only=True, omit_defaults=True):
    """det J in factors. Of a redundant arm: the determinants without some joints."""

    expression: str | None
    factors: list[FactorForm] = []
    determinant_of: UnsolvedDeterminant | None = None
    rows: list[str] = []
    columns: list[str] = []
    without: list[str] = []
    note: str = ""
    minors: list[DeterminantForm] = []


class SymbolicResponse(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Expressions as texts. ``simplified`` says of which quantities they are in their last form.

    ``definitions`` says what C1 or S23 is, ``values`` what the named lengths are, in m; q1, q2, …
    are the joints in ``columns``. A quantity is null where it is too large, with a note.
    """

    units: UNITS_SCHEMA
    convention: str
    parameters: str
    values: dict[str, float]
    definitions: dict[str, str]
    columns: list[str]
    frame: str
    base: str
    expressed_in: str
    notation: str
    simplified: dict[str, bool]
    notes: list[str]
    elapsed_ms: float
    A: list[list[list[str]]] | None = None
    T0: list[list[list[str]]] | None = None
    T: list[list[str]] | None = None
    position: dict[str, str] | None = None
    rotation: dict[str, list[str]] | None = None
    jacobian: JacobianForms | None = None
    det_jacobian: DeterminantForm | None = None
    code: str | None = None


def _run(robot: Robot, request: SymbolicRequest, context: Context) -> Answer:
    started = time.perf_counter()
    table = robot.table
    if table is None:
        table = extract(chain_of_robot(robot), Convention.MODIFIED).table
    answer = context.symbolic_workers().run(table, _read(request, context))
    listing = answer.pop("listing", None)
    payload: dict[str, Any] = {
        "units": {"angle": "rad", "length": "m"},
        **answer,
        "elapsed_ms": 1e3 * (time.perf_counter() - started),
    }
    return Answer(payload, listing=listing)


def _read(request: SymbolicRequest, context: Context) -> symbolic.SymbolicRequest:
    named = [request.quantities] if isinstance(request.quantities, str) else request.quantities
    everything = request.quantities == "all"
    asked = [] if everything else [
        quantity_from(name, "quantities", (k,)) for k, name in enumerate(named)
    ]  # fmt: skip
    return symbolic.SymbolicRequest(
        quantities=tuple(Quantity) if everything else tuple(asked),
        parameters=request.parameters,
        symbols=tuple(sorted(request.symbols.items())),
        frame=request.frame or "tool",
        base=request.base or "base_link",
        expressed_in=request.expressed_in,
        task=None if request.task is None else task_from(request.task),
        notation=_NOTATIONS.get(context.form) or notation_from(request.format, "format"),
        time_budget=min(request.time_budget_ms / 1e3, context.settings.max_request_seconds),
        listing=context.form != JSON,
    )


SYMBOLIC = Operation(
    name="symbolic",
    summary="Closed forms",
    description="Link matrices, pose, Jacobian and its determinant in the short names of lectures"
    " (C23 = cos(q2 + q3)), as text, LaTeX, or a function of Python or C. Worked out in a process"
    " of its own; what is not simplified in time is given as it is.",
    request=SymbolicRequest,
    response=SymbolicResponse,
    run=_run,
    example={"quantities": ["position", "det_jacobian"], "parameters": "symbolic"},
    example_robot="puma560",
    query=(
        "quantities",
        "parameters",
        "symbols",
        "frame",
        "base",
        "expressed_in",
        "task",
        "time_budget_ms",
    ),
    forms=(JSON, TEXT, LATEX, PYTHON_SOURCE, C_SOURCE),
    out_of_process=True,
)
