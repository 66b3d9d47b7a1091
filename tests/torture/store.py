"""The store under kill -9, full disks, copies and two workers: ``python -m tests.torture.store``.

Every campaign gives a :class:`Report`; what it holds against the store is in its ``failures``.
"""

from __future__ import annotations

import argparse
import hashlib
import http.client
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from random import Random
from typing import Any

from robots.errors import QuotaReached, RobotNotFound, StorageError
from robots.shipped import shipped_ids
from robots.store import RobotStore
from tests.conftest import PATIENCE, running_server, until
from tests.processes import workers_of
from tests.torture.disks import small_disk
from tests.torture.writers import SHARED, number_in, robot_of

GONE = "none"


@dataclass
class Report:
    """What a campaign did, and what went wrong in it."""

    name: str
    counts: dict[str, int] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)
    seconds: float = 0.0

    def count(self, what: str, number: int = 1) -> None:
        self.counts[what] = self.counts.get(what, 0) + number

    def expect(self, holds: bool, failure: str) -> None:
        if not holds:
            self.failures.append(failure)

    def text(self) -> str:
        counts = ", ".join(f"{number} {what}" for what, number in self.counts.items())
        head = f"{self.name}: {counts}; {len(self.failures)} failures in {self.seconds:.0f} s"
        return "\n".join([head, *(f"  {failure}" for failure in self.failures[:20])])


@contextmanager
def timed(name: str) -> Iterator[Report]:
    report, start = Report(name), time.monotonic()
    yield report
    report.seconds = time.monotonic() - start


def uploads(store: RobotStore) -> list[str]:
    return [robot_id for robot_id in store.ids() if robot_id not in shipped_ids()]


def check_files(directory: Path, report: Report) -> None:
    """What must hold of a directory whoever was killed, found out without the store's own code."""
    size = count = 0
    for path in (directory / "robots").iterdir():
        if not path.name.endswith(".json"):
            report.expect(False, f"left behind: {path.name}")
            continue
        content = path.read_bytes()
        checksum, _, rest = content.partition(b"\n")
        whole = hashlib.sha256(rest).hexdigest().encode() == checksum
        report.expect(whole, f"torn: {path.name}, {len(content)} bytes")
        count, size = count + 1, size + len(content)
    usage = RobotStore(directory).usage()
    report.expect((usage.robots, usage.bytes) == (count, size), f"{usage}: {count}, {size} bytes")
    moved = list((directory / "quarantine").glob("*"))
    report.expect(not moved, f"in quarantine: {moved}")


@contextmanager
def forking_writers(directory: Path) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", "tests.torture.writers", str(directory)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def killed_writers(directory: Path, kills: int, seed: int = 0, writers: int = 3) -> Report:
    """Processes that write, killed at random moments: nothing torn, nothing confirmed is lost."""
    rng = Random(seed)
    with timed("killed writers") as report, forking_writers(directory) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        expected: dict[str, str] = {}
        counted: set[str] = set()
        while report.counts.get("kills", 0) < kills:
            process.stdin.write(f"{rng.randrange(10**6)} {writers}\n")
            children = [int(word) for word in process.stdout.readline().split()[1:]]
            lines = [process.stdout.readline()]
            while not lines[-1].startswith("done"):
                lines.append(process.stdout.readline())
            time.sleep(rng.uniform(0.0, 0.1))
            for child in rng.sample(children, len(children)):
                os.kill(child, signal.SIGKILL)
                report.count("kills")
                time.sleep(rng.choice((0.0, 0.0, 0.01)))
            confirmed, unsaid = _said(chain(lines, process.stdout), report)
            report.count("writes", len(confirmed))
            for name, number in confirmed:
                if name == SHARED:
                    report.expect(number not in counted, f"{number} was counted twice")
                    counted.add(number)
                else:
                    expected[name] = number
            store = RobotStore(directory)
            for name in {*expected, *(name for name, _ in unsaid)} - {SHARED}:
                found = _stored(store, name)
                values = {expected.get(name, GONE), *(n for one, n in unsaid if one == name)}
                report.expect(found in values, f"{name} is {found}, not one of {sorted(values)}")
                expected[name] = found
            reached = int(_stored(store, SHARED))
            # A killed writer may have counted without having said so.
            counted |= {n for name, n in unsaid if name == SHARED and int(n) <= reached}
            report.expect(
                counted == set(map(str, range(1, reached + 1))), f"lost updates up to {reached}"
            )
            check_files(directory, report)
        report.count("counted", len(counted))
    return report


