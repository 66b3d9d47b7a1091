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
import threading
import time
from collections import OrderedDict
from importlib.util import find_spec
from pathlib import Path
from typing import Any

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
        self._idle: list[subprocess.Popen[bytes]] = []

    def close(self) -> None:
        """End the idle processes."""
        with self._lock:
            idle, self._idle = self._idle, []
        for process in idle:
            with process:
                process.kill()

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
        """Return the last answer of a worker: complete, or up to when it was stopped."""
        process = self._process()
        finished = False
        try:
            task = pickle.dumps((table, request))
            lines, finished = _lines(process, task, request.time_budget)
        finally:
            if finished:
                with self._lock:
                    self._idle.append(process)
            else:
                with process:
                    process.kill()
        if not lines:
            checkpoint()
            raise WorkersBusy(
                "the symbolic worker was stopped before it had an answer; ask again", 1.0
            )
        return lines[-1]

    def _process(self) -> subprocess.Popen[bytes]:
        """Return an idle process, or a new one."""
        while True:
            with self._lock:
                if not self._idle:
                    return _started()
                process = self._idle.pop()
            if process.poll() is None:
                return process
            with process:
                pass

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


def _started() -> subprocess.Popen[bytes]:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join((str(ROOT), os.environ.get("PYTHONPATH", ""))).rstrip(":"),
        "OPENBLAS_NUM_THREADS": "1",
    }
    command = [sys.executable, "-m", "kinematics.symbolic.worker"]
    pipe = subprocess.PIPE
    return subprocess.Popen(
        command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, env=environment
    )


def _lines(process: subprocess.Popen[bytes], task: bytes, budget: float) -> tuple[list[str], bool]:
    """Return the complete lines before the deadline, and whether the task is finished."""
    assert process.stdin is not None
    assert process.stdout is not None
    wanted = current()
    deadline = time.monotonic() + min(budget + GRACE_SECONDS, wanted.left)
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
