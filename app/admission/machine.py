"""How much memory this process may use: what the container allows, or the machine has."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

SUPERVISOR = 100_000_000
"""Bytes of the process that watches several workers."""
IDLE = 500_000_000
"""Bytes of a worker that has served for a while and has nothing to do: programs, the library of
robots, compiled functions, what it keeps of requests, and its idle processes."""
LEAST = 32_000_000
"""Bytes for requests at least."""


def worker_bytes(workers: int, root: Path = Path("/")) -> int:
    """Return the bytes that each of some workers may take.

    Args:
        workers: How many there are.
        root: Where /proc and /sys are.
    """
    whole = min([_physical(), *_limits(root)])
    return max(0, whole - (SUPERVISOR if workers > 1 else 0)) // workers


def request_bytes(worker: int) -> int:
    """Return the bytes for requests of a worker that may take so many in all."""
    return max(LEAST, worker - IDLE)


def _physical() -> int:
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def _limits(root: Path) -> Iterator[int]:
    """Give the limits of the control groups of this process and of those above them."""
    try:
        lines = (root / "proc/self/cgroup").read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, _, rest = line.partition(":")
        controllers, _, group = rest.partition(":")
        if controllers == "":
            top, name = root / "sys/fs/cgroup", "memory.max"
        elif "memory" in controllers.split(","):
            top, name = root / "sys/fs/cgroup/memory", "memory.limit_in_bytes"
        else:
            continue
        path = PurePosixPath(group.lstrip("/"))
        # In a container the names may be those of the host, and only the top is seen.
        for part in (path, *path.parents):
            try:
                text = (top / part / name).read_text().strip()
            except OSError:
                continue
            if text.isdigit():
                yield int(text)
