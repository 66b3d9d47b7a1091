"""ik: one target or many, each answer checked on the model."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Annotated, Any, NotRequired, TypeAlias, TypedDict

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.admission.need import Need
from app.fields import texts
from app.fields.bounds import within
from app.fields.field import LEFT_OUT, Field, Parameter, declared
from app.fields.joints import Seed
from app.fields.lengths import LENGTH
from app.fields.names import Frame, TargetTaskSpace, one_of
from app.fields.numbers import within_query
from app.fields.targets import OptionalTarget, TargetList
from app.http.negotiation import NDJSON
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.branches import BranchEndView, branch_end_view
from app.operations.joint_values import joint_values_view, joints_shown
from app.operations.operation import LIGHT_DOF, SHEET_FORMS, Answer, Context, Operation
from app.operations.reachable_part import ReachableView, reachable_view
from app.operations.shapes import (
    AnswerUnits,
    EachInteger,
    EachNumber,
    EachVector,
    Vector,
    each,
)
from app.operations.sizes import FLOAT, JSON_NUMBER, LISTED, encoded, rows_need
from app.operations.why_forbidden import ForbiddenView, forbidden_view
from app.sheets import columns
from app.sheets.headings import Heading
from app.sheets.sheet import Column, Sheet
from dh_to_urdf.errors import quoted
from dh_to_urdf.messages import say
from kinematics.configuration import joint_names
from kinematics.deadline import current
from kinematics.errors import InvalidOption
from kinematics.inverse import (
    IKBatch,
    IKOptions,
    IKResult,
    IKStatus,
    Tolerance,
    batch_bytes,
    is_compiled,
    solve_ik,
    solve_ik_batch,
)
from kinematics.inverse.all_solutions import all_solutions, curve_solutions, exact_solutions
from kinematics.inverse.one_branch import OneBranch, follow_branch
from kinematics.inverse.solutions import Choice, choose
from kinematics.inverse.unreached import Reasons, why_unreached
from robots.robot import FloatArray, Robot

SHARE_TO_SOLVE = 0.9
"""Share of the time of a request in which targets are solved; in the rest the answer is written."""
STREAMED = 512
"""Targets whose results are sent together where they are streamed."""
MAX_LISTED = 500
"""Targets not reached that the header of an npy answer lists."""
BUDGET_OF_CURVES = 0.5
"""Time budget of a target, s, from which on the curves of a redundant arm are looked at for why it
is not reached: they take some tenths of a second."""
QUICK_ITERATIONS = 1000
QUICK_SECONDS = 0.0005
"""Time that a single solve may take before it is moved to a thread."""


class ToleranceField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Largest accepted errors, m and rad."""

    position: Annotated[float, within(1e-12, 1e3), LENGTH] = 1e-6
    orientation: Annotated[float, within(1e-12, 4)] = 1e-6


@dataclass(frozen=True)
class PoseTolerance(Field):
    """Largest accepted errors; in a query one number for both."""

    def gathered(self, name: str, values: Mapping[str, Any]) -> ToleranceField:
        """Return the tolerance that one number gives."""
        return ToleranceField(position=values[name], orientation=values[name])


IKTolerance = Annotated[
    ToleranceField,
    declared(
        PoseTolerance(
            (
                Parameter(
                    texts.scalar, "singularity: relative tolerance of the rank; ik: m and rad."
                ),
            )
        )
    ),
]
RandomSeed = Annotated[
    int, within_query(0, 2**53, None, "Seed of the random starts.", texts.integer)
]


class IKRequest(msgspec.Struct, kw_only=True):
    """What to reach, with what, from where."""

    target: OptionalTarget = None
    targets: TargetList = None
    frame: Frame = LEFT_OUT
    task: TargetTaskSpace = LEFT_OUT
    seed: Seed = None
    tolerance: IKTolerance = msgspec.field(default_factory=ToleranceField)
    max_restarts: Annotated[
        int, within_query(0, 10_000, None, "Random starts after the seed.", texts.integer)
    ] = 200
    max_iterations: Annotated[
        int, within_query(1, 10_000, None, "Steps of one start.", texts.integer)
    ] = 100
    random_seed: RandomSeed = 0
    choose: Annotated[
        str | None,
        declared(
            Field((Parameter(texts.text, "closest, most_manipulable or farthest_from_limits."),)),
            "Which of all solutions within the limits: closest (to the seed), most_manipulable or"
            " farthest_from_limits; default: what the solver finds first.",
            one_of(Choice, null=True),
        ),
    ] = None
    follow: Annotated[
        bool,
        declared(
            Field((Parameter(texts.flag, "true: targets on one continuous branch."),)),
            "For targets: one q each on one continuous branch, without a jump to another: the first"
            " that reaches all, nearest to the seed at the first target.",
        ),
    ] = False
    time_budget_ms: Annotated[
        float, within_query(0, 60_000, "For each target, milliseconds.", "Milliseconds.")
    ] = 1000.0


