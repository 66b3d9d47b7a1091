"""Symbolic work in processes of their own, which are killed when they take too long."""

from __future__ import annotations

import hashlib
import json
import logging
import math
import os
import pickle
import select
import subprocess
import sys
import tempfile
import threading
import time
from collections import OrderedDict
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

from dh_to_urdf.table import DHTable
from kinematics.deadline import checkpoint, current
from kinematics.errors import KinematicsError
from kinematics.symbolic.request import SymbolicRequest, checked
from kinematics.symbolic.time_limit import GRACE_SECONDS, HEADER

ROOT = Path(__file__).parents[2]
LOOK = 0.2
"""Interval of checks whether the result is still wanted, s."""
PATIENCE = 10.0
"""Longest wait for a worker, s."""
WAITING = 4
"""Largest number of waiting computations; more are refused at once."""
CACHE_CHARACTERS = 32_000_000
"""Largest size of the cached answers, characters."""
TASKS = 100
"""Number of tasks after which a worker is replaced, as libraries accumulate memory."""
ATTEMPTS = 2
"""Number of workers that a task is given to, if they die."""
MAX_ERRORS = 2000
"""Most bytes of a worker's standard error that are logged."""
START = (
    "import sys; sys.path.append(sys.argv[1]); from kinematics.symbolic.worker import main; main()"
)
"""The program of a worker; its argument is where the packages are if they are not installed."""
_LOG = logging.getLogger(__name__)
_READ = 1 << 20


class SymbolicUnavailable(KinematicsError):
    """SymPy is not installed."""

    def __init__(self) -> None:
        super().__init__("SymPy is not installed here: pip install 'denavit[symbolic]'")


class WorkersBusy(KinematicsError):
    """Every worker is busy, or the work was stopped from outside.

    Attributes:
        retry_after: Time after which to try again, s.
    """

    def __init__(self, message: str, retry_after: float) -> None:
        self.retry_after = retry_after
        super().__init__(message)


class SymbolicWorkers:
    """A bounded number of worker processes, and a cache of their answers.

    Answers are cached by the content of table and request, the oldest dropped first. A process
    that has finished its task waits for the next; it ends when its standard input closes, so with
    this process at the latest.
    """

    def __init__(self, workers: int = 1) -> None:
        self._slots = threading.BoundedSemaphore(workers)
        self._places = threading.BoundedSemaphore(workers + WAITING)
        self._answers: OrderedDict[bytes, tuple[str, float]] = OrderedDict()
        self._lock = threading.Lock()
        self._idle: list[_Worker] = []

    def close(self) -> None:
        """End the idle processes."""
        with self._lock:
            idle, self._idle = self._idle, []
        for worker in idle:
            worker.end()

    def run(self, table: DHTable, request: SymbolicRequest) -> dict[str, Any]:
        """Return the answer to a request; see :meth:`kinematics.symbolic.writing.Writing.answer`.

        Blocks until the answer is complete, at most for the time budget and a fixed grace.

        Raises:
            InvalidOption: An option is invalid.
            UnknownFrame: There is no such frame.
            SymbolicUnavailable: SymPy is not installed.
            WorkersBusy: No worker was free in time, or it was killed from outside.
        """
        request = checked(table, request)
        if find_spec("sympy") is None:
            raise SymbolicUnavailable
        key = _key(table, request)
        line = self._known(key, request.time_budget) or self._made(table, request, key)
        answer: dict[str, Any] = json.loads(line)
        if "error" in answer:
            _LOG.error("symbolic worker: %s", answer["error"])
            raise WorkersBusy("the symbolic worker failed on this table", 60.0)
        return answer

    def _made(self, table: DHTable, request: SymbolicRequest, key: bytes) -> str:
        busy = WorkersBusy("all symbolic workers are busy; ask again", 5.0)
        if not self._places.acquire(blocking=False):
            raise busy
        try:
            until = time.monotonic() + PATIENCE
            while not self._slots.acquire(timeout=LOOK):
                checkpoint()
                if time.monotonic() > until:
                    raise busy
            try:
                line = self._known(key, request.time_budget) or self._work(table, request)
            finally:
                self._slots.release()
        finally:
            self._places.release()
        self._keep(key, line, request.time_budget)
        return line

    def _work(self, table: DHTable, request: SymbolicRequest) -> str:
        """Return the last answer of a worker: complete, or up to when it was stopped.

        A task whose worker died before it had an answer is given to one other worker.
        """
        task = pickle.dumps((table, request))
        deadline = time.monotonic() + min(request.time_budget + GRACE_SECONDS, current().left)
        for _ in range(ATTEMPTS):
            lines = self._tried(task, deadline)
            if lines:
                return lines[-1]
            checkpoint()
            if time.monotonic() > deadline:
                break
        raise WorkersBusy("the symbolic worker was stopped before it had an answer; ask again", 1.0)

    def _tried(self, task: bytes, deadline: float) -> list[str]:
        """Return the answers of a worker, which is kept for the next task if it is done."""
        worker = self._worker()
        finished = False
        try:
            lines, finished = worker.lines(task, deadline)
        finally:
            if finished and worker.tasks < TASKS:
                with self._lock:
                    self._idle.append(worker)
            else:
                worker.end()
        return lines

    def _worker(self) -> _Worker:
        """Return an idle worker, or a new one."""
        while True:
            with self._lock:
                if not self._idle:
                    return _Worker()
                worker = self._idle.pop()
            if worker.is_alive():
                return worker
            worker.end()

    def _known(self, key: bytes, budget: float) -> str | None:
        with self._lock:
            line, spent = self._answers.get(key, ("", 0.0))
            if not line or spent < budget:
                return None
            self._answers.move_to_end(key)
            return line

    def _keep(self, key: bytes, line: str, budget: float) -> None:
        """Keep an answer; one that is simplified throughout serves any time budget."""
        answer = json.loads(line)
        if "error" in answer:
            return
        complete = all(answer["simplified"].values())
        with self._lock:
            self._answers[key] = line, math.inf if complete else budget
            size = sum(len(text) for text, _ in self._answers.values())
            while size > CACHE_CHARACTERS and len(self._answers) > 1:
                size -= len(self._answers.popitem(last=False)[1][0])


