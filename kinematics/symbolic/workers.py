"""Symbolic work in processes of their own, which are killed when they take too long."""

from __future__ import annotations

import hashlib
import json
import logging
import math
import threading
from collections import OrderedDict
from importlib.util import find_spec
from typing import Any

from dh_to_urdf.messages import from_data, say
from dh_to_urdf.table import DHTable
from kinematics.deadline import current
from kinematics.errors import KinematicsError, WorkersBusy
from kinematics.processes.pool import ProcessPool, Session, TaskFailed
from kinematics.processes.protocol import Limits
from kinematics.symbolic.request import SymbolicRequest, checked
from kinematics.symbolic.time_limit import GRACE_SECONDS

WORKER = "kinematics.symbolic.worker"
WAITING = 4
"""Largest number of waiting computations; more are refused at once."""
MEMORY = 256 << 20
"""Bytes that a computation may take in its process, besides those of an idle one."""
CACHE_CHARACTERS = 32_000_000
"""Largest size of the cached answers, characters."""
_LOG = logging.getLogger(__name__)


class SymbolicUnavailable(KinematicsError):
    """SymPy is not installed."""

    def __init__(self) -> None:
        super().__init__(say("SymPy is not installed here: pip install 'denavit[symbolic]'"))


class SymbolicWorkers:
    """A bounded number of worker processes, and a cache of their answers.

    Answers are cached by the content of table and request, the oldest dropped first.
    """

    def __init__(self, workers: int = 1) -> None:
        self._pool = ProcessPool(WORKER, workers, WAITING)
        self._answers: OrderedDict[bytes, tuple[str, float]] = OrderedDict()
        self._lock = threading.Lock()

    def close(self) -> None:
        """End the idle processes."""
        self._pool.close()

    def knows(self, table: DHTable, request: SymbolicRequest) -> bool:
        """Return whether the answer to a request is there already."""
        request = checked(table, request)
        return self._known(_key(table, request), request.time_budget) is not None

    def run(self, table: DHTable, request: SymbolicRequest) -> dict[str, Any]:
        """Return the answer to a request; see :meth:`kinematics.symbolic.writing.Writing.answer`.

        Blocks until the answer is complete, at most for the time budget and a fixed grace.

        Raises:
            InvalidOption: An option is invalid.
            UnknownFrame: There is no such frame.
            SymbolicUnavailable: SymPy is not installed.
            WorkersBusy: No worker was free in time, or it was killed from outside.
            OutOfTime: The time of the whole request is up.
            OutOfMemory: The formulas are too long for the memory that they may take.
        """
        request = checked(table, request)
        if find_spec("sympy") is None:
            raise SymbolicUnavailable
        key = _key(table, request)
        line = self._known(key, request.time_budget) or self._made(table, request, key)
        answer: dict[str, Any] = _with_messages(json.loads(line))
        return answer

    def _made(self, table: DHTable, request: SymbolicRequest, key: bytes) -> str:
        with self._pool.session() as session:
            known = self._known(key, request.time_budget)
            line = known or self._work(session, table, request)
        self._keep(key, line, request.time_budget)
        return line

    def _work(self, session: Session, table: DHTable, request: SymbolicRequest) -> str:
        """Return the last answer of a worker: complete, or up to when it was stopped."""
        limits = Limits(MEMORY, request.time_budget)
        try:
            lines = session.call((table, request), limits, request.time_budget + GRACE_SECONDS)
        except TaskFailed as failed:
            _LOG.error("symbolic worker: %s", failed)
            raise WorkersBusy(say("the symbolic worker failed on this table"), 60.0) from None
        if not lines:
            current().check()  # the time of the whole request is up
            raise WorkersBusy(say("the symbolic worker had no answer in time; ask again"), 1.0)
        return lines[-1].decode()

    def _known(self, key: bytes, budget: float) -> str | None:
        with self._lock:
            line, spent = self._answers.get(key, ("", 0.0))
            if not line or spent < budget:
                return None
            self._answers.move_to_end(key)
            return line

    def _keep(self, key: bytes, line: str, budget: float) -> None:
        """Keep an answer; one that is simplified throughout serves any time budget."""
        complete = all(json.loads(line)["simplified"].values())
        with self._lock:
            self._answers[key] = line, math.inf if complete else budget
            size = sum(len(text) for text, _ in self._answers.values())
            while size > CACHE_CHARACTERS and len(self._answers) > 1:
                size -= len(self._answers.popitem(last=False)[1][0])


def _with_messages(value: Any) -> Any:
    """Return an answer with its sentences as messages again."""
    if isinstance(value, list):
        return [_with_messages(inner) for inner in value]
    if not isinstance(value, dict):
        return value
    if value.keys() == {"said"}:
        return from_data(value["said"])
    return {name: _with_messages(inner) for name, inner in value.items()}


def _key(table: DHTable, request: SymbolicRequest) -> bytes:
    rows = [(*_geometry(row), row.name) for row in table.rows]
    content = (table.convention, rows, table.base.tolist(), table.tool.tolist())
    options = {**vars(request), "time_budget": None}
    return hashlib.sha256(repr((content, sorted(options.items()))).encode()).digest()


def _geometry(row: Any) -> tuple[Any, ...]:
    columns = ("type", "alpha", "a", "d", "theta", "offset", "sign", "gamma", "b", "parent")
    return tuple(getattr(row, column) for column in columns)
