"""Task spaces: which of vx, vy, vz, wx, wy, wz count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

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
}


@dataclass(frozen=True)
class Task:
    """A task space, in base axes.

    Attributes:
        name: Its name, or ``mask``.
        rows: The rows of the 6-row Jacobian that count, ascending.
    """

    name: str
    rows: tuple[int, ...]

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
        """1 for the rows that count, else 0; shape (6,)."""
        mask = np.zeros(6)
        mask[list(self.rows)] = 1.0
        return mask

    @property
    def row_names(self) -> tuple[str, ...]:
        """Names such as ``vx``."""
        return tuple(ROWS[row] for row in self.rows)


TASKS = {name: Task(name, rows) for name, rows in _NAMED.items()}
POSE = TASKS["pose"]


def task_from(value: str | Sequence[bool | int | float]) -> Task:
    """A task by name, or by a mask of six (1: the row counts).

    Raises:
        UnknownTask: Neither.
    """
    if isinstance(value, str):
        if value not in TASKS:
            raise UnknownTask(
                f"task {value[:32]!r} is unknown; {hint(value, tuple(TASKS))}, or give a mask of"
                " six 0 or 1 for vx, vy, vz, wx, wy, wz",
                "/task",
            )
        return TASKS[value]
    if len(value) != 6 or any(item not in (0, 1) for item in value) or not any(value):
        raise UnknownTask(
            "a task mask is six 0 or 1 for vx, vy, vz, wx, wy, wz with at least one 1", "/task"
        )
    rows = tuple(row for row, item in enumerate(value) if item)
    return next((task for task in TASKS.values() if task.rows == rows), Task("mask", rows))
