"""ik: one target or many, each answer checked on the model."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Annotated, Any

import msgspec
import numpy as np

from app.operations.base import (
    UNITS_SCHEMA,
    Answer,
    Context,
    Numbers,
    Operation,
    SingleConfiguration,
    TaskField,
    read_single,
)
from app.problems import INVALID_REQUEST, RequestProblem
from app.units import Units
from kinematics.inverse import IKOptions, IKResult, Tolerance, solve_ik
from kinematics.inverse.target import TargetSpec, target_pose
from kinematics.task import Task, task_from
from robots.robot import FloatArray, Robot

NOT_GIVEN = b"null"


def _not_given() -> msgspec.Raw:
    return msgspec.Raw(NOT_GIVEN)


class EulerField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """An orientation as Euler angles."""

    sequence: str
    angles: list[float]


class Target(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """A pose: a matrix, or a position with one orientation; what the task ignores may be left out.

    For the task xy the position may be [x, y]; phi is an angle about z.
    """

    matrix: list[list[float]] | None = None
    position: list[float] | None = None
    quaternion_xyzw: list[float] | None = None
    rpy: list[float] | None = None
    euler: EulerField | None = None
    phi: float | None = None


class EulerBatch(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Orientations as Euler angles of one sequence."""

    sequence: str
    angles: list[list[float]]


