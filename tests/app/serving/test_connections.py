"""Clients that send or read too slowly, too much or too often, on real sockets."""

import asyncio
import contextlib
import json
import resource
import socket
import subprocess
import time

import httpx
import numpy as np
import pytest

from app.serving import connections
from tests.conftest import PATIENCE, until

FK = "/v1/robots/panda/fk?q=0,0,0,0,0,0,0"
JACOBIAN = "/v1/robots/{robot_id}/jacobian"
QUICK = {"head_seconds": 1, "body_seconds": 1, "write_seconds": 1}


def answer(connection: socket.socket) -> bytes:
    parts = []
    while part := connection.recv(65536):
        parts.append(part)
    return b"".join(parts)


def is_fine(server) -> bool:
    return httpx.get(server.address + FK, timeout=PATIENCE).status_code == 200


def problem_of(raw: bytes) -> dict:
    head, _, body = raw.partition(b"\r\n\r\n")
    assert b"application/problem+json" in head
    assert f"content-length: {len(body)}".encode() in head
    problem = json.loads(body)
    assert problem["request_id"]
    assert f"x-request-id: {problem['request_id']}".encode() in head
    return problem


def test_a_head_that_does_not_come_is_cut_off(serve):
    with serve(**QUICK) as server, server.connect() as connection:
        connection.sendall(b"GET /health/live HTTP/1.1\r\nHost: x\r\nX-A: ")
        started, first = time.monotonic(), b""
        with contextlib.suppress(BrokenPipeError):
            while not first and time.monotonic() - started < PATIENCE:
                connection.sendall(b"a")
                time.sleep(0.2)
                connection.settimeout(0.01)
                with contextlib.suppress(TimeoutError):
                    first = connection.recv(1)
        connection.settimeout(PATIENCE)
        raw = first + answer(connection)
        assert raw.startswith(b"HTTP/1.1 408 ")
        assert problem_of(raw)["detail"] == "the head of the request took too long"


@pytest.mark.scene
def test_a_body_that_trickles_is_cut_off_and_a_slow_one_is_not(serve):
    body = json.dumps({"q": [0.0] * 7}).encode()
    head = (
        b"POST /v1/robots/panda/fk HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\n"
        b"Connection: close\r\nContent-Length: %d\r\n\r\n"
    )
    with serve(**QUICK | {"body_seconds": 5}) as server:
        with server.connect() as connection:
            connection.sendall(head % len(body) + body[:5])
            time.sleep(0.5)
            connection.sendall(body[5:])
            assert answer(connection).startswith(b"HTTP/1.1 200 ")
        with server.connect() as connection:
            connection.sendall(head % len(body) + body[:5])
            raw = answer(connection)
            assert raw.startswith(b"HTTP/1.1 408 ")
            assert problem_of(raw)["detail"] == "the body of the request took too long"
        assert is_fine(server)


def test_an_idle_connection_is_closed_and_says_nothing(serve):
    with serve(**QUICK) as server, server.connect() as connection:
        assert answer(connection) == b""


def test_a_thousand_slow_clients_do_not_hold_the_service(serve):
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard < 2500:
        pytest.skip("too few file descriptors")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 2500), hard))
    with (
        serve(max_connections=200, head_seconds=PATIENCE) as server,
        contextlib.ExitStack() as stack,
    ):
        slow = []
        for _ in range(1000):
            connection = stack.enter_context(server.connect())
            connection.sendall(b"POST /v1/fk HTTP/1.1\r\nHost: x\r\nX-A: b")
            slow.append(connection)
        for _ in range(5):
            for connection in slow:
                with contextlib.suppress(OSError):
                    connection.send(b"c")
            assert is_fine(server)
        kept = sum(still_open(connection) for connection in slow)
        assert 100 < kept <= 200


def still_open(connection: socket.socket) -> bool:
    connection.setblocking(False)
    try:
        return connection.recv(1) != b""
    except BlockingIOError:
        return True
    except OSError:
        return False


def asked_for_much(server, stack: contextlib.ExitStack) -> socket.socket:
    """A connection with a small buffer on which 9 MB are to come."""
    body = json.dumps({"q": np.zeros((20_000, 7)).tolist()}).encode()
    connection = stack.enter_context(socket.socket())
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    connection.connect(("127.0.0.1", server.port))
    connection.settimeout(PATIENCE)
    connection.sendall(
        b"POST /v1/robots/panda/jacobian HTTP/1.1\r\nHost: x\r\nContent-Type: application/json"
        b"\r\nConnection: close\r\nContent-Length: %d\r\n\r\n" % len(body) + body
    )
    return connection


def done_with(server) -> int:
    """Requests for a Jacobian that the server is done with."""
    return int(server.counted("denavit_http_requests_total", route=JACOBIAN))


def test_answers_that_nobody_reads_are_dropped(serve):
    with serve(**QUICK) as server, contextlib.ExitStack() as stack:
        connections = [asked_for_much(server, stack) for _ in range(6)]
        until(lambda: done_with(server) == 6)
        assert is_fine(server)
        for connection in connections:
            with contextlib.suppress(ConnectionResetError):
                raw = answer(connection)
                assert len(raw) < 8_000_000, "it was kept for who did not read it"


