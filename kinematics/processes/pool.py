"""A bounded number of processes for one kind of work."""

from __future__ import annotations

import pickle
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from dh_to_urdf.messages import say
from kinematics.deadline import checkpoint, current
from kinematics.errors import OutOfMemory, WorkersBusy
from kinematics.processes.process import LOOK, Process
from kinematics.processes.protocol import Limits

PATIENCE = 10.0
"""Longest wait for a process, s."""
TASKS = 100
"""Number of tasks after which a process is replaced, as libraries accumulate memory."""
ATTEMPTS = 2
"""Number of processes that a task is given to, if they die."""


class TaskFailed(Exception):
    """A task ended with an error in its process; the text is the traceback."""


class ProcessPool:
    """Processes for one kind of work.

    One that has finished its task waits for the next; it ends when its standard input closes, so
    with this process at the latest.

    Args:
        module: Name of the module that does the work; see :mod:`kinematics.processes`.
        processes: How many work at a time.
        waiting: How many callers besides wait for one; more are refused at once.
        idle: How many idle ones are kept.
    """

    def __init__(
        self, module: str, processes: int = 1, waiting: int = 0, idle: int | None = None
    ) -> None:
        self._module = module
        self._slots = threading.BoundedSemaphore(processes)
        self._places = threading.BoundedSemaphore(processes + waiting)
        self._most_idle = processes if idle is None else idle
        self._lock = threading.Lock()
        self._idle: list[Process] = []

    def close(self) -> None:
        """End the idle processes."""
        with self._lock:
            idle, self._idle = self._idle, []
        for process in idle:
            process.end()

    @contextmanager
    def session(self) -> Iterator[Session]:
        """Wait for a place, and hold it with a process of one's own.

        Raises:
            WorkersBusy: Too many wait already, or no place was free in time.
            Cancelled: The result is no longer wanted.
        """
        busy = WorkersBusy(say("all processes for this work are busy; ask again"), 5.0)
        if not self._places.acquire(blocking=False):
            raise busy
        try:
            until = time.monotonic() + PATIENCE
            while not self._slots.acquire(timeout=LOOK):
                checkpoint()
                if time.monotonic() > until:
                    raise busy
            try:
                session = Session(self)
                try:
                    yield session
                finally:
                    session.end()
            finally:
                self._slots.release()
        finally:
            self._places.release()

    def take(self) -> Process:
        """Return an idle process, or a new one."""
        while True:
            with self._lock:
                if not self._idle:
                    return Process(self._module)
                process = self._idle.pop()
            if process.is_alive():
                return process
            process.end()

    def give_back(self, process: Process) -> None:
        """Keep a process that has finished its tasks, or end it: never with one begun."""
        if process.tasks < TASKS:
            with self._lock:
                if len(self._idle) < self._most_idle:
                    self._idle.append(process)
                    return
        process.end()


class Session:
    """One caller's stay with a pool, and its process."""

    def __init__(self, pool: ProcessPool) -> None:
        self._pool = pool
        self._process: Process | None = None

    def start(self) -> None:
        """Have a process start, beside what the caller does before its first task."""
        if self._process is None:
            self._process = self._pool.take()

    def call(self, task: Any, limits: Limits, seconds: float) -> list[bytes]:
        """Return the answers to a task: complete, or as far as they came in time.

        A task whose process died before it had an answer is given to one other process.

        Args:
            task: What the module takes; it is pickled.
            limits: What the task may take.
            seconds: Longest wait, s; also bounded by the current deadline.

        Raises:
            OutOfMemory: The task needs more memory than it may take.
            TaskFailed: It ended with an error.
            WorkersBusy: Its processes died.
            Cancelled: The result is no longer wanted.
        """
        content = pickle.dumps((limits, task))
        deadline = time.monotonic() + min(seconds, current().left)
        for _ in range(ATTEMPTS):
            self.start()
            assert self._process is not None
            finished = False
            try:
                outcome = self._process.outcome(content, deadline)
                finished = outcome.finished
            finally:
                if not finished:
                    self._drop()
            if outcome.out_of_memory and not outcome.answers:
                raise OutOfMemory(limits.memory)
            if outcome.failure:
                raise TaskFailed(outcome.failure)
            if outcome.answers or finished or time.monotonic() > deadline:
                return outcome.answers
            checkpoint()
        raise WorkersBusy(say("the process was stopped before it had an answer; ask again"), 1.0)

    def end(self) -> None:
        """Give the process back."""
        if self._process is not None:
            self._pool.give_back(self._process)
            self._process = None

    def retire(self) -> None:
        """End the process: what it holds of finished tasks is of no use."""
        self._drop()

    def _drop(self) -> None:
        if self._process is not None:
            self._process.end()
            self._process = None
