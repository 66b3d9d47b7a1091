"""Target poses as requests give them -> 4x4 matrices, checked against the task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dh_to_urdf.poses import rigid_transform, rigid_transforms
from kinematics.errors import InvalidTarget, Location, dotted
from kinematics.orientation import rotation_from_euler, rotation_from_quaternion
from kinematics.task import POSE, Task
from robots.robot import FloatArray

MAX_VALUE = 1e6


@dataclass(frozen=True)
class TargetSpec:
    """One target in any of its forms, in m and rad; None where not given.

    Attributes:
        matrix: 4x4.
        position: x, y, z; for tasks without z also x, y.
        quaternion_xyzw: Unit quaternion.
        rpy: Roll, pitch, yaw.
        euler: Sequence and its three angles.
        phi: Angle about z, alone: a planar orientation.
        direction: Of the frame's z axis, of any length: for tasks without the turn about it.
    """

    matrix: Sequence[Sequence[float]] | None = None
    position: Sequence[float] | None = None
    quaternion_xyzw: Sequence[float] | None = None
    rpy: Sequence[float] | None = None
    euler: tuple[str, Sequence[float]] | None = None
    phi: float | None = None
    direction: Sequence[float] | None = None


def target_pose(
    spec: TargetSpec, task: Task, argument: str = "target", index: Location = ()
) -> FloatArray:
    """The pose of a target; what the task does not look at may be missing.

    Args:
        spec: The target.
        task: The task space.
        argument: What errors call it.
        index: Place of the target within that argument.

    Returns:
        4x4; the identity in what is not given.

    Raises:
        InvalidTarget: A part that the task needs is missing, two forms contradict, or a value
            is not finite or no rotation.
        UnknownSequence: Not an Euler sequence.
    """
    name = dotted(argument, index)
    orientations = {
        "quaternion_xyzw": spec.quaternion_xyzw,
        "rpy": spec.rpy,
        "euler": spec.euler,
        "phi": spec.phi,
        "direction": spec.direction,
    }
    given = [form for form, value in orientations.items() if value is not None]
    if spec.matrix is not None:
        if given or spec.position is not None:
            raise InvalidTarget(
                f"{name} has a matrix and other fields; give one form",
                argument=argument,
                index=index,
            )
        try:
            matrix = rigid_transform(spec.matrix)
        except ValueError as error:
            where = index if "matrix" in index else (*index, "matrix")
            raise InvalidTarget(f"target.matrix {error}", argument=argument, index=where) from None
        _vector(matrix[:3, 3].tolist(), 3, "matrix", argument, index)
        return matrix
    if len(given) > 1:
        raise InvalidTarget(
            f"{name} has {' and '.join(given)}; give one orientation",
            argument=argument,
            index=index,
            known=tuple(given),
        )
    if task.positions and spec.position is None:
        raise InvalidTarget(
            f"task {task.name} needs a position; give {name}.position or .matrix",
            argument=argument,
            index=(*index, "position"),
            task=task.name,
        )
    if task.rotations and not given:
        raise InvalidTarget(
            f"task {task.name} needs an orientation; give {name}.rpy, quaternion_xyzw,"
            " euler, phi, direction or matrix, or choose task position",
            argument=argument,
            index=index,
            task=task.name,
            known=(*orientations, "matrix"),
        )
    if spec.phi is not None and task.rotations not in ((), (2,)):
        raise InvalidTarget(
            f"{name}.phi is an angle about z alone, but task {task.name} needs a whole"
            " orientation; give rpy, quaternion_xyzw, euler or matrix",
            argument=argument,
            index=(*index, "phi"),
            task=task.name,
            known=("rpy", "quaternion_xyzw", "euler", "matrix"),
        )
    if spec.direction is not None and task.rotations and not task.own_axes:
        raise InvalidTarget(
            f"{name}.direction leaves the turn about it open, but task {task.name}"
            " needs it; choose task position_direction or direction, or give rpy, quaternion_xyzw,"
            " euler or matrix",
            argument=argument,
            index=(*index, "direction"),
            task=task.name,
            known=("rpy", "quaternion_xyzw", "euler", "matrix"),
        )
    T = np.eye(4)
    if spec.position is not None:
        T[:3, 3] = _position(spec.position, task, argument, index)
    if spec.quaternion_xyzw is not None:
        quaternion = _vector(spec.quaternion_xyzw, 4, "quaternion_xyzw", argument, index)
        try:
            T[:3, :3] = rotation_from_quaternion(quaternion)
        except ValueError as error:
            raise InvalidTarget(
                f"{name}.quaternion_xyzw {error}",
                argument=argument,
                index=(*index, "quaternion_xyzw"),
            ) from None
    elif spec.rpy is not None:
        T[:3, :3] = rotation_from_euler("xyz", _vector(spec.rpy, 3, "rpy", argument, index))
    elif spec.euler is not None:
        sequence, angles = spec.euler
        values = _vector(angles, 3, "euler", argument, index)
        T[:3, :3] = rotation_from_euler(sequence, values, argument, (*index, "euler", "sequence"))
    elif spec.direction is not None:
        T[:3, :3] = _along(
            _vector(spec.direction, 3, "direction", argument, index), argument, index
        )
    elif spec.phi is not None:
        T[:3, :3] = rotation_from_euler(
            "xyz", _vector([0.0, 0.0, spec.phi], 3, "phi", argument, index)
        )
    return T


def target_poses(
    matrices: FloatArray, argument: str = "targets", index: Location = ("matrix",)
) -> FloatArray:
    """Checks many target matrices, shape (n, 4, 4).

    Raises:
        InvalidTarget: One is no rigid placement; the index says which.
    """
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4):
        raise InvalidTarget(
            "targets are no 4x4 matrices; give shape (n, 4, 4)", argument=argument, index=index
        )
    try:
        poses = rigid_transforms(matrices)
    except ValueError:
        for k, matrix in enumerate(matrices):
            target_pose(TargetSpec(matrix=matrix.tolist()), POSE, argument, (*index, k))
        raise
    if poses.size and not np.abs(poses).max() <= MAX_VALUE:
        raise InvalidTarget(
            "a target is beyond ±1e6",
            argument=argument,
            index=index,
            lower=-MAX_VALUE,
            upper=MAX_VALUE,
        )
    return poses


def _along(direction: FloatArray, argument: str, index: Location) -> FloatArray:
    """A rotation whose z axis has a direction."""
    length = float(np.linalg.norm(direction))
    if length < 1e-9:
        raise InvalidTarget(
            f"{dotted(argument, index)}.direction is zero; give the frame's z axis, such as"
            " [0, 0, -1]",
            argument=argument,
            index=(*index, "direction"),
        )
    z = direction / length
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.column_stack((x, np.cross(z, x), z))


def _position(position: Sequence[float], task: Task, argument: str, index: Location) -> FloatArray:
    if 2 in task.positions:
        return _vector(position, 3, "position", argument, index)
    if len(position) not in (2, 3):
        raise InvalidTarget(
            f"{dotted(argument, index)}.position has {len(position)} values; give 2, or 3, of which"
            f" task {task.name} does not look at z",
            argument=argument,
            index=(*index, "position"),
            task=task.name,
            expected=2,
        )
    return _vector([*position, 0.0][:3], 3, "position", argument, index)


def _vector(
    values: Sequence[float], size: int, name: str, argument: str, index: Location
) -> FloatArray:
    place = (*index, name)
    if len(values) != size:
        raise InvalidTarget(
            f"{dotted(argument, place)} has {len(values)} values; give {size}",
            argument=argument,
            index=place,
            expected=size,
        )
    for value in values:
        if not -MAX_VALUE <= value <= MAX_VALUE:
            raise InvalidTarget(
                f"{dotted(argument, place)} has a value that is not finite or beyond ±1e6",
                argument=argument,
                index=place,
                value=float(value),
                lower=-MAX_VALUE,
                upper=MAX_VALUE,
            )
    return np.array(values, dtype=np.float64)
