"""The process that does the work: tables and requests in, answers out, a line of JSON each.

It loads what it needs, then reads one task after another from standard input (its length in eight
bytes, then a pickle) and writes the plain answer, the simplified one, and an empty line. It limits
its own memory and processor time; who started it may kill it at any moment and keep the last line.
It ends with its standard input, also in the middle of a task: who would read the answer is gone.
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
TASKS = 100
"""After so many another process takes over, so that what libraries keep does not pile up."""


def main() -> None:
    """Does tasks until there are no more."""
    threading.Thread(target=_end_with_input, daemon=True).start()
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    from kinematics.symbolic.writing import Writing  # noqa: F401  before the first task

    for _ in range(TASKS):
        length = sys.stdin.buffer.read(HEADER)
        if len(length) < HEADER or not _done(sys.stdin.buffer.read(int.from_bytes(length))):
            return


def _end_with_input() -> None:
    """Waits until nobody can write to standard input any more."""
    watch = select.poll()
    watch.register(sys.stdin.fileno(), 0)  # with no event asked for, only the end is told
    watch.poll()
    os._exit(0)


def _done(task: bytes) -> bool:
    """Does one task; whether this process is fit for another."""
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
