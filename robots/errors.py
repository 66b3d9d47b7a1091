"""What can be wrong with a robot; each exception carries its data."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal, Self, TypeAlias

from dh_to_urdf.errors import Location
from dh_to_urdf.messages import chained, say

MAX_SHOWN = 12
DAMAGED: Final = "damaged"
"""Stands for the revision of a robot whose file cannot be served."""

Quota: TypeAlias = Literal["robots", "bytes"]
QuotaHolder: TypeAlias = Literal["store", "namespace"]
"""Whose uploads are counted: all, or those of one namespace."""


class RobotError(ValueError):
    """Root of this package's errors.

    Attributes:
        argument: Name of the argument at fault; empty where it is no single one.
        index: Where in the argument the value at fault stands; empty for the argument itself.
    """

    argument: str = ""
    index: Location = ()


@dataclass(frozen=True, slots=True)
class URDFFault:
    """One thing wrong with a URDF.

    Attributes:
        message: What is wrong, with element, value and remedy.
        line: Line of the text where it stands, from 1; None where it is no single one.
        xpath: The element at fault, such as ``/robot/joint[@name='elbow']/axis``; else empty.
    """

    message: str
    line: int | None = None
    xpath: str = ""


class InvalidURDF(RobotError):
    """A URDF that is refused; the message names element, value and remedy.

    Attributes:
        location: Where in the document the value at fault stands; empty for the document.
        faults: All that is wrong, in the order of the text.
    """

    def __init__(
        self, message: str, location: Location = (), faults: Sequence[URDFFault] = ()
    ) -> None:
        super().__init__(message)
        self.location = location
        self.faults = tuple(faults) or (URDFFault(message),)

    @classmethod
    def of(cls, faults: Sequence[URDFFault]) -> Self:
        """Return the error of one fault or more."""
        more, first = len(faults) - 1, faults[0].message
        suffix = say(" (and {more} more)", more=more) if more else ""
        message = say("{message}{suffix}", message=first, suffix=suffix) if more else first
        return cls(message, (), faults)

    def within(self, location: Location) -> Self:
        """Return the same error of a document that stands within another."""
        return type(self)(str(self.args[0]), location, self.faults)


class RobotTooLarge(RobotError):
    """A robot beyond the size that is computed with.

    Attributes:
        location: Where in the document the value at fault stands; empty for the document.
    """

    def __init__(self, message: str, location: Location = ()) -> None:
        super().__init__(message)
        self.location = location

    def within(self, location: Location) -> Self:
        """Return the same error of a document that stands within another."""
        return type(self)(str(self.args[0]), location)


class UnknownFrame(RobotError):
    """A frame name that the robot does not have.

    Attributes:
        name: The name.
        valid: The names that the robot has.
        argument: Name of the argument that holds the name.
        index: Where in the argument it stands.
    """

    def __init__(
        self, name: str, valid: Iterable[str], argument: str = "frame", index: Location = ()
    ) -> None:
        self.name = name
        self.valid = tuple(valid)
        self.argument = argument
        self.index = index
        super().__init__(
            say("frame {name!r} is unknown; {hint}", name=name[:64], hint=hint(name, self.valid))
        )


class WrongLimits(RobotError):
    """Limits of an installation that do not fit the robot.

    Attributes:
        joint: The joint that they are given for.
        bound: Which of them; empty for all.
    """

    def __init__(self, message: str, joint: str, bound: str = "") -> None:
        self.joint = joint
        self.bound = bound
        super().__init__(message)

    @property
    def location(self) -> Location:
        """Where they stand among the caller's arguments."""
        return ("limits", self.joint, *((self.bound,) if self.bound else ()))


