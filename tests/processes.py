"""What the processes of a service do and use, read from /proc."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from pathlib import Path

TICKS = os.sysconf("SC_CLK_TCK")
PAGE = os.sysconf("SC_PAGE_SIZE")
QUIET_LOOKS = 6
LOOK_SECONDS = 0.05


def children_of(pid: int) -> dict[int, str]:
    """Child processes with their command lines."""
    found = {}
    with suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            for child in (task / "children").read_text().split():
                with suppress(OSError):
                    found[int(child)] = Path(f"/proc/{child}/cmdline").read_text()
    return found


def family_of(pid: int) -> list[int]:
    """A process and all processes below it."""
    return [pid, *(one for child in children_of(pid) for one in family_of(child))]


def workers_of(pid: int) -> list[int]:
    """Processes that serve: the workers of a service, or itself."""
    workers = [child for child, command in children_of(pid).items() if "spawn_main" in command]
    return workers or [pid]


def symbolic_processes(pid: int) -> list[int]:
    """Processes for closed forms, anywhere below a process."""
    found = []
    for child, command in children_of(pid).items():
        if "kinematics.symbolic.worker" in command:
            found.append(child)
        found += symbolic_processes(child)
    return found


def has_ended(pid: int) -> bool:
    """Whether there is no such process, or nothing of it but its exit status."""
    return (_stat(pid) or ["Z"])[0] == "Z"


def processor_seconds(pid: int) -> float:
    """Processor time that a process and those below it have used."""
    ticks = 0
    for one in family_of(pid):
        if fields := _stat(one):
            ticks += int(fields[11]) + int(fields[12])
    return ticks / TICKS


def resident_bytes(pid: int) -> int:
    """Resident memory of one process; 0 where it has ended."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE
    except OSError:
        return 0


def is_at_rest(pid: int) -> bool:
    """Whether no thread of a process, or of one below it, runs or waits for a processor.

    Told by the scheduler's states, so that neither a throttled machine nor a loaded one makes a
    process that works look as if it did not.
    """
    for look in range(QUIET_LOOKS):
        if look:
            time.sleep(LOOK_SECONDS)
        if any(_has_work(one) for one in family_of(pid)):
            return False
    return True


def _has_work(pid: int) -> bool:
    with suppress(OSError):
        for task in Path(f"/proc/{pid}/task").iterdir():
            with suppress(OSError):
                state = (task / "stat").read_text().rsplit(")", 1)[1].split()[0]
                if state in "RD":
                    return True
    return False


def _stat(pid: int) -> list[str]:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return []
