"""``python -m bench.http_short``: short computations over HTTP, beside a server that does nothing.

The other server is uvicorn with an application that answers with as many bytes and the same
headers, without reading the body. All servers run one process each with the same event loop and
parser, and are loaded in turns by wrk. ``--before PATH`` adds the server of an older checkout,
with its environment in ``.venv``.

Ratios of rates are medians over the rounds, and their best; a busy machine leaves ratios of
processor time alone, which are the server's own seconds for each request, user and system.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.pairs import Row

PORT = 8921
SECONDS, ROUNDS = 1, 7
CONNECTIONS = 8, 64
TICKS = os.sysconf("SC_CLK_TCK")
Q = [0.1, 0.2, 0.3, -1.0, 0.5, 1.2, 0.7]
PANDA = {"target": {"position": [0.4, 0.1, 0.5], "rpy": [3.14, 0, 0]}}
SEEDED = PANDA | {"seed": [0, 0, 0, -1.5, 0, 1.5, 0]}
PUMA = {"target": {"position": [0.4972, -0.1009, 0.884], "rpy": [-0.1164, -0.3036, 1.0983]}}
REQUESTS: dict[str, tuple[str, Mapping[str, Any]]] = {
    "fk": ("panda/fk", {"q": Q}),
    "jacobian": ("panda/jacobian", {"q": Q}),
    "ik": ("panda/ik", SEEDED),
    "ik, closed form": ("puma560/ik", PUMA),
    "singularity": ("panda/singularity", {"q": Q}),
    "ik/solutions": ("puma560/ik/solutions", PUMA),
}
NO_OP = "raw no-op"
FIXED = ("date", "connection", "keep-alive", "content-length", "x-request-id")
"""Headers that the server adds, or that the other makes."""


@dataclass(frozen=True)
class Load:
    """Requests a second, percentiles of the latency in ms, processor time a request in s."""

    rate: float
    p50: float
    p99: float
    busy: float


@dataclass(frozen=True)
class Served:
    """A server that is up."""

    port: int
    pid: int

    def ask(self, path: str, body: Mapping[str, Any]) -> tuple[list[tuple[str, str]], bytes]:
        """Return headers and body of an answer."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port)
        connection.request("POST", path, json.dumps(body), {"Content-Type": "application/json"})
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        if answer.status != 200:
            raise RuntimeError(f"{path}: {answer.status} {text[:200]!r}")
        return answer.getheaders(), text

    def busy(self) -> float:
        """Return its seconds of processor time."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def load(self, script: Path, path: str, connections: int, seconds: int) -> Load:
        """Return what wrk and the kernel tell of some seconds."""
        began = self.busy()
        command = ["wrk", "-t1", f"-c{connections}", f"-d{seconds}s", "--latency", "-s", script]
        command.append(f"http://127.0.0.1:{self.port}{path}")
        done = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        if "Non-2xx" in done or "Socket errors" in done:
            raise RuntimeError(f"{path}: {done}")
        requests = int(found(r"(\d+) requests in", done))
        p50, p99 = (percentile(done, number) for number in (50, 99))
        rate = float(found(r"Requests/sec:\s+([\d.]+)", done))
        return Load(rate, p50, p99, (self.busy() - began) / requests)


def found(pattern: str, text: str) -> str:
    match = re.search(pattern, text)
    assert match is not None
    return match[1]


def percentile(text: str, number: int) -> float:
    """Return milliseconds from wrk's table of latencies."""
    match = re.search(rf"{number}%\s+([\d.]+)(us|ms|s)", text)
    assert match is not None
    return float(match[1]) * {"us": 1e-3, "ms": 1.0, "s": 1e3}[match[2]]


async def no_op(scope: Any, receive: Any, send: Any) -> None:
    """Answer with so many bytes and those headers, as the environment says."""
    del receive
    if scope["type"] == "http":
        await send({"type": "http.response.start", "status": 200, "headers": HEADERS})
        await send({"type": "http.response.body", "body": BODY})


HEADERS: list[tuple[bytes, bytes]] = [
    (name.encode(), value.encode())
    for name, value in json.loads(os.environ.get("BENCH_HEADERS", "[]"))
]
BODY = b"x" * int(os.environ.get("BENCH_BYTES", "0"))


def free_of(headers: list[tuple[str, str]], size: int) -> list[tuple[str, str]]:
    """Return the headers that the no-op answers with."""
    kept = [(name.lower(), value) for name, value in headers if name.lower() not in FIXED]
    return [("content-length", str(size)), ("x-request-id", "0123456789ab-1234"), *kept]


@contextmanager
def denavit(checkout: Path, port: int) -> Iterator[Served]:
    """Run ``denavit serve`` of a checkout."""
    own = checkout / ".venv" / "bin" / "python"
    python = str(own) if own.exists() else sys.executable
    code = "import sys; from app.cli import main; sys.argv[0] = 'denavit'; sys.exit(main())"
    with tempfile.TemporaryDirectory() as data:
        command = [python, "-c", code, "serve", "--port", str(port), "--data-dir", data]
        with serving(command, port, "/health/ready", checkout, {}) as served:
            yield served


