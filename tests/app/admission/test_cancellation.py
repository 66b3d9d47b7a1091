"""A computation ends when its client goes away, and when its time is up."""

import json
import socket
from contextlib import ExitStack

import httpx
import numpy as np
import pytest

from tests.app.conftest import WITH_LONG_WORK, served
from tests.conftest import PATIENCE, until

RNG = np.random.default_rng(0)
Q = RNG.uniform(-1, 1, (60_000, 7)).round(4).tolist()
FAR = [{"position": [0.8, 1e-5 * k, 0.4], "rpy": [2, 1, 0]} for k in range(10_000)]
PATIENT = {"max_restarts": 10_000, "max_iterations": 10_000, "time_budget_ms": 60_000}
SCENE = {
    "q": [1.9, -0.25, -0.45, -0.5, -0.5, -0.35, 0, 0.2],
    "target": {"position": [1.15, -0.15]},
    "task": "xy",
    "obstacles": [{"type": "circle", "center": [0.73, 0.22], "radius": 0.08}],
    "d_safe": 0.02,
}
TABLE = {
    "convention": "standard",
    "joints": [
        {"type": "R", "a": 0.1 + 0.1 * k, "alpha": 0.2 + 0.3 * k, "d": 0.1 + 0.2 * k}
        for k in range(9)
    ],
}
LONG_ARM = {
    "convention": "standard",
    "joints": [{"type": "R", "a": 0.1, "alpha": 0.3 + 0.1 * (k % 7), "d": 0.05} for k in range(60)],
}
BENT = RNG.uniform(-2, 2, 60).round(4).tolist()
WORK = {
    "singularity": ("/v1/robots/panda/", "singularity", {"q": Q}),
    "joint velocities": (
        "/v1/robots/panda/",
        "joint-velocities",
        {"q": Q, "twist": [0.1, 0, 0, 0, 0, 0]},
    ),
    "many targets": ("/v1/robots/panda/", "ik", {"targets": FAR, **PATIENT}),
    "nearest singularity": ("/v1/", "singularity/nearest", {"robot": LONG_ARM, "q": BENT}),
    "sqp": ("/v1/robots/planar_8r/", "path", {**SCENE, "method": "sqp", "samples": 5000}),
    "whole path": (
        "/v1/robots/planar_8r/",
        "path",
        {**SCENE, "method": "whole_path", "samples": 2000},
    ),
    "methods": (
        "/v1/robots/planar_8r/",
        "path/compare",
        {**SCENE, "samples": 5000, "methods": ["sqp"] * 16},
    ),
    "closed forms": (
        "/v1/",
        "symbolic",
        {"robot": TABLE, "quantities": "all", "parameters": "symbolic", "time_budget_ms": 60_000},
    ),
}
STREAM = "Accept: application/x-ndjson"
BEFORE_ANY_IS_DONE = 0.005
"""Seconds. Each of these takes a hundred times as long; a time that is up in the middle of a
computation is the matter of tests/kinematics/test_deadline.py."""


@pytest.fixture(scope="module")
def shared(tmp_path_factory):
    folder = tmp_path_factory.mktemp("shared")
    with served(folder, max_request_seconds=1e6, max_wait_seconds=PATIENCE) as server:
        yield server


@pytest.fixture(scope="module")
def limited(tmp_path_factory):
    with served(
        tmp_path_factory.mktemp("limited"), max_request_seconds=BEFORE_ANY_IS_DONE
    ) as server:
        yield server


def sent(server, path: str, body: dict, *headers: str) -> socket.socket:
    """A connection on which a request is sent, whose answer nobody has read."""
    content = json.dumps(body).encode()
    lines = (
        f"POST {path} HTTP/1.1",
        "Host: x",
        "Content-Type: application/json",
        f"Content-Length: {len(content)}",
        *headers,
    )
    connection = server.connect()
    connection.sendall("\r\n".join((*lines, "\r\n")).encode() + content)
    return connection


