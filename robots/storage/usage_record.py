"""The usage record of a directory of robots: number and size of its files, without a scan.

It is the content of the lock file, read and written under the lock. A writer blanks it before it
changes the directory and rewrites it afterwards, so that after a crash it is blank and the next
writer counts. It holds the directory's time of change, so that ``cp`` or ``rm`` by others makes it
void. Readers use it, without the lock, as the version of the directory.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from typing import Final

from robots.errors import QuotaHolder, QuotaReached

_SIZE: Final = 128
_BLANK: Final = b"-" * _SIZE


@dataclass(frozen=True, slots=True)
class Quotas:
    """Most uploaded robots, and most bytes in their files, of all or of one namespace."""

    robots: int = 10_000
    bytes: int = 1_000_000_000
    holder: QuotaHolder = "store"

    def check(self, before: Usage, after: Usage) -> None:
        """Refuse growth beyond a quota; what shrinks may exceed it still.

        Raises:
            QuotaReached: Names the quota.
        """
        if after.robots > max(self.robots, before.robots):
            raise QuotaReached("robots", self.robots, self.holder)
        if after.bytes > max(self.bytes, before.bytes):
            raise QuotaReached("bytes", self.bytes, self.holder)


@dataclass(frozen=True, slots=True)
class Usage:
    """What is stored.

    Attributes:
        robots: Number of files.
        bytes: Their sizes together.
    """

    robots: int
    bytes: int

    def __add__(self, other: Usage) -> Usage:
        """Return the usage of both together."""
        return Usage(self.robots + other.robots, self.bytes + other.bytes)


NOTHING: Final = Usage(0, 0)


@dataclass(frozen=True, slots=True)
class Total:
    """What several directories may take together, and what the others take.

    Attributes:
        quotas: Of all.
        elsewhere: What is stored in the others.
    """

    quotas: Quotas
    elsewhere: Usage

    def check(self, before: Usage, after: Usage) -> None:
        """Refuse growth of one directory that exceeds a quota of all.

        Raises:
            QuotaReached: Names the quota.
        """
        self.quotas.check(before + self.elsewhere, after + self.elsewhere)


def read_usage_record(descriptor: int) -> bytes:
    """Read the record, in one read."""
    return os.pread(descriptor, _SIZE, 0)


def usage_in(record: bytes, directory_mtime: int) -> Usage | None:
    """Return the usage in a record; None where it is blank, or the directory changed since."""
    fields = record.split()
    if len(record) != _SIZE or len(fields) != 4 or not all(map(bytes.isdigit, fields)):
        return None
    robots, size, mtime, _ = map(int, fields)
    return Usage(robots, size) if mtime == directory_mtime else None


def blank(descriptor: int, record: bytes) -> None:
    """Blank the record before the directory changes.

    Raises:
        OSError: It cannot be said, so nothing may change.
    """
    if len(record) == _SIZE:
        try:
            os.pwrite(descriptor, _BLANK, 0)
        except OSError:
            # Some file systems need space to overwrite a block; none needs it to truncate.
            os.ftruncate(descriptor, 0)


def write_usage_record(descriptor: int, usage: Usage, directory_mtime: int, before: bytes) -> None:
    """Write the usage; the record differs from ``before`` and that of any other change."""
    generation = max(time.time_ns(), _generation(before) + 1)
    text = f"{usage.robots} {usage.bytes} {directory_mtime} {generation}"
    os.pwrite(descriptor, text.ljust(_SIZE).encode(), 0)


def _generation(record: bytes) -> int:
    fields = record.split()
    return int(fields[3]) if len(fields) == 4 and fields[3].isdigit() else 0