def _said(
    lines: Iterable[str], report: Report
) -> tuple[list[tuple[str, str]], set[tuple[str, str]]]:
    """What writers confirmed, in order, and what they began and did not end."""
    confirmed: list[tuple[str, str]] = []
    begun: list[tuple[str, str]] = []
    for line in lines:
        if line == "gone\n":
            break
        step, name, number = line.split()
        if step == "try":
            begun.append((name, number))
        else:
            begun.remove((name, number))
        if step == "done":
            confirmed.append((name, number))
    else:
        report.expect(False, "the writers' parent has ended")
    return confirmed, set(begun)


def _stored(store: RobotStore, name: str) -> str:
    try:
        return str(number_in(store.get(name).robot))
    except RobotNotFound:
        return GONE


class Caller:
    """A client of one thread that opens a connection a request, so that any worker may answer."""

    def __init__(self, address: str) -> None:
        self._port = int(address.rsplit(":", 1)[1])

    def call(
        self, method: str, path: str, body: Any = None, **headers: str
    ) -> tuple[int, str, bytes]:
        """Status, ETag and content.

        Raises:
            OSError: There was no answer.
        """
        connection = http.client.HTTPConnection("127.0.0.1", self._port, timeout=PATIENCE)
        try:
            named = {name.replace("_", "-"): value for name, value in headers.items()}
            if body is not None:
                named["Content-Type"] = "application/json"
            content = None if body is None else json.dumps(body).encode()
            connection.request(method, path, content, named)
            answer = connection.getresponse()
            return answer.status, answer.headers.get("ETag", ""), answer.read()
        except http.client.HTTPException as error:
            raise ConnectionError(str(error)) from None
        finally:
            connection.close()


def table(count: int, dof: int = 1) -> dict[str, Any]:
    joints = [{"type": "R", "alpha": 0, "a": 1, "d": 0}] * dof
    return {"convention": "dh", "joints": joints, "tool": {"xyz": [0, 0, count]}}


def count_of(caller: Caller, name: str) -> int:
    """The number that a stored robot carries."""
    _, _, content = caller.call("GET", f"/v1/robots/{name}/fk?q=0")
    return round(json.loads(content)["poses"]["tool"]["position"][2])


@dataclass(frozen=True)
class Service:
    """A service with two workers."""

    address: str
    process: subprocess.Popen[bytes]
    directory: Path


@contextmanager
def running_service(directory: Path) -> Iterator[Service]:
    with running_server(directory, "--workers", "2") as (address, process):
        yield Service(address, process, directory)


@contextmanager
def only(answering: int, workers: list[int]) -> Iterator[None]:
    """Lets no other worker than one answer."""
    others = [worker for worker in workers if worker != answering]
    for worker in others:
        os.kill(worker, signal.SIGSTOP)
    try:
        yield
    finally:
        for worker in others:
            os.kill(worker, signal.SIGCONT)


def wait_for_both(process: int, caller: Caller) -> None:
    """Waits until each of two workers answers, with the other one stopped."""
    deadline = time.monotonic() + PATIENCE
    while True:
        assert time.monotonic() < deadline, "the workers do not answer"
        workers = workers_of(process)
        with suppress(OSError):
            for worker in workers:
                with only(worker, workers):
                    caller.call("GET", "/health/live")
            if len(workers) == 2:
                return
        time.sleep(0.05)