def _key(table: DHTable, request: SymbolicRequest) -> bytes:
    rows = [(*_geometry(row), row.name) for row in table.rows]
    content = (table.convention, rows, table.base.tolist(), table.tool.tolist())
    options = {**vars(request), "time_budget": None}
    return hashlib.sha256(repr((content, sorted(options.items()))).encode()).digest()


def _geometry(row: Any) -> tuple[Any, ...]:
    columns = ("type", "alpha", "a", "d", "theta", "offset", "sign", "gamma", "b", "parent")
    return tuple(getattr(row, column) for column in columns)


class _Worker:
    """A worker process.

    It imports nothing from the directory in which the service was started: it runs in safe-path
    mode, without PYTHONPATH, from the root directory.

    Attributes:
        tasks: Number of tasks that it has been given.
    """

    def __init__(self) -> None:
        self.tasks = 0
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115  closed by end()
        self._process = _started(self._errors)

    def is_alive(self) -> bool:
        """Return whether the process runs."""
        return self._process.poll() is None

    def end(self) -> None:
        """End the process, and log what it has written to standard error."""
        # A task that a dead process has not read cannot be flushed when its input is closed.
        with suppress(BrokenPipeError), self._process:
            status = self._process.poll()
            self._process.kill()
        with self._errors:
            self._errors.seek(max(self._errors.seek(0, os.SEEK_END) - MAX_ERRORS, 0))
            errors = self._errors.read().decode("utf-8", "replace").strip()
        if status is not None or errors:
            _LOG.error("symbolic worker ended with status %s: %s", status, errors or "no message")

    def lines(self, task: bytes, deadline: float) -> tuple[list[str], bool]:
        """Give it a task; return its complete lines before a deadline, and whether it is done."""
        self.tasks += 1
        return _lines(self._process, task, deadline)


def _started(errors: IO[bytes] | int = subprocess.DEVNULL) -> subprocess.Popen[bytes]:
    """Start a worker process, which writes errors to a file."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.Popen(
        [sys.executable, "-P", "-c", START, str(ROOT)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=errors,
        cwd="/",
        env={**environment, "OPENBLAS_NUM_THREADS": "1"},
    )


def _lines(
    process: subprocess.Popen[bytes], task: bytes, deadline: float
) -> tuple[list[str], bool]:
    """Return the complete lines before the deadline, and whether the task is finished."""
    assert process.stdin is not None
    assert process.stdout is not None
    wanted = current()
    found = b""
    try:
        process.stdin.write(len(task).to_bytes(HEADER) + task)
        process.stdin.flush()
    except BrokenPipeError:
        return [], False
    while not found.endswith(b"\n\n") and (left := deadline - time.monotonic()) > 0:
        ready, _, _ = select.select([process.stdout], [], [], min(left, LOOK))
        if not ready:
            wanted.check_wanted()
            continue
        piece = os.read(process.stdout.fileno(), _READ)
        if not piece:
            break
        found += piece
    lines = [line.decode() for line in found.split(b"\n")[:-1] if line]
    return lines, found.endswith(b"\n\n")
