"""RobotStore: shipped robots, and uploaded ones as plain files that survive crashes.

One JSON file a robot, with its own checksum. A write goes to a temporary file, is flushed to the
disk and takes its final name in one step, so that a reader in any process sees the old robot or
the new one, never a part. Writers of all processes take turns by a lock file; readers need none:
they compare a file's identity with what they have in memory.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import re
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from dh_to_urdf import DHTable, read_mapping
from dh_to_urdf.documents.writing import table_to_mapping
from robots.errors import (
    DamagedRobot,
    InvalidRobotId,
    ReadOnlyRobot,
    RevisionMismatch,
    RobotExists,
    RobotNotFound,
)
from robots.robot import Robot, robot_from_table, robot_from_urdf
from robots.shipped import is_shipped, shipped_file, shipped_ids, shipped_robot

ANY: Final = "*"
ROBOT_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
_FORMAT = 1
_LEFTOVER_AGE = 600.0
_Signature = tuple[int, int, int]
_SHIPPED: _Signature = (0, 0, 0)


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

    def __init__(self, directory: Path) -> None:
        """Opens a store, creating its directory where it is missing.

        Args:
            directory: Where uploads are kept; several processes may share it.
        """
        self._files = directory / "robots"
        self._files.mkdir(parents=True, exist_ok=True)
        self._lock_file = directory / "robots.lock"
        self._cache: dict[str, tuple[_Signature, StoredRobot]] = {}
        self._summaries: dict[str, tuple[_Signature | None, RobotSummary]] = {}
        self._cache_lock = threading.Lock()
        self._sweep()

    def ids(self) -> tuple[str, ...]:
        """Ids of all robots, sorted."""
        uploaded = (path.stem for path in self._files.glob("*.json"))
        return tuple(sorted({*shipped_ids(), *(i for i in uploaded if ROBOT_ID.fullmatch(i))}))

    def summary(self, robot_id: str) -> RobotSummary:
        """What a list shows of a robot; a shipped one is not loaded for it.

        Raises:
            RobotNotFound: No robot has this id.
            DamagedRobot: The stored file fails its checksum.
        """
        if is_shipped(robot_id):
            head = shipped_file(robot_id)
            return RobotSummary(robot_id, "urdf" if head.urdf else "dh", head.title, head.dof, True)
        signature = self._signature(robot_id)
        known = self._summaries.get(robot_id)
        if known is None or known[0] != signature:
            stored = self.get(robot_id)
            robot = stored.robot
            summary = RobotSummary(robot_id, robot.kind, stored.title, robot.dof, False)
            known = self._summaries[robot_id] = (signature, summary)
        return known[1]

    def in_memory(self, robot_id: str) -> StoredRobot | None:
        """The robot if it is loaded and current; does not read the file's content."""
        entry = self._cache.get(robot_id)
        if entry is None:
            return None
        signature, stored = entry
        if stored.shipped or self._signature(robot_id) == signature:
            return stored
        return None

    def get(self, robot_id: str) -> StoredRobot:
        """Loads a robot.

        Raises:
            RobotNotFound: No robot has this id.
            DamagedRobot: The stored file fails its checksum.
        """
        found = self.in_memory(robot_id)
        if found is not None:
            return found
        if is_shipped(robot_id):
            head = shipped_file(robot_id)
            stored = StoredRobot(robot_id, shipped_robot(robot_id), True, head.title, head.source)
            signature = _SHIPPED
        else:
            found_signature = self._signature(robot_id)
            loaded = self._load(robot_id) if found_signature else None
            if found_signature is None or loaded is None:
                raise RobotNotFound(robot_id, self.ids())
            signature, stored = found_signature, loaded
        with self._cache_lock:
            while len(self._cache) >= 512:
                self._cache.pop(next(iter(self._cache)))
            self._cache[robot_id] = (signature, stored)
        return stored

    def put(
        self,
        robot_id: str,
        robot: Robot,
        *,
        create_only: bool = False,
        if_match: tuple[str, ...] = (),
    ) -> tuple[StoredRobot, bool]:
        """Stores a robot durably.

        Args:
            robot_id: Its id.
            robot: The robot.
            create_only: Refuse to replace a robot.
            if_match: Revisions one of which must be stored now, ``ANY`` for any; empty: no matter.

        Returns:
            The stored robot, and True where the id is new.

        Raises:
            InvalidRobotId: The id has other characters than letters, digits and ``. _ -``.
            ReadOnlyRobot: The id belongs to the shipped library.
            RobotExists: ``create_only`` and the id is taken.
            RevisionMismatch: ``if_match`` does not hold.
        """
        if ROBOT_ID.fullmatch(robot_id) is None:
            raise InvalidRobotId(robot_id)
        if is_shipped(robot_id):
            raise ReadOnlyRobot(robot_id)
        content = _encode(robot)
        with self._exclusive():
            current = self._revision(robot_id)
            if create_only and current is not None:
                raise RobotExists(robot_id)
            _check_revision(robot_id, current, if_match)
            _write_durably(self._path(robot_id), content)
        return StoredRobot(robot_id, robot, False, robot.name), current is None

    def delete(self, robot_id: str, *, if_match: tuple[str, ...] = ()) -> None:
        """Removes an uploaded robot.

        Raises:
            ReadOnlyRobot: The robot is shipped.
            RobotNotFound: No robot has this id.
            RevisionMismatch: ``if_match`` does not hold.
        """
        if is_shipped(robot_id):
            raise ReadOnlyRobot(robot_id)
        with self._exclusive():
            current = self._revision(robot_id)
            if current is None:
                raise RobotNotFound(robot_id, self.ids())
            _check_revision(robot_id, current, if_match)
            self._path(robot_id).unlink(missing_ok=True)
            _sync_directory(self._files)
        with self._cache_lock:
            self._cache.pop(robot_id, None)
            self._summaries.pop(robot_id, None)

    def _sweep(self) -> None:
        """Removes what writers left behind that were killed before their file took its name."""
        for leftover in self._files.glob(".*.tmp"):
            with suppress(FileNotFoundError):
                if time.time() - leftover.stat().st_mtime > _LEFTOVER_AGE:
                    leftover.unlink()

    def _path(self, robot_id: str) -> Path:
        return self._files / f"{robot_id}.json"

    def _signature(self, robot_id: str) -> _Signature | None:
        if ROBOT_ID.fullmatch(robot_id) is None:
            return None
        try:
            status = os.stat(self._path(robot_id))  # noqa: PTH116 - twice as fast on the hot path
        except OSError:
            return None
        return status.st_ino, status.st_mtime_ns, status.st_size

    def _revision(self, robot_id: str) -> str | None:
        """Revision on the disk; ``damaged`` for a file that cannot be served."""
        try:
            stored = self._load(robot_id)
        except DamagedRobot:
            return "damaged"
        return stored.robot.revision if stored else None

    def _load(self, robot_id: str) -> StoredRobot | None:
        if ROBOT_ID.fullmatch(robot_id) is None:
            return None
        try:
            content = self._path(robot_id).read_bytes()
        except FileNotFoundError:
            return None
        except OSError:
            raise DamagedRobot(robot_id) from None
        robot = _decode(robot_id, content)
        return StoredRobot(robot_id, robot, False, robot.name)

    @contextmanager
    def _exclusive(self) -> Iterator[None]:
        with self._lock_file.open("a") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            yield