def killed_workers(service: Service, kills: int, seed: int = 0, clients: int = 4) -> Report:
    """Workers of a service, killed while clients count robots up by their ETags; at last all."""
    rng, stop, process = Random(seed), threading.Event(), service.process
    with timed("killed workers") as report:
        caller = Caller(service.address)
        status, _, _ = caller.call("PUT", f"/v1/robots/{SHARED}", table(0))
        report.expect(status == 201, f"the first PUT got {status}")
        done: list[int] = []
        unknown: list[int] = []
        turned_away: list[int] = []

        def count() -> None:
            while not stop.is_set():
                with suppress(OSError):
                    _, tag, _ = caller.call("GET", f"/v1/robots/{SHARED}")
                    number = count_of(caller, SHARED) + 1
                    try:
                        status, _, content = caller.call(
                            "PUT", f"/v1/robots/{SHARED}", table(number), If_Match=tag
                        )
                    except OSError:
                        unknown.append(number)
                        raise
                    if status == 200:
                        done.append(number)
                    elif status == 503:  # its turn did not come in time, and it was told so
                        turned_away.append(number)
                    elif status != 412:
                        report.failures.append(f"PUT got {status}: {content[:200]!r}")

        threads = [threading.Thread(target=count) for _ in range(clients)]
        for thread in threads:
            thread.start()
        try:
            while report.counts.get("kills", 0) < kills:
                written = len(done)
                until(lambda written=written: len(done) > written)
                time.sleep(rng.uniform(0.0, 2.0))
                for worker in rng.sample(workers_of(process.pid), rng.choice((1, 1, 2))):
                    os.kill(worker, signal.SIGKILL)
                    report.count("kills")
                wait_for_both(process.pid, caller)
        finally:
            stop.set()
        for thread in threads:
            thread.join()
        found = count_of(caller, SHARED)
        # A worker that is killed may have stored without having said so.
        silent = set(range(1, found + 1)) - set(done)
        report.expect(len(done) == len(set(done)), "a revision was replaced twice")
        report.expect(max(done) <= found, f"{max(done)} was confirmed, {found} is stored")
        report.expect(silent <= set(unknown), f"{sorted(silent - set(unknown))} were lost")
        report.count("writes", len(done))
        report.count("without an answer", len(unknown))
        report.count("turned away", len(turned_away))
        report.expect(len(turned_away) <= len(done), f"{len(turned_away)} got 503")
        status, _, content = caller.call("GET", "/health/ready")
        sound = status == 200 and f'"{SHARED}"'.encode() not in content
        report.expect(sound, f"/health/ready: {content!r}")
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        report.count("kills", 3)
        check_files(service.directory, report)
        last = number_in(RobotStore(service.directory).get(SHARED).robot)
        report.expect(last == found, f"{found} was stored, {last} is")
    return report


