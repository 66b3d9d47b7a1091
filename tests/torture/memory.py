"""Every computation at the limits of its schema: ``python -m tests.torture.memory``.

Alone, the growth of the worker's memory is compared with what the computation said that it needs.
In pairs, each with each, nothing may die, and the memory of a worker stays within its bound;
meanwhile another process asks for ``/health/live``. ``--names`` takes beginnings of names.
"""

from __future__ import annotations

import argparse
import asyncio
import itertools
import multiprocessing
import random
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import httpx
import pytest

from app.documents import robot_from_inline
from app.fields.doubts import RequestDoubts
from app.fields.field import Reading
from app.http.npy import decode_npy
from app.http.units import Units
from app.operations import OPERATIONS, Context
from app.settings import Settings
from kinematics.symbolic import SymbolicWorkers
from tests.conftest import PATIENCE, running_server, until
from tests.processes import family_of, workers_of
from tests.torture.at_limits import NPY, ROBOTS, Case, cases, table
from tests.torture.soak import probe

WORKER_BYTES = 1_000_000_000
"""Of each of two workers: the 1 GB, and 500 MB for each, that are recommended."""
FITTING = {200, 413, 503}
LARGE, ROOM = 50_000_000, 25_000_000
"""Bytes of an estimate that is held to be near; bytes that a first request may load."""
SETTLED = 3.0
"""Seconds after which a worker has given memory back, at the latest."""
LONGEST = 900.0
"""Seconds of a computation that is measured: what is cut off takes less than it would."""


@dataclass(frozen=True)
class Measured:
    """What one request took, bytes.

    Attributes:
        case: The request.
        status: Of its answer.
        estimate: What its computation said that it needs.
        growth: Of the worker, and of its processes.
        kept: What has not been given back.
        seconds: How long it took.
    """

    case: Case
    status: int
    estimate: int
    growth: int
    kept: int
    seconds: float

    @property
    def as_said(self) -> bool:
        """Whether it is within a factor of two of the estimate; small ones only below it."""
        least = self.estimate / 2 if self.status == 200 and self.estimate > LARGE else 0
        return least - ROOM <= self.growth <= self.estimate + ROOM

    def text(self) -> str:
        """One line of the report."""
        ratio = self.growth / max(1, self.estimate)
        return (
            f"{self.case.name:36s} {self.status} estimate {self.estimate / 1e6:7.0f} MB"
            f"  measured {self.growth / 1e6:7.0f} MB  ratio {ratio:5.2f}"
            f"  kept {self.kept / 1e6:+5.0f} MB  {self.seconds:5.1f} s"
        )


def estimate(case: Case) -> int:
    """Return what a request says that it needs, with what reading and holding its body takes."""
    robot = robot_from_inline(table(case.robot))
    operation = next(one for one in OPERATIONS if one.name == case.operation)
    settings, units, form = Settings(), Units(), operation.form
    doubts = RequestDoubts(robot, units, ())
    reading = Reading(robot, units, settings, doubts, {})
    query = dict(httpx.QueryParams(case.query.lstrip("?")))
    if case.type == NPY:
        assert operation.npy_field is not None
        decoded = form.from_npy(operation.npy_field, decode_npy(case.body), query, reading)
    else:
        decoded = form.from_json(case.body, units)
    accept = operation.forms[0] if case.accept == "*/*" else case.accept
    symbolic = SymbolicWorkers()
    context = Context(units, settings, doubts, accept, symbolic)
    need = operation.memory(robot, form.resolved(decoded, reading), context)
    return max(need.bytes, 4 * len(case.body)) + len(case.body)


def status_of(pid: int, name: str) -> int:
    """Return an entry of /proc/PID/status, bytes; 0 where the process has ended."""
    try:
        text = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0
    _, found, rest = text.partition(f"{name}:")
    return int(rest.split(maxsplit=1)[0]) * 1024 if found else 0


def taken(pid: int) -> int:
    """Return what a process and those below it take, bytes; libraries, which they share, once."""
    family = family_of(pid)
    own = sum(status_of(one, "RssAnon") + status_of(one, "RssShmem") for one in family)
    return own + max(status_of(one, "RssFile") for one in family)


def forget_peak(pid: int) -> None:
    """Have the largest resident memory of a process begin with that of now."""
    Path(f"/proc/{pid}/clear_refs").write_text("5")


@contextmanager
def watched(pid: int) -> Iterator[list[int]]:
    """Watch the memory of the processes below one; the list gets the largest sum."""
    most, stop = [0], threading.Event()

    def watch() -> None:
        while not stop.wait(0.05):
            most[0] = max(most[0], sum(status_of(one, "VmRSS") for one in family_of(pid)[1:]))

    watching = threading.Thread(target=watch)
    watching.start()
    try:
        yield most
    finally:
        stop.set()
        watching.join()


@contextmanager
def service(workers: int, worker_bytes: int, **settings: object) -> Iterator[tuple[str, int]]:
    """A service with the robot at the limits; gives its address and process."""
    chosen = {"max_worker_bytes": worker_bytes, "log_level": "error", **settings}
    with pytest.MonkeyPatch.context() as environment, tempfile.TemporaryDirectory() as folder:
        for name, value in chosen.items():
            environment.setenv(f"DENAVIT_{name.upper()}", str(value))
        arguments = ("--workers", str(workers))
        with running_server(Path(folder), *arguments) as (address, process):
            for robot in ROBOTS:
                path = f"{address}/v1/robots/{robot}"
                answer = httpx.put(path, json=table(robot), timeout=PATIENCE)
                assert answer.status_code == 201, answer.text
            yield address, process.pid


def sent(client: httpx.Client, case: Case) -> int:
    """Send a request and read its answer away; return the status."""
    with client.stream("POST", case.address, content=case.body, headers=case.headers) as answer:
        for _ in answer.iter_raw():
            pass
        return answer.status_code


