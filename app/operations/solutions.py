"""ik/solutions: every q that reaches a pose, with the names of its branches."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec
import numpy as np

from app.operations.base import (
    NOT_GIVEN,
    UNITS_SCHEMA,
    Answer,
    Context,
    Operation,
    OptionalConfiguration,
    TaskField,
    not_given,
    read_frame,
    read_single,
)
from app.operations.inverse import ToleranceField
from app.operations.schema import within
from app.operations.targets import TARGET_QUERY, Target, read_target
from kinematics.inverse import IKOptions, Tolerance
from kinematics.inverse.all_solutions import IKSolution, all_solutions
from kinematics.task import task_from
from robots.robot import Robot


class IKSolutionsRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """What to reach."""

    target: Target
    frame: Annotated[str | None, msgspec.Meta(description="Frame name; default the tip.")] = None
    task: TaskField = "pose"
    seed: OptionalConfiguration = msgspec.field(default_factory=not_given)
    tolerance: ToleranceField = msgspec.field(default_factory=ToleranceField)
    random_seed: Annotated[int, within(0, 2**53)] = 0


class IKSolutionView(msgspec.Struct, kw_only=True):
    """One solution, checked on the model; errors in m and rad."""

    q: list[float]
    posture: list[str]
    within_limits: bool
    position_error: float
    orientation_error: float
    free: list[str]
    swivel: float | None


class IKSolutionsResponse(msgspec.Struct, kw_only=True):
    """All solutions, the closest to the seed first, those within the limits before the others.

    ``complete`` says that mathematics knows no others (but for whole turns). ``free`` names joints
    that a singular branch leaves free; they have the seed's value.
    """

    units: UNITS_SCHEMA
    method: str
    complete: bool
    description: str
    columns: list[str]
    frame: str
    task: str
    seed: list[float]
    solutions: list[IKSolutionView]


def _run(robot: Robot, request: IKSolutionsRequest, context: Context) -> Answer:
    task = task_from(request.task)
    frame = read_frame(request.frame, robot)
    tolerance = Tolerance(request.tolerance.position, request.tolerance.orientation)
    options = IKOptions(tolerance=tolerance, random_seed=request.random_seed)
    seed = None
    if bytes(request.seed) != NOT_GIVEN:
        seed = read_single(request.seed, robot, context, "seed")
    target = read_target(request.target, task, context.units, "target")
    found = all_solutions(robot, target, frame=frame, task=task, seed=seed, options=options)
    payload = {
        "units": context.units.named,
        "method": found.method,
        "complete": found.complete,
        "description": found.description,
        "columns": [joint.name for joint in robot.joints],
        "frame": frame,
        "task": task.name,
        "seed": context.units.joints_out(robot, found.seed),
        "solutions": [_view(robot, one, context) for one in found.solutions],
    }
    rows = [one.q for one in found.solutions]
    q = np.array(rows).reshape(-1, robot.dof)
    return Answer(payload, context.units.joints_out(robot, q))


def _view(robot: Robot, solution: IKSolution, context: Context) -> dict[str, Any]:
    swivel = solution.swivel
    return {
        "q": context.units.joints_out(robot, solution.q),
        "posture": list(solution.posture),
        "within_limits": solution.within_limits,
        "position_error": solution.position_error,
        "orientation_error": solution.orientation_error,
        "free": list(solution.free),
        "swivel": None if swivel is None else float(context.units.angles_out(np.array(swivel))),
    }


SOLUTIONS = Operation(
    name="ik/solutions",
    summary="All solutions of inverse kinematics",
    description="Every q that reaches a pose: in closed form, complete, for 6R arms with a"
    " spherical wrist or three parallel axes, planar 2R and 3R, and SCARA; for 7R arms with"
    " spherical shoulder and wrist at sampled swivel angles; for others by search. As npy: q of"
    " each, shape (n, dof).",
    request=IKSolutionsRequest,
    response=IKSolutionsResponse,
    run=_run,
    example={"target": {"position": [0.4, 0.2, 0.5], "rpy": [0.1, 0.2, 0.3]}},
    example_robot="puma560",
    query=(
        *TARGET_QUERY,
        "frame",
        "task",
        "seed",
        "tolerance",
        "random_seed",
    ),
    quick=lambda robot, request, context: None,  # noqa: ARG005
)
