"""Namespaces: a store of its own for each name, above a shared one.

``robots/<id>.json`` of the data directory are the shared robots, ``namespaces/<folder>/robots/…``
those of a name; each namespace is a directory as the shared one, with its own lock, record and
quarantine. Whoever stores in a namespace holds the lock of the shared directory too, so that what
all take together is counted exactly; the shared lock is always taken first.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from robots.errors import StorageError
from robots.storage.directory import RobotDirectory
from robots.storage.durable import storage_errors
from robots.storage.memory import RobotMemory
from robots.storage.uploads import UploadMemory
from robots.storage.usage_record import NOTHING, Quotas, Total, Usage
from robots.store import RobotStore

FOLDER: Final = "namespaces"
_KEPT: Final = re.compile(r"[a-z0-9_-]")
_FOLDER_NAME: Final = re.compile(r"([a-z0-9_-]|=[0-9a-f]{2})+")


def folder_of(name: str) -> str:
    """Return the folder of a namespace: no two names share one, nor does case or a dot matter.

    Small letters, digits, ``_`` and ``-`` stand for themselves, any other byte is ``=`` and two
    digits, so that ``..`` is no path and ``Ada`` is not ``ada`` on any file system.
    """
    return "".join(
        chr(byte) if _KEPT.fullmatch(chr(byte)) else f"={byte:02x}" for byte in name.encode()
    )


class Namespaces:
    """The stores of one data directory: the shared one, and one for each name.

    Attributes:
        shared: The library, and uploads that all see.
    """

    def __init__(self, directory: Path, total: Quotas, each: Quotas) -> None:
        """Open the shared store; those of names are opened when they are asked for.

        Args:
            directory: The data directory; several processes may share it.
            total: How much all may keep together.
            each: How much one namespace may keep.
        """
        self._folder = directory / FOLDER
        self._total_quotas = total
        self._each = each
        self._memory: UploadMemory = RobotMemory()
        self._stores: dict[str, RobotStore] = {}
        self._lock = threading.Lock()
        self.shared = RobotStore(directory, total, total=self._besides(None), memory=self._memory)

    def of(self, name: str) -> RobotStore:
        """Return the store of a name: its own uploads, the shared ones and the library.

        Its directory is created by the first upload.
        """
        return self._opened(folder_of(name))

    def usage(self) -> Usage:
        """Return how many uploads there are in all and how many bytes they take.

        Raises:
            StorageError: A directory cannot be read.
        """
        return sum((self._usage_of(folder) for folder in self._folders()), self.shared.usage_now())

    def check(self, stopped: Callable[[], bool] = lambda: False) -> None:
        """Verify the checksum of every upload, and remove what killed writers left behind.

        Args:
            stopped: Asked between robots; True ends the check.
        """
        self.shared.check(stopped)
        with suppress(StorageError):
            for folder in self._folders():
                if stopped():
                    return
                store = self._opened(folder)
                store.recover()
                store.check(stopped)

    def damaged(self) -> tuple[tuple[str, ...], int]:
        """Return the damaged shared robots, and the number of damaged ones in namespaces.

        Raises:
            StorageUnavailable: A directory cannot be read.
        """
        count = sum(len(self._opened(folder).damaged()) for folder in self._folders())
        return self.shared.damaged(), count

    def _opened(self, folder: str) -> RobotStore:
        with self._lock:
            found = self._stores.get(folder)
            if found is None:
                found = self._stores[folder] = RobotStore(
                    self._folder / folder,
                    self._each,
                    shared=self.shared,
                    total=self._besides(folder),
                    memory=self._memory,
                    namespace=folder,
                )
            return found

    def _folders(self) -> Iterator[str]:
        """Return the folders of all namespaces, sorted.

        Raises:
            StorageUnavailable: They cannot be read.
        """
        with storage_errors():
            try:
                names = sorted(path.name for path in self._folder.iterdir())
            except (FileNotFoundError, NotADirectoryError):
                names = []
        return filter(_FOLDER_NAME.fullmatch, names)

    def _usage_of(self, folder: str) -> Usage:
        return RobotDirectory(self._folder / folder, self._each).usage()

    def _besides(self, own: str | None) -> Callable[[], Total]:
        """Return what tells the total, for the store of a folder; None for the shared one."""

        def total() -> Total:
            shared = NOTHING if own is None else self.shared.usage_now()
            others = (self._usage_of(folder) for folder in self._folders() if folder != own)
            return Total(self._total_quotas, sum(others, shared))

        return total