class ToleranceView(TypedDict):
    """Largest accepted errors, m and rad."""

    position: float
    orientation: float


EachStatus: TypeAlias = Annotated[
    str | Sequence[str], each({"type": "string", "enum": [one.value for one in IKStatus]})
]


class IKAnswer(TypedDict):
    """The answer; for many targets status, q, errors and counts have a leading axis n.

    Status: converged (checked on the model), not_converged, timeout, unreachable. q is then the
    best that was found. Errors are in m and rad, in the axes of the task. ``explanation``, for one
    target that was not reached: what is proved of it, such as an orientation that the structure
    cannot reach, or the joint that is beyond its limits; ``forbidden``: the same for programs;
    ``reachable``: what of the target is reached instead, the nearest orientation first.
    ``branches``, with ``follow``: those that were tried, and where and why each ends.
    """

    units: AnswerUnits
    status: EachStatus
    q: EachVector
    joint_values: NotRequired[dict[str, EachNumber]]
    position_error: EachNumber
    orientation_error: EachNumber
    iterations: EachInteger
    restarts: EachInteger
    elapsed_ms: EachNumber
    branches: NotRequired[list[BranchEndView]]
    forbidden: NotRequired[ForbiddenView]
    explanation: NotRequired[list[str]]
    reachable: NotRequired[list[ReachableView]]
    columns: list[str]
    frame: str
    task: str
    seed: Vector
    tolerance: ToleranceView
    max_restarts: int
    max_iterations: int
    random_seed: int
    time_budget_ms: float
    warnings: list[str]


def _poses(request: IKRequest) -> tuple[FloatArray, bool]:
    """Return the target poses, shape (n, 4, 4), and whether the request gives many.

    Raises:
        RequestProblem: Neither or both of target and targets are given.
    """
    if (request.target is None) == (request.targets is None):
        raise RequestProblem(
            INVALID_REQUEST, say("give either target (one) or targets (many)"), "/target"
        )
    if request.target is not None:
        return request.target[None], False
    assert request.targets is not None
    return (request.targets, True) if request.targets.ndim == 3 else (request.targets[None], False)


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
    """Return what a request chose, and the same for a first attempt; most choose the same."""
    tolerance = Tolerance(position, orientation)
    budget = time_budget_ms / 1e3
    try:
        options = IKOptions(tolerance, max_restarts, max_iterations, random_seed, budget)
    except InvalidOption as error:
        if error.argument != "time_budget":
            raise
        milliseconds, most = budget * 1e3, 1000 * IKOptions.BOUNDS["time_budget"].upper
        raise InvalidOption(
            say(
                "time_budget_ms is {milliseconds}; give 0 to {most}",
                milliseconds=quoted(milliseconds),
                most=most,
            ),
            argument="time_budget_ms",
            value=milliseconds,
            lower=0,
            upper=most,
        ) from None
    options = options.within(seconds)
    return options, options.within(QUICK_SECONDS)


def _options_of(request: IKRequest, context: Context) -> tuple[IKOptions, IKOptions]:
    return _options(
        request.tolerance.position,
        request.tolerance.orientation,
        request.max_restarts,
        request.max_iterations,
        request.random_seed,
        request.time_budget_ms,
        context.settings.max_request_seconds,
    )


def _memory(robot: Robot, request: IKRequest, context: Context) -> Need:
    targets = request.targets
    many = 1 if targets is None or targets.ndim == 2 else len(targets)
    numbers = robot.dof + joints_shown(robot) + 8
    each = batch_bytes(robot.dof) + FLOAT * numbers + encoded(context.form, numbers, numbers)
    need = rows_need(
        many, each, context.form, numbers=numbers, of=say("targets"), argument="targets"
    )
    if context.form == NDJSON:
        return replace(need, fixed=need.fixed + STREAMED * numbers * (JSON_NUMBER + LISTED))
    return need


def _attempt(robot: Robot, request: IKRequest, context: Context) -> Answer | None:
    """Return the answer for a single target if half a millisecond is enough for it."""
    if request.target is None or request.choose is not None or request.follow:
        return None
    if not is_compiled():
        return None
    if robot.dof > LIGHT_DOF or request.max_iterations > QUICK_ITERATIONS:
        return None
    poses, _ = _poses(request)
    options, quick = _options_of(request, context)
    result = _solve(robot, request, poses[0], quick)
    if result.status is IKStatus.TIMEOUT and quick is not options:
        return None
    if result.status is not IKStatus.CONVERGED:
        # Why takes milliseconds, in a thread.
        return None
    return _single(robot, request, context, result)


