"""What can be wrong with a robot; each exception carries its data."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MAX_SHOWN = 12


class RobotError(ValueError):
    """Root of this package's errors.

    Attributes:
        pointer: JSON pointer to the field at fault, empty for the document as a whole.
    """

    pointer = ""


class InvalidURDF(RobotError):
    """A URDF that is refused; the message names element, value and remedy."""

    def __init__(self, message: str, pointer: str = "") -> None:
        super().__init__(message)
        self.pointer = pointer


class RobotTooLarge(RobotError):
    """A robot beyond the size that the service computes with."""

    def __init__(self, message: str, pointer: str = "") -> None:
        super().__init__(message)
        self.pointer = pointer


class UnknownFrame(RobotError):
    """A frame name that the robot does not have."""

    def __init__(self, name: str, valid: Iterable[str], pointer: str = "/frame") -> None:
        self.name = name
        self.valid = tuple(valid)
        self.pointer = pointer
        super().__init__(f"frame {name[:64]!r} is unknown; {hint(name, self.valid)}")


class RobotNotFound(RobotError):
    """No robot has this id."""

    def __init__(self, robot_id: str, valid: Iterable[str]) -> None:
        self.robot_id = robot_id
        super().__init__(f"there is no robot {robot_id[:64]!r}; {hint(robot_id, tuple(valid))}")


class InvalidRobotId(RobotError):
    """An id that cannot name a robot."""

    pointer = "/name"

    def __init__(self, robot_id: str) -> None:
        super().__init__(
            f"{robot_id[:64]!r} cannot be a robot's id; use letters, digits and . _ - (at most 64,"
            " starting with a letter or digit)"
        )


class RobotExists(RobotError):
    """The id is taken."""

    def __init__(self, robot_id: str) -> None:
        super().__init__(
            f"robot {robot_id!r} exists already; PUT /v1/robots/{robot_id} replaces it, or choose"
            " another name"
        )


class ReadOnlyRobot(RobotError):
    """A shipped robot, which cannot be changed."""

    def __init__(self, robot_id: str) -> None:
        super().__init__(
            f"robot {robot_id!r} is shipped with the service and read-only; choose another id"
        )


class RevisionMismatch(RobotError):
    """The stored revision is not the one that the request was made for."""

    def __init__(self, robot_id: str, current: str | None) -> None:
        self.current = current
        state = f"is at revision {current}" if current else "does not exist"
        super().__init__(f"robot {robot_id!r} {state}; read it again and repeat the request")


class DamagedRobot(RobotError):
    """A stored file whose checksum does not hold; it is never served."""

    def __init__(self, robot_id: str) -> None:
        super().__init__(
            f"the stored file of robot {robot_id!r} is damaged; upload the robot again (PUT)"
        )


def hint(name: str, valid: tuple[str, ...]) -> str:
    """Names the closest valid names, or the first few."""
    close = difflib.get_close_matches(name[:64], valid, n=3)
    if close:
        return "did you mean " + " or ".join(close) + "?"
    shown = ", ".join(valid[:MAX_SHOWN])
    more = f" and {len(valid) - MAX_SHOWN} more" if len(valid) > MAX_SHOWN else ""
    return f"known are {shown}{more}"
