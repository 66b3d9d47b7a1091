"""What a server writes: JSON lines only, with what is promised in them and nothing else."""

import json
import re
import socket
import subprocess
import sys
from contextlib import suppress

import httpx
import pytest

from app.access.keys import Scope, new_key
from tests.conftest import PATIENCE, until

SECRET = "s3cret-value"
FORGED = '{"time":"2000-01-01T00:00:00Z","level":"critical","event":"forged"}'


@pytest.fixture
def logged(tmp_path, start_server):
    """Runs a function against a server of its own; gives the lines that this one wrote."""

    def run(act, *arguments):
        path = tmp_path / "log"
        with path.open("wb") as stderr:
            options = ("--log-level", "info", *arguments)
            with start_server(tmp_path / "data", *options, stderr=stderr) as (address, process):
                act(address)
                process.terminate()
                assert process.wait(PATIENCE) == 0
        return path.read_bytes()

    return run


def raw(address, request):
    """Sends bytes as they are; gives what comes back."""
    host, port = address.removeprefix("http://").split(":")
    with socket.create_connection((host, int(port)), timeout=PATIENCE) as connection:
        connection.sendall(request)
        connection.shutdown(socket.SHUT_WR)
        answer = b""
        while piece := connection.recv(65536):
            answer += piece
    return answer


def hostile(address):
    """What tries to get lines of its own into the log, by every way into the service."""
    heads = [
        f"GET /v1/robots/x%0a{FORGED}%0a HTTP/1.1\r\nHost: x\r\n",
        "GET /%0d%0a%1b%5b2J%e2%80%ae%c2%85%ff HTTP/1.1\r\nHost: x\r\n",
        f"GET /v1/robots?page_token=%0a{SECRET} HTTP/1.1\r\nHost: x\r\n",
        f"GET /health/live HTTP/1.1\r\nHost: a\r\nX-Request-ID: x {FORGED}\r\n",
        "GET /nope HTTP/1.1\r\nHost: a\r\nX-Request-ID: \u202e\x1b[2J\x85\r\n",
        f"GET /nope HTTP/1.1\r\nHost: a\r\nX-Forwarded-For: \u202e{FORGED}\r\n",
        f"GET /nope HTTP/1.1\r\nHost: a\r\nUser-Agent: {FORGED}\x1b\r\nAuthorization: {SECRET}\r\n",
        f"GET /nope HTTP/1.1\r\nHost: a\r\nX-A: b\n{FORGED}\n\r\n",
        "GET /nope HTTP/1.1\r\nHost: a\r\nConnection: Upgrade\r\nUpgrade: \x1b]0;x\x07\r\n",
        f"FORGED{FORGED} / HTTP/1.1\r\nHost: a\r\n",
        f"GET /{FORGED} HTTP/1.1\r\nHost: a\r\n",
    ]
    for head in heads:
        raw(address, head.encode() + b"Connection: close\r\n\r\n")
    raw(address, b"\x16\x03\x01\x00\x00\n{}\n")
    table = {"convention": "standard", "joints": [{"type": "R", "a": 1, "alpha": 0, "d": 0}]}
    for name in (f"a\n{FORGED}\nb", "\u202ea", "a\x1b[2J"):
        httpx.post(f"{address}/v1/robots", json={"name": name, **table}, timeout=PATIENCE)
        joint = {**table["joints"][0], "name": name}
        httpx.post(
            f"{address}/v1/robots",
            json={**table, "name": "ok", "joints": [joint]},
            timeout=PATIENCE,
        )
        urdf = f'<robot name="{name}"><link name="{name}"/></robot>'
        httpx.post(f"{address}/v1/robots", content=urdf.encode(), headers=XML, timeout=PATIENCE)
        httpx.post(
            f"{address}/v1/fk", json={"robot": {"urdf": urdf}, "q": [SECRET]}, timeout=PATIENCE
        )
    httpx.post(f"{address}/v1/robots/puma560/fk", json={"q": [SECRET]}, timeout=PATIENCE)
    httpx.get(
        f"{address}/v1/robots/puma560/fk",
        params={"q": SECRET, "format": f"\n{FORGED}"},
        timeout=PATIENCE,
    )


XML = {"Content-Type": "application/xml"}


