"""The process: reads tasks from standard input, does them, writes answers to standard output.

It limits its own memory and processor time for each task; its parent may kill it at any moment and
keep the last whole answer. It ends when its standard input closes, also in the middle of a task, as
no one reads the answer then. What libraries print goes to standard error.
"""

from __future__ import annotations

import math
import os
import pickle
import resource
import select
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from typing import IO, Any

from kinematics.processes.protocol import (
    ANSWER,
    DONE,
    FAILED,
    HEADER,
    NO_MEMORY,
    Limits,
    framed,
)

UNKNOWN_BASE = 256 << 20
"""Bytes that an idle process counts as, where they cannot be known."""
GRACE_SECONDS = 15
"""Processor time besides that of a task, s: before it and after it."""


def main() -> None:
    """Do tasks until there are no more; the second argument names the module that does them."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    threading.Thread(target=_end_with_input, daemon=True).start()
    work = import_module(sys.argv[2]).prepare()
    base = _data_bytes()
    while True:
        length = sys.stdin.buffer.read(HEADER)
        if len(length) < HEADER:
            return
        limits, task = pickle.loads(sys.stdin.buffer.read(int.from_bytes(length)))
        _limit(limits, base)
        if not _done(work, task, answers):
            return


def _end_with_input() -> None:
    """Wait until standard input is closed, and end the process."""
    watch = select.poll()
    watch.register(sys.stdin.fileno(), 0)  # without requested events, poll reports the end only
    watch.poll()
    os._exit(0)


def _limit(limits: Limits, base: int) -> None:
    """Bound what the next task takes: the data segment, which leaves mapped libraries out."""
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    wanted = base + limits.memory
    if most != resource.RLIM_INFINITY:
        wanted = min(wanted, most)
    resource.setrlimit(resource.RLIMIT_DATA, (wanted, most))
    used = resource.getrusage(resource.RUSAGE_SELF)
    ends = used.ru_utime + used.ru_stime + limits.seconds + GRACE_SECONDS
    seconds = int(ends) if math.isfinite(ends) else resource.RLIM_INFINITY
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, resource.RLIM_INFINITY))


def _data_bytes() -> int:
    """Return the size of this process's data segment."""
    try:
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmData:"):
                return int(line.split()[1]) * 1024
    except OSError:
        pass
    return UNKNOWN_BASE


def _done(work: Callable[[Any], Iterator[bytes]], task: Any, answers: IO[bytes]) -> bool:
    """Do one task; return whether this process is fit for another."""

    def send(tag: bytes, content: bytes = b"") -> None:
        answers.write(framed(content, tag))
        answers.flush()

    try:
        for answer in work(task):
            send(ANSWER, answer)
    except MemoryError:
        send(NO_MEMORY)
        return False
    except Exception:
        send(FAILED, traceback.format_exc(limit=-3).encode())
        return False
    send(DONE)
    return True


if __name__ == "__main__":
    main()
