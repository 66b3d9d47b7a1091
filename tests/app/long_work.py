"""The service, with computations that last as long as a test wishes.

``python -m tests.app.long_work serve …`` is ``denavit serve …`` with these besides:

* ``endless`` takes the requests of ``fk``. It computes, and holds the interpreter, until nobody
  waits for it, its time is up, or the file that ``GATE`` names is there. Its stream is a line
  after the other until then.
* ``again/NAME`` does the computation NAME again and again. It ends only where that computation
  itself asks whether anybody still waits.

No other file of the tests knows how operations are declared.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

from app import main as application
from app.http.negotiation import NDJSON
from app.operations import OPERATIONS, Answer, Context, Operation
from app.operations.forward import FK
from app.operations.operation import Runs
from kinematics.deadline import checkpoint
from kinematics.symbolic import SymbolicWorkers
from robots.robot import Robot

GATE = "TEST_GATE"
"""Environment variable: the file whose presence ends ``endless``."""
LINES_A_SECOND = 50
NEEDED = "time"
"""Operations that need a package of their own are not sent as examples at the start."""


def gate_is_shut() -> bool:
    return not Path(os.environ.get(GATE, "/nowhere")).exists()


def work(robot: Robot, request: Any, context: Context) -> Answer:
    while gate_is_shut():
        checkpoint()
        sum(range(50_000))
    return FK.run(robot, request, context)


def lines(robot: Robot, request: Any, context: Context) -> Iterator[list[dict[str, Any]]]:
    index = 0
    while gate_is_shut():
        yield [{"index": index}]
        index += 1
        time.sleep(1 / LINES_A_SECOND)
    yield [{"last": index}]


def again(operation: Operation) -> Operation:
    def run(robot: Robot, request: Any, context: Context) -> Answer:
        while True:
            # Closed forms that were found are kept: by each of these once.
            with closing(SymbolicWorkers()) as symbolic:
                operation.run(robot, request, replace(context, symbolic=symbolic))

    stream = operation.stream

    def repeated(robot: Robot, request: Any, context: Context) -> Iterator[list[dict[str, Any]]]:
        assert stream is not None
        while True:
            yield from stream(robot, request, context)

    runs = Runs.PROCESS if operation.runs is Runs.PROCESS else Runs.THREAD
    return replace(
        operation,
        name=f"again/{operation.name}",
        run=run,
        runs=runs,
        needs=NEEDED,
        stream=repeated if stream else None,
    )


ENDLESS = replace(
    FK,
    name="endless",
    run=work,
    runs=Runs.THREAD,
    forms=(*FK.forms, NDJSON),
    needs=NEEDED,
    stream=lines,
)

if __name__ in ("__main__", "__mp_main__"):  # the service, and each of its workers
    application.OPERATIONS = (*OPERATIONS, ENDLESS, *map(again, OPERATIONS))

if __name__ == "__main__":
    from app.cli import main

    main()
