"""One server process: it serves until it is told to stop, then ends in good order."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import signal
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import uvicorn

from app.access.keys import KeySource
from app.main import create_app
from app.readiness import Readiness
from app.serving.worker import HANGUP
from app.settings import Settings

LOG = logging.getLogger("denavit.serving")
FAILED_TO_START = 3
"""Exit status of a server that never served."""
IDLE_SECONDS = 0.5
"""Threads with nothing to do end within."""


def server_options(settings: Settings) -> dict[str, Any]:
    """What the service asks of uvicorn."""
    return {
        "log_config": None,
        "access_log": False,
        "server_header": False,
        "http": "app.serving.connections:GuardedProtocol",
        "ws": "none",
        "proxy_headers": bool(settings.trusted_proxies.strip()),
        "forwarded_allow_ips": settings.trusted_proxies.strip() or None,
        "timeout_graceful_shutdown": max(round(settings.shutdown_seconds), 0),
    }


class Server(uvicorn.Server):
    """A server that stops in steps, and reads its keys again on SIGHUP.

    The first signal: it says that it is unready, for ``drain`` seconds still accepts, then refuses
    connections and lets requests in flight end. The second: it goes at once. The process ends with
    status 0 in both cases, not by the signal.
    """

    def __init__(
        self, config: uvicorn.Config, readiness: Readiness, drain: float, keys: KeySource
    ) -> None:
        super().__init__(config)
        self._readiness = readiness
        self._drain = drain
        self._keys = keys
        self._signal: signal.Signals | None = None

    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Takes the signals for the time of serving; none is raised again afterwards."""
        stopping = (signal.SIGTERM, signal.SIGINT, signal.SIGQUIT)
        before: dict[signal.Signals, Any] = {
            number: signal.signal(number, self.handle_exit) for number in stopping
        }
        if HANGUP is not None:
            before[HANGUP] = signal.signal(HANGUP, lambda *_: self._keys.read_again())
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Starts to serve."""
        await super().startup(sockets)
        if self.started:
            LOG.info("serving")

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:  # noqa: ARG002
        """A signal has come."""
        if not self.started:
            logging.shutdown()
            os._exit(0)
        self._signal = signal.Signals(sig)
        if self.should_exit or sig == signal.SIGQUIT:
            self.force_exit = True
        self.should_exit = True
        self._readiness.stop()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Stops serving."""
        if self._signal is not None:
            LOG.info("%s: stopping; a second signal stops at once", self._signal.name)
        left = self._drain
        while left > 0 and not self.force_exit:
            await asyncio.sleep(0.1)
            left -= 0.1
        await super().shutdown(sockets)
        if self.force_exit:  # uvicorn leaves this out
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self.lifespan.shutdown(), 1.0)
        LOG.info("stopped")


def run_server(
    settings: Settings,
    sockets: list[socket.socket],
    server_class: type[Server],
    counters: Path | None = None,
) -> int:
    """Serves until a signal comes.

    Args:
        settings: What a deployment chose.
        sockets: What it accepts from.
        server_class: The server.
        counters: The file in which all workers of the service count requests.

    Returns:
        0, or FAILED_TO_START.
    """
    app = create_app(settings, counters=counters)
    config = uvicorn.Config(app, **server_options(settings))
    server = server_class(config, app.state.readiness, settings.drain_seconds, app.state.keys)
    with contextlib.suppress(SystemExit):  # raised where the application does not start
        server.run(sockets)
    return 0 if server.started else FAILED_TO_START


def leave(status: int) -> None:
    """Ends this process, also where a thread still computes what nobody waits for any more."""
    others = [one for one in threading.enumerate() if one is not threading.main_thread()]
    deadline = time.monotonic() + IDLE_SECONDS
    for one in others:
        one.join(0 if one.daemon else max(deadline - time.monotonic(), 0))
    unfinished = sum(one.is_alive() and not one.daemon for one in others)
    if unfinished:
        LOG.warning("stopped with %d computations unfinished", unfinished)
        logging.shutdown()
        os._exit(status)
    raise SystemExit(status)