def test_a_reader_who_takes_its_time_gets_all(serve):
    seconds = 5
    with serve(write_seconds=seconds) as server, contextlib.ExitStack() as stack:
        connection = asked_for_much(server, stack)
        raw = bytearray(connection.recv(16_384))
        began = time.monotonic()
        while part := connection.recv(16_384):
            raw += part
            if time.monotonic() - began < seconds + 2:
                time.sleep(0.1)
        head, _, body = bytes(raw).partition(b"\r\n\r\n")
        assert f"content-length: {len(body)}".encode() in head
        assert len(body) > 5_000_000


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        (b"GET / HTTP/1.1\r\nHost: x\r\n" + b"X-A: b\r\n" * 200 + b"\r\n", 431),
        (b"GET / HTTP/1.1\r\nHost: x\r\nX-A: " + b"b" * 100_000 + b"\r\n\r\n", 431),
        (b"GET / HTTP/1.1\r\nHost: x\r\nX-A: " + b"b" * 100_000, 431),
        (b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\nHost: x\r\n\r\n", 431),
        (b"GET /" + b"a" * 100_000, 431),
        (b"\x16\x03\x01\x02\x00\x01\x00", 400),
        (b"GET  HTTP/1.1\r\n\r\n", 400),
        (b"POST /v1/fk HTTP/1.1\r\nContent-Length: -1\r\n\r\n", 400),
        (b"POST /v1/fk HTTP/1.1\r\nContent-Length: 3\r\nContent-Length: 4\r\n\r\n", 400),
        (
            b"POST /v1/fk HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n"
            + b"1;"
            + b"e" * 200_000,
            415,
        ),
    ],
    ids=[
        "headers",
        "header",
        "open-header",
        "target",
        "open-target",
        "tls",
        "no-target",
        "negative",
        "two-lengths",
        "extension",
    ],
)
def test_heads_that_are_too_large_or_none_are_refused(server, request_, status):
    host, port = server.removeprefix("http://").split(":")
    with socket.create_connection((host, int(port)), PATIENCE) as connection:
        connection.sendall(request_)
        raw = answer(connection)
    assert raw.startswith(f"HTTP/1.1 {status} ".encode())
    problem = problem_of(raw)
    assert problem["status"] == status
    meant = httpx.get(server + problem["type"], timeout=PATIENCE).json()
    assert (meant["status"], meant["title"]) == (status, problem["title"])
    assert len(raw) < 1500


def test_the_worker_survives_more_connections_than_files(serve, tmp_path):
    with serve(max_connections=5000) as server, contextlib.ExitStack() as stack:
        subprocess.run(["prlimit", f"--pid={server.pid}", "--nofile=120:120"], check=True)
        for _ in range(300):
            with contextlib.suppress(OSError):
                stack.enter_context(server.connect(2))
        stack.close()

        def recovers() -> bool:
            with contextlib.suppress(httpx.TransportError):
                return is_fine(server)
            return False

        until(recovers)


def test_who_goes_away_leaves_none_of_its_pipelined_requests_behind(serve_long_work):
    """The first of two is being computed; the server learns of the end by the second."""
    body = json.dumps({"q": [0.1] * 7}).encode()
    first = (
        b"POST /v1/robots/panda/endless HTTP/1.1\r\nHost: x\r\nContent-Type: application/json"
        b"\r\nContent-Length: %d\r\n\r\n" % len(body) + body
    )
    with serve_long_work(max_request_seconds=1e6) as server:
        with server.connect() as connection:
            connection.sendall(first + b"GET /health/live HTTP/1.1\r\nHost: x\r\n\r\n")
            server.works_for(0.5)
            assert server.in_progress() == 1
        server.comes_to_rest()
        assert is_fine(server)


def test_one_pipelined_request_too_many_is_told_so_after_the_answers(serve):
    many = 3 * connections.MAX_PIPELINED
    with serve() as server, server.connect() as connection:
        connection.sendall(b"GET /v1/robots HTTP/1.1\r\nHost: localhost\r\n\r\n" * many)
        raw = answer(connection)
    answers = raw.count(b"HTTP/1.1 200 ")
    assert connections.MAX_PIPELINED <= answers < many
    last = raw[raw.rindex(b"HTTP/1.1 ") :]
    assert last.startswith(b"HTTP/1.1 429 ")
    problem = problem_of(last)
    assert problem["type"] == "/problems/too-many-requests"
    assert problem["title"] == "Too many requests"
    assert "more than 64 requests wait for their answers" in problem["detail"]


def test_requests_that_take_long_leave_a_turn_of_the_event_loop_to_others(monkeypatch):
    """So long a turn, then others; the first of a turn always begins."""
    clock, begun, turns = [0.0], [], []
    monkeypatch.setattr(connections, "monotonic", lambda: clock[0])
    guard = connections.ConnectionGuard(connections.ConnectionLimits())

    def start(seconds):
        begun.append(len(turns))
        clock[0] += seconds

    async def loaded():
        loop = asyncio.get_running_loop()
        for seconds in (0.3 * connections.TURN_SECONDS,) * 6 + (5.0, 5.0):
            guard.begin(lambda seconds=seconds: start(seconds), loop)
        while guard.waiting:
            turns.append(None)
            await asyncio.sleep(0)

    asyncio.run(loaded())
    assert begun == [0, 0, 0, 0, 1, 1, 1, 2]