def alone(
    chosen: Sequence[Case], worker_bytes: int = 1 << 40, seconds: float = LONGEST
) -> Iterator[Measured]:
    """Send requests one by one and measure each; a computation may take so long."""
    with (
        service(1, worker_bytes, max_request_seconds=seconds) as (address, pid),
        httpx.Client(base_url=address, timeout=seconds + PATIENCE) as client,
    ):
        until(lambda: len(family_of(pid)) == 1)  # no longer compiling
        kept = 0
        for case in chosen:
            said = estimate(case)
            small = {"q": [[0.0] * ROBOTS[case.robot]] * 2}
            client.post(f"/v1/robots/{case.robot}/fk", json=small).raise_for_status()
            before = status_of(pid, "VmRSS")
            idle = sum(status_of(one, "VmRSS") for one in family_of(pid)[1:])
            forget_peak(pid)
            started = time.monotonic()
            with watched(pid) as below:
                status = sent(client, case)
            seconds = time.monotonic() - started
            # What the one before left free in the process serves this one.
            growth = status_of(pid, "VmHWM") - before + max(0, kept) + max(0, below[0] - idle)
            deadline = time.monotonic() + SETTLED
            while (kept := status_of(pid, "VmRSS") - before) > 0 and time.monotonic() < deadline:
                time.sleep(0.1)
            yield Measured(case, status, said, growth, kept, seconds)


@dataclass
class Report:
    """What a campaign of pairs saw.

    Attributes:
        pairs: Number of pairs.
        statuses: Answers by status.
        peak: Largest memory of all processes, bytes.
        health: Seconds in which ``/health/live`` answered.
        failures: What must not happen.
    """

    pairs: int = 0
    statuses: Counter[int] = field(default_factory=Counter)
    peak: int = 0
    health: list[float] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)

    def text(self) -> str:
        """The report."""
        health = sorted(self.health)
        p99 = health[int(len(health) * 0.99)] if health else 0.0
        return "\n".join(
            [
                f"{self.pairs} pairs; statuses {dict(sorted(self.statuses.items()))}",
                f"largest memory of all processes: {self.peak / 1e6:.0f} MB",
                f"/health/live: {len(health)} asked, p99 {1e3 * p99:.1f} ms",
                *(self.failures or ["no failures"]),
            ]
        )


def in_pairs(
    pairs: Sequence[tuple[Case, Case]],
    workers: int = 2,
    worker_bytes: int = WORKER_BYTES,
    told: Callable[[str], None] = lambda _: None,
    *,
    preload: bool = True,
) -> Report:
    """Send pairs of requests at the same time to some workers; tell a line of each."""
    report = Report()
    spawn = multiprocessing.get_context("spawn")
    with service(workers, worker_bytes, preload=preload) as (address, pid):
        httpx.get(f"{address}/health/ready", timeout=PATIENCE).raise_for_status()
        before = workers_of(pid)
        ours, theirs = spawn.Pipe()
        prober = spawn.Process(target=probe, args=(int(address.rsplit(":", 1)[1]), theirs))
        prober.start()
        ours.recv()
        stop = threading.Event()

        def watch() -> None:
            while not stop.wait(0.1):
                report.peak = max(report.peak, taken(pid))

        watching = threading.Thread(target=watch)
        watching.start()
        try:
            for pair in pairs:
                asyncio.run(_together(address, pair, report, told))
        finally:
            stop.set()
            watching.join()
            ours.send("stop")
            report.health, unwell = ours.recv()
            prober.join()
        report.failures += unwell
        if workers_of(pid) != before:
            report.failures.append(f"workers were {before}, are {workers_of(pid)}: one died")
    if report.peak > workers * worker_bytes:
        report.failures.append(f"they took {report.peak / 1e6:.0f} MB")
    return report


async def _together(
    address: str, pair: tuple[Case, Case], report: Report, told: Callable[[str], None]
) -> None:
    async def one(case: Case) -> None:
        # A connection of its own, so that any worker may get it.
        async with httpx.AsyncClient(base_url=address, timeout=PATIENCE) as client:
            try:
                async with client.stream(
                    "POST", case.address, content=case.body, headers=case.headers
                ) as answer:
                    head = b""
                    async for part in answer.aiter_raw():
                        head = head or part[:300]
            except httpx.TransportError as error:
                report.failures.append(f"{case.name}: {error!r}")
                return
        statuses.append(answer.status_code)
        report.statuses[answer.status_code] += 1
        if answer.status_code not in FITTING and b"out-of-time" not in head:
            report.failures.append(f"{case.name}: {answer.status_code} {head!r}")

    report.pairs += 1
    statuses: list[int] = []
    started = time.monotonic()
    await asyncio.gather(*map(one, pair))
    names = " + ".join(case.name for case in pair)
    told(f"{names:75s} {statuses} {time.monotonic() - started:5.1f} s")


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--names", nargs="*", default=[""], help="beginnings of names")
    parser.add_argument("--pairs", type=int, help="so many of all pairs; default all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--alone", action="store_true", help="only one by one")
    parser.add_argument("--together", action="store_true", help="only in pairs")
    options = parser.parse_args()
    chosen = [one for one in cases() if one.name.startswith(tuple(options.names))]
    failed = False
    if not options.together:
        for measured in alone(chosen):
            print(measured.text(), flush=True)
            failed |= not measured.as_said
    if not options.alone:
        pairs = list(itertools.combinations_with_replacement(chosen, 2))
        random.Random(options.seed).shuffle(pairs)
        report = in_pairs(pairs[: options.pairs], told=lambda line: print(line, flush=True))
        print(report.text())
        failed |= bool(report.failures)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