class TargetBatch(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Many targets: every field with a leading axis n."""

    matrix: list[list[list[float]]] | None = None
    position: list[list[float]] | None = None
    quaternion_xyzw: list[list[float]] | None = None
    rpy: list[list[float]] | None = None
    euler: EulerBatch | None = None
    phi: list[float] | None = None


class ToleranceField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Largest accepted errors, m and rad."""

    position: float = 1e-6
    orientation: float = 1e-6


class IKRequest(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """What to reach, with what, from where."""

    target: Target | None = None
    targets: Annotated[
        list[Target] | TargetBatch | None,
        msgspec.Meta(description="Many targets: a list, or one object with leading axes n."),
    ] = None
    frame: Annotated[str | None, msgspec.Meta(description="Frame name; default the tip.")] = None
    task: TaskField = "pose"
    seed: SingleConfiguration = msgspec.field(default_factory=_not_given)
    tolerance: ToleranceField = msgspec.field(default_factory=ToleranceField)
    max_restarts: int = 50
    max_iterations: int = 100
    random_seed: int = 0
    time_budget_ms: Annotated[float, msgspec.Meta(description="For each target, milliseconds.")] = (
        1000.0
    )


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


def _run(robot: Robot, request: IKRequest, context: Context) -> Answer:
    task = task_from(request.task)
    frame = robot.tip_frame if request.frame is None else request.frame
    robot.frame_id(frame)
    options = IKOptions(
        tolerance=Tolerance(request.tolerance.position, request.tolerance.orientation),
        max_restarts=request.max_restarts,
        max_iterations=request.max_iterations,
        random_seed=request.random_seed,
        time_budget=request.time_budget_ms / 1e3,
    )
    seed = None
    if bytes(request.seed) != NOT_GIVEN:
        seed = read_single(request.seed, robot, context, "/seed")
    poses, many = _targets(request, task, context)
    deadline = time.perf_counter() + context.settings.max_request_seconds
    results = []
    for pose in poses:
        left = max(0.0, deadline - time.perf_counter())
        limited = replace(options, time_budget=min(options.time_budget, left))
        results.append(solve_ik(robot, pose, frame=frame, task=task, seed=seed, options=limited))
    q = context.units.joints_out(robot, np.array([result.q for result in results]))
    leaves = _leaves(results, q)
    payload = {
        "units": context.units.named,
        **(leaves if many else {name: leaf[0] for name, leaf in leaves.items()}),
        "columns": [joint.name for joint in robot.joints],
        "frame": frame,
        "task": task.name,
        "seed": context.units.joints_out(robot, results[0].seed),
        "tolerance": msgspec.to_builtins(request.tolerance),
        "max_restarts": request.max_restarts,
        "max_iterations": request.max_iterations,
        "random_seed": request.random_seed,
        "time_budget_ms": request.time_budget_ms,
    }
    return Answer(payload, q if many else q[0])


def _leaves(results: list[IKResult], q: FloatArray) -> dict[str, Any]:
    return {
        "status": [result.status.value for result in results],
        "q": q,
        "position_error": [result.position_error for result in results],
        "orientation_error": [result.orientation_error for result in results],
        "iterations": [result.iterations for result in results],
        "restarts": [result.restarts for result in results],
        "elapsed_ms": [round(result.elapsed * 1e3, 6) for result in results],
    }


def _targets(request: IKRequest, task: Task, context: Context) -> tuple[list[FloatArray], bool]:
    if (request.target is None) == (request.targets is None):
        raise RequestProblem(
            INVALID_REQUEST, "give either target (one) or targets (many)", "/target"
        )
    if request.target is not None:
        return [_pose(request.target, task, context.units, "/target")], False
    targets = request.targets
    listed = targets if isinstance(targets, list) else _split(targets or TargetBatch())
    limit = context.settings.max_ik_batch
    if not 1 <= len(listed) <= limit:
        raise RequestProblem(
            INVALID_REQUEST, f"targets holds {len(listed)}; give 1 to {limit}", "/targets"
        )
    poses = [
        _pose(target, task, context.units, f"/targets/{index}")
        for index, target in enumerate(listed)
    ]
    return poses, True


def _split(batch: TargetBatch) -> list[Target]:
    """A batch field by field -> target by target."""
    columns: dict[str, list[Any]] = {
        name: value
        for name in ("matrix", "position", "quaternion_xyzw", "rpy", "phi")
        if (value := getattr(batch, name)) is not None
    }
    if batch.euler is not None:
        sequence = batch.euler.sequence
        columns["euler"] = [EulerField(sequence=sequence, angles=a) for a in batch.euler.angles]
    lengths = {name: len(value) for name, value in columns.items()}
    if len(set(lengths.values())) != 1:
        found = ", ".join(f"{name} {length}" for name, length in lengths.items()) or "nothing"
        raise RequestProblem(
            INVALID_REQUEST, f"targets has fields of unequal lengths ({found})", "/targets"
        )
    count = next(iter(lengths.values()))
    return [Target(**{name: value[k] for name, value in columns.items()}) for k in range(count)]


def _pose(target: Target, task: Task, units: Units, pointer: str) -> FloatArray:
    def angles(values: list[float] | None) -> list[float] | None:
        return None if values is None else list(units.angles_in(np.array(values)))

    euler = None
    if target.euler is not None:
        euler = (target.euler.sequence, angles(target.euler.angles) or [])
    phi = angles([target.phi]) if target.phi is not None else None
    spec = TargetSpec(
        matrix=target.matrix,
        position=target.position,
        quaternion_xyzw=target.quaternion_xyzw,
        rpy=angles(target.rpy),
        euler=euler,
        phi=phi[0] if phi else None,
    )
    return target_pose(spec, task, pointer)


IK = Operation(
    name="ik",
    summary="Inverse kinematics",
    description="A q within the limits that brings a frame to a target. An answer that is not"
    " found is a 200 with an honest `status`, the best q and its measured errors. Only the joints"
    " between base and frame move; the others stay at the seed. As npy: q.",
    request=IKRequest,
    response=IKResponse,
    run=_run,
    example={"target": {"position": [0.5, 0.2, 0.6], "rpy": [0, 1.5, 0]}, "task": "pose"},
    example_robot="pa10",
    query=(
        "position",
        "rpy",
        "quaternion_xyzw",
        "euler",
        "phi",
        "matrix",
        "frame",
        "task",
        "seed",
        "max_restarts",
        "random_seed",
        "time_budget_ms",
        "max_iterations",
        "tolerance",
    ),
    light=lambda robot, request: False,  # noqa: ARG005
)
