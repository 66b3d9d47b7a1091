"""Keeps so many workers alive, and ends with them."""

from __future__ import annotations

import logging
import multiprocessing
import multiprocessing.connection
import os
import signal
import socket
import tempfile
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from types import FrameType

from app.access.shared_counters import create_counters
from app.serving.worker import BEAT_SECONDS, HANGUP, SERVING, WorkerTask, work
from app.settings import Settings
from app.telemetry.metrics import forget_worker
from app.telemetry.processes import cpu_seconds, is_stopped, pid_file

LOG = logging.getLogger("denavit.serving")
HOPELESS_SECONDS = 60.0
"""After so long in which no worker serves and starts fail, the service gives up."""
STOPPED_SECONDS = 7.0
"""A worker that a signal has stopped for so long is replaced: requests wait for it."""
BUSY_SECONDS = 8.0
"""A worker that has worked for so long and said nothing is stuck, and is replaced. What counts is
its processor time: on a machine that has none to give, silence means nothing."""
SILENT_SECONDS = 60.0
STARTING_SECONDS = 600.0
"""A worker that is silent for so long is replaced in any case."""
LONGEST_PAUSE = 30.0
MARGIN_SECONDS = 3.0
"""How much longer than its own time to stop a worker may take."""


@dataclass
class _Worker:
    slot: int
    process: SpawnProcess
    connection: Connection
    heard: float
    cpu: float = 0.0
    serving: bool = False
    stopped: float | None = None

    @property
    def stuck(self) -> bool:
        """Whether it is alive only in name."""
        now = time.monotonic()
        silent = now - self.heard
        if silent < 2 * BEAT_SECONDS:
            self.stopped = None
            return False
        if is_stopped(self.process.pid):
            self.stopped = self.stopped or now
            return now - self.stopped > STOPPED_SECONDS - 2 * BEAT_SECONDS
        self.stopped = None
        if silent > (SILENT_SECONDS if self.serving else STARTING_SECONDS):
            return True
        return self.serving and cpu_seconds(self.process.pid) - self.cpu > BUSY_SECONDS