def _run(robot: Robot, request: IKRequest, context: Context) -> Answer:
    poses, many = _poses(request)
    options, _ = _options_of(request, context)
    if request.follow:
        if not many or request.choose is not None:
            message = (
                say("follow takes targets (many), and chooses the branch; leave choose out")
                if many
                else say("follow takes targets (many), and chooses the branch; give targets")
            )
            raise RequestProblem(INVALID_REQUEST, message, "/follow")
        return _followed(robot, request, context, poses, options)
    if request.choose is not None:
        choice = _choice(request.choose)
        if many:
            raise RequestProblem(
                INVALID_REQUEST, say("choose takes one target at a time"), "/choose"
            )
        result = _chosen(robot, request, poses[0], options, choice)
        return _told(robot, request, context, poses[0], options, result)
    if not many:
        result = _solve(robot, request, poses[0], options)
        return _told(robot, request, context, poses[0], options, result)
    batch = _solve_batch(robot, request, poses, options, context, _seconds_to_solve(context))
    return _many(robot, request, context, batch)


def _followed(
    robot: Robot, request: IKRequest, context: Context, poses: FloatArray, options: IKOptions
) -> Answer:
    """Return the answer for targets on one branch."""
    started = time.perf_counter()
    found = follow_branch(
        robot, poses, frame=request.frame, task=request.task, seed=request.seed, options=options
    )
    batch = _as_batch(found, (time.perf_counter() - started) / len(poses))
    views = [branch_end_view(robot, one, context.units) for one in found.branches]
    return _many(robot, request, context, batch, views)


def _as_batch(found: OneBranch, seconds: float) -> IKBatch:
    n, names = len(found.q), tuple(IKStatus)
    codes = np.full(n, names.index(IKStatus.NOT_CONVERGED))
    codes[: found.reached] = names.index(IKStatus.CONVERGED)
    none = np.zeros(n, dtype=np.int64)
    return IKBatch(
        codes,
        found.q,
        found.seed,
        found.position_error,
        found.orientation_error,
        none,
        none,
        np.full(n, seconds),
    )


def _many(
    robot: Robot,
    request: IKRequest,
    context: Context,
    batch: IKBatch,
    branches: list[BranchEndView] | None = None,
) -> Answer:
    """Return the answer for many targets."""
    q = context.units.joints_out(robot, batch.q)
    names = np.array([status.value for status in IKStatus])
    statuses: list[str] = names[batch.codes].tolist()
    missed = np.flatnonzero(names[batch.codes] != IKStatus.CONVERGED.value).tolist()
    answer: IKAnswer = {
        "units": context.units.named,
        "status": statuses,
        "q": q,
        **joint_values_view(robot, batch.q, context.units),
        "position_error": context.units.lengths_out(batch.position_error),
        "orientation_error": batch.orientation_error,
        "iterations": batch.iterations,
        "restarts": batch.restarts,
        "elapsed_ms": batch.elapsed * 1e3,
        **_echo(robot, request, context, batch.seed),
    }
    if branches is not None:
        answer["branches"] = branches
    listed = [str(k) for k in missed[:MAX_LISTED]]
    if len(missed) > MAX_LISTED:
        listed.append(f"... {len(missed) - MAX_LISTED} more: with=status marks each row")
    headers = {
        "x-converged": str(len(statuses) - len(missed)),
        "x-not-converged": ",".join(listed),
    }
    errors = batch.position_error, batch.orientation_error
    return Answer(
        answer,
        q,
        headers,
        sheet=lambda: _sheet(
            robot,
            context,
            statuses,
            batch.q,
            *errors,
            batch.iterations,
            batch.restarts,
            batch.elapsed,
        ),
        records=lambda: _records(q, statuses, context.units.lengths_out(errors[0]), errors[1]),
    )


def _sheet(
    robot: Robot,
    context: Context,
    statuses: list[str],
    q: FloatArray,
    position_error: FloatArray,
    orientation_error: FloatArray,
    iterations: NDArray[np.int64],
    restarts: NDArray[np.int64],
    elapsed: FloatArray,
) -> Sheet:
    """Return one row a target, with its status; q of shape (n, dof), the others (n,)."""
    return Sheet(
        (
            columns.samples(len(statuses)),
            Column(Heading.STATUS, statuses),
            *columns.joints(robot, q, context.units),
            *columns.joint_values(robot, q, context.units),
            *columns.errors(position_error, orientation_error, context.units),
            Column(Heading.ITERATIONS, iterations),
            Column(Heading.RESTARTS, restarts),
            Column(Heading.ELAPSED, elapsed * 1e3, "ms"),
        )
    )


