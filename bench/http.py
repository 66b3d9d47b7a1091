"""Endpoints against no-op endpoints of the same server, loaded in turns by wrk.

All protections are on: guarded connections as in ``denavit serve``, a key, a rate limit.
"""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from fastapi import FastAPI, Request, Response
from starlette.routing import Route

from app.access.keys import Scope, new_key
from app.main import create_app
from app.operations import Answer
from app.operations.forward import FK
from app.routes.compute import Computation
from app.settings import Settings
from bench.pairs import Row, paired, seconds
from kinematics.forward import fk
from kinematics.inverse import solve_ik_batch
from robots.robot import FloatArray, Robot
from robots.shipped import shipped_robot

PORT = 8917
SECONDS = 2
ROUNDS = 5
Q = {"q": [0.1, 0.2, 0.3, -1.0, 0.5, 1.2, 0.7]}
REQUESTS = {
    "route": ("/v1/route/panda", Q),
    "bare": ("/v1/robots/panda/bare", Q),
    "idle": ("/v1/robots/panda/idle", Q),
    "fk": ("/v1/robots/panda/fk", Q),
    "jacobian": ("/v1/robots/panda/jacobian", Q),
    "ik": (
        "/v1/robots/panda/ik",
        {
            "target": {"position": [0.4, 0.1, 0.5], "rpy": [3.14, 0, 0]},
            "seed": [0, 0, 0, -1.5, 0, 1.5, 0],
        },
    ),
}


TARGETS = 10_000
SECRET, KEY = new_key("bench", Scope.READ)
PROTECTED = {
    "DENAVIT_API_KEYS": KEY.line,
    "DENAVIT_RATE_LIMIT": "1000000/second;10000000/minute",
    "DENAVIT_METRICS": "true",
}


@dataclass(frozen=True)
class Load:
    """Requests a second, and percentiles of the latency in ms."""

    rate: float
    p50: float
    p99: float


def application() -> FastAPI:
    """The service with three endpoints besides.

    ``route`` is a no-op as a route of FastAPI, behind all protections.
    ``idle`` is that of FK with a no-op in place of the computation: what is left is all that
    protects and checks. ``bare`` reads a body and does nothing: a plain route in front of all
    others, as the computations are.
    """
    app, settings = create_app(), Settings()
    idle = Computation(
        replace(FK, name="idle", run=lambda *_: Answer({})), settings.max_compute_bytes
    )

    async def bare(request: Request) -> Response:
        await request.body()
        return Response(b"{}", media_type="application/json")

    @app.post("/v1/route/{robot_id}")
    async def route(robot_id: str, request: Request) -> Response:  # noqa: ARG001
        return await bare(request)

    path = "/v1/robots/{robot_id}/"
    app.router.routes.insert(0, Route(f"{path}bare", bare, methods=["POST"]))
    app.router.routes.insert(1, Route(f"{path}idle", idle.post, methods=["POST"]))
    return app


def load(name: str, folder: Path) -> Load:
    """One endpoint under wrk."""
    path, body = REQUESTS[name]
    script = folder / f"{name}.lua"
    script.write_text(
        f"wrk.method='POST'\nwrk.body='{json.dumps(body)}'\n"
        f"wrk.headers['X-API-Key']='{SECRET}'\n"
        "wrk.headers['Content-Type']='application/json'\n"
    )
    command = ["wrk", "-t1", "-c8", f"-d{SECONDS}s", "--latency", "-s", str(script)]
    done = subprocess.run(
        [*command, f"http://127.0.0.1:{PORT}{path}"], capture_output=True, text=True, check=True
    )
    if "Non-2xx" in done.stdout:
        raise RuntimeError(f"{name}: {done.stdout}")
    rate = float(re.search(r"Requests/sec:\s+([\d.]+)", done.stdout)[1])
    return Load(rate, percentile(done.stdout, 50), percentile(done.stdout, 99))


def percentile(text: str, number: int) -> float:
    """Milliseconds from wrk's table of latencies."""
    value, unit = re.search(rf"{number}%\s+([\d.]+)(us|ms|s)", text).groups()
    return float(value) * {"us": 1e-3, "ms": 1.0, "s": 1e3}[unit]


def run() -> list[Row]:
    if shutil.which("wrk") is None:
        print("wrk is not installed (apt install wrk): no figures over HTTP")
        return []
    return [row for workers in (1, 2) for row in rows_of(workers)] + cold_starts()


