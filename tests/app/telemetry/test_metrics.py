"""/metrics: true counts, by one worker or several, with templates for routes."""

import os
import signal
import socket

import httpx
import pytest
from prometheus_client.parser import text_string_to_metric_families

FK = "/v1/robots/{robot_id}/fk"


@pytest.fixture(params=["1", "2"])
def service(request, tmp_path, start_server):
    with start_server(tmp_path, "--workers", request.param) as (address, process):
        yield address, process, int(request.param)


def scraped(address):
    """Values by name and labels."""
    answer = httpx.get(f"{address}/metrics", timeout=30)
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
        size += len(httpx.get(f"{address}/v1/robots/puma560/fk?q=0,0,0,0,0,{k % 2}").content)
        httpx.get(f"{address}/secret-{k}")
        httpx.get(f"{address}/v1/robots/none-{k}")
    httpx.post(f"{address}/v1/fk", json={})
    httpx.get(f"{address}/v1/fk")
    httpx.get(f"{address}/docs-assets/swagger-ui.css")
    httpx.request("PROPFIND", f"{address}/v1/robots")
    httpx.put(f"{address}/v1/robots/mine", json=ARM).raise_for_status()

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
    assert 0 < of_route(samples, "request_duration_seconds_sum", FK) < 60
    assert of_route(samples, "response_bytes_total", FK) == size
    assert samples[("denavit_http_requests_in_progress",)] == 1  # the scrape itself
    assert samples[("denavit_robots",)] == 1
    alive = [key for key in samples if key[0] == "denavit_worker_resident_memory_bytes"]
    assert len(alive) == workers
    assert all(samples[key] > 1e7 for key in alive)
    assert samples[("denavit_build_info", ("version", "0.1.0"))] == 1


ARM = {"convention": "standard", "joints": [{"type": "R", "a": 1, "alpha": 0, "d": 0}]}


def test_a_killed_worker_leaves_its_counts_and_nothing_else(
    tmp_path, start_server, worker_pids, wait_for
):
    with start_server(tmp_path, "--workers", "2") as (address, process):
        for _ in range(30):
            httpx.get(f"{address}/v1/robots/puma560/fk?q=0,0,0,0,0,0")
        before = worker_pids(process)
        # In progress when its worker dies: bodies that do not come.
        head = b"POST /v1/robots/puma560/fk HTTP/1.1\r\nHost: x\r\nContent-Type: application/json"
        host, port = address.removeprefix("http://").split(":")
        halves = [socket.create_connection((host, int(port))) for _ in range(16)]
        for half in halves:
            half.sendall(head + b"\r\nContent-Length: 100\r\n\r\n")
        wait_for(lambda: in_progress(address) == 17)
        os.kill(before[0], signal.SIGKILL)
        wait_for(lambda: len(set(worker_pids(process)) - {before[0]}) == 2)
        left = 17 - sum(lost(half) for half in halves)
        assert 1 < left < 17
        wait_for(lambda: in_progress(address) == left)
        for half in halves:
            half.close()
        wait_for(lambda: in_progress(address) == 1)
        samples = scraped(address)
        assert counted(samples, FK) == 30


def in_progress(address):
    return scraped(address)[("denavit_http_requests_in_progress",)]


def lost(connection):
    """Whether the other end has gone."""
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
        assert httpx.get(f"{address}/metrics").status_code == 404
