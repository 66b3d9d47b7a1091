"""A robot under its id, and a line of a list of robots."""

from __future__ import annotations

from dataclasses import dataclass

from robots.robot import Robot


@dataclass(frozen=True)
class StoredRobot:
    """A robot under its id.

    Attributes:
        id: Name in the store.
        robot: The robot.
        shipped: True for the read-only library.
        title: Name for people.
        source: Where the numbers come from, for shipped robots.
        maker: Name of the key that stored it, for uploads; None where it is not known.
    """

    id: str
    robot: Robot
    shipped: bool
    title: str
    source: str | None = None
    maker: str | None = None


@dataclass(frozen=True, slots=True)
class RobotSummary:
    """One line of a list of robots.

    Attributes:
        id: Name in the store.
        kind: ``dh`` or ``urdf``.
        title: Name for people.
        dof: Number of joints in q.
        shipped: True for the read-only library.
    """

    id: str
    kind: str
    title: str
    dof: int
    shipped: bool