@contextmanager
def idle(port: int, headers: list[tuple[str, str]], size: int) -> Iterator[Served]:
    """Run uvicorn with the no-op."""
    told = {"BENCH_HEADERS": json.dumps(free_of(headers, size)), "BENCH_BYTES": str(size)}
    command = [sys.executable, "-m", "uvicorn", "bench.http_short:no_op", "--port", str(port)]
    command += ["--log-level", "critical", "--no-access-log", "--no-server-header"]
    command += ["--lifespan", "off", "--ws", "none", "--http", "httptools"]
    with serving(command, port, "/", Path(__file__).parents[1], told) as served:
        yield served


@contextmanager
def serving(
    command: list[str], port: int, probe: str, cwd: Path, more: dict[str, str]
) -> Iterator[Served]:
    environment = {**os.environ, **more, "PYTHONPATH": str(cwd)}
    environment.pop("NUMBA_CACHE_DIR", None)
    process = subprocess.Popen(
        command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, cwd=cwd, env=environment
    )
    try:
        wait(process, port, probe)
        yield Served(port, process.pid)
    finally:
        process.terminate()
        process.wait()


def wait(process: subprocess.Popen[bytes], port: int, probe: str) -> None:
    """Return once a server is ready."""
    deadline = time.monotonic() + 300
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise RuntimeError(f"{process.args!r} stopped")
        connection = http.client.HTTPConnection("127.0.0.1", port)
        try:
            connection.request("GET", probe)
            if connection.getresponse().status == 200:
                return
        except OSError:
            pass
        finally:
            connection.close()
        time.sleep(0.2)
    raise RuntimeError(f"{process.args!r} is not ready")


def measured(
    chosen: list[str],
    before: Path | None,
    connections: int,
    *,
    rounds: int = ROUNDS,
    seconds: int = SECONDS,
    port: int = PORT,
) -> dict[str, dict[str, list[Load]]]:
    """Return the loads of each round by request and server, all servers in turns."""
    loads: dict[str, dict[str, list[Load]]] = {}
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        here = stack.enter_context(denavit(Path(__file__).parents[1], port))
        servers = {"now": here}
        if before is not None:
            servers["before"] = stack.enter_context(denavit(before, port + 1))
        for name in chosen:
            path, body = REQUESTS[name]
            path = f"/v1/robots/{path}"
            headers, text = here.ask(path, body)
            script = folder / "request.lua"
            script.write_text(
                f"wrk.method='POST'\nwrk.body='{json.dumps(body)}'\n"
                "wrk.headers['Content-Type']='application/json'\n"
            )
            with idle(port + 2, headers, len(text)) as other:
                turn = servers | {NO_OP: other}
                for one in turn.values():
                    one.load(script, path, connections, 1)
                kept = loads[name] = {key: [] for key in turn}
                for _ in range(rounds):
                    for key, one in turn.items():
                        kept[key].append(one.load(script, path, connections, seconds))
    return loads


def rows_of(loads: dict[str, dict[str, list[Load]]], connections: int) -> list[Row]:
    """Return a line for each pair of servers and each figure."""
    rows = []
    for name, by_server in loads.items():
        ours = by_server["now"]
        for other, theirs in by_server.items():
            if other == "now":
                continue
            pairs = list(zip(ours, theirs, strict=True))
            rates = statistics.median(a.rate / b.rate for a, b in pairs)
            best = max(one.rate for one in ours) / max(one.rate for one in theirs)
            busy = min(one.busy for one in theirs) / min(one.busy for one in ours)
            tails = statistics.median((a.p99 / a.p50) / (b.p99 / b.p50) for a, b in pairs)
            head = f"POST {name} | {other}, {connections} connections"
            most = [f"{max(one.rate for one in some):.0f}/s" for some in (ours, theirs)]
            spent = [f"{min(one.busy for one in some) * 1e6:.1f} µs" for some in (ours, theirs)]
            tail = [
                f"{statistics.median(one.p99 / one.p50 for one in some):.2f}"
                for some in (ours, theirs)
            ]
            rows.append(Row(f"{head}: requests a second, median", *most, rates))
            rows.append(Row(f"{head}: requests a second, best", *most, best))
            rows.append(Row(f"{head}: requests a second of processor time", *spent, busy))
            rows.append(Row(f"{head}: 99th percentile over median", *tail, tails))
    return rows


def run(before: Path | None = None) -> list[Row]:
    """Return the lines of ``python -m bench``."""
    if shutil.which("wrk") is None:
        print("wrk is not installed (apt install wrk): no figures over HTTP")
        return []
    names = list(REQUESTS)
    return [
        row for number in CONNECTIONS for row in rows_of(measured(names, before, number), number)
    ]


def main() -> None:
    """Print what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m bench.http_short", description=__doc__)
    parser.add_argument("--before", type=Path, metavar="PATH", help="an older checkout")
    parser.add_argument("--only", nargs="+", default=list(REQUESTS), choices=list(REQUESTS))
    parser.add_argument("--connections", nargs="+", type=int, default=list(CONNECTIONS))
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--seconds", type=int, default=SECONDS)
    parser.add_argument("--port", type=int, default=PORT, help="the first of three")
    chosen = parser.parse_args()
    for number in chosen.connections:
        older = None if chosen.before is None else chosen.before.resolve()
        loads = measured(
            chosen.only,
            older,
            number,
            rounds=chosen.rounds,
            seconds=chosen.seconds,
            port=chosen.port,
        )
        for row in rows_of(loads, number):
            print(f"{row.what:78}{row.ours:>12}{row.other:>12}  {row.ratio:.2f}", flush=True)


if __name__ == "__main__":
    main()
