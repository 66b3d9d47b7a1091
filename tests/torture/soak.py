"""Twice as much work as there is room for: ``python -m tests.torture.soak --minutes 10``.

First clients that wait for their answers show how many requests the service can do in a second.
Then twice as many are sent, whether answers come or not. Meanwhile another process asks for
``/health/live``, and the memory of all workers is looked at.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import multiprocessing
import os
import socket
import statistics
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from random import Random

import numpy as np

from tests.conftest import PATIENCE, running_server
from tests.processes import workers_of
from tests.torture.requests import megabytes

CLIENTS = 16
"""Connections that find out how much the service can do."""
MOST_IN_FLIGHT = 400
"""Connections at a time; what comes while all are busy counts as not sent."""
DELIBERATE = {200, 201, 204, 409, 412, 428, 429, 503}
CORES = max(1, (os.cpu_count() or 2) - 1)
P99 = 0.05
"""Seconds in which /health/live answers, 99 times of 100, where the machine does nothing else."""
GROWTH = 0.10
"""By how much of itself the memory may grow between the first and the last quarter."""

Piece = tuple[int, bytes]


def pieces() -> list[Piece]:
    """Requests with their weights: what is asked of a service, cheap and dear."""
    rng = np.random.default_rng(0)
    q = rng.uniform(-1, 1, (2000, 7)).round(4).tolist()
    targets = [{"position": [0.4, 0.001 * k, 0.5], "rpy": [3.1, 0, 0]} for k in range(100)]
    scene = {
        "q": [1.9, -0.25, -0.45, -0.5, -0.5, -0.35, 0, 0.2],
        "target": {"position": [1.15, -0.15]},
        "task": "xy",
        "d_safe": 0.02,
        "samples": 31,
        "method": "sqp",
        "obstacles": [{"type": "circle", "center": [0.73, 0.22], "radius": 0.08}],
    }
    row = {"type": "R", "alpha": 0.1, "a": 0.2, "d": 0.3}
    table = {"convention": "standard", "joints": [row] * 6}
    return [
        (20, posted("/v1/robots/panda/fk", {"q": q[0]})),
        (8, posted("/v1/robots/panda/fk", {"q": q})),
        (8, posted("/v1/robots/panda/jacobian", {"q": q[:500]})),
        (8, posted("/v1/robots/panda/singularity", {"q": q[:200]})),
        (8, posted("/v1/robots/panda/ik", {"targets": targets})),
        (4, posted("/v1/robots/puma560/ik/solutions", {"target": targets[0]})),
        (4, posted("/v1/robots/planar_8r/path", scene)),
        (4, posted("/v1/fk", {"robot": table, "q": q[0][:6]})),
        (2, posted("/v1/robots/soak", table, "PUT")),
        (2, posted("/v1/robots/planar_2r/symbolic", {"quantities": ["jacobian"]})),
        (2, posted("/v1/robots/panda/fk", {"q": ["x"] * 20_000})),
        (2, posted("/v1/robots/nobody/fk", {"q": [0]})),
    ]


def posted(path: str, body: object, method: str = "POST") -> bytes:
    content = json.dumps(body).encode()
    head = f"{method} {path} HTTP/1.1\r\nHost: soak\r\nContent-Type: application/json\r\n"
    return f"{head}Content-Length: {len(content)}\r\n\r\n".encode() + content


@dataclass
class Report:
    """What a soak saw."""

    capacity: float = 0.0
    offered: int = 0
    unsent: int = 0
    seconds: float = 0.0
    statuses: Counter[int] = field(default_factory=Counter)
    health: list[float] = field(default_factory=list)
    megabytes: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)

    @property
    def p99(self) -> float:
        return sorted(self.health)[int(len(self.health) * 0.99)]

    @property
    def growth(self) -> float:
        """Of the memory, from the first quarter after the start to the last."""
        quarter = max(1, len(self.megabytes) // 4)
        first = statistics.median(self.megabytes[quarter : 2 * quarter] or self.megabytes)
        return statistics.median(self.megabytes[-quarter:]) / first - 1.0

    def text(self) -> str:
        health = sorted(self.health)
        done = sum(count for status, count in self.statuses.items() if status != 503)
        return "\n".join(
            [
                f"soak: {self.seconds:.0f} s at {self.offered / self.seconds:.0f} requests a second"
                f" ({self.capacity:.0f} can be done), {self.unsent} not sent; done {done},"
                f" {len(self.failures)} failures",
                "statuses: " + ", ".join(f"{k}: {n}" for k, n in sorted(self.statuses.items())),
                f"/health/live: {len(health)} asked, median {1e3 * health[len(health) // 2]:.1f}"
                f" ms, p99 {1e3 * self.p99:.1f} ms, worst {1e3 * health[-1]:.1f} ms",
                f"memory of all workers: {self.megabytes[0]:.0f} MB at first,"
                f" {max(self.megabytes):.0f} MB at most, {self.megabytes[-1]:.0f} MB at last,"
                f" growth {100 * self.growth:+.1f} %",
                *self.failures[:50],
            ]
        )


def soak(port: int, pid: int, seconds: float, seed: int = 0) -> Report:
    """Loads a service for so long."""
    report, rng, choices = Report(), Random(seed), pieces()
    workers = workers_of(pid)
    report.capacity = asyncio.run(_capacity(port, choices, rng, min(10.0, seconds / 3)))
    ours, theirs = multiprocessing.get_context("spawn").Pipe()
    prober = multiprocessing.get_context("spawn").Process(target=probe, args=(port, theirs))
    prober.start()
    ours.recv()  # it is running
    try:
        asyncio.run(_load(port, choices, rng, seconds, workers, report))
    finally:
        ours.send("stop")
        report.health, unwell = ours.recv()
        prober.join()
    report.failures += unwell
    if workers_of(pid) != workers:
        report.failures.append(f"workers were {workers}, are {workers_of(pid)}: one died")
    return report


def probe(port: int, connection: Connection) -> None:
    """Asks for /health/live twenty times a second, each time on a connection of its own."""
    ask = b"GET /health/live HTTP/1.1\r\nHost: soak\r\nConnection: close\r\n\r\n"
    found: list[float] = []
    unwell: list[str] = []
    connection.send("ready")
    while not connection.poll(0.05):
        started = time.perf_counter()
        try:
            with socket.create_connection(("127.0.0.1", port), PATIENCE) as one:
                one.sendall(ask)
                answer = b""
                while part := one.recv(4096):
                    answer += part
            if not answer.startswith(b"HTTP/1.1 200 "):
                unwell.append(f"/health/live: {answer[:100]!r}")
        except OSError as error:
            unwell.append(f"/health/live: {error!r}")
        found.append(time.perf_counter() - started)
    connection.send((found, unwell))


async def _capacity(port: int, choices: list[Piece], rng: Random, seconds: float) -> float:
    """Requests a second that the service does for clients that wait for their answers."""
    done, end = 0, time.monotonic() + seconds

    async def client() -> None:
        nonlocal done
        while time.monotonic() < end:
            await _asked(port, _chosen(choices, rng))
            done += 1

    started = time.monotonic()
    await asyncio.gather(*(client() for _ in range(CLIENTS)))
    return done / (time.monotonic() - started)


async def _load(
    port: int, choices: list[Piece], rng: Random, seconds: float, workers: list[int], report: Report
) -> None:
    """Sends twice as many requests as can be done, in even steps."""
    pause, started = 1.0 / (2.0 * report.capacity), time.monotonic()
    flying: set[asyncio.Task[None]] = set()
    looked = 0.0

    async def one(request: bytes) -> None:
        before = time.monotonic()
        try:
            status = await _asked(port, request)
        except (OSError, asyncio.IncompleteReadError, ValueError) as error:
            report.failures.append(f"{request[:60]!r}: {error!r}")
            return
        report.statuses[status] += 1
        # Waiting in the queue, then the longest computation.
        if time.monotonic() - before > PATIENCE:
            report.failures.append(f"{request[:60]!r} took {time.monotonic() - before:.0f} s")
        elif status not in DELIBERATE and not (status in (404, 422) and status_is_right(request)):
            report.failures.append(f"{request[:60]!r}: status {status}")

    while (now := time.monotonic() - started) < seconds:
        report.offered += 1
        if len(flying) < MOST_IN_FLIGHT:
            task = asyncio.create_task(one(_chosen(choices, rng)))
            flying.add(task)
            task.add_done_callback(flying.discard)
        else:
            report.unsent += 1
        if now - looked > 0.5:
            looked = now
            report.megabytes.append(sum(megabytes(pid) for pid in workers))
        await asyncio.sleep(max(0.0, report.offered * pause - (time.monotonic() - started)))
    report.seconds = time.monotonic() - started
    await asyncio.gather(*flying)


def status_is_right(request: bytes) -> bool:
    """Whether a request is one of those that are wrong on purpose."""
    return b"/nobody/" in request[:60] or b'["x"' in request[:200]


def _chosen(choices: list[Piece], rng: Random) -> bytes:
    return rng.choices([one for _, one in choices], [weight for weight, _ in choices])[0]


async def _asked(port: int, request: bytes) -> int:
    """The status of the answer to one request, on a connection of its own, read to its end."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=2**20)
    try:
        writer.write(request)
        head = (await reader.readuntil(b"\r\n\r\n")).lower()
        length = int(head.partition(b"content-length:")[2].split(b"\r\n", 1)[0] or 0)
        await reader.readexactly(length)
        return int(head[9:12])
    finally:
        writer.close()


def slower() -> float:
    """By how much a busy machine makes everything slower: processes that wait, per core."""
    return max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=CORES, help="a core is left to the clients")
    chosen = parser.parse_args()
    os.environ["DENAVIT_PRELOAD"] = "true"
    with (
        tempfile.TemporaryDirectory() as folder,
        running_server(Path(folder), "--workers", str(chosen.workers)) as (address, process),
    ):
        report = soak(int(address.rsplit(":", 1)[1]), process.pid, 60 * chosen.minutes, chosen.seed)
    print(report.text())
    slow = report.p99 > P99 * slower()
    return 1 if report.failures or slow or report.growth > GROWTH else 0


if __name__ == "__main__":
    sys.exit(main())