def rows_of(workers: int) -> list[Row]:
    with tempfile.TemporaryDirectory() as name, serving(workers):
        loads: dict[str, list[Load]] = {key: [] for key in REQUESTS}
        for _ in range(ROUNDS):
            for key, found in loads.items():
                found.append(load(key, Path(name)))
        batch = batches() if workers == 1 else []
    rows = []
    none = {
        "route": "a no-op as a route of FastAPI",
        "bare": "a bare no-op",
        "idle": "the same with a no-op for the computation",
    }
    for key, found in loads.items():
        for other in none if key not in none else ():
            theirs = loads[other]
            ratio = statistics.median(a.rate / b.rate for a, b in zip(found, theirs, strict=True))
            rates = (statistics.median(one.rate for one in some) for some in (found, theirs))
            what = f"{workers} workers: POST {key} | {none[other]} (requests a second)"
            rows.append(Row(what, *(f"{rate:.0f}/s" for rate in rates), ratio))
    for key, found in loads.items():
        p50, p99 = (statistics.median(getattr(one, p) for one in found) for p in ("p50", "p99"))
        what = f"{workers} workers: {key}, 99th percentile | median"
        rows.append(Row(what, f"{p99:.2f} ms", f"{p50:.2f} ms", p99 / p50))
    return rows + batch


def batches() -> list[Row]:
    """Ten thousand IK targets in one request as npy, against the same in this process."""
    rows = []
    for name in ("panda", "puma560"):
        robot = shipped_robot(name)
        rng = np.random.default_rng(0)
        low, high = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
        poses = fk(robot, rng.uniform(low, high, (TARGETS, robot.dof)))[robot.tip_frame]
        memory = io.BytesIO()
        np.save(memory, poses)
        headers = {"Content-Type": "application/x-npy", "Accept": "application/x-npy"}
        headers["X-API-Key"] = SECRET
        url = f"http://127.0.0.1:{PORT}/v1/robots/{name}/ik"
        request = urllib.request.Request(url, memory.getvalue(), headers)

        def over_http(request: urllib.request.Request = request) -> None:
            with urllib.request.urlopen(request) as answer:
                np.load(io.BytesIO(answer.read()))

        def in_process(robot: Robot = robot, poses: FloatArray = poses) -> None:
            solve_ik_batch(robot, poses, threads=2)

        what = f"{name}: {TARGETS} targets, a solve: over HTTP as npy | in process, 2 threads"
        rows.append(paired(what, over_http, in_process, per=TARGETS, rounds=9))
    return rows


def cold_starts() -> list[Row]:
    """The first request that a server gets, against the later ones; a server each."""
    found: dict[str, list[tuple[float, float]]] = {"fk": [], "ik": []}
    for _ in range(ROUNDS):
        for key, times in found.items():
            path, body = REQUESTS[key]
            url, data = f"http://127.0.0.1:{PORT}{path}", json.dumps(body).encode()
            headers = {"Content-Type": "application/json", "X-API-Key": SECRET}
            request = urllib.request.Request(url, data, headers)

            def call(request: urllib.request.Request = request) -> None:
                urllib.request.urlopen(request).close()

            with serving(1):
                times.append(
                    (seconds(call, 1), statistics.median(seconds(call, 1) for _ in range(50)))
                )
    rows = []
    for key, times in found.items():
        first, later = (statistics.median(column) * 1e3 for column in zip(*times, strict=True))
        ratio = statistics.median(a / b for a, b in times)
        what = f"{key}: the first request of a server | its later ones"
        rows.append(Row(what, f"{first:.2f} ms", f"{later:.2f} ms", ratio))
    return rows


@contextmanager
def serving(workers: int) -> Iterator[None]:
    command = [sys.executable, "-m", "uvicorn", "--factory", "bench.http:application"]
    options = ["--port", str(PORT), "--workers", str(workers), "--log-level", "warning"]
    guarded = ["--http", "app.serving.connections:GuardedProtocol", "--ws", "none"]
    server = subprocess.Popen([*command, *options, *guarded], env={**os.environ, **PROTECTED})
    try:
        wait()
        yield
    finally:
        server.terminate()
        server.wait()


def wait() -> None:
    deadline = time.monotonic() + 300
    while True:
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{PORT}/health/ready").close()
            return
        except urllib.error.URLError:
            if time.monotonic() > deadline:
                raise
            time.sleep(0.1)
