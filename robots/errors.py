"""What can be wrong with a robot; each exception carries its data."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Final

MAX_SHOWN = 12
DAMAGED: Final = "damaged"
"""Stands for the revision of a robot whose file cannot be served."""


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
    """No robot has this id.

    Args:
        robot_id: The id.
        valid: Ids that exist, of many those near it.
        total: How many there are, where ``valid`` does not hold them all.
    """

    def __init__(self, robot_id: str, valid: Iterable[str], total: int | None = None) -> None:
        self.robot_id = robot_id
        shown = hint(robot_id, tuple(valid), total)
        super().__init__(f"there is no robot {robot_id[:64]!r}; {shown}")


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
        if current == DAMAGED:
            state = "is damaged; upload it without If-Match"
        else:
            found = f"is at revision {current}" if current else "does not exist"
            state = f"{found}; read it again and repeat the request"
        super().__init__(f"robot {robot_id!r} {state}")


class MeshNotFound(RobotError):
    """A mesh that a robot does not have; only shipped robots have any."""

    def __init__(self, robot_id: str, name: str, valid: tuple[str, ...]) -> None:
        told = hint(name, valid) if valid else "no mesh of it is kept here"
        super().__init__(f"robot {robot_id[:64]!r} has no mesh {name[:64]!r}; {told}")


class DamagedRobot(RobotError):
    """A stored file that cannot be served, and never is.

    Attributes:
        robot_id: The robot.
        moved: True where the file lies in quarantine now.
    """

    def __init__(self, robot_id: str, fault: str, *, moved: bool) -> None:
        self.robot_id = robot_id
        self.moved = moved
        where = "; it was moved to quarantine" if moved else ""
        super().__init__(
            f"the stored file of robot {robot_id!r} {fault}{where}; upload the robot again (PUT"
            f" /v1/robots/{robot_id}), or delete it"
        )


class QuotaReached(RobotError):
    """One more robot, or its bytes, would exceed what the store takes."""

    def __init__(self, quota: str) -> None:
        super().__init__(
            f"the store takes {quota}, and this robot would exceed that; delete robots (DELETE"
            " /v1/robots/{id}), or send the robot in the body of a computation: that stores nothing"
        )


class StorageError(RuntimeError):
    """The disk, not the robot, is at fault: nothing was changed, and reading goes on."""

    pointer = ""


class StorageFull(StorageError):
    """No space left for a file."""

    def __init__(self) -> None:
        super().__init__(
            "the disk of the service is full and the robot was not stored; what was stored before"
            " is intact; delete robots, or have the operator make room, then repeat the request"
        )


class StorageUnavailable(StorageError):
    """The directory of the uploads cannot be used now.

    Attributes:
        retry_after: Seconds after which another try may succeed.
    """

    retry_after: Final = 5.0

    def __init__(self, fault: str) -> None:
        super().__init__(
            f"{fault}; shipped robots and robots in the body of a request work; repeat the request"
            " later"
        )


def hint(name: str, valid: tuple[str, ...], total: int | None = None) -> str:
    """Names the closest valid names, or the first few."""
    close = difflib.get_close_matches(name[:64], valid, n=3)
    if close:
        return "did you mean " + " or ".join(close) + "?"
    shown = ", ".join(valid[:MAX_SHOWN])
    count = len(valid) if total is None else total
    more = f" and {count - MAX_SHOWN} more" if count > MAX_SHOWN else ""
    return f"known are {shown}{more}"
