"""path: an arm follows a path by one method, sample by sample, and is judged by what it did."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from typing import Annotated, Any, NotRequired, TypedDict

import numpy as np

from app.admission.need import Need
from app.fields import texts
from app.fields.field import Field, Parameter, declared
from app.fields.names import one_of
from app.http.negotiation import JSON, NDJSON
from app.operations.joint_values import joint_values_view, joints_shown
from app.operations.operation import PICTURES, SHEET_FORMS, Answer, Context, Operation, Runs
from app.operations.path_fields import (
    PathScenario,
    read_options,
    read_problem,
    scenario_need,
)
from app.operations.path_links import LinksView, links_view
from app.operations.path_sheet import path_sheet
from app.operations.retime import RetimedMotion, motion_samples, read_retime, timing_view
from app.operations.shapes import AnswerUnits, Matrix, Vector, or_null, shaped, vector
from app.operations.sizes import FLOAT, JSON_NUMBER, fixed_bytes
from app.pictures.path_figure import path_figure
from kinematics.configuration import joint_names
from kinematics.redundancy.follow import PathResult, follow, followed
from kinematics.redundancy.judging.summary import Summary, summary
from kinematics.redundancy.measure import clearances_at, errors_at
from kinematics.redundancy.methods import METHODS, method_from
from kinematics.redundancy.timing.result import retimed
from robots.robot import FloatArray, Robot


class PathRequest(PathScenario, kw_only=True):
    """A path and a method."""

    method: Annotated[
        str,
        declared(
            Field((Parameter(texts.text, "Name of a method, such as qp."),)),
            ", ".join(METHODS) + ".",
            one_of(tuple(METHODS)),
        ),
    ] = "qp"


class JudgedView(TypedDict):
    """Verdict and figures of a followed path."""

    method: str
    success: bool
    reason: str | None
    message: str
    violations: list[str]
    tracked: float
    first_lost: int | None
    samples: int
    samples_done: int
    summary: dict[str, float | None]
    velocity_limits_respected: bool
    closed: bool
    drift: Annotated[FloatArray | None, shaped(or_null(vector()))]


class PathAnswer(JudgedView, LinksView):
    """The followed path, and whether the task was done.

    ``success`` is measured: errors, limits, clearance (swept) and speeds hold at every sample, to
    the end. Otherwise ``reason`` names what stands in the way: singular_start, singular,
    unreachable, diverged, infeasible, collision, clearance, limits, velocity, tracking or timeout.
    ``tracked`` is the part of the path, 0 to 1, that was followed within the tolerance. Lists have
    a leading axis over the samples that were computed. ``clearance_swept`` belongs to a sample
    and the next one, a lower bound. Errors are in m and rad; speeds come from differences of the
    samples. ``links`` lists the capsules of the URDF where those are asked for.
    """

    units: AnswerUnits
    frame: str
    task: str
    time_law: str
    tf: float
    columns: list[str]
    t: Vector
    r: Vector
    q: Matrix
    joint_values: NotRequired[dict[str, Vector]]
    velocity: Matrix
    acceleration: Matrix
    position_error: Vector
    orientation_error: Vector
    clearance: Annotated[FloatArray | None, shaped(or_null(vector()))]
    clearance_swept: Annotated[FloatArray | None, shaped(or_null(vector()))]
    warnings: list[str]
    retimed: RetimedMotion | None


def _memory(robot: Robot, request: PathRequest, context: Context) -> Need:
    need = scenario_need(robot, request, [request.method])
    numbers = 3 * robot.dof + joints_shown(robot) + 6
    shown = 3 * robot.dof * (1 if request.retime is None else 2)
    each = need.each + FLOAT * shown
    if context.form in (JSON, NDJSON):
        each += JSON_NUMBER * (numbers - 3 * robot.dof + shown)
    return replace(need, each=each, fixed=need.fixed + fixed_bytes(context.form))


def _run(robot: Robot, request: PathRequest, context: Context) -> Answer:
    method = method_from(request.method)
    problem = read_problem(robot, request, context)
    seconds = context.settings.max_request_seconds
    options = read_options(robot, request, problem, seconds, context)
    timing = read_retime(request.retime, problem.arm, request.samples, context)
    result = followed(problem, method, options)
    motion = None if timing is None else retimed(result, timing)
    q = context.units.joints_out(robot, result.q)
    measures, done, lengths = result.measures, len(q), context.units.lengths_out
    links, warnings = links_view(problem, context.units)
    answer: PathAnswer = {
        "units": {**context.units.named, "time": "s"},
        **judged(robot, result, context),
        "frame": problem.arm.frame,
        "task": problem.arm.task.name,
        "time_law": request.time_law,
        "tf": request.tf,
        "columns": list(joint_names(robot)),
        "t": problem.path.t[:done],
        "r": problem.path.r[:done],
        "q": q,
        **joint_values_view(robot, result.q, context.units),
        "velocity": context.units.joints_out(robot, result.velocity),
        "acceleration": context.units.joints_out(robot, result.acceleration),
        "position_error": lengths(measures.position_error),
        "orientation_error": measures.orientation_error,
        "clearance": lengths(measures.clearance) if request.obstacles else None,
        "clearance_swept": lengths(measures.swept) if request.obstacles else None,
        **links,
        "warnings": [*context.warnings, *warnings],
        "retimed": None
        if motion is None
        else {
            **timing_view(robot, motion, problem.arm, context),
            **motion_samples(robot, motion, context),
        },
    }
    title = f"{robot.name}: {result.method}"
    shown = [(result.method, result)]
    return Answer(
        answer,
        q,
        sheet=lambda: path_sheet(robot, result, context.units),
        picture=lambda: path_figure(shown, title, context.units, motion=motion),
    )


def judged(robot: Robot, result: PathResult, context: Context) -> JudgedView:
    """Return verdict and figures of a result."""
    verdict, drift = result.verdict, result.drift
    return {
        "method": result.method,
        "success": verdict.success,
        "reason": verdict.reason,
        "message": verdict.message,
        "violations": list(verdict.violations),
        "tracked": verdict.tracked,
        "first_lost": verdict.first_lost,
        "samples": result.problem.path.samples,
        "samples_done": len(result.q),
        "summary": asdict(figures_of(robot, result, context)),
        "velocity_limits_respected": "velocity" not in verdict.violations,
        "closed": result.problem.path.closed,
        "drift": None if drift is None else context.units.joints_out(robot, drift),
    }


def figures_of(robot: Robot, result: PathResult, context: Context) -> Summary:
    """Return the figures of a result, in the units of the answer."""
    found, out = summary(result, joint_units(robot, context)), context.units.length_out
    return replace(
        found,
        max_position_error=out(found.max_position_error),
        end_position_error=out(found.end_position_error),
        min_clearance=optional(found.min_clearance, out),
        min_clearance_swept=optional(found.min_clearance_swept, out),
    )


def optional(value: float | None, out: Callable[[float], float]) -> float | None:
    """Return a value in the units of the answer, None where there is none."""
    return None if value is None else out(value)


def joint_units(robot: Robot, context: Context) -> FloatArray:
    """What each joint's value is multiplied with for the answer."""
    return context.units.joints_out(robot, np.ones(robot.dof))


