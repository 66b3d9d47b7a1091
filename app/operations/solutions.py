"""ik/solutions: every q that reaches a pose, with the names of its branches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NotRequired, TypedDict

import msgspec
import numpy as np

from app.admission.need import Need
from app.fields.field import LEFT_OUT
from app.fields.joints import Seed
from app.fields.names import Frame, TargetTaskSpace
from app.fields.redundancy import SwivelAngle, Windings, WindingsChoice
from app.fields.targets import RequiredTarget
from app.operations.inverse import IKTolerance, RandomSeed, ToleranceField
from app.operations.operation import LIGHT_DOF, SHEET_FORMS, Answer, Context, Operation
from app.operations.reachable_part import ReachableView, reachable_view
from app.operations.self_motion import SelfMotionView, self_motion_view
from app.operations.shapes import AnswerUnits, Vector
from app.operations.sizes import LISTED, fixed_bytes
from app.operations.why_forbidden import ForbiddenView, forbidden_view
from app.sheets import columns
from app.sheets.headings import Heading
from app.sheets.sheet import Column, Sheet
from kinematics.chain import chain_of
from kinematics.inverse import IKOptions, Tolerance
from kinematics.inverse.all_solutions import all_solutions, solutions_at_once
from kinematics.inverse.equivalents import with_equivalents
from kinematics.inverse.solutions import IKSolution, IKSolutions
from kinematics.inverse.unreached import beyond_limits, why_unreached
from robots.robot import FloatArray, Robot

MOST_ROWS = 8_000
"""Rows of q of one answer, with room: solutions in all their turns, or samples of curves."""


class IKSolutionsRequest(msgspec.Struct, kw_only=True):
    """What to reach."""

    target: RequiredTarget
    frame: Frame = LEFT_OUT
    task: TargetTaskSpace = LEFT_OUT
    seed: Seed = None
    tolerance: IKTolerance = msgspec.field(default_factory=ToleranceField)
    random_seed: RandomSeed = 0
    swivel: SwivelAngle = None
    windings: WindingsChoice = Windings.NEAREST


class IKSolutionView(TypedDict):
    """One solution, checked on the model; errors in m and rad."""

    q: Vector
    posture: list[str]
    within_limits: bool
    beyond_limits: NotRequired[list[str]]
    position_error: float
    orientation_error: float
    free: list[str]
    swivel: float | None
    multiplicity: NotRequired[int]


class IKSolutionsAnswer(TypedDict):
    """All solutions, the closest to the seed first, those within the limits before the others.

    ``complete`` says that mathematics knows no others (but for whole turns). ``free`` names joints
    that a singular branch leaves free; they have the seed's value. ``multiplicity``, where it is
    above 1: how many solutions meet there, as two do where an arm is stretched. ``beyond_limits``,
    where there are some, names the joints beyond their limits. ``explanation``, where no solution
    is within the limits: why, as far as it is proved; ``forbidden``: the same for programs;
    ``reachable``: what of the target is reached instead, the nearest orientation first.
    ``self_motion``, of an arm with more joints than the task needs: the curves of solutions that
    these are on.
    """

    units: AnswerUnits
    method: str
    complete: bool
    description: str
    columns: list[str]
    frame: str
    task: str
    seed: Vector
    solutions: list[IKSolutionView]
    self_motion: NotRequired[SelfMotionView]
    forbidden: NotRequired[ForbiddenView]
    explanation: NotRequired[list[str]]
    reachable: NotRequired[list[ReachableView]]
    warnings: list[str]


def _memory(robot: Robot, _: IKSolutionsRequest, context: Context) -> Need:
    return Need(0.0, fixed=fixed_bytes(context.form) + MOST_ROWS * LISTED * robot.dof)


def _options(request: IKSolutionsRequest) -> IKOptions:
    tolerance = Tolerance(request.tolerance.position, request.tolerance.orientation)
    return IKOptions(tolerance=tolerance, random_seed=request.random_seed)


def _run(robot: Robot, request: IKSolutionsRequest, context: Context) -> Answer:
    found = all_solutions(
        robot,
        request.target,
        frame=request.frame,
        task=request.task,
        seed=request.seed,
        options=_options(request),
        swivel=request.swivel,
    )
    return _told(robot, request, context, found)


def _attempt(robot: Robot, request: IKSolutionsRequest, context: Context) -> Answer | None:
    """Return the answer of a closed form that reaches the target within the limits."""
    if request.swivel is not None or request.windings is not Windings.NEAREST:
        return None
    if robot.dof > LIGHT_DOF:
        return None
    found = solutions_at_once(
        robot,
        request.target,
        frame=request.frame,
        task=request.task,
        seed=request.seed,
        tolerance=Tolerance(request.tolerance.position, request.tolerance.orientation),
    )
    return None if found is None else _told(robot, request, context, found)


def _told(
    robot: Robot, request: IKSolutionsRequest, context: Context, found: IKSolutions
) -> Answer:
    """Return the answer that tells solutions, and if none is within the limits, why."""
    task, frame, options = request.task, request.frame, _options(request)
    if request.windings is Windings.ALL:
        found = with_equivalents(robot, chain_of(robot, frame), found)
    answer: IKSolutionsAnswer = {
        "units": context.units.named,
        "method": found.method,
        "complete": found.complete,
        "description": found.description,
        "columns": [joint.name for joint in robot.joints],
        "frame": frame,
        "task": task.name,
        "seed": context.units.joints_out(robot, found.seed),
        "solutions": [_view(robot, one, context) for one in found.solutions],
        "warnings": context.warnings,
    }
    if found.self_motion is not None:
        answer["self_motion"] = self_motion_view(robot, found.self_motion, context.units)
    if not any(one.within_limits for one in found.solutions):
        why = why_unreached(
            robot,
            request.target,
            frame=frame,
            task=task,
            seed=request.seed,
            options=options,
            found=found,
        )
        answer["explanation"] = list(why.sentences)
        if why.forbidden is not None:
            answer["forbidden"] = forbidden_view(robot, why.forbidden, context.units)
        if why.reachable:
            answer["reachable"] = [
                reachable_view(robot, one, context.units) for one in why.reachable
            ]
    rows = [one.q for one in found.solutions]
    q = np.array(rows).reshape(-1, robot.dof)
    return Answer(
        answer,
        context.units.joints_out(robot, q),
        sheet=lambda: _sheet(robot, found.solutions, q, context),
    )


def _sheet(robot: Robot, solutions: Sequence[IKSolution], q: FloatArray, context: Context) -> Sheet:
    """Return one row a solution."""
    units = context.units
    swivels = np.array([np.nan if one.swivel is None else one.swivel for one in solutions])
    position, orientation = (
        np.array([getattr(one, name) for one in solutions], np.float64)
        for name in ("position_error", "orientation_error")
    )
    beyond = [() if one.within_limits else beyond_limits(robot, one.q) for one in solutions]
    return Sheet(
        (
            Column(Heading.SOLUTION, list(range(1, len(solutions) + 1))),
            *columns.joints(robot, q, units),
            *columns.joint_values(robot, q, units),
            columns.words(Heading.POSTURE, [one.posture for one in solutions]),
            Column(Heading.WITHIN_LIMITS, [one.within_limits for one in solutions]),
            columns.words(Heading.BEYOND_LIMITS, beyond),
            columns.words(Heading.FREE, [one.free for one in solutions]),
            Column(Heading.SWIVEL, units.angles_out(swivels), units.named["angle"]),
            *columns.errors(position, orientation, units),
        )
    )


def _view(robot: Robot, solution: IKSolution, context: Context) -> IKSolutionView:
    swivel = solution.swivel
    view: IKSolutionView = {
        "q": context.units.joints_out(robot, solution.q),
        "posture": list(solution.posture),
        "within_limits": solution.within_limits,
        "position_error": context.units.length_out(solution.position_error),
        "orientation_error": solution.orientation_error,
        "free": list(solution.free),
        "swivel": None if swivel is None else float(context.units.angles_out(np.array(swivel))),
    }
    if solution.multiplicity > 1:
        view["multiplicity"] = solution.multiplicity
    if not solution.within_limits:
        view["beyond_limits"] = list(beyond_limits(robot, solution.q))
    return view


SOLUTIONS = Operation(
    name="ik/solutions",
    summary="All solutions of inverse kinematics",
    description="Every q that reaches a pose: in closed form, complete, for arms of three joints"
    " that place a point, alone or before a spherical wrist, 6R arms with three parallel axes,"
    " planar arms of two and three joints, and SCARA; algebraic, complete, for any other arm with"
    " no more joints than the task has rows, where the task has the whole orientation, a direction,"
    " no orientation, or one angle of joints that turn about that axis alone. An arm with"
    " one joint more has curves of solutions: self_motion tells each, with its ends, and solutions"
    " on it are listed; those of 7R arms with spherical shoulder and wrist by swivel angle. For"
    " others by search. As npy: q of each, shape (n, dof). As csv and latex: one row a solution.",
    request=IKSolutionsRequest,
    answer=IKSolutionsAnswer,
    memory=_memory,
    run=_run,
    example={"target": {"position": [0.4, 0.2, 0.5], "rpy": [0.1, 0.2, 0.3]}},
    example_robot="puma560",
    forms=SHEET_FORMS,
    attempt=_attempt,
)
