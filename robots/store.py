"""RobotStore: shipped robots, and uploaded ones as plain files that survive crashes.

One file a robot, with its own checksum. A write goes to a temporary file, is flushed to the disk
and takes its final name in one step, so that a reader in any process sees the old robot or the new
one, never a part. Writers of all processes take turns (:mod:`robots.storage.directory`); readers
need none: they compare a file's identity with what they have in memory. A file that is damaged is
never served: it is moved to quarantine, and its robot is refused until it is uploaded again or
deleted.
"""

from __future__ import annotations

import os
from bisect import bisect_left, bisect_right
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

from robots.errors import (
    DAMAGED,
    DamagedRobot,
    InvalidRobotId,
    ReadOnlyRobot,
    RevisionMismatch,
    RobotError,
    RobotExists,
    RobotNotFound,
    StorageError,
)
from robots.robot import Robot
from robots.shipped import is_shipped, shipped_file, shipped_ids, shipped_robot
from robots.storage.directory import RobotDirectory
from robots.storage.durable import storage_errors
from robots.storage.memory import RobotMemory, weight_of
from robots.storage.stored_file import (
    FAULTS,
    ROBOT_ID,
    BrokenFile,
    Signature,
    UnusableFile,
    decode,
    encode,
    read_file,
    read_head,
)
from robots.storage.usage_record import Quotas, Usage

ANY: Final = "*"
T = TypeVar("T")
_UNKNOWN: Final = "was found damaged"
_NEAR: Final = 100
"""Ids on either side of an unknown one among which the nearest names are sought."""
_READERS_PATIENCE: Final = 1.0
_STARTING_PATIENCE: Final = 2.0


@dataclass(frozen=True)
class StoredRobot:
    """A robot under its id.

    Attributes:
        id: Name in the API.
        robot: The robot.
        shipped: True for the read-only library.
        title: Name for people.
        source: Where the numbers come from, for shipped robots.
    """

    id: str
    robot: Robot
    shipped: bool
    title: str
    source: str | None = None


@dataclass(frozen=True, slots=True)
class RobotSummary:
    """One line of a list of robots."""

    id: str
    kind: str
    title: str
    dof: int
    shipped: bool


