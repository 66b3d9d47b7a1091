"""What all tests share: reference data and a real server."""

import json
import os
import random
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

import httpx
import pytest
from hypothesis import HealthCheck, settings

TESTS = Path(__file__).parent
FIXTURES = TESTS / "fixtures"
SCRIPTS = Path(sys.executable).parent
DENAVIT = (str(SCRIPTS / "denavit"),)
LIBRARIES = ("dh_to_urdf", "robots", "kinematics")
"""Folders whose tests are in the first tier, but for the slow ones."""
LONG = ("test_schemathesis", "test_soak")
"""Modules whose tests take longest: they begin, so that no worker is left with one at the end."""
PATIENCE = 600.0
"""Seconds after which a test gives up. What it waits for comes in much less, on any machine."""


# The same cases in every run; `--hypothesis-profile=exploring` looks for others.
ANY_MACHINE = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow]}
settings.register_profile("exploring", **ANY_MACHINE)
settings.register_profile("repeatable", **ANY_MACHINE, derandomize=True, database=None)
settings.load_profile("repeatable")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks the first tier, what ``make test`` runs, and has long tests begin."""
    for item in items:
        in_libraries = item.path.relative_to(TESTS).parts[0] in LIBRARIES
        if item.get_closest_marker("scene") or (
            in_libraries and not item.get_closest_marker("slow")
        ):
            item.add_marker("first")
    items.sort(key=lambda item: item.path.stem not in LONG)


def until(condition: Callable[[], object]) -> None:
    """Waits for a condition."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.05)


def unused_port() -> int:
    """A port on which nobody listens, of those that clients are not given either."""
    while True:
        port = random.SystemRandom().randrange(10_000, 30_000)
        with socket.socket() as probe, suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port


@contextmanager
def running_server(
    data_dir: Path,
    *arguments: str,
    stderr: IO[bytes] | None = None,
    program: Sequence[str] = DENAVIT,
) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """A ``denavit serve`` of its own; gives its address and process."""
    port = unused_port()
    command = [*program, "serve", "--port", str(port), "--log-level", "warning"]
    process = subprocess.Popen(
        [*command, "--data-dir", str(data_dir), *arguments],
        env={
            "DENAVIT_PRELOAD": "false",
            "DENAVIT_ALLOWED_HOSTS": "*",
            **os.environ,
            "PYTHONWARNINGS": "default",
        },
        start_new_session=True,
        stderr=stderr,
    )
    address = f"http://127.0.0.1:{port}"

    def answers() -> bool:
        assert process.poll() is None, "the server stopped while starting"
        try:
            return httpx.get(f"{address}/health/ready").status_code == 200
        except httpx.TransportError:
            return False

    try:
        until(answers)
        yield address, process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGTERM)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


@pytest.fixture(scope="session")
def shared_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, int]]:
    """The server that tests share: its address, and the number of its process."""
    with running_server(tmp_path_factory.mktemp("data")) as (address, process):
        yield address, process.pid


@pytest.fixture(scope="session")
def server(shared_service: tuple[str, int]) -> str:
    return shared_service[0]


@pytest.fixture(scope="session")
def client(server: str) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=server, timeout=PATIENCE) as shared:
        yield shared


@pytest.fixture
def free_port() -> int:
    return unused_port()


@pytest.fixture
def start_server():
    """The context manager that starts a server of a test's own."""
    return running_server


@pytest.fixture
def wait_for():
    """A function that waits until a condition holds."""
    return until


@pytest.fixture(scope="session")
def exercises() -> dict:
    return json.loads((FIXTURES / "exercises.json").read_text())


@pytest.fixture(scope="session")
def oracle_documents() -> list[tuple[dict, dict]]:
    """The reference robots: each with its table as a document of the API."""
    robots = json.loads((FIXTURES / "rtb_oracle.json").read_text())["robots"]
    return [(robot, document_of(robot)) for robot in robots]


def document_of(robot: dict) -> dict:
    joints = []
    for joint in robot["joints"]:
        row = {key: joint[key] for key in ("type", "alpha", "a", "d", "theta", "offset")}
        row["sign"] = -1 if joint["flip"] else 1
        if joint["qlim"]:
            row["limits"] = {"lower": joint["qlim"][0], "upper": joint["qlim"][1]}
        joints.append(row)
    return {
        "name": f"oracle-{robot['name']}",
        "convention": robot["convention"],
        "base": {"matrix": robot["base"]},
        "tool": {"matrix": robot["tool"]},
        "joints": joints,
    }