def _records(q: FloatArray, statuses: list[str], *errors: FloatArray) -> NDArray[Any]:
    """Return results as rows with named fields, of which npy tells the status too."""
    form = [
        ("q", "<f8", q.shape[-1:]),
        ("status", f"S{max(map(len, IKStatus))}"),
        ("position_error", "<f8"),
        ("orientation_error", "<f8"),
    ]
    rows = np.empty(len(statuses), form)
    rows["q"], rows["status"] = q, statuses
    rows["position_error"], rows["orientation_error"] = errors
    return rows


def _solve(robot: Robot, request: IKRequest, pose: FloatArray, options: IKOptions) -> IKResult:
    return solve_ik(
        robot, pose, frame=request.frame, task=request.task, seed=request.seed, options=options
    )


def _solve_batch(
    robot: Robot,
    request: IKRequest,
    poses: FloatArray,
    options: IKOptions,
    context: Context,
    seconds: float,
) -> IKBatch:
    return solve_ik_batch(
        robot,
        poses,
        frame=request.frame,
        task=request.task,
        seed=request.seed,
        options=options,
        threads=context.settings.compute_threads,
        seconds=seconds,
    )


def _seconds_to_solve(context: Context) -> float:
    """Return the time in which targets are solved, s; those that are left are marked ``timeout``.

    The rest of the request's time is for the answer: what was solved is not lost.
    """
    return SHARE_TO_SOLVE * min(context.settings.max_request_seconds, current().left)


def _stream(robot: Robot, request: IKRequest, context: Context) -> Iterator[list[dict[str, Any]]]:
    """Give the results of many targets, some hundreds at a time, as they are solved."""
    poses, many = _poses(request)
    if not many:
        raise RequestProblem(
            INVALID_REQUEST, say("ndjson is for targets, not for one target"), "/target"
        )
    if request.follow:
        raise RequestProblem(
            INVALID_REQUEST,
            say("follow looks at all targets before it answers; ask for JSON"),
            "/follow",
        )
    options, _ = _options_of(request, context)
    deadline = time.perf_counter() + _seconds_to_solve(context)
    first = 0
    while first < len(poses):
        left = max(0.0, deadline - time.perf_counter())
        # Out of time, the rest is marked at once.
        part = poses[first : first + STREAMED] if left > 0 else poses[first:]
        batch = _solve_batch(robot, request, part, options, context, left)
        q = context.units.joints_out(robot, batch.q)
        position_error = context.units.lengths_out(batch.position_error)
        yield [
            {
                "index": first + k,
                "status": status.value,
                "q": q[k],
                "position_error": position_error[k],
                "orientation_error": batch.orientation_error[k],
                "iterations": batch.iterations[k],
                "restarts": batch.restarts[k],
            }
            for k, status in enumerate(batch.statuses)
        ]
        first += len(part)


def _choice(name: str) -> Choice:
    if name not in tuple(Choice):
        message = say(
            "choose is {name}; give {choice}", name=quoted(name), choice=", ".join(Choice)
        )
        raise RequestProblem(INVALID_REQUEST, message, "/choose")
    return Choice(name)


def _chosen(
    robot: Robot, request: IKRequest, pose: FloatArray, options: IKOptions, choice: Choice
) -> IKResult:
    """Return the solution that the request prefers among all; the solver's where there is none."""
    started = time.perf_counter()
    found = all_solutions(
        robot, pose, frame=request.frame, task=request.task, seed=request.seed, options=options
    )
    best = choose(robot, found, request.frame, choice)
    if best is None:
        return _solve(robot, request, pose, options)
    elapsed = time.perf_counter() - started
    errors = best.position_error, best.orientation_error
    return IKResult(IKStatus.CONVERGED, best.q, found.seed, *errors, 0, 0, elapsed)


