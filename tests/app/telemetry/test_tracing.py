"""OpenTelemetry: off unless asked for; then spans with routes, ids and nothing of the query."""

import json
import os
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import httpx
import pytest

from app.telemetry.tracing import asked_for, telemetry_config
from tests.conftest import PATIENCE

TRACE = "4bf92f3577b34da6a3ce929d0e0e4736"


class Sink(ThreadingHTTPServer):
    """A collector: keeps what it is sent, by path."""

    def __init__(self):
        self.received = []
        super().__init__(("127.0.0.1", 0), self.Handler)

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            body = self.rfile.read(int(self.headers["Content-Length"]))
            self.server.received.append((self.path, body))
            self.send_response(200)
            self.end_headers()

        def log_message(self, *arguments):
            pass


@pytest.fixture
def sink():
    with Sink() as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def test_spans_and_metrics_arrive(tmp_path, start_server, monkeypatch, sink):
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_ENDPOINT", f"http://127.0.0.1:{sink.server_port}")
    monkeypatch.setenv("OTEL_EXPORTER_OTLP_COMPRESSION", "none")
    path = tmp_path / "log"
    with (
        path.open("wb") as stderr,
        start_server(tmp_path / "data", "--log-level", "info", stderr=stderr) as (url, process),
    ):
        headers = {"traceparent": f"00-{TRACE}-00f067aa0ba902b7-01", "X-Request-ID": "mine-1"}
        query = {"q": "0,0,0,0,0,0.125", "format": "text"}
        httpx.get(f"{url}/v1/robots/puma560/fk", params=query, headers=headers, timeout=PATIENCE)
        httpx.get(f"{url}/health/live", timeout=PATIENCE)
        process.terminate()
        assert process.wait(PATIENCE) == 0
    spans = b"".join(body for path, body in sink.received if path == "/v1/traces")
    assert b"/v1/robots/{robot_id}/fk" in spans
    assert bytes.fromhex(TRACE) in spans
    assert b"denavit" in spans
    assert b"0.125" not in spans
    assert b"/health/live" not in spans
    counts = b"".join(body for path, body in sink.received if path == "/v1/metrics")
    assert b"http.server.request.duration" in counts
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    (line,) = [line for line in lines if line.get("request_id") == "mine-1"]
    assert line["trace_id"] == TRACE
    assert len(line["span_id"]) == 16


def test_a_missing_package_is_told(tmp_path):
    (tmp_path / "sitecustomize.py").write_text(
        "import sys\n"
        "class Without:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.startswith(('opentelemetry.sdk', 'opentelemetry.exporter')):\n"
        "            raise ModuleNotFoundError(name)\n"
        "sys.meta_path.insert(0, Without())\n"
    )
    path = f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    done = subprocess.run(
        [Path(sys.executable).parent / "denavit", "serve", "--port", "0"],
        env={
            **os.environ,
            "PYTHONPATH": path,
            "DENAVIT_DATA_DIR": str(tmp_path),
            "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT": "http://127.0.0.1:9/v1/traces",
        },
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 1
    assert "pip install 'denavit[telemetry]'" in json.loads(done.stderr)["event"]


@pytest.mark.parametrize(
    ("environment", "wanted"),
    [
        ({}, False),
        ({"OTEL_SERVICE_NAME": "arms"}, False),
        ({"OTEL_EXPORTER_OTLP_ENDPOINT": "http://x"}, True),
        ({"OTEL_EXPORTER_OTLP_METRICS_ENDPOINT": "http://x"}, True),
        ({"OTEL_EXPORTER_OTLP_ENDPOINT": "http://x", "OTEL_SDK_DISABLED": "True"}, False),
    ],
)
def test_the_standard_variables_decide(monkeypatch, environment, wanted):
    for name in [name for name in os.environ if name.startswith("OTEL_")]:
        monkeypatch.delenv(name)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert asked_for() is wanted
    assert telemetry_config().get("auto_configure") is wanted
