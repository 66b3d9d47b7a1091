"""A worker process: a server whose life is watched by a supervisor."""

from __future__ import annotations

import os
import signal
import socket
import threading
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType

from app.settings import Settings
from app.telemetry.logs import log_to_stderr
from app.telemetry.metrics import share_values

BEAT_SECONDS = 1.0
STARTING, SERVING = b"starting", b"serving"
HANGUP: signal.Signals | None = getattr(signal, "SIGHUP", None)
"""Asks a service to read its keys again; Windows has no such signal."""


@dataclass(frozen=True)
class WorkerTask:
    """What a worker needs to know.

    Attributes:
        slot: Its number.
        settings: The service's settings.
        sockets: What it accepts from.
        directory: Where it counts.
        counters: Where all workers count the requests of a client, if there is a rate limit.
    """

    slot: int
    settings: Settings
    sockets: list[socket.socket]
    directory: Path
    counters: Path | None = None


def work(task: WorkerTask, connection: Connection) -> None:
    """Serves until the supervisor, or its end, says otherwise."""
    # A Ctrl-C reaches every process of the terminal: what it means is the supervisor's decision.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if HANGUP is not None:
        signal.signal(HANGUP, signal.SIG_IGN)
    log_to_stderr(task.settings)
    share_values(task.directory, task.slot)
    state = _State()
    patience = task.settings.drain_seconds + task.settings.shutdown_seconds
    beat = threading.Thread(target=_beat, args=(connection, state, patience), daemon=True)
    beat.start()

    from app.serving.server import Server, leave, run_server

    class Worker(Server):
        """Tells the supervisor when it serves, and leaves Ctrl-C to it."""

        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            state.serving = self.started

        def handle_exit(self, sig: int, frame: FrameType | None) -> None:
            if sig == signal.SIGQUIT or (sig == signal.SIGTERM and not self.should_exit):
                super().handle_exit(sig, frame)

    leave(run_server(task.settings, task.sockets, Worker, task.counters))


class _State:
    serving = False


def _beat(connection: Connection, state: _State, patience: float) -> None:
    """Tells the supervisor each second how it is; stops this process when that one is gone."""
    try:
        while not connection.poll(BEAT_SECONDS):
            connection.send_bytes(SERVING if state.serving else STARTING)
    except OSError:
        pass
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(patience + BEAT_SECONDS)
    os._exit(1)