def _check_revision(robot_id: str, current: str | None, if_match: tuple[str, ...]) -> None:
    if not if_match or (ANY in if_match and current is not None):
        return
    if current not in if_match:
        raise RevisionMismatch(robot_id, current)


def _encode(robot: Robot) -> bytes:
    document: dict[str, Any] = {"format": _FORMAT, "kind": robot.kind}
    if robot.table is not None:
        document["table"] = table_to_mapping(robot.table)
        document["warnings"] = list(robot.warnings)
    else:
        document.update(urdf=robot.urdf, base=robot.base_frame, tip=robot.tip_frame)
        document["warnings"] = list(robot.warnings)
    body = json.dumps(document, ensure_ascii=False).encode()
    return hashlib.sha256(body).hexdigest().encode() + b"\n" + body


def _decode(robot_id: str, content: bytes) -> Robot:
    checksum, _, body = content.partition(b"\n")
    if hashlib.sha256(body).hexdigest().encode() != checksum:
        raise DamagedRobot(robot_id)
    try:
        return _robot_of(json.loads(body))
    except (LookupError, TypeError, ValueError):
        raise DamagedRobot(robot_id) from None


def _robot_of(document: dict[str, Any]) -> Robot:
    if document["kind"] == "dh":
        table = read_mapping(document["table"])
        warnings = tuple(document["warnings"])
        return robot_from_table(
            DHTable(table.name, table.convention, table.rows, table.base, table.tool, warnings)
        )
    return robot_from_urdf(
        document["urdf"],
        base=document["base"],
        tip=document["tip"],
        warnings=tuple(document["warnings"]),
    )


def _write_durably(path: Path, content: bytes) -> None:
    """Temporary file, flush to the disk, rename, flush of the directory."""
    descriptor, temporary = tempfile.mkstemp(prefix=".", suffix=".tmp", dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        Path(temporary).replace(path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    _sync_directory(path.parent)


def _sync_directory(directory: Path) -> None:
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
