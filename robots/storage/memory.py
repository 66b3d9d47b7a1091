"""RobotMemory: the last used robots by id, within a bound on their memory cost."""

from __future__ import annotations

import threading
from collections import OrderedDict
from typing import Generic, TypeVar

from robots.robot import Robot

Entry = TypeVar("Entry")
MAX_WEIGHT = 20_000.0


def weight_of(robot: Robot) -> float:
    """Return the memory cost of a robot, in arbitrary units: dof², its text and its hulls."""
    hulls = sum(one.hull.vertices.nbytes + one.hull.triangles.nbytes for one in robot.meshes)
    return 20.0 + robot.dof**2 + (len(robot.urdf) + hulls) / 1000.0


class RobotMemory(Generic[Entry]):
    """Entries by id; the least recently used one is dropped first. Safe between threads."""

    def __init__(self, max_weight: float = MAX_WEIGHT) -> None:
        self._max_weight = max_weight
        self._entries: OrderedDict[str, tuple[float, Entry]] = OrderedDict()
        self._weight = 0.0
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._entries)

    def get(self, robot_id: str) -> Entry | None:
        """Return the entry and mark it as the last used."""
        with self._lock:
            found = self._entries.get(robot_id)
            if found is None:
                return None
            self._entries.move_to_end(robot_id)
            return found[1]

    def keep(self, robot_id: str, entry: Entry, weight: float) -> None:
        """Keep an entry, and drop others beyond the bound."""
        with self._lock:
            self._drop(robot_id)
            self._entries[robot_id] = (weight, entry)
            self._weight += weight
            while self._weight > self._max_weight and len(self._entries) > 1:
                self._drop(next(iter(self._entries)))

    def forget(self, robot_id: str) -> None:
        """Drop an entry where there is one."""
        with self._lock:
            self._drop(robot_id)

    def _drop(self, robot_id: str) -> None:
        dropped = self._entries.pop(robot_id, None)
        if dropped is not None:
            self._weight -= dropped[0]
