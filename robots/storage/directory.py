"""RobotDirectory: the files of uploaded robots, changed by one process at a time.

Layout: ``robots/<id>.json``, ``quarantine/…``, and ``robots.lock``, which holds the record. Writers
lock that file; the kernel releases the lock of a killed process. The first writer after a crash
removes what was left behind and counts anew.
"""

from __future__ import annotations

import errno
import fcntl
import os
import stat
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from dh_to_urdf.messages import say
from robots.errors import StorageUnavailable
from robots.storage.durable import storage_errors, sync_directory
from robots.storage.quarantine import Quarantine
from robots.storage.stored_file import ROBOT_ID, SUFFIX, Signature, signature_of
from robots.storage.usage_record import NOTHING, Quotas, Usage, read_usage_record, usage_in
from robots.storage.write_transaction import WriteTransaction, counted

PATIENCE: Final = 4.0
"""Seconds that a writer waits for the lock; a change takes milliseconds."""
_BUSY: Final = say("another process has been writing robots for too long")
_LOCK_FLAGS = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC


class RobotDirectory:
    """The directory of one store; several processes may share it."""

    def __init__(self, directory: Path, quotas: Quotas) -> None:
        self.files = directory / "robots"
        self.quarantine = Quarantine(directory / "quarantine")
        self.directory = directory
        self._lock_path = directory / "robots.lock"
        self._quotas = quotas
        self._threads = threading.Lock()
        self._listed: tuple[tuple[bytes, int], tuple[str, ...]] | None = None

    def path(self, robot_id: str) -> Path:
        """Return where the file of a robot lies."""
        return self.files / f"{robot_id}{SUFFIX}"

    def signature(self, robot_id: str) -> Signature | None:
        """Return the identity of a robot's file; None where there is none.

        Raises:
            StorageUnavailable: The directory cannot be looked into.
        """
        if ROBOT_ID.fullmatch(robot_id) is None:
            return None
        try:
            return signature_of(os.lstat(f"{self.files}/{robot_id}{SUFFIX}"))
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError:
            raise StorageUnavailable(say("the stored robots cannot be read now")) from None

    def ids(self) -> tuple[str, ...]:
        """Return the ids that have a file, sorted; the same tuple as long as none comes or goes.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        with storage_errors():
            version = self._version()
            if version is not None and self._listed is not None and self._listed[0] == version:
                return self._listed[1]
            try:
                names = [path.name for path in self.files.iterdir()]
            except (FileNotFoundError, NotADirectoryError):
                return ()
            found = (name.removesuffix(SUFFIX) for name in names if name.endswith(SUFFIX))
            ids = tuple(sorted(filter(ROBOT_ID.fullmatch, found)))
            if version is not None and version == self._version():
                self._listed = version, ids
            return ids

    def usage(self) -> Usage:
        """Return what is stored now, without the lock.

        Raises:
            StorageUnavailable: The directory cannot be read.
        """
        with storage_errors():
            version = self._version()
            known = None if version is None else usage_in(*version)
            try:
                return known or counted(self.files)
            except (FileNotFoundError, NotADirectoryError):
                return NOTHING

    @contextmanager
    def write_transaction(self, patience: float = PATIENCE) -> Iterator[WriteTransaction]:
        """Hold the lock of all writers: wait for it, and give the transaction.

        Args:
            patience: Most seconds to wait.

        Raises:
            StorageUnavailable: Others did not end, or the directory cannot be written to.
            StorageFull: The disk is full.
        """
        until = time.monotonic() + patience
        if not self._threads.acquire(timeout=patience):
            raise StorageUnavailable(_BUSY)
        try:
            with storage_errors():
                descriptor = self._locked(until)
                try:
                    yield self._transaction(descriptor)
                finally:
                    # Closing alone would leave the lock with a child that was forked meanwhile.
                    fcntl.flock(descriptor, fcntl.LOCK_UN)
                    os.close(descriptor)
        finally:
            self._threads.release()

    def _locked(self, until: float) -> int:
        while True:
            self._make()
            descriptor = os.open(self._lock_path, _LOCK_FLAGS, 0o600)
            try:
                status = os.fstat(descriptor)
                if not stat.S_ISREG(status.st_mode):
                    raise OSError(errno.EINVAL, say("the lock is no file"))
                _wait_for_lock(descriptor, until)
                # Not a file that was removed meanwhile: others would lock its successor.
                with suppress(FileNotFoundError):
                    if os.path.samestat(status, os.lstat(self._lock_path)):
                        return descriptor
            except BaseException:
                os.close(descriptor)
                raise
            os.close(descriptor)

    def _make(self) -> None:
        """Create the directory, also where it was removed under a running service."""
        if not self.files.is_dir():
            missing = [one for one in (self.files, *self.files.parents) if not one.is_dir()]
            self.files.mkdir(parents=True, exist_ok=True)
            for one in reversed(missing):
                # What lies above the data directory may be closed to the service.
                with suppress(PermissionError):
                    sync_directory(one.parent)

    def _transaction(self, descriptor: int) -> WriteTransaction:
        record = read_usage_record(descriptor)
        usage = usage_in(record, self.files.stat().st_mtime_ns)
        transaction = WriteTransaction(
            self.files, self.quarantine, usage or Usage(0, 0), self._quotas, descriptor, record
        )
        if usage is None:
            transaction.recover()
        return transaction

    def _version(self) -> tuple[bytes, int] | None:
        """Return a value that differs after every change; None while it cannot be told."""
        try:
            descriptor = os.open(self._lock_path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        except OSError:
            return None
        try:
            record = read_usage_record(descriptor)
            mtime = self.files.stat().st_mtime_ns
        except OSError:
            return None
        finally:
            os.close(descriptor)
        return None if usage_in(record, mtime) is None else (record, mtime)


def _wait_for_lock(descriptor: int, until: float) -> None:
    pause = 0.0005
    while True:
        try:
            return fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > until:
                raise StorageUnavailable(_BUSY) from None
            time.sleep(pause)
            pause = min(2 * pause, 0.01)