class Supervisor:
    """The parent of the workers.

    A worker that dies is replaced at once; one that dies before it serves, after a pause that
    doubles. Where nothing serves for a minute and starts fail, the service ends with status 1.
    """

    def __init__(self, settings: Settings, sockets: list[socket.socket]) -> None:
        self._settings = settings
        self._sockets = sockets
        self._workers: dict[int, _Worker] = {}
        self._due: dict[int, float] = {}
        self._failed_starts = 0
        self._served = time.monotonic()
        self._signals: list[signal.Signals] = []
        self._counters: Path | None = None
        self._context = multiprocessing.get_context("spawn")

    def run(self) -> int:
        """Serves until a signal comes.

        Returns:
            Exit status: 0 after a signal, 1 where the workers do not start.
        """
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._signalled)
        if HANGUP is not None:
            signal.signal(HANGUP, lambda number, _: self._send(signal.Signals(number)))
        with tempfile.TemporaryDirectory(prefix="denavit-metrics-") as name:
            directory = Path(name)
            if self._settings.rate_limit.strip():
                self._counters = directory / "rates"
                create_counters(self._counters)
            self._due = dict.fromkeys(range(self._settings.workers), 0.0)
            try:
                while not self._signals:
                    self._start_due(directory)
                    self._listen(0.5)
                    self._bury(directory)
                    if self._is_hopeless():
                        LOG.critical(
                            "no worker has served for %.0f s, %d starts have failed: giving up;"
                            " the lines above say why",
                            HOPELESS_SECONDS,
                            self._failed_starts,
                        )
                        return 1
            finally:
                self._stop()
        return 0

    def _signalled(self, number: int, frame: FrameType | None) -> None:  # noqa: ARG002
        self._signals.append(signal.Signals(number))

    def _is_hopeless(self) -> bool:
        """Return whether workers cannot be brought up; one that still starts may be."""
        now = time.monotonic()
        if any(worker.serving for worker in self._workers.values()):
            self._served, self._failed_starts = now, 0
        return not self._workers and now - self._served > HOPELESS_SECONDS

    def _start_due(self, directory: Path) -> None:
        now = time.monotonic()
        for slot in [slot for slot, moment in self._due.items() if moment <= now]:
            del self._due[slot]
            ours, theirs = self._context.Pipe()
            task = WorkerTask(slot, self._settings, self._sockets, directory, self._counters)
            name = f"denavit-worker-{slot}"
            process = self._context.Process(target=work, args=(task, theirs), name=name)
            process.start()
            theirs.close()
            pid_file(directory, slot).write_text(str(process.pid))
            self._workers[slot] = _Worker(slot, process, ours, time.monotonic())
            LOG.info("worker %d starts, process %d", slot, process.pid)

    def _listen(self, seconds: float) -> None:
        """Waits until a worker says something or dies, at most for some seconds."""
        sources: dict[object, _Worker] = {}
        for worker in self._workers.values():
            sources[worker.process.sentinel] = worker
            if not worker.connection.closed:
                sources[worker.connection] = worker
        ready = multiprocessing.connection.wait(list(sources), seconds)  # type: ignore[arg-type]
        for source in ready:
            if isinstance(source, Connection):
                self._hear(sources[source])
        if not sources:
            time.sleep(seconds)

    def _hear(self, worker: _Worker) -> None:
        try:
            said = worker.connection.recv_bytes()
        except (OSError, EOFError):
            worker.connection.close()
            return
        worker.heard, worker.cpu = time.monotonic(), cpu_seconds(worker.process.pid)
        if said == SERVING and not worker.serving:
            worker.serving = True

    def _bury(self, directory: Path) -> None:
        """Puts down the stuck, and lets each of the dead be replaced."""
        for worker in list(self._workers.values()):
            process = worker.process
            if process.is_alive() and worker.stuck:
                silent = time.monotonic() - worker.heard
                state = "stopped by a signal" if worker.stopped else "stuck"
                LOG.error("worker %d is %s, silent for %.0f s: killed", worker.slot, state, silent)
                process.kill()
                process.join()
            if process.is_alive():
                continue
            process.join()
            worker.connection.close()
            del self._workers[worker.slot]
            forget_worker(directory, worker.slot)
            LOG.error("worker %d died: %s", worker.slot, _cause(process.exitcode))
            pause = 0.0
            if not worker.serving:
                pause = min(0.5 * 2 ** min(self._failed_starts, 10), LONGEST_PAUSE)
                self._failed_starts += 1
            self._due[worker.slot] = time.monotonic() + pause

    def _stop(self) -> None:
        """Ends all workers: in good order, at once on a further signal, by force if need be."""
        # The kernel listens until the last process lets go.
        for one in self._sockets:
            one.close()
        if not self._workers:
            return
        names = f"{self._signals[0].name}: " if self._signals else ""
        LOG.info("%sstopping; a second signal stops at once", names)
        signals = len(self._signals)
        self._send(signal.SIGTERM)
        patience = self._settings.drain_seconds + self._settings.shutdown_seconds + MARGIN_SECONDS
        if not self._ended_within(patience, signals):
            self._send(signal.SIGQUIT)
            self._ended_within(MARGIN_SECONDS, None)
        for worker in self._workers.values():
            if worker.process.is_alive():
                LOG.error("worker %d does not stop: killed", worker.slot)
                worker.process.kill()
            worker.process.join()
            worker.connection.close()
        LOG.info("stopped")

    def _send(self, number: signal.Signals) -> None:
        for worker in self._workers.values():
            if worker.process.is_alive() and worker.process.pid is not None:
                os.kill(worker.process.pid, number)

    def _ended_within(self, seconds: float, signals: int | None) -> bool:
        """Whether all workers end in time, and before there are more signals than given."""
        deadline = time.monotonic() + seconds
        while any(worker.process.is_alive() for worker in self._workers.values()):
            if time.monotonic() > deadline or (
                signals is not None and len(self._signals) > signals
            ):
                return False
            time.sleep(0.05)
        return True


def _cause(exitcode: int | None) -> str:
    if exitcode is not None and exitcode < 0:
        return f"killed by {signal.Signals(-exitcode).name}"
    return f"exit status {exitcode}"