def _told(
    robot: Robot,
    request: IKRequest,
    context: Context,
    pose: FloatArray,
    options: IKOptions,
    result: IKResult,
) -> Answer:
    """Return the answer for one target, with the reasons where it is not reached."""
    if result.status is IKStatus.CONVERGED:
        return _single(robot, request, context, result)
    found = exact_solutions(
        robot,
        pose,
        frame=request.frame,
        task=request.task,
        seed=request.seed,
        tolerance=options.tolerance,
    )
    if found is None and options.time_budget >= BUDGET_OF_CURVES:
        found = curve_solutions(
            robot, pose, frame=request.frame, task=request.task, seed=request.seed
        )
    best = None if found is None else choose(robot, found, request.frame, Choice.CLOSEST)
    if (
        best is not None
        and best.position_error <= options.tolerance.position
        and best.orientation_error <= options.tolerance.orientation
    ):
        result = result._replace(
            status=IKStatus.CONVERGED,
            q=best.q,
            position_error=best.position_error,
            orientation_error=best.orientation_error,
        )
        return _single(robot, request, context, result)
    why = why_unreached(
        robot,
        pose,
        frame=request.frame,
        task=request.task,
        seed=request.seed,
        options=options,
        found=found,
    )
    if why.reachable and not why.reachable[0].given_up:
        # What the search for a part of it came upon.
        part = why.reachable[0]
        result = result._replace(
            status=IKStatus.CONVERGED,
            q=part.q,
            position_error=part.position_error,
            orientation_error=part.orientation_error,
        )
        return _single(robot, request, context, result)
    if why.proven:
        result = result._replace(status=IKStatus.UNREACHABLE)
    return _single(robot, request, context, result, why)


def _single(
    robot: Robot,
    request: IKRequest,
    context: Context,
    result: IKResult,
    why: Reasons | None = None,
) -> Answer:
    q = context.units.joints_out(robot, result.q)
    answer: IKAnswer = {
        "units": context.units.named,
        "status": result.status.value,
        "q": q,
        **joint_values_view(robot, result.q, context.units),
        "position_error": context.units.length_out(result.position_error),
        "orientation_error": result.orientation_error,
        "iterations": result.iterations,
        "restarts": result.restarts,
        "elapsed_ms": round(result.elapsed * 1e3, 6),
        **_echo(robot, request, context, result.seed),
    }
    if why is not None:
        answer["explanation"] = list(why.sentences)
        if why.forbidden is not None:
            answer["forbidden"] = forbidden_view(robot, why.forbidden, context.units)
        if why.reachable:
            answer["reachable"] = [
                reachable_view(robot, one, context.units) for one in why.reachable
            ]
    miss = context.units.length_out(result.position_error)
    errors = np.array([miss]), np.array([result.orientation_error])
    return Answer(
        answer,
        q,
        sheet=lambda: _sheet(
            robot,
            context,
            [result.status.value],
            result.q[None],
            *(np.atleast_1d(value) for value in result[3:]),
        ),
        records=lambda: _records(q[None], [result.status.value], *errors),
    )


class _Echo(TypedDict):
    """What the request chose, or what was taken where it did not."""

    columns: list[str]
    frame: str
    task: str
    seed: FloatArray
    tolerance: ToleranceView
    max_restarts: int
    max_iterations: int
    random_seed: int
    time_budget_ms: float
    branches: NotRequired[list[BranchEndView]]
    forbidden: NotRequired[ForbiddenView]
    explanation: NotRequired[list[str]]
    reachable: NotRequired[list[ReachableView]]
    warnings: list[str]


def _echo(robot: Robot, request: IKRequest, context: Context, seed: FloatArray) -> _Echo:
    tolerance = request.tolerance
    return {
        "columns": list(joint_names(robot)),
        "frame": request.frame,
        "task": request.task.name,
        "seed": context.units.joints_out(robot, seed),
        "tolerance": {
            "position": context.units.length_out(tolerance.position),
            "orientation": tolerance.orientation,
        },
        "max_restarts": request.max_restarts,
        "max_iterations": request.max_iterations,
        "random_seed": request.random_seed,
        "time_budget_ms": request.time_budget_ms,
        "warnings": context.warnings,
    }


IK = Operation(
    name="ik",
    summary="Inverse kinematics",
    description="A q within the limits that brings a frame to a target. An answer that is not"
    " found is a 200 with an honest `status`, the best q and its measured errors. Only the joints"
    " between base and frame move; the others stay at the seed. As npy: targets (n, 4, 4) in, q"
    " out; the headers X-Converged and X-Not-Converged say how many and which, and with=status"
    " gives rows with the fields q, status, position_error and orientation_error. As csv and"
    " latex: one row a target, with its status. As ndjson: one line a target, sent while the others"
    " are being solved.",
    request=IKRequest,
    answer=IKAnswer,
    memory=_memory,
    run=_run,
    example={"target": {"position": [0.5, 0.2, 0.6], "rpy": [0, 1.5, 0]}, "task": "pose"},
    example_robot="pa10",
    forms=(*SHEET_FORMS, NDJSON),
    npy_field="targets",
    statuses=True,
    attempt=_attempt,
    stream=_stream,
)
