"""Servers of a test's own, raw sockets, and what a process uses."""

import os
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest


class Server:
    """A running service: its address, and the processor time of all its processes."""

    def __init__(self, address: str, pid: int) -> None:
        self.address = address
        self.pid = pid
        self.port = int(address.rsplit(":", 1)[1])

    def connect(self, timeout: float = 20.0) -> socket.socket:
        return socket.create_connection(("127.0.0.1", self.port), timeout)

    def processor_seconds(self) -> float:
        ticks = sum(sum(_times(pid)) for pid in (self.pid, *_children(self.pid)))
        return ticks / os.sysconf("SC_CLK_TCK")

    def resident_bytes(self) -> int:
        return sum(_resident(pid) for pid in (self.pid, *_children(self.pid)))

    def is_idle(self, within: float) -> bool:
        """Whether it comes to rest: a quarter of a second of hardly any work."""
        deadline = time.monotonic() + within
        while time.monotonic() < deadline:
            before = self.processor_seconds()
            time.sleep(0.25)
            if self.processor_seconds() - before < 0.05:
                return True
        return False

    def is_busy(self, within: float = 10.0) -> bool:
        deadline = time.monotonic() + within
        while time.monotonic() < deadline:
            before = self.processor_seconds()
            time.sleep(0.25)
            if self.processor_seconds() - before > 0.05:
                return True
        return False


def _stat(pid: int) -> list[str]:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return []


def _times(pid: int) -> tuple[int, int]:
    fields = _stat(pid)
    return (int(fields[11]), int(fields[12])) if fields else (0, 0)


def _resident(pid: int) -> int:
    fields = _stat(pid)
    return int(fields[21]) * os.sysconf("SC_PAGE_SIZE") if fields else 0


def _children(pid: int) -> list[int]:
    every = [int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdigit()]
    found = [one for one in every if (fields := _stat(one)) and int(fields[1]) == pid]
    return [*found, *(inner for one in found for inner in _children(one))]


@pytest.fixture
def serve(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, start_server
) -> Callable[..., AbstractContextManager[Server]]:
    """Starts a server with settings, given as environment variables without their prefix."""

    @contextmanager
    def started(*arguments: str, **settings: object) -> Iterator[Server]:
        with monkeypatch.context() as environment:
            for name, value in settings.items():
                environment.setenv(f"DENAVIT_{name.upper()}", str(value))
            with start_server(tmp_path / "data", *arguments) as (address, process):
                yield Server(address, process.pid)

    return started


@pytest.fixture(scope="module")
def start_server_for_module(running_servers) -> Callable[..., AbstractContextManager[Server]]:
    """As ``serve``, for a server that the tests of a module share."""

    @contextmanager
    def started(data: Path, **settings: object) -> Iterator[Server]:
        with pytest.MonkeyPatch.context() as environment:
            for name, value in settings.items():
                environment.setenv(f"DENAVIT_{name.upper()}", str(value))
            with running_servers(data) as (address, process):
                yield Server(address, process.pid)

    return started