class RobotNotFound(RobotError):
    """No robot has this id.

    Attributes:
        robot_id: The id.
        valid: Ids that exist, of many those near it.
        total: How many there are, where ``valid`` does not hold them all.
    """

    def __init__(self, robot_id: str, valid: Iterable[str], total: int | None = None) -> None:
        self.robot_id = robot_id
        self.valid = tuple(valid)
        self.total = total
        shown = hint(robot_id, self.valid, total)
        super().__init__(
            say("there is no robot {robot_id!r}; {shown}", robot_id=robot_id[:64], shown=shown)
        )


class InvalidRobotId(RobotError):
    """An id that cannot name a robot.

    Attributes:
        robot_id: The id.
    """

    argument = "name"

    def __init__(self, robot_id: str) -> None:
        self.robot_id = robot_id
        super().__init__(
            say(
                "{robot_id!r} cannot be a robot's id; use letters, digits and . _ - (at"
                " most 64, starting with a letter or digit)",
                robot_id=robot_id[:64],
            )
        )


class RobotExists(RobotError):
    """The id is taken.

    Attributes:
        robot_id: The id.
    """

    def __init__(self, robot_id: str) -> None:
        self.robot_id = robot_id
        super().__init__(say("robot {robot_id!r} exists already", robot_id=robot_id))


Change: TypeAlias = Literal["replace", "delete"]


class AnothersRobot(RobotError):
    """A stored robot that this maker may not replace or delete unasked.

    Attributes:
        robot_id: Its id.
        change: What was to be done with it.
    """

    def __init__(self, robot_id: str, change: Change = "replace") -> None:
        self.robot_id = robot_id
        self.change = change
        super().__init__(
            say(
                "the id {robot_id!r} holds another robot, perhaps of somebody else",
                robot_id=robot_id,
            )
        )


class SharedRobot(RobotError):
    """A robot that all see and that cannot be changed from a namespace.

    Attributes:
        robot_id: Its id.
    """

    def __init__(self, robot_id: str) -> None:
        self.robot_id = robot_id
        super().__init__(
            say(
                "robot {robot_id!r} is shared by all and not changed by this key", robot_id=robot_id
            )
        )


class ReadOnlyRobot(RobotError):
    """A shipped robot, which cannot be changed.

    Attributes:
        robot_id: Its id.
    """

    def __init__(self, robot_id: str) -> None:
        self.robot_id = robot_id
        super().__init__(
            say(
                "robot {robot_id!r} is shipped with the service and read-only; choose another id",
                robot_id=robot_id,
            )
        )


class RevisionMismatch(RobotError):
    """The stored revision is not the expected one.

    Attributes:
        robot_id: The robot.
        current: The stored revision; ``DAMAGED`` where it cannot be told, None where no robot has
            the id.
        mesh: The mesh of the robot whose revision ``current`` is; None where it is the robot's.
    """

    def __init__(self, robot_id: str, current: str | None, mesh: str | None = None) -> None:
        self.robot_id = robot_id
        self.current = current
        self.mesh = mesh
        if current == DAMAGED:
            state = say("is damaged")
        else:
            state = (
                say("is at revision {current}", current=current)
                if current
                else say("does not exist")
            )
        if mesh is None:
            message = say("robot {robot_id!r} {state}", robot_id=robot_id, state=state)
        else:
            message = say(
                "mesh {mesh!r} of robot {robot_id!r} {state}",
                mesh=mesh,
                robot_id=robot_id,
                state=state,
            )
        super().__init__(message)


class InvalidMesh(RobotError):
    """A mesh file that is refused; the message says why."""


class InvalidArchive(RobotError):
    """An archive that is refused; the message says why.

    Attributes:
        several: Whether it is because one of several URDFs must be named.
    """

    def __init__(self, message: str, *, several: bool = False) -> None:
        self.several = several
        super().__init__(message)


class MeshesTooLarge(RobotError):
    """More bytes of meshes than are kept with one robot.

    Attributes:
        size: All of them.
        most: How many are kept.
    """

    def __init__(self, size: int, most: int) -> None:
        self.size, self.most = size, most
        super().__init__(
            say(
                "the meshes of the robot take {size} bytes as they are kept; at most {most} are"
                " kept: simplify them, or leave some out",
                size=size,
                most=most,
            )
        )


