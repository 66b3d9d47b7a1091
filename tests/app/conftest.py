"""Servers with settings of a test's own, and what their processes do."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from functools import partial
from pathlib import Path
from typing import IO, TypeAlias

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

from tests.app import long_work
from tests.conftest import DENAVIT, PATIENCE, running_server, until
from tests.processes import is_at_rest, processor_seconds

WITH_LONG_WORK = (sys.executable, "-m", "tests.app.long_work")


class Server:
    """A running service.

    Attributes:
        address: Where it answers.
        process: Its first process.
        pid: That process's number.
        port: The port of its address.
        gate: The file that ends what is endless.
    """

    def __init__(self, address: str, process: subprocess.Popen[bytes], gate: Path) -> None:
        self.address = address
        self.process = process
        self.pid = process.pid
        self.port = int(address.rsplit(":", 1)[1])
        self.gate = gate

    def connect(self, timeout: float = PATIENCE) -> socket.socket:
        return socket.create_connection(("127.0.0.1", self.port), timeout)

    def processor_seconds(self) -> float:
        """Processor time that all its processes have used."""
        return processor_seconds(self.pid)

    def works_for(self, seconds: float) -> None:
        """Waits until it has used so much processor time."""
        end = self.processor_seconds() + seconds
        until(lambda: self.processor_seconds() > end)

    def comes_to_rest(self) -> None:
        """Waits until nothing is computed any more."""
        until(lambda: is_at_rest(self.pid))

    def in_progress(self) -> int:
        """Requests that have come and are not answered, without the one that asks."""
        return int(self.counted("denavit_http_requests_in_progress")) - 1

    def counted(self, name: str, **labels: str) -> float:
        """The sum of a metric over all samples that have these labels."""
        answer = httpx.get(f"{self.address}/metrics", timeout=PATIENCE)
        return sum(
            sample.value
            for family in text_string_to_metric_families(answer.text)
            for sample in family.samples
            if sample.name == name and labels.items() <= sample.labels.items()
        )

    def open_gate(self) -> None:
        """Ends what is endless."""
        self.gate.touch()


@contextmanager
def served(
    folder: Path,
    *arguments: str,
    program: Sequence[str] = WITH_LONG_WORK,
    stderr: IO[bytes] | None = None,
    **settings: object,
) -> Iterator[Server]:
    """A service with long work; settings are environment variables without their prefix."""
    gate, data = folder / "gate", folder / "data"
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv(long_work.GATE, str(gate))
        for name, value in settings.items():
            environment.setenv(f"DENAVIT_{name.upper()}", str(value))
        with running_server(data, *arguments, stderr=stderr, program=program) as (address, process):
            yield Server(address, process, gate)


Serve: TypeAlias = Callable[..., AbstractContextManager[Server]]


@pytest.fixture
def serve(tmp_path: Path) -> Serve:
    """Starts a service of a test's own: ``with serve(compute_threads=1) as server``."""
    return partial(served, tmp_path, program=DENAVIT)


@pytest.fixture
def serve_long_work(tmp_path: Path) -> Serve:
    """The same, with the operations of :mod:`tests.app.long_work`."""
    return partial(served, tmp_path)
