"""check: an answer that somebody worked out; right or not, where, by how much, and why."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, NotRequired, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields import texts
from app.fields.bounds import within
from app.fields.doubts import RequestDoubts
from app.fields.field import LEFT_OUT, Field, Parameter, Reading, declared
from app.fields.joints import optional_configuration
from app.fields.names import (
    TASK_IN_QUERY,
    TASK_SCHEMA,
    TASK_TEXT,
    Frame,
    ReferenceFrameChoice,
    TaskName,
    euler_sequence,
    one_of,
)
from app.fields.numbers import within_query
from app.fields.targets import ORIENTATION_FIELDS, OneTarget, Target, target_pose
from app.http.negotiation import JSON, TEXT
from app.http.pointers import json_pointer
from app.http.problems import INVALID_REQUEST, NOT_REVEALED, RequestProblem
from app.http.strict_json import decode_json
from app.operations.operation import Answer, Context, Operation, Runs
from app.operations.shapes import AnswerUnits
from app.operations.sizes import fixed_bytes
from app.settings import Settings
from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.checking.check import LEAST_TOLERANCE, MOST_TOLERANCE, check_answer
from kinematics.checking.jacobians import task_of
from kinematics.checking.question import TOLERANCE, Quantity, Question
from kinematics.checking.verdict import Verdict
from kinematics.task import POSE, TASKS, Task
from robots.robot import FloatArray, Robot

MAX_INDEX = 300
WORK_BYTES = 32_000_000
"""Memory of the slips that are tried at once, whose number is bounded."""
_ORIENTATIONS = ("matrix", *ORIENTATION_FIELDS)


def _json_or_formula(name: str, value: str, reading: Reading) -> Any:
    """Return what a query's text holds: JSON, or else a formula."""
    del reading
    try:
        return decode_json(value.encode(), Any, f"/{name}")
    except RequestProblem:
        if value.lstrip()[:1] in ("[", "{"):
            raise
        return value


@dataclass(frozen=True)
class CheckedTarget(OneTarget):
    """A target, whose task is what it gives where none is named."""

    def resolve(self, value: Any, location: Location, reading: Reading) -> FloatArray | None:
        """Return the pose, shape (4, 4), m.

        Raises:
            InvalidTarget: It is no pose, or lacks what the task needs.
        """
        if value is None:
            return None
        task = reading.given["task"] or target_task(value)
        reading.given["task"] = task
        return target_pose(value, task, reading.doubts, location)


def target_task(target: Target) -> Task:
    """Return the task space of what a target gives."""
    if any(getattr(target, name) is not None for name in _ORIENTATIONS):
        return POSE
    if target.phi is not None:
        return TASKS["xy_phi"]
    if target.direction is not None:
        return TASKS["position_direction"]
    flat = target.position is not None and len(target.position) == 2
    return TASKS["xy" if flat else "position"]


class CheckRequest(msgspec.Struct, kw_only=True):
    """What was asked, and the answer to check."""

    quantity: Annotated[
        str,
        declared(
            Field((Parameter(texts.text, "T, T0, A, jacobian, det_jacobian, euler, …"),)),
            "T: pose of the frame, or its rotation or position. T0: pose at q = 0, or the products"
            " 0A_k. A: link matrices. jacobian, det_jacobian: of the rows of the task. euler: three"
            " angles, or both triples. ik: one q or a list of them. delta_q: a differential step."
            " table: a D-H table.",
            one_of(Quantity),
        ),
    ]
    answer: Annotated[
        Any,
        declared(
            Field((Parameter(_json_or_formula, "Numbers as JSON, or a formula."),)),
            "Numbers or formulas such as a1*C1 + a2*C12, in nested lists; for table its document or"
            " its rows.",
        ),
    ]
    q: Annotated[
        FloatArray | None,
        optional_configuration(
            "Joint values that the answer holds at, comma-separated.",
            "Joint values that the answer holds at; not needed by formulas, T0, ik and table.",
        ),
    ] = None
    index: Annotated[
        int | None,
        declared(
            Field((Parameter(texts.integer, "Number of the matrix, from 1."),)),
            "Which A_k, or which 0A_k; left out: all of them.",
        ),
        within(1, MAX_INDEX),
    ] = None
    frame: Frame = LEFT_OUT
    reference_frame: ReferenceFrameChoice = LEFT_OUT
    task: Annotated[
        Task | None,
        declared(
            TaskName((TASK_IN_QUERY,), optional=True),
            f"Rows of Jacobians, and what of a target counts; default by the answer. {TASK_TEXT}",
            {"allOf": [{"anyOf": [TASK_SCHEMA, {"type": "null"}]}]},
        ),
    ] = None
    euler: Annotated[
        str | None,
        euler_sequence("Sequence of the angles, default ZXZ; with jacobian the analytic one."),
    ] = None
    target: Annotated[
        FloatArray | None,
        declared(CheckedTarget(optional=True), "ik: what to reach; default the pose at q."),
    ] = None
    delta_x: Annotated[
        list[float] | None,
        declared(
            Field((Parameter(texts.scalars, "Wanted motion, one value a task row."),)),
            "delta_q: wanted motion, one value a task row: m, and rad (or degrees).",
        ),
    ] = None
    z: Annotated[
        FloatArray | None,
        optional_configuration(
            "Wanted joint motion, of which the part in the null space is added.",
            "delta_q: wanted joint motion; its part in the null space is added.",
            posture=False,
        ),
    ] = None
    damping: Annotated[
        float,
        within_query(0, 1e3, "delta_q: λ of damped least squares.", "0 (none), or such as 0.01."),
    ] = 0.0
    symbols: Annotated[
        dict[str, str],
        declared(
            Field((Parameter(texts.renamings, "Names of lengths: a2:L1,a3:L2."),)),
            'Other names for lengths in formulas: {"a2": "L1"}.',
        ),
    ] = msgspec.field(default_factory=dict)
    solutions: Annotated[
        str | None,
        declared(
            Field((Parameter(texts.text, "all or any."),)),
            "ik: whether all solutions are asked, or any; default all where the answer is a list"
            " of them.",
            one_of(("all", "any"), null=True),
        ),
    ] = None
    tolerance: Annotated[
        float,
        within_query(
            LEAST_TOLERANCE,
            MOST_TOLERANCE,
            "Largest error that counts as right: m and rad, of entries over 1 relative.",
            "Such as 0.001.",
        ),
    ] = TOLERANCE
    reveal: Annotated[
        bool,
        declared(
            Field((Parameter(texts.flag, "true: also what is right."),)),
            "Also what is right. A deployment may switch this off.",
        ),
    ] = False


