"""Target poses in any of their forms -> 4x4 matrices, checked against the task."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import chained, say
from dh_to_urdf.poses import rigid_transform, rigid_transforms
from kinematics.bounds import MAX_VALUE
from kinematics.errors import InvalidTarget
from kinematics.orientation import (
    parse_sequence,
    rotation_from_euler,
    rotation_from_quaternion,
)
from kinematics.orientation_formats import FORMATS, OrientationFormat
from kinematics.task import Task
from robots.robot import FloatArray

Rows: TypeAlias = Sequence[Sequence[float]] | FloatArray


@dataclass(frozen=True)
class Targets:
    """Target poses, all in one form, each field with a leading axis n, m and rad.

    Attributes:
        matrix: Homogeneous matrices, shape (n, 4, 4).
        position: x, y, z of each, shape (n, 3); for tasks without z also (n, 2).
        quaternion_xyzw: Unit quaternions, shape (n, 4).
        rpy: Roll, pitch, yaw, shape (n, 3).
        euler: Sequence, and its angles, shape (n, 3).
        phi: Angles about z, alone: planar orientations, shape (n,).
        direction: Of the frame's z axis, of any length, shape (n, 3).
        written: Name of one of ``FORMATS``, and its values, rad, shape (n, 3) or (n, 4).
        count: n.
        location: Where the targets stand among the caller's arguments, for errors.
        many: Whether the caller gives a list of them; else n is 1.
        by_field: Whether the caller gives one list a field, not one object a target.
    """

    matrix: Sequence[Sequence[Sequence[float]]] | FloatArray | None = None
    position: Rows | None = None
    quaternion_xyzw: Rows | None = None
    rpy: Rows | None = None
    euler: tuple[str, Rows] | None = None
    phi: Sequence[float] | FloatArray | None = None
    direction: Rows | None = None
    written: tuple[str, Rows] | None = None
    count: int = 1
    location: Location = ("target",)
    many: bool = False
    by_field: bool = False

    def place(self, k: int, *field: str) -> Location:
        """Return where target ``k``, or a field of it, stands among the caller's arguments."""
        if not self.many:
            return (*self.location, *field)
        return (*self.location, *field, k) if self.by_field else (*self.location, k, *field)

    def called(self, k: int, *field: str) -> str:
        """Return the same in words: ``targets.3.position``."""
        return ".".join(map(str, self.place(k, *field)))

    def refusal(
        self,
        k: int,
        message: str,
        *field: str,
        task: Task | None = None,
        expected: int | None = None,
    ) -> InvalidTarget:
        """Return the exception that says what is wrong with a field of target ``k``."""
        argument, *index = self.place(k, *field)
        name = None if task is None else task.name
        return InvalidTarget(
            message, argument=str(argument), index=tuple(index), task=name, expected=expected
        )


def target_poses(targets: Targets, task: Task) -> FloatArray:
    """Return the poses of targets, shape (n, 4, 4); the identity in what is not given.

    Args:
        targets: The targets.
        task: The task space: what it does not look at may be missing.

    Raises:
        InvalidTarget: A part that the task needs is missing, two forms contradict, or a value is
            not finite, beyond 1e6 or no rotation.
        UnknownSequence: Not an Euler sequence.
    """
    given = [
        name
        for name in ("quaternion_xyzw", "rpy", "euler", "phi", "direction")
        if getattr(targets, name) is not None
    ]
    if targets.written is not None:
        given.append(targets.written[0])
    if targets.matrix is not None:
        if given or targets.position is not None:
            message = say(
                "{called} has a matrix and other fields; give one form", called=targets.called(0)
            )
            raise targets.refusal(0, message)
        return _matrices(targets)
    _check_parts(targets, task, given)
    rotations = _rotations(targets)
    positions = None if targets.position is None else _positions(targets, task)
    poses = np.zeros((targets.count, 4, 4))
    poses[:, 3, 3] = 1.0
    poses[:, :3, :3] = np.eye(3) if rotations is None else rotations
    if positions is not None:
        poses[:, :3, 3] = positions
    return poses


