"""Children that are killed while they work: ``python -m tests.torture.children``.

Closed forms are asked for one after the other, each of another table, so that no answer is known
yet. At random moments the processes that compute them are killed, at most once a request. Every
answer must come, and be right.
"""

from __future__ import annotations

import argparse
import math
import os
import signal
import statistics
import sys
import tempfile
import threading
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

import httpx

from tests.conftest import PATIENCE, running_server
from tests.processes import symbolic_processes

TOLERANCE = 1e-12
SPARE = 20
"""Requests at the end that no kill is planned for: some kills find no process yet."""
TYPICAL = 50
"""Requests whose times tell how long a request takes."""


@dataclass
class Report:
    """What a campaign saw."""

    requests: int = 0
    kills: int = 0
    busy_kills: int = 0
    statuses: Counter[int] = field(default_factory=Counter)
    seconds: float = 0.0
    slowest: float = 0.0
    failures: list[str] = field(default_factory=list)

    def text(self) -> str:
        statuses = ", ".join(f"{k}: {n}" for k, n in sorted(self.statuses.items()))
        return "\n".join(
            [
                f"children: {self.requests} requests, {self.kills} kills ({self.busy_kills} while"
                f" the request ran), {len(self.failures)} answers lost or wrong;"
                f" {self.seconds:.0f} s, the slowest answer {self.slowest:.1f} s",
                f"statuses: {statuses}",
                *self.failures[:20],
            ]
        )


def question(number: int) -> tuple[dict[str, object], tuple[float, float]]:
    """A request that no other number asks, and the lengths of its planar arm."""
    lengths = 0.1 + 1e-6 * number, 0.7 - 1e-6 * number
    rows = [{"type": "R", "a": a, "alpha": 0, "d": 0} for a in lengths]
    table = {"convention": "standard", "joints": rows}
    return {"robot": table, "quantities": ["position"]}, lengths


def fault_of(answer: dict[str, dict[str, str]], lengths: tuple[float, float]) -> str | None:
    """What is wrong with the position of a planar arm, at one q."""
    q1, q2 = 0.3, 0.4
    angles = {"1": q1, "2": q2, "12": q1 + q2}
    scope = {f"C{name}": math.cos(angle) for name, angle in angles.items()}
    scope |= {f"S{name}": math.sin(angle) for name, angle in angles.items()}
    scope |= {"cos": math.cos, "sin": math.sin, "q1": q1, "q2": q2}  # type: ignore[dict-item]
    right = {
        "X": lengths[0] * math.cos(q1) + lengths[1] * math.cos(q1 + q2),
        "Y": lengths[0] * math.sin(q1) + lengths[1] * math.sin(q1 + q2),
    }
    for name, value in right.items():
        text = answer["position"][name]
        found = eval(text, {"__builtins__": {}}, scope)  # what the service itself wrote
        if not abs(found - value) <= TOLERANCE:
            return f"{name} = {text}, which is {found}, not {value}"
    return None


class Killer:
    """Kills the children of a service once, a while after a request began."""

    def __init__(self, pid: int, delay: float) -> None:
        self._pid, self._delay = pid, delay
        self.killed = 0
        self.answered = threading.Event()
        self.while_running = False
        self._thread = threading.Thread(target=self._run)

    def start(self) -> None:
        self._thread.start()

    def join(self) -> None:
        self._thread.join()

    def _run(self) -> None:
        self.answered.wait(self._delay)
        for child in symbolic_processes(self._pid):
            with suppress(ProcessLookupError):
                os.kill(child, signal.SIGKILL)
                self.killed += 1
        self.while_running = bool(self.killed) and not self.answered.is_set()


def campaign(address: str, pid: int, requests: int, kills: int, seed: int = 0) -> Report:
    """Ask so many questions and kill children while so many of them are answered."""
    rng, report = Random(seed), Report()
    started = time.monotonic()
    times: list[float] = []
    with httpx.Client(base_url=address, timeout=PATIENCE) as client:
        for number in range(requests):
            # So that all kills are done: a random share of what is left, from the second on.
            left = requests - number
            kills_left = kills - report.kills
            killer = None
            if number and kills_left > 0 and rng.random() < kills_left / max(1, left - SPARE):
                typical = statistics.median(times[-TYPICAL:])
                killer = Killer(pid, rng.uniform(0.0, 1.2 * typical))
            before = time.monotonic()
            _ask(client, number, killer, report)
            spent = time.monotonic() - before
            report.slowest = max(report.slowest, spent)
            if killer is None:
                times.append(spent)
            else:
                report.kills += killer.killed
                report.busy_kills += killer.while_running
    report.requests, report.seconds = requests, time.monotonic() - started
    return report


def _ask(client: httpx.Client, number: int, killer: Killer | None, report: Report) -> None:
    body, lengths = question(number)
    if killer is not None:
        killer.start()
    try:
        answer = client.post("/v1/symbolic", json=body)
    except httpx.TransportError as error:
        report.failures.append(f"request {number}: {error!r}")
        return
    finally:
        if killer is not None:
            killer.answered.set()
            killer.join()
    report.statuses[answer.status_code] += 1
    if answer.status_code != 200:
        report.failures.append(f"request {number}: {answer.status_code} {answer.text[:200]}")
        return
    fault = fault_of(answer.json(), lengths)
    if fault is not None:
        report.failures.append(f"request {number}: {fault}")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--requests", type=int, default=10_000)
    parser.add_argument("--kills", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as folder,
        running_server(Path(folder)) as (address, process),
    ):
        report = campaign(address, process.pid, chosen.requests, chosen.kills, chosen.seed)
    print(report.text())
    return 1 if report.failures or report.kills < chosen.kills else 0


if __name__ == "__main__":
    sys.exit(main())