@pytest.mark.parametrize("workers", ["1", "2"])
def test_nothing_that_a_request_carries_makes_a_line(logged, workers):
    written = logged(hostile, "--workers", workers)
    lines = [json.loads(line) for line in written.decode("ascii").splitlines()]
    assert SECRET not in written.decode()
    assert all({"time", "level", "event", "logger", "pid"} <= line.keys() for line in lines)
    assert not [line for line in lines if line["level"] not in ("info", "warning")]
    assert not any("forged" in str(line) for line in lines)
    assert sum(line["event"] == "request" for line in lines) > 15


def test_requests_that_are_turned_away_are_logged_with_their_route(logged, monkeypatch):
    secret, key = new_key("reader", Scope.READ)
    monkeypatch.setenv("DENAVIT_API_KEYS", key.line)
    monkeypatch.setenv("DENAVIT_RATE_LIMIT", "6/hour")
    monkeypatch.setenv("DENAVIT_ALLOWED_HOSTS", "127.0.0.1")
    mine = {"Authorization": f"Bearer {secret}"}
    asked = [
        (401, "GET", "/v1/robots/puma560/fk", "/v1/robots/{robot_id}/fk", {}),
        (403, "DELETE", "/v1/robots/mine", "/v1/robots/{robot_id}", mine),
        (403, "PUT", "/v1/robots/mine", "/v1/robots/{robot_id}", {"Origin": "http://x.example"}),
        (421, "POST", "/v1/ik", "/v1/ik", {"Host": "x.example"}),
        (400, "POST", "/v1/robots", "/v1/robots", {"Host": "a b"}),
        (400, "GET", "/v1/robots/a/urdf", "/v1/robots/{robot_id}/urdf", mine | {"X-API-Key": "b"}),
        (401, "GET", "/v1/nothing", "unmatched", {}),
        (429, "GET", "/v1/robots/a/meshes/b/c", "/v1/robots/{robot_id}/meshes/{name:path}", {}),
    ]

    def act(address):
        for number, (status, method, path, _, headers) in enumerate(asked):
            if status == 429:
                for _ in range(6):
                    httpx.get(f"{address}/v1/robots", timeout=PATIENCE)
            answer = httpx.request(
                method,
                address + path,
                headers=headers | {"X-Request-ID": f"asked-{number}"},
                timeout=PATIENCE,
            )
            assert answer.status_code == status, path

    lines = [json.loads(line) for line in logged(act).splitlines()]
    by_id = {line.get("request_id"): line for line in lines}
    for number, (status, method, _, route, _) in enumerate(asked):
        line = by_id[f"asked-{number}"]
        assert (line["status"], line["method"], line["route"]) == (status, method, route)
        assert secret not in json.dumps(line)


@pytest.mark.scene
def test_a_line_for_each_request(logged):
    def act(address):
        headers = {"X-Request-ID": "mine-7", "X-Forwarded-For": "192.0.2.1"}
        httpx.get(
            f"{address}/v1/robots/puma560/fk?q=0,0,0,0,0,0", headers=headers, timeout=PATIENCE
        )
        httpx.get(
            f"{address}/v1/robots/nobody", headers={"X-Request-ID": "mine-8"}, timeout=PATIENCE
        )
        httpx.get(f"{address}/health/live", headers={"X-Request-ID": "mine-9"}, timeout=PATIENCE)

    lines = [json.loads(line) for line in logged(act).splitlines()]
    by_id = {line.get("request_id"): line for line in lines}
    found = by_id["mine-7"]
    assert found["method"] == "GET"
    assert found["route"] == "/v1/robots/{robot_id}/fk"
    assert found["status"] == 200
    assert 0 < found["duration_ms"] < 60_000
    assert found["bytes"] > 100
    assert "client" not in found
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", found["time"])
    assert by_id["mine-8"]["status"] == 404
    assert by_id["mine-8"]["route"] == "/v1/robots/{robot_id}"
    assert "mine-9" not in by_id  # a probe that goes well is no event
    assert [line["event"] for line in lines].count("serving") == 1


def test_what_is_no_request_gets_one_line_with_the_id_of_its_refusal(logged):
    answers = []
    lines = logged(lambda address: answers.append(raw(address, b"GET  nonsense\r\n\r\n")))
    problem = json.loads(answers[0].partition(b"\r\n\r\n")[2])
    found = [json.loads(line) for line in lines.splitlines() if b"not read" in line.lower()]
    assert b"Invalid HTTP request received" not in lines
    assert [(one["request_id"], one["status"]) for one in found] == [(problem["request_id"], 400)]