class AmbiguousMesh(RobotError):
    """The end of several names of meshes.

    Attributes:
        name: What was given.
        names: The meshes that end so.
    """

    def __init__(self, name: str, names: tuple[str, ...]) -> None:
        self.name, self.names = name, names
        shown = ", ".join(repr(one[:64]) for one in names[:5])
        super().__init__(
            say(
                "{name!r} is the end of {count} names of meshes: {shown}; give more of it",
                name=name[:64],
                count=len(names),
                shown=shown,
            )
        )


class MeshNotFound(RobotError):
    """A mesh that a robot does not have.

    Attributes:
        robot_id: The robot.
        name: Name of the mesh.
        valid: Names of the meshes that the robot has.
    """

    def __init__(self, robot_id: str, name: str, valid: tuple[str, ...]) -> None:
        self.robot_id = robot_id
        self.name = name
        self.valid = valid
        known = hint(name, valid) if valid else say("no mesh of it is kept here")
        super().__init__(
            say(
                "robot {robot_id!r} has no mesh {name!r}; {known}",
                robot_id=robot_id[:64],
                name=name[:64],
                known=known,
            )
        )


class DamagedRobot(RobotError):
    """A stored file that cannot be served, and never is.

    Attributes:
        robot_id: The robot.
        fault: What is wrong with the file, after "the stored file of robot 'x'".
        moved: True where the file lies in quarantine now.
    """

    def __init__(self, robot_id: str, fault: str, *, moved: bool) -> None:
        self.robot_id = robot_id
        self.fault = fault
        self.moved = moved
        where = say("; it was moved to quarantine") if moved else ""
        super().__init__(
            say(
                "the stored file of robot {robot_id!r} {fault}{where}",
                robot_id=robot_id,
                fault=fault,
                where=where,
            )
        )


_HOLDERS = {"store": say("store"), "namespace": say("namespace")}


class QuotaReached(RobotError):
    """One more robot, or its bytes, would exceed what the store takes.

    Attributes:
        quota: What is counted.
        limit: How much is taken at most.
        holder: Whose uploads are counted.
    """

    def __init__(self, quota: Quota, limit: int, holder: QuotaHolder = "store") -> None:
        self.quota = quota
        self.limit = limit
        self.holder = holder
        counted = say("bytes of uploaded robots") if quota == "bytes" else say("uploaded robots")
        super().__init__(
            say(
                "the {holder} takes {limit} {counted} at most, and this robot would exceed that",
                holder=_HOLDERS[holder],
                limit=limit,
                counted=counted,
            )
        )


class StorageError(RuntimeError):
    """The disk, not the robot, is at fault: nothing was changed, and reading goes on."""


class StorageFull(StorageError):
    """No space left for a file."""

    def __init__(self) -> None:
        super().__init__(
            say("the disk is full and the robot was not stored; what was stored before is intact")
        )


class StorageUnavailable(StorageError):
    """The directory of the uploads cannot be used now.

    Attributes:
        fault: What is wrong.
        retry_after: Seconds after which another try may succeed.
    """

    retry_after: Final = 5.0

    def __init__(self, fault: str) -> None:
        self.fault = fault
        super().__init__(fault)


def hint(name: str, valid: tuple[str, ...], total: int | None = None) -> str:
    """Name the closest valid names, or the first few."""
    close = difflib.get_close_matches(name[:64], valid, n=3)
    if close:
        return say("did you mean ") + chained(say(" or "), close) + "?"
    shown = ", ".join(valid[:MAX_SHOWN])
    count = len(valid) if total is None else total
    more = say(" and {count} more", count=count - MAX_SHOWN) if count > MAX_SHOWN else ""
    return say("known are {shown}{more}", shown=shown, more=more)
