"""A service that is told to stop: what is in flight ends well, nothing is left behind."""

import json
import os
import signal
import time

import httpx
import pytest
from in_flight import gone, stream, symbolic, symbolic_processes


def told(asked):
    """Whether a client was told to ask again."""
    answer = asked.answer
    assert answer.headers["retry-after"] == "1"
    return answer.status_code == 503 and answer.json()["type"] == "/problems/stopping"


def refused(address):
    try:
        httpx.get(f"{address}/health/live", timeout=2)
    except httpx.ConnectError:
        return True
    except httpx.HTTPError:
        pass
    return False


@pytest.mark.parametrize("workers", ["1", "2"])
def test_requests_in_flight_end_and_new_ones_are_refused(
    tmp_path, start_server, children, wait_for, workers
):
    with start_server(tmp_path, "--workers", workers) as (address, process):
        httpx.post(f"{address}/v1/robots/planar_2r/symbolic", json={})  # leaves an idle process
        slow, lines = symbolic(address, 8), stream(address, 1000)
        wait_for(lambda: lines.lines and symbolic_processes(children, process.pid))
        below = [*symbolic_processes(children, process.pid), *children(process.pid)]
        process.send_signal(signal.SIGTERM)
        wait_for(lambda: refused(address), 20)
        assert process.poll() is None
        assert process.wait(60) == 0
        slow.join(5)
        lines.join(5)
        assert slow.answer.status_code == 200
        assert lines.error is None
        assert [line["index"] for line in lines.lines] == [*range(1000)]
        wait_for(lambda: all(gone(pid) for pid in below), 10)


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_second_signal_stops_at_once(tmp_path, start_server, children, wait_for, workers):
    with start_server(tmp_path, "--workers", workers) as (address, process):
        slow, lines = symbolic(address, 30), stream(address, 10_000)
        wait_for(lambda: lines.lines and symbolic_processes(children, process.pid))
        below = [*symbolic_processes(children, process.pid), *children(process.pid)]
        process.send_signal(signal.SIGTERM)
        wait_for(lambda: refused(address), 20)
        asked = time.monotonic()
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0
        assert time.monotonic() - asked < 10
        for one in (slow, lines):
            one.join(5)
        assert told(slow)
        assert isinstance(lines.error, httpx.RemoteProtocolError | httpx.ReadError)
        wait_for(lambda: all(gone(pid) for pid in below), 10)


@pytest.mark.parametrize("workers", ["1", "2"])
def test_the_time_to_stop_is_bounded(tmp_path, start_server, monkeypatch, wait_for, workers):
    monkeypatch.setenv("DENAVIT_SHUTDOWN_SECONDS", "1")
    monkeypatch.setenv("DENAVIT_DRAIN_SECONDS", "3")
    path = tmp_path / "log"
    with path.open("wb") as stderr:
        options = ("--workers", workers, "--log-level", "info")
        with start_server(tmp_path / "data", *options, stderr=stderr) as (address, process):
            lines = stream(address, 10_000)
            wait_for(lambda: lines.lines)
            begun = time.monotonic()
            os.killpg(process.pid, signal.SIGTERM)  # as a terminal or a service manager does
            time.sleep(1)
            # While it drains it serves, and says that it is going.
            answer = httpx.get(f"{address}/health/ready")
            assert answer.status_code == 503
            assert answer.json()["status"] == "stopping"
            assert httpx.get(f"{address}/v1/robots/ur5/fk?q=0,0,0,0,0,0").status_code == 200
            assert process.wait(60) == 0
            assert 3 < time.monotonic() - begun < 20
            lines.join(5)
            assert isinstance(lines.error, httpx.RemoteProtocolError | httpx.ReadError)
            assert [line["index"] for line in lines.lines] == [*range(len(lines.lines))]
    events = [json.loads(line)["event"] for line in path.read_text().splitlines()]
    assert "request cut off" in events