def _stream(robot: Robot, request: PathRequest, context: Context) -> Iterator[list[dict[str, Any]]]:
    """Samples as they are computed, then those of the motion; at last verdict and figures."""
    method = method_from(request.method)
    problem = read_problem(robot, request, context)
    seconds = context.settings.max_request_seconds
    options = read_options(robot, request, problem, seconds, context)
    timing = read_retime(request.retime, problem.arm, request.samples, context)
    work = follow(problem, method, options)
    while True:
        try:
            part = next(work)
        except StopIteration as end:
            result: PathResult = end.value
            break
        Q = part.q[part.first : part.last]
        q = context.units.joints_out(robot, problem.arm.expanded(Q, problem.start))
        position, orientation = errors_at(problem, Q, part.first)
        clearance, _ = clearances_at(problem, Q)
        position, clearance = map(context.units.lengths_out, (position, clearance))
        yield [
            {
                "sample": part.first + k,
                "t": problem.path.t[part.first + k],
                "q": q[k],
                "position_error": position[k],
                "orientation_error": orientation[k],
                "clearance": clearance[k] if request.obstacles else None,
            }
            for k in range(len(Q))
        ]
    links, warnings = links_view(problem, context.units)
    told: dict[str, Any] = {
        **judged(robot, result, context),
        **links,
        "warnings": [*context.warnings, *warnings],
        "retimed": None,
    }
    if timing is not None:
        motion = retimed(result, timing)
        told["retimed"] = timing_view(robot, motion, problem.arm, context)
        samples: dict[str, Any] = {**motion_samples(robot, motion, context)}
        if len(motion.t):
            yield [
                {"retimed_sample": k, **{name: values[k] for name, values in samples.items()}}
                for k in range(len(motion.t))
            ]
    yield [told]


PATH = Operation(
    name="path",
    summary="Follow a path with a redundant arm",
    description="From q along a straight line to a target, through waypoints or around a circle,"
    " by a time law, with one of the methods " + ", ".join(METHODS) + ". Links are capsules between"
    " successive joint origins, or about the shapes of the URDF (link_geometry). The verdict comes"
    " from measured errors, limits, clearances (swept between samples) and speeds. With retime the"
    " joint path is also given in the shortest time within speeds and accelerations. As npy: q of"
    " each sample. As csv: one row a sample, with what is violated there. As svg: the arm"
    " among its obstacles, and curves. As ndjson: one line a sample while it is computed, then"
    " those of the retimed motion, and one with the verdict, or with the `problem` where time is"
    " up.",
    request=PathRequest,
    answer=PathAnswer,
    memory=_memory,
    run=_run,
    example={
        "q": [1.9, -0.25, -0.45, -0.5, -0.5, -0.35, 0, 0.2],
        "target": {"position": [1.15, -0.15]},
        "task": "xy",
        "obstacles": [
            {"type": "circle", "center": [0.73, 0.22], "radius": 0.08},
            {"type": "circle", "center": [0.91, -0.04], "radius": 0.08},
        ],
        "link_radius": 0.02,
        "d_safe": 0.02,
    },
    example_robot="planar_8r",
    runs=Runs.THREAD,
    forms=(*SHEET_FORMS, NDJSON, *PICTURES),
    stream=_stream,
    needs="toppra",
)