def test_clients_are_named_when_wanted_and_escaped(logged, monkeypatch):
    monkeypatch.setenv("DENAVIT_LOG_CLIENTS", "true")

    def act(address):
        raw(
            address,
            "GET /nope HTTP/1.1\r\nHost: a\r\nX-Forwarded-For: \u202e1\x85\r\n"
            "Connection: close\r\n\r\n".encode(),
        )
        httpx.get(f"{address}/nope", timeout=PATIENCE)

    written = logged(act)
    lines = [json.loads(line) for line in written.decode("ascii").splitlines()]
    clients = [line["client"] for line in lines if line["event"] == "request"]
    assert clients[-1] == "127.0.0.1"
    assert len(clients) == 2


@pytest.mark.parametrize(
    ("name", "value"), [("DENAVIT_ACCESS_LOG", "false"), ("DENAVIT_LOG_LEVEL", "warning")]
)
def test_without_access_lines(logged, monkeypatch, name, value):
    monkeypatch.setenv(name, value)
    options = ("--log-level", value) if name == "DENAVIT_LOG_LEVEL" else ()
    written = logged(lambda address: httpx.get(f"{address}/v1/robots", timeout=PATIENCE), *options)
    assert b'"event":"request"' not in written


def test_text_is_for_people(logged, monkeypatch):
    monkeypatch.setenv("DENAVIT_LOG_FORMAT", "text")
    written = logged(hostile).decode()
    assert "Try:\n  curl 'http://localhost:" in written
    assert SECRET not in written
    lines = written.split("\n")
    assert all(line.isprintable() for line in lines)
    assert any(
        re.match(r"\d\d:\d\d:\d\d INFO +request .*method=GET route=/", line) for line in lines
    )


def test_what_nobody_catches_is_a_line_too():
    program = """
import sys, threading, warnings, logging
from app.settings import Settings
from app.telemetry.logs import log_to_stderr
log_to_stderr(Settings(log_format="json"))
warnings.warn("a\\nwarning")
thread = threading.Thread(target=lambda: 1 / 0)
thread.start()
thread.join()
class Bad:
    def __del__(self):
        raise ValueError("in\\ndel")
Bad()
logging.getLogger("uvicorn.error").error("multi\\nline")
raise RuntimeError("at\\nthe end")
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    lines = [json.loads(line) for line in done.stderr.splitlines()]
    assert [line["level"] for line in lines] == ["warning", "error", "error", "error", "critical"]
    assert "a\nwarning" in lines[0]["event"]
    assert lines[1]["exception"].endswith("ZeroDivisionError: division by zero")
    assert lines[2]["exception"].endswith("in\ndel")
    assert lines[4]["exception"].endswith("RuntimeError: at\nthe end")
    assert done.returncode == 1


def test_a_failure_of_the_service_is_told_with_its_traceback(tmp_path):
    program = """
import sys
from app.main import create_app
from app.settings import Settings
from app.telemetry.logs import log_to_stderr
import uvicorn
settings = Settings(log_format="json", preload=False)
log_to_stderr(settings)
app = create_app(settings)
async def fails(request):
    raise ValueError("the\\ncause")
app.add_route("/fails", fails)
uvicorn.run(app, port=int(sys.argv[1]), log_config=None, access_log=False)
"""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sys.executable, "-c", program, str(port)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        answers = []

        def answered():
            with suppress(httpx.TransportError):
                answers.append(httpx.get(f"http://127.0.0.1:{port}/fails", timeout=PATIENCE))
            return answers

        until(answered)
        (answer,) = answers
        process.terminate()
        lines = [json.loads(line) for line in process.communicate(timeout=PATIENCE)[1].splitlines()]
    assert answer.status_code == 500
    assert "cause" not in answer.text
    (failed,) = [line for line in lines if line["event"] == "request failed"]
    assert failed["request_id"] == answer.json()["request_id"]
    assert failed["exception"].endswith("ValueError: the\ncause")
    (request,) = [line for line in lines if line["event"] == "request"]
    assert request["status"] == 500
    assert request["request_id"] == failed["request_id"]
