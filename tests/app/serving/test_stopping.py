"""A service that is told to stop: what is in flight ends well, nothing is left behind."""

import json
import os
import signal
import time

import httpx
import pytest

from tests.app.conftest import served
from tests.app.serving.in_flight import Asked, stream, symbolic
from tests.conftest import PATIENCE, until
from tests.processes import children_of, has_ended, symbolic_processes
from tests.scenes import one_scene


def told(asked: Asked) -> bool:
    """Whether a client was told to ask again."""
    answer = asked.answer
    assert answer.headers["retry-after"] == "1"
    return answer.status_code == 503 and answer.json()["type"] == "/problems/stopping"


def refused(address: str) -> bool:
    try:
        httpx.get(f"{address}/health/live", timeout=2)
    except httpx.ConnectError:
        return True
    except httpx.HTTPError:
        pass
    return False


@pytest.mark.parametrize("workers", one_scene(["1", "2"]))
def test_requests_in_flight_end_and_new_ones_are_refused(tmp_path, workers):
    with served(tmp_path, "--workers", workers, shutdown_seconds=PATIENCE) as server:
        address = server.address
        httpx.post(
            f"{address}/v1/robots/planar_2r/symbolic", json={}, timeout=PATIENCE
        )  # leaves an idle process
        slow, lines = symbolic(address, 8), stream(address)
        until(lambda: lines.lines and symbolic_processes(server.pid))
        below = [*symbolic_processes(server.pid), *children_of(server.pid)]
        server.process.send_signal(signal.SIGTERM)
        until(lambda: refused(address))
        assert server.process.poll() is None
        server.open_gate()
        assert server.process.wait(PATIENCE) == 0
        slow.join(PATIENCE)
        lines.join(PATIENCE)
        assert slow.answer.status_code == 200
        assert lines.error is None
        count = len(lines.lines) - 1
        assert lines.lines == [*({"index": k} for k in range(count)), {"last": count}]
        until(lambda: all(map(has_ended, below)))


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_second_signal_stops_at_once(tmp_path, workers):
    """Neither what is in flight nor the time that it has is waited for."""
    with served(tmp_path, "--workers", workers, shutdown_seconds=10 * PATIENCE) as server:
        address, process = server.address, server.process
        slow, lines = symbolic(address, 30), stream(address)
        until(lambda: lines.lines and symbolic_processes(server.pid))
        below = [*symbolic_processes(server.pid), *children_of(server.pid)]
        process.send_signal(signal.SIGTERM)
        until(lambda: refused(address))
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0
        for one in (slow, lines):
            one.join(PATIENCE)
        assert told(slow)
        assert isinstance(lines.error, httpx.RemoteProtocolError | httpx.ReadError)
        until(lambda: all(map(has_ended, below)))


@pytest.mark.parametrize("workers", ["1", "2"])
def test_the_time_to_stop_is_bounded(tmp_path, workers):
    drain = 8.0
    path = tmp_path / "log"
    with path.open("wb") as stderr:
        options = ("--workers", workers, "--log-level", "info")
        limits = {"shutdown_seconds": 1, "drain_seconds": drain}
        with served(tmp_path, *options, stderr=stderr, **limits) as server:
            address, process = server.address, server.process
            lines = stream(address)
            until(lambda: lines.lines)
            begun = time.monotonic()
            os.killpg(process.pid, signal.SIGTERM)  # as a terminal or a service manager does
            # While it drains it serves, and says that it is going.
            until(lambda: httpx.get(f"{address}/health/ready", timeout=PATIENCE).status_code == 503)
            assert (
                httpx.get(f"{address}/health/ready", timeout=PATIENCE).json()["status"]
                == "stopping"
            )
            assert (
                httpx.get(f"{address}/v1/robots/ur5/fk?q=0,0,0,0,0,0", timeout=PATIENCE).status_code
                == 200
            )
            assert process.wait(PATIENCE) == 0
            assert time.monotonic() - begun > drain
            lines.join(PATIENCE)
            assert isinstance(lines.error, httpx.RemoteProtocolError | httpx.ReadError)
            assert lines.lines == [{"index": k} for k in range(len(lines.lines))]
    events = [json.loads(line)["event"] for line in path.read_text().splitlines()]
    assert "request cut off" in events
