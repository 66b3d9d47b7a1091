"""Endpoints against a no-op endpoint of the same server, loaded in turns by wrk."""

from __future__ import annotations

import json
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

from fastapi import FastAPI, Request, Response

from app.main import create_app
from bench.pairs import Row

PORT = 8917
SECONDS = 2
ROUNDS = 5
REQUESTS = {
    "noop": ("/noop", {}),
    "fk": ("/v1/robots/panda/fk", {"q": [0.1, 0.2, 0.3, -1.0, 0.5, 1.2, 0.7]}),
    "jacobian": ("/v1/robots/panda/jacobian", {"q": [0.1, 0.2, 0.3, -1.0, 0.5, 1.2, 0.7]}),
    "ik": (
        "/v1/robots/panda/ik",
        {"target": {"position": [0.4, 0.1, 0.5], "rpy": [3.14, 0, 0]},
         "seed": [0, 0, 0, -1.5, 0, 1.5, 0]},
    ),
}  # fmt: skip


def application() -> FastAPI:
    """The service with a FastAPI endpoint besides that reads a body and does nothing."""
    app = create_app()

    @app.post("/noop")
    async def noop(request: Request) -> Response:
        await request.body()
        return Response(b"{}", media_type="application/json")

    return app


def load(name: str, folder: Path) -> float:
    """Requests a second of one endpoint."""
    path, body = REQUESTS[name]
    script = folder / f"{name}.lua"
    script.write_text(
        f"wrk.method='POST'\nwrk.body='{json.dumps(body)}'\n"
        "wrk.headers['Content-Type']='application/json'\n"
    )
    command = ["wrk", "-t1", "-c8", f"-d{SECONDS}s", "-s", str(script)]
    done = subprocess.run(
        [*command, f"http://127.0.0.1:{PORT}{path}"], capture_output=True, text=True, check=True
    )
    if "Non-2xx" in done.stdout:
        raise RuntimeError(f"{name}: {done.stdout}")
    return float(re.search(r"Requests/sec:\s+([\d.]+)", done.stdout)[1])


def run() -> list[Row]:
    if shutil.which("wrk") is None:
        print("wrk is not installed (apt install wrk): no figures over HTTP")
        return []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        command = [sys.executable, "-m", "uvicorn", "--factory", "bench.http:application"]
        server = subprocess.Popen([*command, "--port", str(PORT), "--log-level", "warning"])
        try:
            wait()
            rates = {key: [] for key in REQUESTS}
            for _ in range(ROUNDS):
                for key, found in rates.items():
                    found.append(load(key, folder))
        finally:
            server.terminate()
            server.wait()
    rows = []
    for key in ("fk", "jacobian", "ik"):
        ratio = statistics.median(a / b for a, b in zip(rates[key], rates["noop"], strict=True))
        mine, noop = statistics.median(rates[key]), statistics.median(rates["noop"])
        what = f"panda: POST {key} | no-op endpoint (requests a second)"
        rows.append(Row(what, f"{mine:.0f}/s", f"{noop:.0f}/s", ratio))
    return rows


def wait() -> None:
    deadline = time.monotonic() + 60
    while True:
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{PORT}/health/ready").close()
            return
        except urllib.error.URLError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.1)
