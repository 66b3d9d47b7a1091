"""symbolic: A_k, 0A_k, T, position, Jacobian and its determinant as formulas or source code."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any, Literal, NotRequired, TypedDict

import msgspec

from app.admission.need import NOTHING, Need
from app.fields import texts
from app.fields.field import Field, Parameter, Text, declared
from app.fields.names import FRAME_IN_QUERY, TASK_IN_QUERY, TASK_SCHEMA, TaskName, one_of
from app.http.negotiation import C_SOURCE, JSON, LATEX, MATLAB_SOURCE, PYTHON_SOURCE, TEXT
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.operation import Answer, Context, Operation, Runs
from app.operations.shapes import AnswerUnits
from dh_to_urdf import Convention, DHTable, extract
from dh_to_urdf.messages import say
from kinematics import symbolic
from kinematics.errors import InvalidOption
from kinematics.symbolic.chain import fraction_in
from kinematics.symbolic.request import (
    DEFAULT_BUDGET,
    Notation,
    Quantity,
    notation_from,
    quantity_from,
)
from kinematics.task import Task
from robots.chains import chain_of_robot
from robots.robot import Robot

_NOTATIONS = {
    LATEX: Notation.LATEX,
    PYTHON_SOURCE: Notation.PYTHON,
    C_SOURCE: Notation.C,
    MATLAB_SOURCE: Notation.MATLAB,
}


_QUANTITY = {"enum": list(Quantity)}
_ANY_QUANTITY = {"enum": ["all", *Quantity]}


def _text(
    read: Text, in_query: str, text: str, schema: dict[str, Any] | None = None
) -> msgspec.Meta:
    """Return the annotation of a field that a query gives too."""
    return declared(Field((Parameter(read, in_query),)), text, schema)


class SymbolicRequest(msgspec.Struct, kw_only=True):
    """What to write down, and how."""

    quantities: Annotated[
        list[str] | str,
        _text(
            texts.names,
            "Comma-separated: A, T0, T, position, rotation, jacobian, det_jacobian,"
            " inverse_jacobian, inverse.",
            "Of A (link matrices), T0 (products 0A_k), T, position, rotation, jacobian,"
            " det_jacobian, inverse_jacobian, inverse (the inverse model of an arm with a closed"
            ' form, derived in steps); or "all". Default T.',
            {"allOf": [{"anyOf": [_ANY_QUANTITY, {"type": "array", "items": _QUANTITY}]}]},
        ),
    ] = msgspec.field(default_factory=lambda: ["T"])
    parameters: Annotated[
        str,
        _text(
            texts.text,
            "numeric (default) or symbolic: names instead of lengths.",
            "numeric (default): lengths as numbers; symbolic: by name, a2 and d4, in khalil D2 and"
            " R4, of the base xb yb zb, of the tool xt yt zt.",
            one_of(("numeric", "symbolic")),
        ),
    ] = "numeric"
    symbols: Annotated[
        dict[str, str],
        _text(
            texts.renamings,
            "Names of lengths: a2:L1,a3:L2.",
            'Other names for lengths: {"a2": "L1"}. With numeric, only these are named.',
        ),
    ] = msgspec.field(default_factory=dict)
    frame: Annotated[
        str | None,
        declared(Field((FRAME_IN_QUERY,)), "tool (default) or frame_k, without the tool."),
    ] = None
    base: Annotated[
        str | None,
        _text(
            texts.text,
            "base_link (default) or frame_0.",
            "base_link (default) or frame_0, without the base.",
        ),
    ] = None
    expressed_in: Annotated[
        str | None,
        _text(
            texts.text,
            "Frame in whose axes the Jacobian is written.",
            "Frame in whose axes the Jacobian is written; default the base.",
        ),
    ] = None
    task: Annotated[
        Task | None,
        declared(
            TaskName((TASK_IN_QUERY,), optional=True),
            "Rows of the Jacobian, its determinant and its inverse: a task or a mask. Default: all"
            " six rows; of determinant and inverse the rows that do not vanish, or vx, vy, vz.",
            {"allOf": [{"anyOf": [TASK_SCHEMA, {"type": "null"}]}]},
        ),
    ] = None
    format: Annotated[
        str,
        msgspec.Meta(description="How expressions are written: text, latex, python, c or matlab."),
        msgspec.Meta(extra_json_schema=one_of(Notation)),
    ] = "text"
    time_budget_ms: Annotated[
        float,
        _text(
            texts.scalar,
            "Milliseconds.",
            "For simplification, milliseconds.",
            {"exclusiveMinimum": 0},
        ),
    ] = DEFAULT_BUDGET * 1e3


class JacobianForms(TypedDict):
    """The Jacobian as expressions."""

    matrix: list[list[str]]
    rows: list[str]
    columns: list[str]


class FactorForm(TypedDict):
    """A factor of a determinant."""

    factor: str
    exponent: int


class UnsolvedDeterminant(TypedDict):
    """A matrix whose determinant is meant; columns of parallel axes are differences."""

    matrix: list[list[str]]
    expressed_in: str
    at_origin_of: str


class DeterminantForm(TypedDict):
    """det J in factors. Of a redundant arm: the determinants without some joints."""

    expression: str | None
    factors: NotRequired[list[FactorForm]]
    determinant_of: NotRequired[UnsolvedDeterminant]
    rows: NotRequired[list[str]]
    columns: NotRequired[list[str]]
    without: NotRequired[list[str]]
    note: NotRequired[str]
    minors: NotRequired[list[DeterminantForm]]


class InverseForm(TypedDict):
    """The inverse of J: ``matrix`` over ``divisor``; one row a joint, one column a row of J."""

    matrix: list[list[str]]
    divisor: str
    rows: list[str]
    columns: list[str]


class ModelLine(TypedDict):
    """A line of a derivation: a ``remark``, an ``equation`` that is used, or a ``formula``."""

    kind: Literal["remark", "equation", "formula"]
    text: str


class ModelStep(TypedDict):
    """A step of a derivation."""

    title: str
    lines: list[ModelLine]


class InverseModel(TypedDict):
    """An inverse model in steps.

    ``kind``, ``description`` and ``postures`` are those of ``ik/solutions``; ``target`` names the
    elements of the 4x4 target. A formula ``e1 = 1`` stands for both signs; ``q`` is found last.
    """

    kind: str
    description: str
    target: list[list[str]]
    steps: list[ModelStep]
    q: dict[str, str]
    postures: list[list[str]]
    most_solutions: int


class SymbolicAnswer(TypedDict):
    """Expressions as texts. ``simplified`` says of which quantities they are in their last form.

    ``definitions`` says what C1 or S23 is, ``values`` what the named lengths are, in m; q1, q2, …
    are the joints in ``columns``. A quantity is null where it is too large, with a note.
    """

    units: AnswerUnits
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
    A: NotRequired[list[list[list[str]]] | None]
    T0: NotRequired[list[list[list[str]]] | None]
    T: NotRequired[list[list[str]] | None]
    position: NotRequired[dict[str, str] | None]
    rotation: NotRequired[dict[str, list[str]] | None]
    jacobian: NotRequired[JacobianForms | None]
    det_jacobian: NotRequired[DeterminantForm | None]
    inverse_jacobian: NotRequired[InverseForm | None]
    inverse: NotRequired[InverseModel | None]
    code: NotRequired[str | None]
    warnings: list[str]


def _run(robot: Robot, request: SymbolicRequest, context: Context) -> Answer:
    started = time.perf_counter()
    table = robot.table
    if table is None:
        table = extract(chain_of_robot(robot), Convention.MODIFIED).table
    _refuse_fractions(table)
    with _in_milliseconds(request):
        answer = context.symbolic_workers().run(table, _read(request, context))
    _refuse_without_closed_form(request, answer)
    listing = answer.pop("listing", None)
    payload: dict[str, Any] = {
        "units": {"angle": "rad", "length": "m"},
        **answer,
        "elapsed_ms": 1e3 * (time.perf_counter() - started),
        "warnings": context.warnings,
    }
    return Answer(payload, listing=listing)


def _memory(robot: Robot, request: SymbolicRequest, context: Context) -> Need:
    """The process's, but for formulas that are known."""
    table = robot.table
    with _in_milliseconds(request):
        if table is None or context.symbolic_workers().knows(table, _read(request, context)):
            return NOTHING
    return Need(0.0, fixed=symbolic.MEMORY)


