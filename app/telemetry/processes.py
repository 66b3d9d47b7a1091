"""Memory and processor time of the worker processes, from /proc; nothing where there is none."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_TICKS = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True, slots=True)
class Usage:
    """What a process takes.

    Attributes:
        resident_bytes: Memory.
        cpu_seconds: User and system time.
        start_time: When it started, seconds since 1970.
    """

    resident_bytes: int
    cpu_seconds: float
    start_time: float


def pid_file(directory: Path, slot: int) -> Path:
    """Where the process id of a worker is written down."""
    return directory / f"worker_{slot}.pid"


def usage(directory: Path | None) -> Iterator[tuple[str, Usage]]:
    """Each worker's number and usage; this process as worker 0 where there is no directory."""
    if directory is None:
        pids = {"0": os.getpid()}
    else:
        pids = {}
        for path in sorted(directory.glob("worker_*.pid")):
            try:
                pids[path.stem.removeprefix("worker_")] = int(path.read_text())
            except (OSError, ValueError):  # it has just died
                continue
    for slot, pid in pids.items():
        found = _usage_of(pid)
        if found is not None:
            yield slot, found


def cpu_seconds(pid: int | None) -> float:
    """Processor time of a process so far; 0 where it cannot be known."""
    found = None if pid is None else _usage_of(pid)
    return 0.0 if found is None else found.cpu_seconds


def is_stopped(pid: int | None) -> bool:
    """Return whether a process was stopped by a signal, such as SIGSTOP, and does not run."""
    fields = None if pid is None else _stat_of(pid)
    return fields is not None and fields[0] == "T"


def _stat_of(pid: int) -> list[str] | None:
    """Return the fields of /proc/PID/stat from the third on, which is the state."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split() or None
    except OSError:
        return None


def _usage_of(pid: int) -> Usage | None:
    fields = _stat_of(pid)
    try:
        boot = Path("/proc/stat").read_text().partition("btime ")[2].split(maxsplit=1)[0]
    except (OSError, IndexError):
        return None
    if fields is None:
        return None
    # Fields 14, 15, 22 and 24 of proc(5), counted from the state, which is field 3.
    user, system, start, pages = (int(fields[number - 3]) for number in (14, 15, 22, 24))
    return Usage(pages * _PAGE, (user + system) / _TICKS, int(boot) + start / _TICKS)
