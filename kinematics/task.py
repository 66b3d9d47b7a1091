"""Task spaces: the rows of vx, vy, vz, wx, wy, wz that count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import say
from kinematics.errors import UnknownTask
from robots.errors import hint
from robots.robot import FloatArray

ROWS = ("vx", "vy", "vz", "wx", "wy", "wz")

_NAMED = {
    "pose": (0, 1, 2, 3, 4, 5),
    "position": (0, 1, 2),
    "orientation": (3, 4, 5),
    "xy": (0, 1),
    "xz": (0, 2),
    "yz": (1, 2),
    "x": (0,),
    "y": (1,),
    "z": (2,),
    "xy_phi": (0, 1, 5),
    "xyz_phi": (0, 1, 2, 5),
    "direction": (3, 4),
    "position_direction": (0, 1, 2, 3, 4),
}
_OWN_AXES = ("direction", "position_direction")


@dataclass(frozen=True)
class Task:
    """A task space, in base axes.

    Attributes:
        name: Its name, or ``mask``.
        rows: The rows of the 6-row Jacobian that count, ascending.
        own_axes: True where the rows of rotation are those about the frame's own x and y: the
            direction of its z axis counts, a turn about it does not.
    """

    name: str
    rows: tuple[int, ...]
    own_axes: bool = False

    @property
    def positions(self) -> tuple[int, ...]:
        """Rows of linear velocity, 0 to 2."""
        return tuple(row for row in self.rows if row < 3)

    @property
    def rotations(self) -> tuple[int, ...]:
        """Rows of angular velocity, 0 to 2."""
        return tuple(row - 3 for row in self.rows if row >= 3)

    @property
    def mask(self) -> FloatArray:
        """1 for the rows that count, else 0, then 1 for ``own_axes``; shape (7,).

        With own axes all three rows of rotation count: they hold a vector perpendicular to z.
        """
        mask = np.zeros(7)
        mask[list(self.rows)] = 1.0
        if self.own_axes:
            mask[5] = mask[6] = 1.0
        return mask

    def of(self, J: FloatArray, R: FloatArray) -> FloatArray:
        """Return the rows of a Jacobian that count.

        Args:
            J: Geometric Jacobian in base axes, shape (..., 6, n).
            R: Rotation of the frame in base axes, shape (..., 3, 3).

        Returns:
            Shape (..., rows, n).
        """
        if self.own_axes:
            J = np.concatenate((J[..., :3, :], np.swapaxes(R, -1, -2) @ J[..., 3:, :]), axis=-2)
        return np.asarray(J[..., list(self.rows), :])

    @property
    def row_names(self) -> tuple[str, ...]:
        """Names such as ``vx``."""
        return tuple(ROWS[row] for row in self.rows)


TASKS = {name: Task(name, rows, name in _OWN_AXES) for name, rows in _NAMED.items()}
POSE = TASKS["pose"]


def task_from(
    value: str | Sequence[bool | int | float], argument: str = "task", index: Location = ()
) -> Task:
    """Return a task by name, or by a mask of six (1: the row counts).

    Args:
        value: Name or mask.
        argument: Name of the argument in errors.
        index: Place of the task within that argument, for errors.

    Raises:
        UnknownTask: Neither.
    """
    if isinstance(value, str):
        if value not in TASKS:
            raise UnknownTask(
                say(
                    "task {value!r} is unknown; {hint}, or give a mask of six 0 or 1 for"
                    " vx, vy, vz, wx, wy, wz",
                    value=value[:32],
                    hint=hint(value, tuple(TASKS)),
                ),
                argument=argument,
                index=index,
                value=value,
                known=tuple(TASKS),
            )
        return TASKS[value]
    if len(value) != 6 or any(item not in (0, 1) for item in value) or not any(value):
        raise UnknownTask(
            say("a task mask is six 0 or 1 for vx, vy, vz, wx, wy, wz with at least one 1"),
            argument=argument,
            index=index,
        )
    rows = tuple(row for row, item in enumerate(value) if item)
    named = (task for task in TASKS.values() if task.rows == rows and not task.own_axes)
    return next(named, Task("mask", rows))
