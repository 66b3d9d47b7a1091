"""Counters of a rate limit that all workers of a service share: a table in a mapped file.

The table has a fixed size. A client is looked for in one bucket of a few slots, which a keyed hash
chooses, so that nobody can aim at the bucket of another. In a full bucket the counter
gives way whose window has ended, else the one that has counted least: many new clients push out
each other, not one that asks much.

A bucket is changed under a lock on its bytes, which the kernel releases when a process ends. A
worker that a signal has stopped would hold it for ever: after a moment it is not waited for, and
at worst one request is not counted. A worker that is killed in the middle of a change leaves at
worst one counter wrong, until its window ends.
"""

from __future__ import annotations

import fcntl
import hashlib
import mmap
import os
import secrets
import struct
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

BUCKETS: Final = 1 << 14
SLOTS: Final = 8
"""Slots of a bucket. With the buckets 131,072 counters, 4 MB."""
TRIES: Final = 500
PAUSE: Final = 1e-4
"""How often a locked bucket is tried, and the seconds between: a change takes microseconds."""
_SLOT: Final = struct.Struct("<16sQd")
"""Hash of a client with the number of a window; requests; end of the window, s since the epoch."""
_BUCKET: Final = struct.Struct("<" + "16sQd" * SLOTS)
_SECRET_BYTES: Final = 32
_START: Final = 64
"""Bytes before the first bucket; the secret of the hash is in them."""


def create_counters(path: Path) -> None:
    """Create the file of the counters, before any worker opens it.

    Raises:
        OSError: It cannot be created.
    """
    with path.open("xb") as file:
        path.chmod(0o600)
        file.write(secrets.token_bytes(_SECRET_BYTES))
        file.truncate(_START + BUCKETS * _BUCKET.size)


class SharedCounters:
    """One worker's view of the table; one event loop uses it."""

    def __init__(self, path: Path) -> None:
        """Open the table.

        Args:
            path: As of :func:`create_counters`.

        Raises:
            OSError: It cannot be opened.
        """
        # Open as long as this lives: closing any descriptor of it would release the locks.
        self._file = path.open("r+b", buffering=0)
        self._descriptor = self._file.fileno()
        self._table = mmap.mmap(self._descriptor, _START + BUCKETS * _BUCKET.size)
        self._secret = self._table[:_SECRET_BYTES]

    def count(self, client: str, windows: Sequence[float]) -> list[tuple[int, float]]:
        """Count a request; see :meth:`app.access.rates.Counters.count`."""
        digest = hashlib.blake2b(client.encode(), digest_size=15, key=self._secret).digest()
        bucket = _START + int.from_bytes(digest[:4], "little") % BUCKETS * _BUCKET.size
        locked = self._lock(bucket)
        try:
            return [
                self._count(bucket, digest + bytes((number,)), seconds)
                for number, seconds in enumerate(windows)
            ]
        finally:
            if locked:
                fcntl.lockf(self._descriptor, fcntl.LOCK_UN, 1, bucket, os.SEEK_SET)

    def _count(self, bucket: int, key: bytes, seconds: float) -> tuple[int, float]:
        now = time.time()
        values = _BUCKET.unpack_from(self._table, bucket)
        keys, counts, ends = values[::3], values[1::3], values[2::3]
        count, end = 0, 0.0
        if key in keys:
            slot = keys.index(key)
            count, end = counts[slot], ends[slot]
        else:
            # Ended windows give way first, then the smallest counts.
            slot = min(range(SLOTS), key=lambda k: (ends[k] > now, counts[k]))
        if end <= now:
            count, end = 0, now + seconds
        _SLOT.pack_into(self._table, bucket + slot * _SLOT.size, key, count + 1, end)
        return count + 1, end

    def close(self) -> None:
        """Close the table."""
        self._table.close()
        self._file.close()

    def _lock(self, bucket: int) -> bool:
        """Lock a bucket; return False where another process does not let go."""
        for attempt in range(TRIES):
            if attempt:
                time.sleep(PAUSE)
            try:
                fcntl.lockf(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, bucket, os.SEEK_SET)
            except OSError:
                continue
            return True
        return False