@contextmanager
def _in_milliseconds(request: SymbolicRequest) -> Iterator[None]:
    """Name the time budget as the request does where it is refused.

    Raises:
        InvalidOption: The same.
    """
    try:
        yield
    except InvalidOption as error:
        if error.argument != "time_budget":
            raise
        raise InvalidOption(
            say("time_budget_ms is not above 0; give milliseconds"),
            argument="time_budget_ms",
            value=request.time_budget_ms,
            lower=error.lower,
        ) from None


def _refuse_fractions(table: DHTable) -> None:
    """Refuse a robot with a joint that turns by a fraction of an entry of q.

    Raises:
        RequestProblem: With the first such joint.
    """
    name = fraction_in(table)
    if name is not None:
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "joint {name} turns by a fraction of what it depends on; closed forms"
                " are written for whole multiples: use fk and jacobian",
                name=name,
            ),
            "/robot",
        )


def _refuse_without_closed_form(request: SymbolicRequest, answer: dict[str, Any]) -> None:
    """Refuse an inverse model that was asked for by name where there is none.

    Raises:
        RequestProblem: With the reason.
    """
    reason = answer.pop("no_inverse", None)
    if reason is None or request.quantities == "all":
        return
    named = [request.quantities] if isinstance(request.quantities, str) else request.quantities
    raise RequestProblem(
        INVALID_REQUEST,
        say("this robot has no inverse model in closed form: {reason}", reason=reason),
        f"/quantities/{named.index(Quantity.INVERSE)}" if len(named) > 1 else "/quantities",
    )