class CheckError(TypedDict):
    """An entry beyond the tolerance: its place, and the size of its error without sign."""

    pointer: str
    given: float | str | None
    off_by: float | None


class CheckDiagnosis(TypedDict):
    """A slip. Those with one number of ``explanation`` happened together; 1 is the likeliest."""

    code: str
    message: str
    explanation: int


class CheckAnswer(TypedDict):
    """Right or not. Errors have two digits, in the units of the answer.

    ``note`` says what of a wrong answer is right. ``expected`` is there with ``reveal``; null for
    a formula without q.
    """

    units: AnswerUnits
    quantity: str
    correct: bool
    largest_error: float | None
    tolerance: float
    errors: list[CheckError]
    diagnosis: list[CheckDiagnosis]
    note: str
    expected: NotRequired[Any]
    warnings: list[str]


def check_reveal(reveal: bool, settings: Settings) -> None:
    """Refuse to show right answers where the deployment does not.

    Raises:
        RequestProblem: 403.
    """
    if reveal and not settings.check_reveal:
        raise RequestProblem(
            NOT_REVEALED,
            say("this service checks answers and does not show the right ones; leave reveal out"),
            "/reveal",
        )


def question_of(robot: Robot, request: CheckRequest, doubts: RequestDoubts) -> Question:
    """Return the question of a request.

    Raises:
        RequestProblem: A name is unknown.
    """
    if request.quantity not in list(Quantity):
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "quantity is {quantity!r}; give {quantity_2}",
                quantity=request.quantity[:32],
                quantity_2=", ".join(Quantity),
            ),
            "/quantity",
        )
    if request.solutions not in (None, "all", "any"):
        raise RequestProblem(
            INVALID_REQUEST,
            say("solutions is {solutions!r}; give all or any", solutions=request.solutions[:32]),
            "/solutions",
        )
    angle = math.pi / 180 if doubts.units.degrees else 1.0
    question = Question(
        quantity=Quantity(request.quantity),
        robot=robot,
        q=request.q,
        frame=request.frame,
        reference_frame=request.reference_frame,
        task=request.task,
        euler=request.euler,
        index=request.index,
        target=request.target,
        z=request.z,
        damping=request.damping,
        symbols=request.symbols,
        every=None if request.solutions is None else request.solutions == "all",
        tolerance=request.tolerance,
        angle=angle,
    )
    if request.delta_x is None:
        return question
    dx = np.array(request.delta_x)
    task = task_of(question, len(dx))
    if len(dx) == len(task.rows):
        dx = np.where([row >= 3 for row in task.rows], angle * dx, dx)
    return replace(question, delta_x=dx)


def verdict_view(
    verdict: Verdict, *, reveal: bool, within: Location = ("answer",)
) -> dict[str, Any]:
    """Return what is told of an answer.

    Args:
        verdict: What was found.
        reveal: Whether also what is right.
        within: Place of the answer in the request.
    """
    view: dict[str, Any] = {
        "correct": verdict.correct,
        "largest_error": verdict.largest_error,
        "errors": [
            {
                "pointer": json_pointer((*within, *one.index)),
                "given": one.given,
                "off_by": one.off_by,
            }
            for one in verdict.errors
        ],
        "diagnosis": [
            {"code": one.code, "message": one.message, "explanation": one.explanation}
            for one in verdict.diagnosis
        ],
        "note": verdict.note,
    }
    if reveal:
        view["expected"] = _plain(verdict.expected())
    return view


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, list):
        return [_plain(one) for one in value]
    return float(value) if isinstance(value, np.floating) else value


def _memory(_: Robot, __: CheckRequest, context: Context) -> Need:
    return Need(0.0, fixed=fixed_bytes(context.form) + WORK_BYTES)


def _run(robot: Robot, request: CheckRequest, context: Context) -> Answer:
    check_reveal(request.reveal, context.settings)
    verdict = check_answer(question_of(robot, request, context.doubts), request.answer)
    answer: Mapping[str, Any] = {
        "units": context.units.named,
        "quantity": request.quantity,
        "tolerance": request.tolerance,
        **verdict_view(verdict, reveal=request.reveal),
        "warnings": context.warnings,
    }
    return Answer(answer)


CHECK = Operation(
    name="check",
    summary="Check an answer",
    description="Says whether an answer is right, where it is not and by how much, and which known"
    " slips explain it: one or two of them, the likeliest first. Numbers within the tolerance and"
    " formulas that are equal everywhere are right, in any equivalent form. What is right is not"
    " told, but for `reveal`.",
    request=CheckRequest,
    lengths=False,
    answer=CheckAnswer,
    run=_run,
    memory=_memory,
    example={"quantity": "det_jacobian", "answer": "a1*a2*S2", "task": "xy"},
    example_robot="planar_2r",
    runs=Runs.THREAD,
    forms=(JSON, TEXT),
)
