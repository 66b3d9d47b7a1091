"""Uploaded robots as they are read: from memory, from their files, or refused as damaged.

Readers take no lock: they compare the identity of a file with that of what is in memory. A file
that fails its checks is never served: it is moved to quarantine, and its robot is refused until it
is uploaded again or deleted.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from typing import Final, TypeAlias, TypeVar

from dh_to_urdf.messages import say
from robots.errors import DAMAGED, DamagedRobot, StorageError
from robots.revisions import ANY
from robots.robot import Robot
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
    maker_in,
    read_file,
    read_head,
    read_mesh,
    read_meshes,
)
from robots.stored_robot import RobotSummary, StoredRobot
from robots.uploaded_mesh import UploadedMesh

T = TypeVar("T")
UploadMemory: TypeAlias = RobotMemory[tuple[Signature, StoredRobot]]
_UNKNOWN: Final = say("was found damaged")
_TRIES: Final = 5
"""Times that a reader starts again where the file is replaced while it reads."""
_PATIENCE: Final = 1.0
"""Seconds that a reader waits for the lock to move a broken file."""


class UploadReader:
    """Reads the robots of a directory and remembers the last used ones."""

    def __init__(
        self, directory: RobotDirectory, memory: UploadMemory | None = None, namespace: str = ""
    ) -> None:
        """Read a directory.

        Args:
            directory: The directory.
            memory: Where robots are remembered; several readers may share it.
            namespace: Tells the robots of this reader from those of others in the memory.
        """
        self._directory = directory
        self._memory: UploadMemory = RobotMemory() if memory is None else memory
        # No id has this character.
        self._prefix = f"{namespace}/"
        self._summaries: dict[str, tuple[Signature, RobotSummary]] = {}
        self._unusable: dict[str, int | None] = {}

    def in_memory(self, robot_id: str) -> StoredRobot | None:
        """Return the robot if it is loaded and current, without reading its file.

        Raises:
            StorageUnavailable: The directory cannot be looked into.
        """
        entry = self._memory.get(self._prefix + robot_id)
        if entry is None or self._directory.signature(robot_id) != entry[0]:
            return None
        return entry[1]

    def get(self, robot_id: str) -> StoredRobot | None:
        """Read a robot; None where no upload has the id.

        Raises:
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        stored = self._read(robot_id, self._load)
        if stored is not None:
            self._unusable.pop(robot_id, None)
        return stored

    def summary(self, robot_id: str) -> RobotSummary | None:
        """Verify the file of a robot and return its line of a list; None where there is no file.

        Raises:
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        signature = self._directory.signature(robot_id)
        known = self._summaries.get(robot_id)
        if known is None or known[0] != signature:
            known = self._read(robot_id, self._summarised)
            if known is None:
                return None
            self._summaries[robot_id] = known
        return known[1]

    def revision(self, robot_id: str, *, exact: bool) -> str | None:
        """Return the revision that is stored now.

        Args:
            robot_id: The robot.
            exact: False where it is enough to know that there is one.

        Returns:
            The revision, ``ANY`` where ``exact`` is False, ``DAMAGED`` where the file cannot be
            served, None where no upload has the id.
        """
        if self._directory.signature(robot_id) is None:
            return DAMAGED if self._directory.quarantine.of(robot_id) else None
        return self._stored_revision(robot_id) if exact else ANY

    def maker(self, robot_id: str) -> str | None:
        """Return the maker of a robot that is stored now; None where it is not known."""
        with suppress(BrokenFile, UnusableFile):
            stored = self._current(robot_id)
            return stored.maker if stored else None
        return None

    def stored(self, robot_id: str) -> StoredRobot | None:
        """Return what is stored now, for a writer who holds the lock; None where nothing is.

        Raises:
            DamagedRobot: The stored file cannot be served.
        """
        try:
            return self._current(robot_id)
        except (BrokenFile, UnusableFile):
            raise DamagedRobot(robot_id, _UNKNOWN, moved=False) from None

    def mesh_files(self, robot_id: str, robot: Robot) -> dict[str, bytes]:
        """Return the mesh files of what is stored now, for a writer who holds the lock.

        Raises:
            DamagedRobot: They cannot be read.
        """
        if not robot.meshes:
            return {}
        signature = self._directory.signature(robot_id)
        found = None
        with suppress(BrokenFile, UnusableFile):
            if signature is not None:
                found = read_meshes(self._directory.path(robot_id), robot, signature)
        if found is None:
            raise DamagedRobot(robot_id, _UNKNOWN, moved=False)
        return found

    def mesh_file(self, robot_id: str, name: str) -> tuple[UploadedMesh, bytes] | None:
        """Return an uploaded mesh and its file; None where the robot has none of this name.

        Raises:
            DamagedRobot: The stored file cannot be served.
            StorageUnavailable: The directory cannot be read.
        """
        for _ in range(_TRIES):
            stored = self.get(robot_id)
            entry = self._memory.get(self._prefix + robot_id)
            meshes = {} if stored is None else {one.name: one for one in stored.robot.meshes}
            if name not in meshes:
                return None
            if entry is not None and entry[1] is stored:
                content = self._read(robot_id, self._mesh_reader(entry, name))
                if content is not None:
                    return meshes[name], content
        return None

    def _mesh_reader(
        self, entry: tuple[Signature, StoredRobot], name: str
    ) -> Callable[[str], bytes | None]:
        signature, stored = entry
        path = self._directory.path(stored.id)
        return lambda _: read_mesh(path, stored.robot, signature, name)

    def knows(self, robot_id: str) -> bool:
        """Return whether an upload has the id, sound or damaged.

        Raises:
            StorageUnavailable: The directory cannot be looked into.
        """
        if ROBOT_ID.fullmatch(robot_id) is None:
            return False
        with storage_errors():
            return self.revision(robot_id, exact=False) is not None

    def _stored_revision(self, robot_id: str) -> str | None:
        try:
            stored = self._current(robot_id)
        except (BrokenFile, UnusableFile):
            return DAMAGED
        return stored.robot.revision if stored else None

    def warm(self, robot_id: str) -> None:
        """Load a robot before its revision is asked for under the lock."""
        with suppress(BrokenFile, UnusableFile):
            self._current(robot_id)

    def forget(self, robot_id: str) -> None:
        """Drop what is in memory of a robot."""
        self._memory.forget(self._prefix + robot_id)
        self._summaries.pop(robot_id, None)

    def limit_summaries(self, count: int) -> None:
        """Drop all lines of lists where over ``2 count + 1000`` are kept."""
        if len(self._summaries) > 2 * count + 1000:
            self._summaries.clear()

    def damaged(self) -> tuple[str, ...]:
        """Return the ids whose files were found damaged and not replaced since, sorted.

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

    def _current(self, robot_id: str) -> StoredRobot | None:
        return self.in_memory(robot_id) or self._load(robot_id)

    def _load(self, robot_id: str) -> StoredRobot | None:
        found = read_file(self._directory.path(robot_id))
        if found is None:
            return None
        content, signature = found
        robot = decode(content)
        stored = StoredRobot(robot_id, robot, False, robot.name, maker=maker_in(content))
        self._memory.keep(self._prefix + robot_id, (signature, stored), weight_of(robot))
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

    def _read(self, robot_id: str, read: Callable[[str], T | None]) -> T | None:
        """Read the file of a robot; move it to quarantine where it holds none."""
        if ROBOT_ID.fullmatch(robot_id) is None:
            return None
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
        return found

    def _set_aside(self, robot_id: str, read: Callable[[str], T | None], fault: str) -> T | None:
        """Move a broken file to quarantine, unless another process was first or replaced it."""
        try:
            with self._directory.write_transaction(_PATIENCE) as transaction:
                try:
                    return read(robot_id)
                except BrokenFile as error:
                    transaction.set_aside(robot_id, error.reason)
        except StorageError:
            raise UnusableFile(fault) from None
        return None

    def _changed(self, robot_id: str) -> int | None:
        """Return when anything about a file changed, its permissions included, ns."""
        try:
            return os.lstat(self._directory.path(robot_id)).st_ctime_ns
        except OSError:
            return None
