"""WriteTransaction: changes of a directory of robots by one writer, under the lock."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from robots.storage.durable import LEFTOVER, sync_directory, write_durably
from robots.storage.quarantine import Quarantine
from robots.storage.stored_file import ROBOT_ID, SUFFIX
from robots.storage.usage_record import (
    Quotas,
    Total,
    Usage,
    blank,
    read_usage_record,
    write_usage_record,
)


@dataclass
class WriteTransaction:
    """One writer's change of the directory, under its lock; each step is durable when it returns.

    Attributes:
        files: The folder of the files.
        quarantine: Where damaged files go.
        usage: What is stored.
        quotas: What may be stored.
    """

    files: Path
    quarantine: Quarantine
    usage: Usage
    quotas: Quotas
    _descriptor: int
    _record: bytes

    def write(self, robot_id: str, content: bytes, total: Total | None = None) -> None:
        """Store or replace a file.

        Args:
            robot_id: The robot.
            content: Of its file.
            total: What this directory and others may take together.

        Raises:
            QuotaReached: It would exceed a quota.
            OSError: It is not stored; what was there before is.
        """
        path, old = self._path(robot_id), self._size(robot_id)
        if old is None and os.path.lexists(path):
            self.set_aside(robot_id, "foreign")
        usage = Usage(
            self.usage.robots + (old is None), self.usage.bytes + len(content) - (old or 0)
        )
        self.quotas.check(self.usage, usage)
        if total is not None:
            total.check(self.usage, usage)
        with self._change(usage):
            write_durably(path, content)
            sync_directory(path.parent)

    def remove(self, robot_id: str) -> None:
        """Remove a robot's file and those that were moved aside from its id.

        Raises:
            OSError: Something is still there.
        """
        path, old = self._path(robot_id), self._size(robot_id)
        if old is None and os.path.lexists(path):
            self.set_aside(robot_id, "foreign")
        if old is not None:
            with self._change(Usage(self.usage.robots - 1, self.usage.bytes - old)):
                path.unlink()
                sync_directory(path.parent)
        self.quarantine.settle(robot_id)

    def set_aside(self, robot_id: str, reason: str) -> None:
        """Move a robot's file to quarantine.

        Raises:
            OSError: It lies where it lay.
        """
        blank(self._descriptor, self._record)
        self.quarantine.take(self._path(robot_id), robot_id, reason)
        # The damage may have changed the size of the file.
        self.recover()

    def recover(self) -> None:
        """Remove what killed writers left behind, and count what is stored."""
        blank(self._descriptor, self._record)
        with os.scandir(self.files) as entries:
            for entry in entries:
                if entry.name.startswith(".") and entry.name.endswith(LEFTOVER):
                    with suppress(OSError):
                        os.unlink(entry.path)  # noqa: PTH108
        self._write(counted(self.files))

    def _path(self, robot_id: str) -> Path:
        return self.files / f"{robot_id}{SUFFIX}"

    def _size(self, robot_id: str) -> int | None:
        """Return the size of a robot's file, bytes; None where no regular file is there."""
        try:
            status = os.lstat(self._path(robot_id))
        except FileNotFoundError:
            return None
        return status.st_size if stat.S_ISREG(status.st_mode) else None

    @contextmanager
    def _change(self, after: Usage) -> Iterator[None]:
        blank(self._descriptor, self._record)
        yield
        self._write(after)

    def _write(self, usage: Usage) -> None:
        self.usage = usage
        mtime = self.files.stat().st_mtime_ns
        # Without a record the next writer counts.
        with suppress(OSError):
            write_usage_record(self._descriptor, usage, mtime, self._record)
            self._record = read_usage_record(self._descriptor)


def counted(files: Path) -> Usage:
    """Count the robots of a folder, file by file.

    Raises:
        OSError: It cannot be read.
    """
    robots = size = 0
    with os.scandir(files) as entries:
        for entry in entries:
            if _is_robots(entry.name) and entry.is_file(follow_symlinks=False):
                robots += 1
                size += entry.stat(follow_symlinks=False).st_size
    return Usage(robots, size)


def _is_robots(name: str) -> bool:
    return name.endswith(SUFFIX) and ROBOT_ID.fullmatch(name.removesuffix(SUFFIX)) is not None
