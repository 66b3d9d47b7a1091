"""The worker process: reads tables and requests, writes answers, one line of JSON each.

It imports its libraries, then reads one task after another from standard input (its length in eight
bytes, then a pickle) and writes the plain answer, the simplified one, and an empty line. It limits
its own memory and processor time; its parent may kill it at any moment and keep the last line. It
ends when its standard input closes, also in the middle of a task, as no one reads the answer then.
"""

from __future__ import annotations

import json
import os
import pickle
import resource
import select
import sys
import threading
import traceback
from typing import TYPE_CHECKING

from kinematics.symbolic.time_limit import GRACE_SECONDS, HEADER

if TYPE_CHECKING:
    from dh_to_urdf.table import DHTable
    from kinematics.symbolic.request import SymbolicRequest

GIGABYTE = 1 << 30
MEMORY = 2 * GIGABYTE


def main() -> None:
    """Process tasks until there are no more."""
    threading.Thread(target=_end_with_input, daemon=True).start()
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    from kinematics.symbolic.writing import Writing  # noqa: F401  before the first task

    while True:
        length = sys.stdin.buffer.read(HEADER)
        if len(length) < HEADER or not _done(sys.stdin.buffer.read(int.from_bytes(length))):
            return


def _end_with_input() -> None:
    """Wait until standard input is closed, and end the process."""
    watch = select.poll()
    watch.register(sys.stdin.fileno(), 0)  # without requested events, poll reports the end only
    watch.poll()
    os._exit(0)


def _done(task: bytes) -> bool:
    """Process one task; return whether this process is fit for another."""
    table, request = pickle.loads(task)
    used = resource.getrusage(resource.RUSAGE_SELF)
    seconds = int(used.ru_utime + used.ru_stime + request.time_budget) + GRACE_SECONDS
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, resource.RLIM_INFINITY))
    try:
        _write(table, request)
    except Exception:
        _send(json.dumps({"error": traceback.format_exc(limit=-3)}))
        return False
    _send("")
    return True


def _write(table: DHTable, request: SymbolicRequest) -> None:
    from kinematics.symbolic.writing import Writing

    writing = Writing(table, request)
    writing.plain()
    _send(json.dumps(writing.answer()))
    writing.simplify()
    _send(json.dumps(writing.answer()))


def _send(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
