"""path/compare: several methods on one path, in one table."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Annotated, NotRequired, TypedDict

import msgspec

from app.admission.need import Need
from app.fields import texts
from app.fields.field import Field, Parameter, declared
from app.fields.lengths import LENGTH
from app.fields.names import one_of
from app.operations.operation import PICTURES, TABLE_FORMS, Answer, Context, Operation, Runs
from app.operations.path import PATH, figures_of
from app.operations.path_fields import (
    GainsField,
    PathScenario,
    read_options,
    read_problem,
    scenario_need,
)
from app.operations.path_links import LinksView, links_view
from app.operations.retime import read_retime
from app.operations.shapes import AnswerUnits
from app.operations.sizes import fixed_bytes
from app.pictures.path_figure import path_figure
from app.sheets.sheet import Sheet
from dh_to_urdf.messages import chained, say
from kinematics.errors import InvalidOption, KinematicsError
from kinematics.redundancy.compare import compared
from kinematics.redundancy.follow import PathResult
from kinematics.redundancy.judging.summary import Summary
from kinematics.redundancy.methods import METHODS, method_from
from kinematics.redundancy.timing.result import Retimed, retimed
from robots.robot import Robot

MAX_METHODS = 16
DEFAULT = ("pseudo_inverse", "damped", "null_space", "sqp", "qp")


class MethodChoice(msgspec.Struct, forbid_unknown_fields=True, kw_only=True, omit_defaults=True):
    """A method with options of its own, in the place of the common ones."""

    method: Annotated[str, msgspec.Meta(extra_json_schema=one_of(tuple(METHODS)))]
    label: str | None = None
    closed_loop: bool | None = None
    damping: float | None = None
    iterations: int | None = None
    gains: GainsField | None = None
    influence: Annotated[float | None, LENGTH] = None
    obstacle_weight: float | None = None
    margin: Annotated[float | None, LENGTH] = None
    perturb: float | None = None


class CompareRequest(PathScenario, kw_only=True):
    """A path, and the methods to compare on it."""

    methods: Annotated[
        list[str | MethodChoice],
        declared(
            Field((Parameter(texts.names, "Names of methods, comma-separated."),)),
            "Names, or objects {method, label, and options of its own}: " + ", ".join(METHODS),
            {"minItems": 1, "maxItems": MAX_METHODS},
        ),
    ] = msgspec.field(default_factory=lambda: list(DEFAULT))


class CompareRow(TypedDict):
    """One method; see the answer of path for what the figures mean."""

    method: str
    success: bool
    reason: str | None
    tracked: float
    max_position_error: float
    end_position_error: float
    max_orientation_error: float
    end_orientation_error: float
    sum_dq: float
    largest_step: float
    min_clearance: float | None
    min_clearance_swept: float | None
    limit_margin: float | None
    speed_ratio: float | None
    drift: float | None
    ms_per_point: float
    retimed_success: bool | None
    retimed_duration: float | None


class LeftOut(TypedDict, total=False):
    """Methods that were left out, and why."""

    left_out: dict[str, str]


class CompareAnswer(LinksView):
    """The table, and in words what stood in the way of each method.

    ``left_out``, where there are some: methods that need what the request does not have, each with
    what that is.
    """

    units: AnswerUnits
    frame: str
    task: str
    samples: int
    rows: list[CompareRow]
    messages: dict[str, str]
    left_out: NotRequired[dict[str, str]]
    warnings: list[str]


def _memory(robot: Robot, request: CompareRequest, context: Context) -> Need:
    methods = [one if isinstance(one, str) else one.method for one in request.methods]
    need = scenario_need(robot, request, methods[:MAX_METHODS])
    return replace(need, fixed=need.fixed + fixed_bytes(context.form))


def _run(robot: Robot, request: CompareRequest, context: Context) -> Answer:
    problem = read_problem(robot, request, context)
    if not 1 <= len(request.methods) <= MAX_METHODS:
        raise InvalidOption(
            say(
                "methods holds {count}; give 1 to {max_methods}",
                count=len(request.methods),
                max_methods=MAX_METHODS,
            ),
            argument="methods",
            value=len(request.methods),
            lower=1,
            upper=MAX_METHODS,
        )
    seconds = context.settings.max_request_seconds
    labels: list[str] = []
    entries = []
    for k, one in enumerate(request.methods):
        choice = MethodChoice(method=one) if isinstance(one, str) else one
        own = {
            name: value
            for name in choice.__struct_fields__[2:]
            if (value := getattr(choice, name)) is not None
        }
        method = method_from(choice.method, "methods", (k,))
        told = msgspec.structs.replace(request, **own)
        labels.append(_label(choice.label or choice.method, labels))
        try:
            options = read_options(robot, told, problem, seconds, context)
        except InvalidOption as error:
            if error.argument not in own:
                raise
            raise InvalidOption(
                str(error),
                argument="methods",
                index=(k, *error.location),
                value=error.value,
                lower=error.lower,
                upper=error.upper,
                known=error.known,
            ) from None
        entries.append((method, options))
    timing = read_retime(request.retime, problem.arm, request.samples, context)
    done, left_out = _done(labels, compared(problem, entries, seconds))
    labels, results = list(done), list(done.values())
    motions = [None if timing is None else retimed(result, timing) for result in results]
    rows = [
        _row(label, result, motion, figures_of(robot, result, context))
        for label, result, motion in zip(labels, results, motions, strict=True)
    ]
    links, warnings = links_view(problem, context.units)
    answer: CompareAnswer = {
        "units": context.units.named,
        "frame": problem.arm.frame,
        "task": problem.arm.task.name,
        "samples": problem.path.samples,
        "rows": rows,
        "messages": {
            label: result.verdict.message
            if motion is None
            else chained("; ", (result.verdict.message, motion.message))
            for label, result, motion in zip(labels, results, motions, strict=True)
        },
        **_left_out_view(left_out),
        **links,
        "warnings": [
            *context.warnings,
            *warnings,
            *(
                say("{label} is left out: {why}", label=label, why=why)
                for label, why in left_out.items()
            ),
        ],
    }
    shown = list(zip(labels, results, strict=True))
    title = say("{robot}: methods compared", robot=robot.name)
    return Answer(
        answer,
        sheet=lambda: Sheet.of_rows(rows),
        picture=lambda: path_figure(shown, title, context.units),
    )


def _left_out_view(left_out: dict[str, str]) -> LeftOut:
    return {"left_out": left_out} if left_out else {}


def _done(
    labels: list[str], results: Iterable[PathResult | KinematicsError]
) -> tuple[dict[str, PathResult], dict[str, str]]:
    """Return the results by label, and why the other methods have none.

    Raises:
        KinematicsError: No method has one; what the first says.
    """
    done: dict[str, PathResult] = {}
    left_out: dict[str, KinematicsError] = {}
    for label, result in zip(labels, results, strict=True):
        if isinstance(result, PathResult):
            done[label] = result
        else:
            left_out[label] = result
    if not done:
        raise next(iter(left_out.values()))
    return done, {label: str(error) for label, error in left_out.items()}


def _row(label: str, result: PathResult, motion: Retimed | None, figures: Summary) -> CompareRow:
    verdict = result.verdict
    return {
        "method": label,
        "success": verdict.success,
        "reason": verdict.reason,
        "tracked": verdict.tracked,
        "max_position_error": figures.max_position_error,
        "end_position_error": figures.end_position_error,
        "max_orientation_error": figures.max_orientation_error,
        "end_orientation_error": figures.end_orientation_error,
        "sum_dq": figures.sum_dq,
        "largest_step": figures.largest_step,
        "min_clearance": figures.min_clearance,
        "min_clearance_swept": figures.min_clearance_swept,
        "limit_margin": figures.limit_margin,
        "speed_ratio": figures.speed_ratio,
        "drift": figures.drift,
        "ms_per_point": figures.ms_per_point,
        "retimed_success": None if motion is None else motion.success,
        "retimed_duration": None if motion is None else motion.duration,
    }


def _label(name: str, taken: list[str]) -> str:
    """A name that no row has yet."""
    label, count = name[:64], 1
    while label in taken:
        count += 1
        label = f"{name[:64]} ({count})"
    return label


COMPARE = Operation(
    name="path/compare",
    summary="Compare methods on one path",
    description="Several methods on one scenario, in one table: errors, Σ‖Δq‖, largest step, least"
    " clearance (swept between samples), limit margin, drift of closed paths, ms a point, the"
    " shortest time (with retime), and the verdict. A method that"
    " needs more input is left out, with a warning. Also as text, CSV, LaTeX and SVG.",
    request=CompareRequest,
    answer=CompareAnswer,
    memory=_memory,
    run=_run,
    example={**PATH.example, "methods": ["pseudo_inverse", "null_space", "qp"]},
    example_robot="planar_8r",
    runs=Runs.THREAD,
    forms=(*TABLE_FORMS, *PICTURES),
    needs="toppra",
)