def full_disk(place: Path, rounds: int, seed: int = 0) -> Report:
    """A disk filled again and again by writers and by others: refused whole, or stored whole."""
    rng = Random(seed)
    with timed("full disk") as report, small_disk(place, size="300k", nr_inodes=40) as directory:
        if directory is None:
            report.count("rounds", 0)
            return report
        stored: dict[str, str] = {}
        ballast = directory / "ballast"
        robots = [robot_of(k, dof) for k, dof in enumerate((1, 2, 6, 12, 30, 60))]
        for _ in range(rounds):
            report.count("rounds")
            store = RobotStore(directory)
            refused = 0
            while refused < 10:
                name, robot = f"r{rng.randrange(60)}", rng.choice(robots)
                try:
                    store.put(name, robot)
                    stored[name] = robot.revision
                    report.count("stored")
                except (StorageError, QuotaReached):
                    refused += 1
                    report.count("refused")
                if rng.random() < 0.1:
                    with suppress(OSError):
                        ballast.write_bytes(b"x" * rng.randrange(200_000))
            fresh = RobotStore(directory)
            report.expect(uploads(fresh) == sorted(stored), f"{uploads(fresh)} are stored")
            for name, revision in stored.items():
                report.expect(fresh.get(name).robot.revision == revision, f"{name} has changed")
            check_files(directory, report)
            for name in rng.sample(sorted(stored), len(stored) // 2):
                fresh.delete(name)
                del stored[name]
                report.count("deleted")
            ballast.unlink(missing_ok=True)
    return report


def copied(directory: Path, copies: int, seed: int = 0) -> Report:
    """The directory copied while it is written to: every copy is a store, each robot old or new."""
    commands: list[Callable[[Path], list[str]]] = [
        lambda target: ["cp", "-r", f"{directory}/.", str(target)],
        lambda target: ["sh", "-c", f"tar -cf - -C {directory} . | tar -xf - -C {target}"],
    ]
    with (
        timed("copies") as report,
        forking_writers(directory) as process,
        tempfile.TemporaryDirectory() as folder,
    ):
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        process.stdin.write(f"{seed} 3\n")
        children = [int(word) for word in process.stdout.readline().split()[1:]]
        newest = {SHARED: 0}

        def follow() -> None:
            for line in process.stdout or ():
                words = line.split()
                if words[:2] == ["done", SHARED]:
                    newest[SHARED] = max(newest[SHARED], int(words[2]))

        follower = threading.Thread(target=follow, daemon=True)
        follower.start()
        for k in range(copies):
            before, target = newest[SHARED], Path(folder) / f"copy{k}"
            target.mkdir()
            # Both may say that a file changed or went away while it was read: that is the point.
            subprocess.run(
                commands[k % 2](target), capture_output=True, check=False, timeout=PATIENCE
            )
            store = RobotStore(target)
            store.check()
            report.expect(store.damaged() == (), f"damaged in the copy: {store.damaged()}")
            for name in uploads(store):
                store.get(name)
                report.count("robots")
            number = number_in(store.get(SHARED).robot)
            report.expect(number >= before, f"{before} was stored before the copy with {number}")
            check_files(target, report)
            report.count("copies")
            shutil.rmtree(target)
        for child in children:
            os.kill(child, signal.SIGKILL)
        process.kill()
        follower.join(PATIENCE)
        report.count("counted meanwhile", newest[SHARED])
    return report


def two_workers(service: Service, rounds: int) -> Report:
    """What one worker has confirmed, the other one knows at once."""
    process = service.process
    with timed("two workers") as report:
        caller = Caller(service.address)
        wait_for_both(process.pid, caller)
        workers = workers_of(process.pid)
        for k in range(rounds):
            writer, reader = workers[k % 2], workers[(k + 1) % 2]
            path = f"/v1/robots/robot{k % 3}"
            with only(writer, workers):
                status, tag, _ = caller.call("PUT", f"{path}?overwrite=true", table(k))
                report.expect(status in (200, 201), f"PUT got {status}")
                deleted = k % 5 == 4
                if deleted:
                    status, _, _ = caller.call("DELETE", path)
                    report.expect(status == 204, f"DELETE got {status}")
            with only(reader, workers):
                status, seen, _ = caller.call("GET", path)
                wanted = (404, "") if deleted else (200, tag)
                report.expect((status, seen) == wanted, f"{(status, seen)} is not {wanted}")
                _, _, content = caller.call("GET", "/v1/robots?page_size=1000")
                listed = {line["id"] for line in json.loads(content)["robots"]}
                report.expect((f"robot{k % 3}" in listed) != deleted, "the list is another one")
                if not deleted:
                    report.expect(count_of(caller, f"robot{k % 3}") == k, "an older robot computes")
                    status, _, _ = caller.call("PUT", path, table(k), If_Match='"0"')
                    report.expect(status == 412, f"PUT at an old revision got {status}")
                    status, _, _ = caller.call("PUT", path, table(k), If_None_Match="*")
                    report.expect(status == 412, f"PUT of a new robot got {status}")
            report.count("rounds")
    return report


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=300, help="in all; one of ten is a worker's")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    of_workers = max(1, chosen.kills // 10)
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        reports = [
            killed_writers(place / "writers", chosen.kills - of_workers, chosen.seed),
            full_disk(place / "disk", chosen.kills // 10, chosen.seed),
            copied(place / "copied", chosen.kills // 5, chosen.seed),
        ]
        with running_service(place / "service") as service:
            reports += [
                two_workers(service, chosen.kills // 10),
                killed_workers(service, of_workers, chosen.seed),
            ]
    for report in reports:
        print(report.text())
    return 1 if any(report.failures for report in reports) else 0


if __name__ == "__main__":
    sys.exit(main())