def _check_parts(targets: Targets, task: Task, given: list[str]) -> None:
    """Check that the task finds what it needs, once."""
    name = targets.called(0)
    if len(given) > 1:
        raise targets.refusal(
            0,
            say(
                "{name} has {given}; give one orientation",
                name=name,
                given=chained(say(" and "), given),
            ),
        )
    if task.positions and targets.position is None:
        message = say(
            "task {task} needs a position; give {name}.position or .matrix",
            task=task.name,
            name=name,
        )
        raise targets.refusal(0, message, "position", task=task)
    if task.rotations and not given:
        raise targets.refusal(
            0,
            say(
                "task {task} needs an orientation; give {name}.rpy, quaternion_xyzw,"
                " euler, phi, direction or matrix, or choose task position",
                task=task.name,
                name=name,
            ),
            task=task,
        )
    if targets.phi is not None and task.rotations not in ((), (2,)):
        raise targets.refusal(
            0,
            say(
                "{name}.phi is an angle about z alone, but task {task} needs a whole"
                " orientation; give rpy, quaternion_xyzw, euler or matrix",
                name=name,
                task=task.name,
            ),
            "phi",
            task=task,
        )
    if targets.direction is not None and task.rotations and not task.own_axes:
        raise targets.refusal(
            0,
            say(
                "{name}.direction leaves the turn about it open, but task {task} needs"
                " it; choose task position_direction or direction, or give rpy,"
                " quaternion_xyzw, euler or matrix",
                name=name,
                task=task.name,
            ),
            "direction",
            task=task,
        )


def _matrices(targets: Targets) -> FloatArray:
    """Return checked matrices, shape (n, 4, 4), with their rounding mended."""
    given = targets.matrix
    assert given is not None
    if not targets.many:
        return _matrix(targets, 0, given[0])[None]
    if isinstance(given, np.ndarray) and given.shape[1:] != (4, 4):
        argument, *index = (*targets.location, "matrix")
        raise InvalidTarget(
            say("targets are no 4x4 matrices; give shape (n, 4, 4)"),
            argument=str(argument),
            index=tuple(index),
        )
    try:
        poses = rigid_transforms(_regular(given), printed=True)
    except ValueError:
        # One of them, or their shape: looked at one by one for the place and the reason.
        return np.array([_matrix(targets, k, one) for k, one in enumerate(given)])
    if poses.size and not np.abs(poses[:, :3, 3]).max() <= MAX_VALUE:
        k = int(np.flatnonzero(~(np.abs(poses[:, :3, 3]) <= MAX_VALUE).all(axis=1))[0])
        _matrix(targets, k, poses[k])
    return poses


def mended(matrices: Sequence[Sequence[Sequence[float]]] | FloatArray, poses: FloatArray) -> float:
    """Return how far rotations of target matrices were from those that were taken, the largest.

    Args:
        matrices: As they were given, shape (n, 4, 4).
        poses: What :func:`target_poses` made of them.
    """
    given = np.asarray(matrices, dtype=np.float64)
    return float(np.abs(given[:, :3, :3] - poses[:, :3, :3]).max(initial=0.0))


def _regular(matrices: Sequence[Sequence[Sequence[float]]] | FloatArray) -> FloatArray:
    array = np.asarray(matrices, dtype=np.float64)
    if array.ndim != 3 or array.shape[1:] != (4, 4):
        raise ValueError(say("not 4x4 matrices"))
    return array


def _matrix(targets: Targets, k: int, given: Sequence[Sequence[float]] | FloatArray) -> FloatArray:
    try:
        matrix = rigid_transform(given, printed=True)
    except ValueError as error:
        # A placement that is no target is named as it is.
        named = "target.matrix" if targets.many else targets.called(k, "matrix")
        raise targets.refusal(
            k, say("{named} {error}", named=named, error=error), "matrix"
        ) from None
    _check_values(targets, k, "matrix", matrix[:3, 3])
    return matrix


