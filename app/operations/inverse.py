"""ik: one target or many, each answer checked on the model."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any

import msgspec

from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.base import (
    LIGHT_DOF,
    NOT_GIVEN,
    UNITS_SCHEMA,
    Answer,
    Context,
    Numbers,
    Operation,
    OptionalConfiguration,
    TaskField,
    not_given,
    read_frame,
    read_single,
)
from app.operations.schema import (
    one_of,
    within,
)
from app.operations.targets import TARGET_QUERY, Target, TargetBatch, read_targets
from dh_to_urdf.errors import quoted
from kinematics.inverse import (
    IKBatch,
    IKOptions,
    IKResult,
    IKStatus,
    Tolerance,
    is_compiled,
    solve_ik,
    solve_ik_batch,
)
from kinematics.inverse.all_solutions import Choice, all_solutions, choose
from kinematics.task import Task, task_from
from robots.robot import FloatArray, Robot

STREAMED = 512
"""Targets whose results are sent together where they are streamed."""
MAX_LISTED = 500
"""Targets not reached that the header of an npy answer lists."""


class ToleranceField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Largest accepted errors, m and rad."""

    position: Annotated[float, within(1e-12, 1e3)] = 1e-6
    orientation: Annotated[float, within(1e-12, 4)] = 1e-6


class IKRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """What to reach, with what, from where."""

    target: Target | None = None
    targets: Annotated[
        list[Target] | TargetBatch | None,
        msgspec.Meta(description="Many targets: a list, or one object with leading axes n."),
    ] = None
    frame: Annotated[str | None, msgspec.Meta(description="Frame name; default the tip.")] = None
    task: TaskField = "pose"
    seed: OptionalConfiguration = msgspec.field(default_factory=not_given)
    tolerance: ToleranceField = msgspec.field(default_factory=ToleranceField)
    max_restarts: Annotated[int, within(0, 10_000)] = 200
    max_iterations: Annotated[int, within(1, 10_000)] = 100
    random_seed: Annotated[int, within(0, 2**53)] = 0
    choose: Annotated[
        str | None,
        msgspec.Meta(
            description="Which of all solutions within the limits: closest (to the seed),"
            " most_manipulable or farthest_from_limits; default: what the solver finds first."
        ),
        one_of(Choice, null=True),
    ] = None
    time_budget_ms: Annotated[
        float, msgspec.Meta(description="For each target, milliseconds."), within(0, 60_000)
    ] = 1000.0


class IKResponse(msgspec.Struct, kw_only=True):
    """The answer; for many targets status, q, errors and counts have a leading axis n.

    Status: converged (checked on the model), not_converged, timeout, unreachable. q is then the
    best that was found. Errors are in m and rad, in the axes of the task.
    """

    units: UNITS_SCHEMA
    status: str | list[str]
    q: Numbers
    position_error: float | list[float]
    orientation_error: float | list[float]
    iterations: int | list[int]
    restarts: int | list[int]
    elapsed_ms: float | list[float]
    columns: list[str]
    frame: str
    task: str
    seed: list[float]
    tolerance: ToleranceField
    max_restarts: int
    max_iterations: int
    random_seed: int
    time_budget_ms: float


QUICK_ITERATIONS = 1000
QUICK_SECONDS = 0.0005
"""What a single solve may take before it is moved to a thread."""


@dataclass(frozen=True)
class _Problem:
    """A request, read and checked."""

    frame: str
    task: Task
    options: IKOptions
    quick_options: IKOptions
    seed: FloatArray | None
    poses: FloatArray
    many: bool


def _read(robot: Robot, request: IKRequest, context: Context) -> _Problem:
    task = task_from(request.task)
    frame = read_frame(request.frame, robot)
    options, quick_options = _options(
        request.tolerance.position,
        request.tolerance.orientation,
        request.max_restarts,
        request.max_iterations,
        request.random_seed,
        request.time_budget_ms,
        context.settings.max_request_seconds,
    )
    seed = None
    if bytes(request.seed) != NOT_GIVEN:
        seed = read_single(request.seed, robot, context, "/seed")
    poses, many = read_targets(request.target, request.targets, task, context)
    return _Problem(frame, task, options, quick_options, seed, poses, many)


@lru_cache(maxsize=1024)
def _options(
    position: float,
    orientation: float,
    max_restarts: int,
    max_iterations: int,
    random_seed: int,
    time_budget_ms: float,
    seconds: float,
) -> tuple[IKOptions, IKOptions]:
    """What a request chose, and the same for a first look; most requests choose the same."""
    tolerance = Tolerance(position, orientation)
    budget = time_budget_ms / 1e3
    options = IKOptions(tolerance, max_restarts, max_iterations, random_seed, budget)
    options = options.within(seconds)
    return options, options.within(QUICK_SECONDS)


def _quick(robot: Robot, request: IKRequest, context: Context) -> Answer | None:
    """A single target if half a millisecond is enough for it."""
    if request.target is None or request.choose is not None or not is_compiled():
        return None
    if robot.dof > LIGHT_DOF or request.max_iterations > QUICK_ITERATIONS:
        return None
    problem = _read(robot, request, context)
    result = _solve_one(robot, problem, problem.quick_options)
    if result.status is IKStatus.TIMEOUT and problem.quick_options is not problem.options:
        return None
    return _single(robot, request, context, problem, result)


