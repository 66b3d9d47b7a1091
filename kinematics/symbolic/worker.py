"""The process that does the work: a table and a request in, answers out, a line of JSON each.

It loads what it needs, reads a pickle from standard input, writes the plain answer and then the
simplified one. It limits its own memory and processor time; who started it may kill it at any
moment and keep the last line.
"""

from __future__ import annotations

import json
import os
import pickle
import resource
import sys
import traceback

from kinematics.symbolic.time_limit import GRACE_SECONDS

GIGABYTE = 1 << 30
MEMORY = 2 * GIGABYTE


def main() -> None:
    """Reads one request, answers, ends."""
    os.nice(5)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    from kinematics.symbolic.writing import Writing

    task = sys.stdin.buffer.read()
    if not task:
        return
    table, request = pickle.loads(task)
    seconds = int(request.time_budget) + GRACE_SECONDS
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 2))
    try:
        writing = Writing(table, request)
        writing.plain()
        _send(writing.answer())
        writing.simplify()
        _send(writing.answer())
    except MemoryError:
        _send({"error": "out of memory"})
    except Exception:
        _send({"error": traceback.format_exc(limit=-3)})


def _send(answer: dict[str, object]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
