"""Quarantine: files that hold no robot, moved aside with time and reason in their names.

``quarantine/<id>.<UTC time>.<reason>``. While such a file exists and no sound file has its
id, the id counts as damaged. Files of deleted ids are removed; a directory, which may hold
anything, is only renamed to ``….settled``.
"""

from __future__ import annotations

import logging
import os
import re
import stat
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from robots.storage.durable import sync_directory
from robots.storage.stored_file import ROBOT_ID

_NAME: Final = re.compile(
    rf"(?P<id>{ROBOT_ID.pattern})\.(?P<when>[0-9]{{8}}T[0-9]{{6}}\.[0-9]{{9}}Z)\.(?P<reason>[a-z]{{1,16}})"
)
_SETTLED: Final = ".settled"
_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class QuarantinedFile:
    """A file that was moved aside.

    Attributes:
        robot_id: Id of its robot.
        when: When it was moved, UTC.
        reason: Why, in one word.
        path: Where it lies.
    """

    robot_id: str
    when: str
    reason: str
    path: Path


class Quarantine:
    """The folder of one store; to be changed under the store's lock only."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def files(self) -> tuple[QuarantinedFile, ...]:
        """Return all files that were moved aside, by id and time.

        Raises:
            OSError: The folder cannot be read.
        """
        try:
            names = [path.name for path in self._folder.iterdir()]
        except (FileNotFoundError, NotADirectoryError):
            return ()
        found = ((name, _NAME.fullmatch(name)) for name in sorted(names))
        return tuple(
            QuarantinedFile(match["id"], match["when"], match["reason"], self._folder / name)
            for name, match in found
            if match is not None
        )

    def of(self, robot_id: str) -> tuple[QuarantinedFile, ...]:
        """Return the files that were moved aside from one id, oldest first."""
        return tuple(file for file in self.files() if file.robot_id == robot_id)

    def take(self, path: Path, robot_id: str, reason: str) -> None:
        """Move a file aside durably, whatever it is.

        Raises:
            OSError: It cannot be moved.
        """
        self._folder.mkdir(exist_ok=True)
        while True:
            seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
            when = time.strftime("%Y%m%dT%H%M%S", time.gmtime(seconds)) + f".{nanoseconds:09}Z"
            target = self._folder / f"{robot_id}.{when}.{reason}"
            if not os.path.lexists(target):
                break
        path.rename(target)
        sync_directory(self._folder)
        sync_directory(path.parent)
        sync_directory(self._folder.parent)
        _log.warning("robot %s: its file was moved to %s", robot_id, target)

    def settle(self, robot_id: str) -> None:
        """Remove what was moved aside from an id.

        Raises:
            OSError: It cannot be removed.
        """
        found = self.of(robot_id)
        for file in found:
            if stat.S_ISDIR(os.lstat(file.path).st_mode):
                file.path.rename(file.path.with_name(file.path.name + _SETTLED))
            else:
                file.path.unlink()
        if found:
            sync_directory(self._folder)
