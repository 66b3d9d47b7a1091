"""Targets of requests: one pose or many, in any one of their forms."""

from __future__ import annotations

from typing import Annotated, Any

import msgspec
import numpy as np

from app.http.problems import INVALID_REQUEST, RequestProblem
from app.http.units import Units
from app.operations.base import Context
from app.operations.schema import MATRICES, MATRIX, SEQUENCE, batch_of, coordinates, within
from kinematics.errors import InvalidTarget, Location
from kinematics.inverse.target import TargetSpec, target_pose, target_poses
from kinematics.task import Task
from robots.robot import FloatArray

TARGET_QUERY = ("position", "rpy", "quaternion_xyzw", "euler", "phi", "direction", "matrix")
"""The fields of a target, as a query names them."""


class EulerField(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """An orientation as Euler angles."""

    sequence: Annotated[str, SEQUENCE]
    angles: Annotated[list[float], coordinates(3)]


class Target(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """A pose: a matrix, or a position with one orientation; what the task ignores may be left out.

    For the task xy the position may be [x, y]. phi is an angle about z: a frame that follows a
    path turns to it with whatever tilt it has. direction is that of the frame's z axis, for tasks
    that leave the turn about it open.
    """

    matrix: Annotated[list[list[float]] | None, MATRIX] = None
    position: Annotated[list[float] | None, coordinates(2, 3)] = None
    quaternion_xyzw: Annotated[list[float] | None, coordinates(4)] = None
    rpy: Annotated[list[float] | None, coordinates(3)] = None
    euler: EulerField | None = None
    phi: Annotated[float | None, within(-1e6, 1e6)] = None
    direction: Annotated[list[float] | None, coordinates(3)] = None


class EulerBatch(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Orientations as Euler angles of one sequence."""

    sequence: Annotated[str, SEQUENCE]
    angles: Annotated[list[list[float]], batch_of(3)]


class TargetBatch(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    """Many targets: every field with a leading axis n."""

    matrix: Annotated[list[list[list[float]]] | None, MATRICES] = None
    position: Annotated[list[list[float]] | None, batch_of(2, 3)] = None
    quaternion_xyzw: Annotated[list[list[float]] | None, batch_of(4)] = None
    rpy: Annotated[list[list[float]] | None, batch_of(3)] = None
    euler: EulerBatch | None = None
    phi: list[float] | None = None
    direction: Annotated[list[list[float]] | None, batch_of(3)] = None


def read_targets(
    target: Target | None,
    targets: list[Target] | TargetBatch | FloatArray | None,
    task: Task,
    context: Context,
) -> tuple[FloatArray, bool]:
    """The poses of a request, shape (n, 4, 4), in m and rad, and whether it gives many.

    Args:
        target: One target.
        targets: Or many; an array of a body in npy is one where it has two axes.
        task: Says what a target must give.
        context: Units and the most targets of a request.

    Raises:
        RequestProblem: Neither or both are given, too many, or fields of unequal lengths.
        InvalidTarget: A target is no pose, or lacks what the task needs.
    """
    if (target is None) == (targets is None):
        raise RequestProblem(
            INVALID_REQUEST, "give either target (one) or targets (many)", "/target"
        )
    if target is not None:
        return read_target(target, task, context.units, "target")[None], False
    if isinstance(targets, np.ndarray):
        _check_count(len(targets) if targets.ndim == 3 else 1, context)
        return target_poses(targets if targets.ndim == 3 else targets[None]), targets.ndim == 3
    if isinstance(targets, TargetBatch) and targets.matrix is not None and _only_matrix(targets):
        _check_count(len(targets.matrix), context)
        try:
            return target_poses(np.array(targets.matrix, dtype=np.float64)), True
        except ValueError as error:
            if isinstance(error, InvalidTarget):
                raise
    assert targets is not None
    listed = targets if isinstance(targets, list) else _split(targets)
    _check_count(len(listed), context)
    poses = [
        read_target(one, task, context.units, "targets", (index,))
        for index, one in enumerate(listed)
    ]
    return np.array(poses), True


def _only_matrix(batch: TargetBatch) -> bool:
    return all(getattr(batch, name) is None for name in TARGET_QUERY if name != "matrix")


def _check_count(count: int, context: Context) -> None:
    limit = context.settings.max_ik_batch
    if not 1 <= count <= limit:
        raise RequestProblem(
            INVALID_REQUEST, f"targets holds {count}; give 1 to {limit}", "/targets"
        )


def _split(batch: TargetBatch) -> list[Target]:
    """A batch field by field -> target by target."""
    columns: dict[str, list[Any]] = {
        name: value
        for name in ("matrix", "position", "quaternion_xyzw", "rpy", "phi", "direction")
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


def read_target(
    target: Target, task: Task, units: Units, argument: str, index: Location = ()
) -> FloatArray:
    """The pose of a target, 4x4, in m and rad.

    Raises:
        InvalidTarget: The target is no pose, or lacks what the task needs.
    """

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
        direction=target.direction,
    )
    return target_pose(spec, task, argument, index)