class RobotStore:
    """Robots by id: the shipped library and a directory of uploads."""

    def __init__(self, directory: Path, quotas: Quotas | None = None) -> None:
        """Opens a store, creating its directory where it is missing.

        Clears what killed writers left behind. A directory that cannot be written to is no
        hindrance: what can be read is served.

        Args:
            directory: Where uploads are kept; several processes may share it.
            quotas: How much may be kept.
        """
        self._directory = RobotDirectory(directory, quotas or Quotas())
        self._shipped: dict[str, StoredRobot] = {}
        self._memory: RobotMemory[tuple[Signature, StoredRobot]] = RobotMemory()
        self._summaries: dict[str, tuple[Signature, RobotSummary]] = {}
        self._unusable: dict[str, int | None] = {}
        self._merged: tuple[tuple[str, ...] | None, tuple[str, ...]] = (None, ())
        with (
            suppress(StorageError),
            self._directory.write_transaction(_STARTING_PATIENCE) as transaction,
        ):
            transaction.recover()

    def ids(self) -> tuple[str, ...]:
        """Ids of all robots, sorted.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        uploaded, merged = self._merged
        current = self._directory.ids()
        if current is not uploaded:
            merged = tuple(sorted({*shipped_ids(), *current}))
            self._merged = current, merged
            if len(self._summaries) > 2 * len(current) + 1000:
                self._summaries.clear()
        return merged

    def ids_after(self, robot_id: str, count: int) -> tuple[str, ...]:
        """The first ``count`` ids after one, which need not exist.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        ids = self.ids()
        first = bisect_right(ids, robot_id)
        return ids[first : first + count]

    def usage(self) -> Usage:
        """What the uploads take now.

        Raises:
            StorageError: The directory cannot be used.
        """
        with self._directory.write_transaction() as transaction:
            return transaction.usage

    def summary(self, robot_id: str) -> RobotSummary:
        """What a list shows of a robot, which is not built for it; the file's checksum is verified.

        Raises:
            RobotNotFound: No robot has this id.
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        if robot_id in shipped_ids():
            head = shipped_file(robot_id)
            return RobotSummary(robot_id, "urdf" if head.urdf else "dh", head.title, head.dof, True)
        signature = self._directory.signature(robot_id)
        known = self._summaries.get(robot_id)
        if known is None or known[0] != signature:
            known = self._summaries[robot_id] = self._read(robot_id, self._summarised)
        return known[1]

    def in_memory(self, robot_id: str) -> StoredRobot | None:
        """The robot if it is loaded and current; does not read the file's content.

        Raises:
            StorageUnavailable: The directory cannot be looked into.
        """
        shipped = self._shipped.get(robot_id)
        if shipped is not None:
            return shipped
        entry = self._memory.get(robot_id)
        if entry is None or self._directory.signature(robot_id) != entry[0]:
            return None
        return entry[1]

    def get(self, robot_id: str) -> StoredRobot:
        """Loads a robot.

        Raises:
            RobotNotFound: No robot has this id.
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        found = self.in_memory(robot_id)
        if found is not None:
            return found
        if is_shipped(robot_id):
            head = shipped_file(robot_id)
            stored = StoredRobot(robot_id, shipped_robot(robot_id), True, head.title, head.source)
            return self._shipped.setdefault(robot_id, stored)
        stored = self._read(robot_id, self._load)
        self._unusable.pop(robot_id, None)
        return stored

    @staticmethod
    def check_id(robot_id: str) -> None:
        """Whether a robot may be stored under an id.

        Raises:
            InvalidRobotId: The id has other characters than letters, digits and ``. _ -``.
            ReadOnlyRobot: The id belongs to the shipped library.
        """
        if ROBOT_ID.fullmatch(robot_id) is None:
            raise InvalidRobotId(robot_id)
        if is_shipped(robot_id):
            raise ReadOnlyRobot(robot_id)

    def put(
        self,
        robot_id: str,
        robot: Robot,
        *,
        create_only: bool = False,
        if_match: tuple[str, ...] = (),
        if_none_match: tuple[str, ...] = (),
    ) -> tuple[StoredRobot, bool]:
        """Stores a robot durably.

        Args:
            robot_id: Its id.
            robot: The robot.
            create_only: Refuse to replace a robot.
            if_match: Revisions one of which must be stored now, ``ANY`` for any; empty: no matter.
            if_none_match: Revisions none of which may be stored now, ``ANY`` for any.

        Returns:
            The stored robot, and True where the id is new.

        Raises:
            InvalidRobotId: The id has other characters than letters, digits and ``. _ -``.
            ReadOnlyRobot: The id belongs to the shipped library.
            RobotExists: ``create_only`` and the id is taken.
            RevisionMismatch: ``if_match`` or ``if_none_match`` does not hold.
            QuotaReached: It would exceed a quota.
            StorageError: The disk does not take it; what was stored before is intact.
        """
        self.check_id(robot_id)
        content = encode(robot)
        named = _revisions(if_match, if_none_match)
        self._warm(robot_id, named)
        with self._directory.write_transaction() as transaction:
            current = self._state(robot_id, named)
            if create_only and current is not None:
                raise RobotExists(robot_id)
            _check_revision(robot_id, current, if_match, if_none_match)
            transaction.write(robot_id, content)
        return StoredRobot(robot_id, robot, False, robot.name), current is None

    def delete(
        self,
        robot_id: str,
        *,
        if_match: tuple[str, ...] = (),
        if_none_match: tuple[str, ...] = (),
    ) -> None:
        """Removes an uploaded robot, and what was moved to quarantine from its id.

        Raises:
            ReadOnlyRobot: The robot is shipped.
            RobotNotFound: No robot has this id.
            RevisionMismatch: ``if_match`` or ``if_none_match`` does not hold.
            StorageError: The directory cannot be written to.
        """
        if is_shipped(robot_id):
            raise ReadOnlyRobot(robot_id)
        named = _revisions(if_match, if_none_match)
        self._warm(robot_id, named)
        with self._directory.write_transaction() as transaction:
            current = self._state(robot_id, named)
            if current is not None:
                _check_revision(robot_id, current, if_match, if_none_match)
                transaction.remove(robot_id)
        self._memory.forget(robot_id)
        self._summaries.pop(robot_id, None)
        if current is None:
            raise self._not_found(robot_id)

    def check(self, stopped: Callable[[], bool] = lambda: False) -> None:
        """Verifies the checksum of every upload, and remembers what a list shows of it.

        Args:
            stopped: Asked between robots; True ends the check.
        """
        with suppress(StorageError):
            for robot_id in self._directory.ids():
                if stopped():
                    return
                with suppress(RobotError):
                    self.summary(robot_id)

    def damaged(self) -> tuple[str, ...]:
        """Ids of robots whose stored files were found damaged and not replaced since, sorted.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        with storage_errors():
            moved = {file.robot_id for file in self._directory.quarantine.files()}
        signature = self._directory.signature
        left = {
            robot_id
            for robot_id, changed in tuple(self._unusable.items())
            if changed is not None and self._changed(robot_id) == changed
        }
        return tuple(sorted(left | {i for i in moved if signature(i) is None}))

    def _load(self, robot_id: str) -> StoredRobot | None:
        found = read_file(self._directory.path(robot_id))
        if found is None:
            return None
        content, signature = found
        robot = decode(content)
        stored = StoredRobot(robot_id, robot, False, robot.name)
        self._memory.keep(robot_id, (signature, stored), weight_of(robot))
        return stored

    def _summarised(self, robot_id: str) -> tuple[Signature, RobotSummary] | None:
        found = read_file(self._directory.path(robot_id))
        if found is None:
            return None
        content, signature = found
        head = read_head(content)
        if head is None:
            robot = decode(content)
            return signature, RobotSummary(robot_id, robot.kind, robot.name, robot.dof, False)
        return signature, RobotSummary(robot_id, head.kind, head.title, head.dof, False)

    def _read(self, robot_id: str, read: Callable[[str], T | None]) -> T:
        """Reads a robot's file; what is no robot's goes to quarantine."""
        if ROBOT_ID.fullmatch(robot_id) is None:
            raise self._not_found(robot_id)
        try:
            try:
                found = read(robot_id)
            except BrokenFile as error:
                found = self._set_aside(robot_id, read, FAULTS[error.reason])
        except UnusableFile as error:
            self._unusable[robot_id] = self._changed(robot_id)
            raise DamagedRobot(robot_id, error.fault, moved=False) from None
        if found is None:
            moved = self._directory.quarantine.of(robot_id)
            if moved:
                raise DamagedRobot(robot_id, FAULTS.get(moved[-1].reason, _UNKNOWN), moved=True)
            raise self._not_found(robot_id)
        return found

    def _set_aside(self, robot_id: str, read: Callable[[str], T | None], fault: str) -> T | None:
        """Moves a broken file to quarantine, unless another process was first or replaced it."""
        try:
            with self._directory.write_transaction(_READERS_PATIENCE) as transaction:
                try:
                    return read(robot_id)
                except BrokenFile as error:
                    transaction.set_aside(robot_id, error.reason)
        except StorageError:
            raise UnusableFile(fault) from None
        return None

    def _changed(self, robot_id: str) -> int | None:
        """When anything about a file changed, its permissions included."""
        try:
            return os.lstat(self._directory.path(robot_id)).st_ctime_ns
        except OSError:
            return None

    def _warm(self, robot_id: str, named: tuple[str, ...]) -> None:
        """Loads the robot whose revision is asked for, so that others need not wait for that."""
        if named:
            with suppress(BrokenFile, UnusableFile):
                self._current(robot_id)

    def _current(self, robot_id: str) -> StoredRobot | None:
        return self.in_memory(robot_id) or self._load(robot_id)

    def _state(self, robot_id: str, named: tuple[str, ...]) -> str | None:
        """What is stored now: a revision, where ``named`` asks for one; None for nothing."""
        if self._directory.signature(robot_id) is None:
            return DAMAGED if self._directory.quarantine.of(robot_id) else None
        if not named:
            return ANY
        try:
            stored = self._current(robot_id)
        except (BrokenFile, UnusableFile):
            return DAMAGED
        return stored.robot.revision if stored else None

    def _not_found(self, robot_id: str) -> RobotNotFound:
        ids = self.ids()
        place = bisect_left(ids, robot_id)
        near = ids[max(0, place - _NEAR) : place + _NEAR]
        return RobotNotFound(robot_id, sorted({*near, *shipped_ids()}), len(ids))


def _revisions(*conditions: tuple[str, ...]) -> tuple[str, ...]:
    """The revisions that conditions name; none where it is enough to know whether there is one."""
    return tuple(one for condition in conditions for one in condition if one != ANY)


def _check_revision(
    robot_id: str,
    current: str | None,
    if_match: tuple[str, ...],
    if_none_match: tuple[str, ...],
) -> None:
    found = current is not None
    if if_match and current not in if_match and not (ANY in if_match and found):
        raise RevisionMismatch(robot_id, current)
    if found and (current in if_none_match or ANY in if_none_match):
        raise RevisionMismatch(robot_id, current)