def _positions(targets: Targets, task: Task) -> FloatArray:
    """Return positions, shape (n, 3); z is 0 where it is not given."""
    given = targets.position
    assert given is not None
    sizes = (3,) if 2 in task.positions else (2, 3)
    rows = np.zeros((len(given), 3))
    for k, row in enumerate(given):
        if len(row) not in sizes:
            name = targets.called(k, "position")
            wanted = (
                "3"
                if sizes == (3,)
                else say("2, or 3, of which task {task} does not look at z", task=task.name)
            )
            message = say(
                "{name} has {count} values; give {wanted}", name=name, count=len(row), wanted=wanted
            )
            raise targets.refusal(k, message, "position", task=task, expected=sizes[0])
        rows[k, : len(row)] = row
    _check_rows(targets, "position", rows)
    return rows


def _rotations(targets: Targets) -> FloatArray | None:
    """Return rotations, shape (n, 3, 3); None where no orientation is given."""
    if targets.quaternion_xyzw is not None:
        return _each(targets, "quaternion_xyzw", targets.quaternion_xyzw, 4, _of_quaternion)
    if targets.rpy is not None:
        return _each(targets, "rpy", targets.rpy, 3, lambda _, row: rotation_from_euler("xyz", row))
    if targets.euler is not None:
        sequence, angles = targets.euler
        first: Location = (0,) if targets.many and not targets.by_field else ()
        argument, *index = (*targets.location, *first, "euler", "sequence")
        parse_sequence(sequence, str(argument), tuple(index))
        return _each(targets, "euler", angles, 3, lambda _, row: rotation_from_euler(sequence, row))
    if targets.written is not None:
        name, values = targets.written
        found = FORMATS[name]
        return _each(
            targets, name, values, found.size, lambda refusal, row: _written(found, refusal, row)
        )
    if targets.direction is not None:
        return _each(targets, "direction", targets.direction, 3, _along)
    if targets.phi is not None:
        rows = np.zeros((len(targets.phi), 3))
        rows[:, 2] = targets.phi
        return _each(targets, "phi", rows, 3, lambda _, row: rotation_from_euler("xyz", row))
    return None


def _each(
    targets: Targets,
    name: str,
    given: Rows,
    size: int,
    rotation: Callable[[Callable[[str], InvalidTarget], FloatArray], FloatArray],
) -> FloatArray:
    """Return the rotation of each row of a field, which must have ``size`` values."""
    for k, row in enumerate(given):
        if len(row) != size:
            message = say(
                "{k} has {count} values; give {size}",
                k=targets.called(k, name),
                count=len(row),
                size=size,
            )
            raise targets.refusal(k, message, name, expected=size)
    rows = np.asarray(given, dtype=np.float64)
    _check_rows(targets, name, rows)

    def refusal(k: int) -> Callable[[str], InvalidTarget]:
        return lambda why: targets.refusal(
            k, say("{k} {why}", k=targets.called(k, name), why=why), name
        )

    return np.array([rotation(refusal(k), row) for k, row in enumerate(rows)])


def _check_rows(targets: Targets, name: str, rows: FloatArray) -> None:
    good = np.abs(rows) <= MAX_VALUE  # False for NaN too
    if not good.all():
        k = int(np.flatnonzero(~good.all(axis=1))[0])
        _check_values(targets, k, name, rows[k])


def _check_values(targets: Targets, k: int, name: str, values: FloatArray) -> None:
    if not (np.abs(values) <= MAX_VALUE).all():
        shown = targets.called(k, name)
        message = say("{shown} has a value that is not finite or beyond ±1e6", shown=shown)
        raise targets.refusal(k, message, name)


def _of_quaternion(refusal: Callable[[str], InvalidTarget], row: FloatArray) -> FloatArray:
    try:
        return rotation_from_quaternion(row)
    except ValueError as error:
        raise refusal(str(error)) from None


def _written(
    found: OrientationFormat, refusal: Callable[[str], InvalidTarget], row: FloatArray
) -> FloatArray:
    try:
        return found.rotation(row)
    except ValueError as error:
        raise refusal(str(error)) from None


def _along(refusal: Callable[[str], InvalidTarget], direction: FloatArray) -> FloatArray:
    """Return a rotation whose z axis has a direction."""
    length = float(np.linalg.norm(direction))
    if length < 1e-9:
        raise refusal(say("is zero; give the frame's z axis, such as [0, 0, -1]"))
    z = direction / length
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.column_stack((x, np.cross(z, x), z))