def _read(request: SymbolicRequest, context: Context) -> symbolic.SymbolicRequest:
    named = [request.quantities] if isinstance(request.quantities, str) else request.quantities
    everything = request.quantities == "all"
    asked = () if everything else enumerate(named)
    found = [quantity_from(name, "quantities", (k,)) for k, name in asked]
    return symbolic.SymbolicRequest(
        quantities=tuple(Quantity) if everything else tuple(found),
        parameters=request.parameters,
        symbols=tuple(sorted(request.symbols.items())),
        frame=request.frame or "tool",
        base=request.base or "base_link",
        expressed_in=request.expressed_in,
        task=request.task,
        notation=_NOTATIONS.get(context.form) or notation_from(request.format, "format"),
        time_budget=min(request.time_budget_ms / 1e3, context.settings.max_request_seconds),
        listing=context.form != JSON,
    )


SYMBOLIC = Operation(
    name="symbolic",
    summary="Closed forms",
    description="Link matrices, pose, Jacobian, its determinant and its inverse in the short names"
    " of lectures (C23 = cos(q2 + q3)), and the inverse model of arms with a closed form in steps;"
    " as text, LaTeX, or a function of Python, C or MATLAB. Worked out in a process of its own;"
    " what is not simplified in time is given as it is.",
    request=SymbolicRequest,
    installed=False,
    lengths=False,
    answer=SymbolicAnswer,
    memory=_memory,
    run=_run,
    example={"quantities": ["position", "det_jacobian"], "parameters": "symbolic"},
    example_robot="puma560",
    forms=(JSON, TEXT, LATEX, PYTHON_SOURCE, C_SOURCE, MATLAB_SOURCE),
    runs=Runs.PROCESS,
)
