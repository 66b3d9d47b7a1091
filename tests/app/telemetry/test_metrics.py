"""/metrics: true counts, by one worker or several, with templates for routes."""

import asyncio
import os
import signal
import socket
from contextlib import ExitStack, contextmanager

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

from app.telemetry.metrics import BUCKETS, PENDING_SECONDS, Metrics
from tests.conftest import PATIENCE, until
from tests.processes import workers_of
from tests.scenes import one_scene

FK = "/v1/robots/{robot_id}/fk"


@pytest.fixture(params=one_scene(["1", "2"]))
def service(request, tmp_path, start_server):
    with start_server(tmp_path, "--workers", request.param) as (address, process):
        yield address, process, int(request.param)


def scraped(address):
    """Values by name and labels."""
    answer = httpx.get(f"{address}/metrics", timeout=PATIENCE)
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/plain")
    return {
        (sample.name, *sorted(sample.labels.items())): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }


def counted(samples, route, method="GET", kind="2xx"):
    labels = (("method", method), ("route", route), ("status_class", kind))
    return samples.get(("denavit_http_requests_total", *labels), 0)


def of_route(samples, name, route, method="GET"):
    return samples[(f"denavit_http_{name}", ("method", method), ("route", route))]


def test_counts_are_exact_and_routes_are_templates(service):
    address, _, workers = service
    size = 0
    for k in range(40):  # each on a connection of its own, so that all workers get some
        size += len(
            httpx.get(
                f"{address}/v1/robots/puma560/fk?q=0,0,0,0,0,{k % 2}", timeout=PATIENCE
            ).content
        )
        httpx.get(f"{address}/secret-{k}", timeout=PATIENCE)
        httpx.get(f"{address}/v1/robots/none-{k}", timeout=PATIENCE)
    httpx.post(f"{address}/v1/fk", json={}, timeout=PATIENCE)
    httpx.get(f"{address}/v1/fk", timeout=PATIENCE)
    httpx.get(f"{address}/docs-assets/swagger-ui.css", timeout=PATIENCE)
    httpx.request("PROPFIND", f"{address}/v1/robots", timeout=PATIENCE)
    httpx.put(f"{address}/v1/robots/mine", json=ARM, timeout=PATIENCE).raise_for_status()

    samples = scraped(address)
    assert counted(samples, FK) == 40
    assert counted(samples, "unmatched", kind="4xx") == 40
    assert counted(samples, "/v1/robots/{robot_id}", kind="4xx") == 40
    assert counted(samples, "/v1/fk", "POST", "4xx") == 1
    assert counted(samples, "/v1/fk", "GET", "4xx") == 1
    assert counted(samples, "/docs-assets/{path}") == 1
    assert counted(samples, "/v1/robots", "other", "4xx") == 1
    assert not [key for key in samples if "secret" in str(key) or "none-" in str(key)]
    assert of_route(samples, "request_duration_seconds_count", FK) == 40
    assert of_route(samples, "request_duration_seconds_sum", FK) > 0
    assert of_route(samples, "response_bytes_total", FK) == size
    assert samples[("denavit_http_requests_in_progress",)] == 1  # the scrape itself
    assert samples[("denavit_robots",)] == 1
    alive = workers_that_tell(address)
    assert len(alive) == workers
    assert all(samples[key] > 1e7 for key in alive)
    assert samples[("denavit_build_info", ("version", "0.1.0"))] == 1


ARM = {"convention": "standard", "joints": [{"type": "R", "a": 1, "alpha": 0, "d": 0}]}


def test_a_killed_worker_leaves_its_counts_and_nothing_else(tmp_path, start_server, monkeypatch):
    monkeypatch.setenv("DENAVIT_BODY_SECONDS", str(PATIENCE))
    with start_server(tmp_path, "--workers", "2") as (address, process):
        until(lambda: len(workers_that_tell(address)) == 2)
        for _ in range(30):
            httpx.get(f"{address}/v1/robots/puma560/fk?q=0,0,0,0,0,0", timeout=PATIENCE)
        doomed, other = workers_of(process.pid)
        # In progress when a worker dies: bodies that do not come, eight for each worker.
        with ExitStack() as halves:
            with stopped(doomed):
                kept = [halves.enter_context(half_a_request(address)) for _ in range(8)]
                until(lambda: in_progress(address) == 9)
            with stopped(other):
                lost = [halves.enter_context(half_a_request(address)) for _ in range(8)]
                until(lambda: in_progress(address) == 17)
            os.kill(doomed, signal.SIGKILL)
            until(lambda: len(set(workers_of(process.pid)) - {doomed}) == 2)
            until(lambda: in_progress(address) == 9)
            assert not any(has_gone(half) for half in kept)
            assert all(has_gone(half) for half in lost)
        until(lambda: in_progress(address) == 1)
        samples = scraped(address)
        assert counted(samples, FK) == 30


@contextmanager
def stopped(pid):
    """Meanwhile the process neither runs nor dies: what is asked, others answer."""
    os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(pid, signal.SIGCONT)


def half_a_request(address):
    host, port = address.removeprefix("http://").split(":")
    connection = socket.create_connection((host, int(port)))
    connection.sendall(
        b"POST /v1/robots/puma560/fk HTTP/1.1\r\nHost: x\r\n"
        b"Content-Type: application/json\r\nContent-Length: 100\r\n\r\n"
    )
    return connection


def workers_that_tell(address):
    return [key for key in scraped(address) if key[0] == "denavit_worker_resident_memory_bytes"]


def in_progress(address):
    return scraped(address)[("denavit_http_requests_in_progress",)]


def has_gone(connection):
    """Whether the other end has."""
    connection.settimeout(0.2)
    try:
        return connection.recv(1) == b""
    except TimeoutError:
        return False
    except ConnectionResetError:
        return True


def test_metrics_can_be_switched_off(tmp_path, start_server, monkeypatch):
    monkeypatch.setenv("DENAVIT_METRICS", "false")
    with start_server(tmp_path) as (address, _):
        assert httpx.get(f"{address}/metrics", timeout=PATIENCE).status_code == 404


def test_requests_that_are_gathered_count_as_those_that_are_counted_singly():
    seconds = [0.0, 1e-5, BUCKETS[0], BUCKETS[3], BUCKETS[3] * 1.01, BUCKETS[-1], 100.0]
    requests = [("POST", FK, status, one, 7) for one in seconds for status in (200, 404)]
    requests.append(("BREW", FK, 405, 0.5, 0))

    async def gathered(metrics):
        for request in requests[:5]:
            metrics.count_soon(*request)
        metrics.write_pending()
        for request in requests[5:]:
            metrics.count_soon(*request)
        await asyncio.sleep(3 * PENDING_SECONDS)

    singly, together = Metrics(), Metrics()
    for request in requests:
        singly.count(*request)
    asyncio.run(gathered(together))
    assert told(together) == told(singly)


def told(metrics):
    text = metrics.exposition(lambda: 0).decode()
    return {
        (sample.name, *sorted(sample.labels.items())): round(sample.value, 12)
        for family in text_string_to_metric_families(text)
        for sample in family.samples
        if family.name.startswith("denavit_http") and not sample.name.endswith("_created")
    }
