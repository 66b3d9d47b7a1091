"""Atomic, durable writes, and the errors of a disk as errors of this package."""

from __future__ import annotations

import errno
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from dh_to_urdf.messages import say
from robots.errors import StorageFull, StorageUnavailable

LEFTOVER: Final = ".tmp"
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_READ_ONLY = (errno.EROFS, errno.EACCES, errno.EPERM)
_SHORT = (errno.EMFILE, errno.ENFILE, errno.ENOMEM)


@contextmanager
def storage_errors() -> Iterator[None]:
    """Convert what the system refuses into this package's errors.

    Raises:
        StorageFull: No space, no inodes, a quota of the system or its limit on files.
        StorageUnavailable: Anything else.
    """
    try:
        yield
    except OSError as error:
        if error.errno in _FULL:
            raise StorageFull from None
        if error.errno in _READ_ONLY:
            fault = say("the data directory of the service is not writable")
        elif error.errno in _SHORT:
            fault = say("the service has too many files open or too little memory")
        else:
            name = errno.errorcode.get(error.errno or 0) or say("an error")
            fault = say("the data directory of the service cannot be used ({name})", name=name)
        raise StorageUnavailable(fault) from None


def write_durably(path: Path, content: bytes) -> None:
    """Write a temporary file, flush it, rename it; the caller flushes the directory.

    The file's time of change is set from the clock, which is finer than the stamps of older
    kernels, and later than that of the file that it replaces, so that no two versions are equal.

    Raises:
        OSError: Nothing has changed.
    """
    descriptor, temporary = tempfile.mkstemp(prefix=".", suffix=LEFTOVER, dir=path.parent)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content)
            stream.flush()
            now = time.time_ns()
            with suppress(FileNotFoundError):
                now = max(now, os.lstat(path).st_mtime_ns + 1)
            os.utime(stream.fileno(), ns=(now, now))
            os.fsync(stream.fileno())
        os.replace(temporary, path)  # noqa: PTH105 - no more is known of the name
    except BaseException:
        with suppress(OSError):
            os.unlink(temporary)  # noqa: PTH108
        raise


def sync_directory(directory: Path) -> None:
    """Flush the names in a directory to the disk."""
    descriptor = os.open(directory, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
