"""Mutated requests against a running service: ``python -m tests.torture.requests --count 50000``.

Every case is made from the seed and its own number, so that ``--first N --count 1`` repeats it.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import sys
import tempfile
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from tests.conftest import running_server
from tests.processes import resident_bytes, workers_of
from tests.torture.exchange import Client, Received, Sent
from tests.torture.mutations import mutated
from tests.torture.oracle import faults
from tests.torture.seeds import document_of, seeds

SETTINGS = {
    "DENAVIT_PRELOAD": "false",
    "DENAVIT_MAX_REQUEST_SECONDS": "2",
    "DENAVIT_COMPUTE_THREADS": "2",
}
"""A computation may take 2 s here, so that none has a reason to take over 5."""
CLIENTS = 4
MAX_MEGABYTES = 1500
"""Resident memory that one worker may have."""


@dataclass
class Report:
    """What a campaign saw."""

    count: int = 0
    statuses: Counter[int] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    slowest: tuple[float, str] = (0.0, "")
    health: list[float] = field(default_factory=list)
    megabytes: list[float] = field(default_factory=list)
    seconds: float = 0.0

    def add(
        self, number: int, sent: Sent, got: Received | None, wrong: list[str], lock: threading.Lock
    ) -> None:
        """Counts one case; tells what is wrong with it so that it can be repeated."""
        status, seconds, body = (
            (0, 0.0, b"") if got is None else (got.status, got.seconds, got.body)
        )
        with lock:
            self.count += 1
            self.statuses[status] += 1
            if seconds > self.slowest[0]:
                self.slowest = (seconds, f"{number}: {sent.method} {sent.target[:80]}")
            if wrong:
                self.failures.append(
                    f"{number} [{sent.what}]: {'; '.join(wrong)}\n  {sent.shown()}\n"
                    f"  -> {status} {body[:500]!r}"
                )

    def text(self) -> str:
        health = sorted(self.health) or [0.0]
        lines = [
            f"{self.count} requests in {self.seconds:.0f} s, {len(self.failures)} failures",
            "statuses: " + ", ".join(f"{k}: {n}" for k, n in sorted(self.statuses.items())),
            f"slowest: {self.slowest[0]:.2f} s, {self.slowest[1]}",
            f"/health/live: {len(health)} asked, median {1e3 * health[len(health) // 2]:.1f} ms,"
            f" p99 {1e3 * health[int(len(health) * 0.99)]:.1f} ms, worst {1e3 * health[-1]:.1f} ms",
            f"memory of the largest worker: {self.megabytes[0]:.0f} MB at first,"
            f" {max(self.megabytes):.0f} MB at most",
            *self.failures[:200],
        ]
        return "\n".join(lines)


def case(pool: list[Sent], seed: int, number: int) -> Sent:
    """The request of a number."""
    rng = Random(f"{seed}/{number}")
    return mutated(rng.choice(pool), rng)


def campaign(
    port: int, pid: int, count: int, seed: int = 0, first: int = 0, minutes: float = 0.0
) -> Report:
    """Sends ``count`` mutated requests from several connections, and watches the service."""
    pool, report, lock = seeds(document_of(port)), Report(), threading.Lock()
    workers = workers_of(pid)
    report.megabytes.append(max(map(megabytes, workers)))
    done, started = threading.Event(), time.monotonic()

    def attack(offset: int) -> None:
        with Client(port) as client:
            for number in range(first + offset, first + count, CLIENTS):
                if minutes and time.monotonic() - started > 60 * minutes:
                    return
                try:
                    sent = case(pool, seed, number)
                except Exception as error:  # a fault of this campaign, told as one
                    report.failures.append(f"{number}: no such case: {error!r}")
                    continue
                report.add(number, sent, *answered(client, sent), lock)

    def watch() -> None:
        ask = Sent("GET", "/health/live")
        with Client(port) as client:
            while not done.wait(0.05):
                got, wrong = answered(client, ask)
                if got is not None:
                    report.health.append(got.seconds)
                if wrong or got is None or got.status != 200:
                    report.failures.append(f"/health/live: {wrong} {got}")
                report.megabytes.append(max(map(megabytes, workers), default=0.0))

    threads = [threading.Thread(target=attack, args=(k,)) for k in range(CLIENTS)]
    watcher = threading.Thread(target=watch)
    for thread in (*threads, watcher):
        thread.start()
    for thread in threads:
        thread.join()
    done.set()
    watcher.join()
    report.seconds = time.monotonic() - started
    if workers_of(pid) != workers:
        report.failures.append(f"workers were {workers}, are {workers_of(pid)}: one died")
    if max(report.megabytes) > MAX_MEGABYTES:
        report.failures.append(f"a worker took {max(report.megabytes):.0f} MB")
    return report


def answered(client: Client, sent: Sent) -> tuple[Received | None, list[str]]:
    """What came back, and what is wrong with it."""
    try:
        got = client.send(sent)
    except (OSError, http.client.HTTPException) as error:
        return None, [f"no answer: {error!r}"]
    return got, faults(sent, got)


def megabytes(pid: int) -> float:
    """Resident memory; 0 of a process that is gone."""
    return resident_bytes(pid) / 1e6


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--minutes", type=float, default=0.0, help="stop after so long")
    parser.add_argument("--show", action="store_true", help="only print the cases")
    chosen = parser.parse_args()
    os.environ |= SETTINGS
    with (
        tempfile.TemporaryDirectory() as folder,
        running_server(Path(folder), "--workers", "2") as (address, process),
    ):
        port = int(address.rsplit(":", 1)[1])
        if chosen.show:
            pool = seeds(document_of(port))
            for number in range(chosen.first, chosen.first + chosen.count):
                print(json.dumps(case(pool, chosen.seed, number).shown()))
            return 0
        report = campaign(
            port, process.pid, chosen.count, chosen.seed, chosen.first, chosen.minutes
        )
    print(report.text())
    return 1 if report.failures else 0


if __name__ == "__main__":
    sys.exit(main())