@pytest.mark.parametrize("name", WORK)
def test_work_stops_when_the_client_goes_away(shared, name):
    """The service does it again and again, until the computation itself sees that nobody waits."""
    start, operation, body = WORK[name]
    shared.comes_to_rest()
    with sent(shared, f"{start}again/{operation}", body):
        shared.works_for(1.5)
        assert shared.in_progress() == 1
    shared.comes_to_rest()


def test_a_stream_stops_too(shared):
    start, operation, body = WORK["many targets"]
    shared.comes_to_rest()
    with sent(shared, f"{start}again/{operation}", body, STREAM):
        shared.works_for(0.5)
    shared.comes_to_rest()


def test_who_leaves_the_queue_is_not_computed_for(serve_long_work):
    settings = {"max_request_seconds": 1e6, "max_wait_seconds": PATIENCE}
    with serve_long_work(compute_threads=1, **settings) as server:
        with ExitStack() as stack:
            for _ in range(6):
                stack.enter_context(sent(server, "/v1/robots/panda/endless", {"q": Q[0]}))
            until(lambda: server.in_progress() == 6)
            server.works_for(0.2)
        server.comes_to_rest()
        path = "/v1/robots/panda/singularity"
        quick = httpx.post(server.address + path, json={"q": Q[:100]}, timeout=PATIENCE)
        assert quick.status_code == 200


@pytest.mark.parametrize("name", WORK)
def test_every_computation_obeys_the_time_limit(limited, name):
    start, operation, body = WORK[name]
    answer = httpx.post(f"{limited.address}{start}{operation}", json=body, timeout=PATIENCE)
    if answer.status_code == 200:
        told = ("timeout", "time was over", "too little time", '"simplified"')
        assert any(words in answer.text for words in told)
    else:
        assert answer.status_code == 422
        assert answer.json()["type"] == "/problems/out-of-time"
    limited.comes_to_rest()


@pytest.mark.parametrize("name", ["many targets", "sqp"])
def test_a_stream_whose_time_is_up_says_so_in_its_last_line(
    name, tmp_path, start_server, monkeypatch
):
    monkeypatch.setenv("DENAVIT_MAX_REQUEST_SECONDS", "1")
    start, operation, body = WORK[name]
    log, headers = tmp_path / "log", {"Accept": "application/x-ndjson"}
    with (
        log.open("wb") as stderr,
        start_server(tmp_path / "data", stderr=stderr, program=WITH_LONG_WORK) as (address, _),
    ):
        url = f"{address}{start}again/{operation}"
        answer = httpx.post(url, json=body, timeout=PATIENCE, headers=headers)
    assert answer.status_code == 200
    last = json.loads(answer.text.splitlines()[-1])
    assert last["problem"]["type"] == "/problems/out-of-time"
    assert last["problem"]["request_id"] == answer.headers["x-request-id"]
    assert b"exception" not in log.read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("streamed", [False, True])
def test_what_was_solved_in_time_is_kept(serve, streamed):
    """10,000 targets of which some tenths of a second are enough for the first ones only."""
    start, operation, body = WORK["many targets"]
    near = {"position": [0.4, 0.1, 0.4], "rpy": [3.0, 0.1, 0.2]}
    asked = {**body, "targets": [near] * 8 + (body["targets"] * 10_000)[:9_992]}
    headers = {"Accept": "application/x-ndjson" if streamed else "application/json"}
    with serve(max_request_seconds=20) as server:
        url = f"{server.address}{start}{operation}"
        answer = httpx.post(url, json=asked, timeout=PATIENCE, headers=headers)
    assert answer.status_code == 200
    if streamed:
        statuses = [json.loads(line)["status"] for line in answer.text.splitlines()]
    else:
        statuses = answer.json()["status"]
    assert len(statuses) == 10_000
    assert statuses[:8] == ["converged"] * 8
    assert statuses[-1] == "timeout"