def _run(robot: Robot, request: IKRequest, context: Context) -> Answer:
    problem = _read(robot, request, context)
    if request.choose is not None:
        return _chosen(robot, request, context, problem)
    if not problem.many:
        result = _solve_one(robot, problem, problem.options)
        return _single(robot, request, context, problem, result)
    seconds = context.settings.max_request_seconds
    batch = _solve_batch(robot, problem, problem.poses, context, seconds)
    q = context.units.joints_out(robot, batch.q)
    statuses = batch.statuses
    missed = [k for k, status in enumerate(statuses) if status is not IKStatus.CONVERGED]
    leaves = {
        "status": [status.value for status in statuses],
        "q": q,
        "position_error": batch.position_error,
        "orientation_error": batch.orientation_error,
        "iterations": batch.iterations,
        "restarts": batch.restarts,
        "elapsed_ms": batch.elapsed * 1e3,
    }
    headers = {
        "x-converged": str(len(statuses) - len(missed)),
        "x-not-converged": ",".join(map(str, missed[:MAX_LISTED])),
    }
    echo = _echo(robot, request, context, problem, batch.seed)
    return Answer({"units": context.units.named, **leaves, **echo}, q, headers)


def _solve_one(robot: Robot, problem: _Problem, options: IKOptions) -> IKResult:
    return solve_ik(
        robot,
        problem.poses[0],
        frame=problem.frame,
        task=problem.task,
        seed=problem.seed,
        options=options,
    )


def _solve_batch(
    robot: Robot, problem: _Problem, poses: FloatArray, context: Context, seconds: float
) -> IKBatch:
    return solve_ik_batch(
        robot,
        poses,
        frame=problem.frame,
        task=problem.task,
        seed=problem.seed,
        options=problem.options,
        threads=context.settings.compute_threads,
        seconds=seconds,
    )


def _stream(robot: Robot, request: IKRequest, context: Context) -> Iterator[list[dict[str, Any]]]:
    """Results of many targets, some hundreds at a time, as they are solved."""
    problem = _read(robot, request, context)
    if not problem.many:
        raise RequestProblem(
            INVALID_REQUEST, "ndjson is for targets, not for one target", "/target"
        )
    deadline = time.perf_counter() + context.settings.max_request_seconds
    for first in range(0, len(problem.poses), STREAMED):
        left = max(0.0, deadline - time.perf_counter())
        poses = problem.poses[first : first + STREAMED]
        batch = _solve_batch(robot, problem, poses, context, left)
        q = context.units.joints_out(robot, batch.q)
        yield [
            {
                "index": first + k,
                "status": status.value,
                "q": q[k],
                "position_error": batch.position_error[k],
                "orientation_error": batch.orientation_error[k],
                "iterations": batch.iterations[k],
                "restarts": batch.restarts[k],
            }
            for k, status in enumerate(batch.statuses)
        ]


def _chosen(robot: Robot, request: IKRequest, context: Context, problem: _Problem) -> Answer:
    """The solution that the request prefers among all; the solver's where there is none."""
    choices = tuple(Choice)
    if request.choose not in choices:
        raise RequestProblem(
            INVALID_REQUEST,
            f"choose is {quoted(request.choose)}; give {', '.join(choices)}",
            "/choose",
        )
    if problem.many:
        raise RequestProblem(INVALID_REQUEST, "choose takes one target at a time", "/choose")
    started = time.perf_counter()
    found = all_solutions(
        robot,
        problem.poses[0],
        frame=problem.frame,
        task=problem.task,
        seed=problem.seed,
        options=problem.options,
    )
    best = choose(robot, found, problem.frame, Choice(request.choose))
    if best is None:
        result = _solve_one(robot, problem, problem.options)
    else:
        elapsed = time.perf_counter() - started
        result = IKResult(
            IKStatus.CONVERGED,
            best.q,
            found.seed,
            best.position_error,
            best.orientation_error,
            0,
            0,
            elapsed,
        )
    return _single(robot, request, context, problem, result)


def _single(
    robot: Robot, request: IKRequest, context: Context, problem: _Problem, result: IKResult
) -> Answer:
    q = context.units.joints_out(robot, result.q)
    payload = {
        "units": context.units.named,
        "status": result.status.value,
        "q": q,
        "position_error": result.position_error,
        "orientation_error": result.orientation_error,
        "iterations": result.iterations,
        "restarts": result.restarts,
        "elapsed_ms": round(result.elapsed * 1e3, 6),
        **_echo(robot, request, context, problem, result.seed),
    }
    return Answer(payload, q)


def _echo(
    robot: Robot, request: IKRequest, context: Context, problem: _Problem, seed: FloatArray
) -> dict[str, Any]:
    """What the request chose, or what was taken where it did not."""
    return {
        "columns": [joint.name for joint in robot.joints],
        "frame": problem.frame,
        "task": problem.task.name,
        "seed": context.units.joints_out(robot, seed),
        "tolerance": {
            "position": request.tolerance.position,
            "orientation": request.tolerance.orientation,
        },
        "max_restarts": request.max_restarts,
        "max_iterations": request.max_iterations,
        "random_seed": request.random_seed,
        "time_budget_ms": request.time_budget_ms,
    }


IK = Operation(
    name="ik",
    summary="Inverse kinematics",
    description="A q within the limits that brings a frame to a target. An answer that is not"
    " found is a 200 with an honest `status`, the best q and its measured errors. Only the joints"
    " between base and frame move; the others stay at the seed. As npy: targets (n, 4, 4) in, q"
    " out; the headers X-Converged and X-Not-Converged say how many and which. As ndjson: one line"
    " a target, sent while the others are being solved.",
    request=IKRequest,
    response=IKResponse,
    run=_run,
    example={"target": {"position": [0.5, 0.2, 0.6], "rpy": [0, 1.5, 0]}, "task": "pose"},
    example_robot="pa10",
    query=(
        *TARGET_QUERY,
        "frame",
        "task",
        "seed",
        "max_restarts",
        "random_seed",
        "time_budget_ms",
        "max_iterations",
        "tolerance",
        "choose",
    ),
    quick=_quick,
    stream=_stream,
    array_field="targets",
)
