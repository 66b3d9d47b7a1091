"""path/compare: several methods on one path, in one table."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any

import msgspec

from app.operations.base import UNITS_SCHEMA, Answer, Context, Operation
from app.operations.path import PATH, joint_units
from app.operations.path_fields import GainsField, PathScenario, read_options, read_problem
from app.operations.path_links import LinkPart, told_of_links
from app.operations.retime import read_retime
from app.operations.schema import METHOD, items
from app.pictures.path_figure import path_figure
from kinematics.errors import InvalidOption
from kinematics.redundancy.compare import compared
from kinematics.redundancy.judging.summary import summary
from kinematics.redundancy.methods import METHODS, method_from
from kinematics.redundancy.timing.result import retimed
from robots.robot import Robot

MAX_METHODS = 16
DEFAULT = ("pseudo_inverse", "damped", "null_space", "sqp", "qp")


class MethodChoice(msgspec.Struct, forbid_unknown_fields=True, kw_only=True, omit_defaults=True):
    """A method with options of its own, in the place of the common ones."""

    method: Annotated[str, METHOD]
    label: str | None = None
    closed_loop: bool | None = None
    damping: float | None = None
    iterations: int | None = None
    gains: GainsField | None = None
    influence: float | None = None
    obstacle_weight: float | None = None
    margin: float | None = None
    perturb: float | None = None


class CompareRequest(PathScenario, forbid_unknown_fields=True, kw_only=True):
    """A path, and the methods to compare on it."""

    methods: Annotated[
        list[str | MethodChoice],
        msgspec.Meta(
            description="Names, or objects {method, label, and options of its own}: "
            + ", ".join(METHODS)
        ),
        items(1, MAX_METHODS),
    ] = msgspec.field(default_factory=lambda: list(DEFAULT))


class CompareRow(msgspec.Struct, kw_only=True):
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


class CompareResponse(msgspec.Struct, kw_only=True):
    """The table, and in words what stood in the way of each method."""

    units: UNITS_SCHEMA
    frame: str
    task: str
    samples: int
    rows: list[CompareRow]
    messages: dict[str, str]
    links: list[LinkPart] | None
    warnings: list[str]


def _run(robot: Robot, request: CompareRequest, context: Context) -> Answer:
    problem = read_problem(robot, request, context)
    if not 1 <= len(request.methods) <= MAX_METHODS:
        raise InvalidOption(
            f"methods holds {len(request.methods)}; give 1 to {MAX_METHODS}",
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
    results = list(compared(problem, entries, seconds))
    motions = [None if timing is None else retimed(result, timing) for result in results]
    unit = joint_units(robot, context)
    rows: list[dict[str, Any]] = [
        {
            "method": label,
            "success": result.verdict.success,
            "reason": result.verdict.reason,
            "tracked": result.verdict.tracked,
            **asdict(summary(result, unit)),
            "retimed_success": None if motion is None else motion.success,
            "retimed_duration": None if motion is None else motion.duration,
        }
        for label, result, motion in zip(labels, results, motions, strict=True)
    ]
    payload = {
        "units": context.units.named,
        "frame": problem.arm.frame,
        "task": problem.arm.task.name,
        "samples": problem.path.samples,
        "rows": rows,
        "messages": {
            label: result.verdict.message + ("" if motion is None else f"; {motion.message}")
            for label, result, motion in zip(labels, results, motions, strict=True)
        },
        **told_of_links(problem),
    }
    shown = list(zip(labels, results, strict=True))
    title = f"{robot.name}: methods compared"
    return Answer(payload, rows=rows, picture=lambda: path_figure(shown, title))


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
    " shortest time (with retime), and the verdict. Also as text, CSV and SVG.",
    request=CompareRequest,
    response=CompareResponse,
    run=_run,
    example={**PATH.example, "methods": ["pseudo_inverse", "null_space", "qp"]},
    example_robot="planar_8r",
    query=(*PATH.query, "methods"),
    quick=lambda robot, request, context: None,  # noqa: ARG005
    tabular=True,
    pictured=True,
    rehearsed=False,
    extras=True,
)
