"""Hostile, broken and odd inputs against a running service of two workers, one by one."""

from __future__ import annotations

import json
import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import httpx
import pytest

from tests.conftest import PATIENCE, running_server, until
from tests.corpus import addresses, bodies, tables, urdfs, wire
from tests.corpus.case import Case
from tests.corpus.judge import wrong_with
from tests.cost import within
from tests.processes import processor_seconds, workers_of
from tests.torture.exchange import Client, Sent
from tests.torture.requests import megabytes

MOST_SECONDS = 5.0
"""Processor time for one case, all processes of the service together."""
MAX_GROWTH = 400
"""Megabytes that a worker may have more after all of it: libraries, caches, arenas of threads."""


def cases(*kinds: str) -> list[Case]:
    modules: tuple[ModuleType, ...] = (urdfs, tables, bodies, addresses)
    return [
        case
        for module in modules
        for kind in kinds
        if hasattr(module, kind)
        for case in getattr(module, kind)()
    ]


REFUSED, ACCEPTED = cases("refused"), cases("meshes", "accepted")


def named(case: Case | wire.Wire) -> str:
    return re.sub(r"[^\w:, +-]", "?", case.name, flags=re.ASCII)[:60]


class Service:
    """A service under attack: its port, its data directory, and how its health was."""

    def __init__(self, address: str, pid: int, folder: Path) -> None:
        self.address = address
        self.port = int(address.rsplit(":", 1)[1])
        self.pid = pid
        self.folder = folder
        self.client = Client(self.port)
        self.unwell: list[str] = []
        self.asked = 0
        self._stop = threading.Event()
        self._watch = threading.Thread(target=self._ask)
        self.at_first = self.stored()
        self._watch.start()

    def _ask(self) -> None:
        with httpx.Client(base_url=self.address, timeout=PATIENCE) as client:
            while not self._stop.wait(0.1):
                try:
                    answer = client.get("/health/live")
                    if answer.status_code != 200:
                        self.unwell.append(f"/health/live: {answer.status_code}")
                except httpx.HTTPError as error:
                    self.unwell.append(repr(error))
                self.asked += 1

    def close(self) -> None:
        # A worker of pytest may have got a few cases only: it is asked some times all the same.
        until(lambda: self.asked > 10)
        self._stop.set()
        self._watch.join()
        self.client.connection.close()

    @contextmanager
    def quickly(self) -> Iterator[None]:
        """Does what is done in it with little processor time, whatever takes its turn besides."""
        before = processor_seconds(self.pid)
        yield
        spent = processor_seconds(self.pid) - before
        assert within(spent, MOST_SECONDS), f"{spent:.1f} s of processor time"

    def stored(self) -> tuple[list[str], list[str]]:
        """What the service lists, and what lies in its directory."""
        listed = json.loads(self.client.send(Sent("GET", "/v1/robots", "page_size=1000")).body)
        files = (str(path.relative_to(self.folder)) for path in self.folder.rglob("*"))
        return [robot["id"] for robot in listed["robots"]], sorted(files)

    def clear(self) -> None:
        """Deletes what a case has left, so that the next one is judged by itself."""
        for robot_id in {*self.stored()[0]} - {*self.at_first[0]}:
            self.client.send(Sent("DELETE", f"/v1/robots/{robot_id}", "overwrite=true"))


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    folder = tmp_path_factory.mktemp("corpus")
    with running_server(folder, "--workers", "2") as (address, process):
        found = Service(address, process.pid, folder)
        before = {pid: megabytes(pid) for pid in workers_of(process.pid)}
        yield found
        found.close()
        after = {pid: megabytes(pid) for pid in workers_of(process.pid)}
        assert set(after) == set(before), "a worker died"
        assert all(after[pid] < before[pid] + MAX_GROWTH for pid in before), (before, after)
        assert found.unwell == []
        assert found.asked > 10


def test_there_are_as_many_as_are_promised():
    hostile = len(REFUSED) + len(list(urdfs.meshes())) + len(wire.CASES)
    assert hostile > 700
    assert len({case.name for case in (*REFUSED, *ACCEPTED)}) == len(REFUSED) + len(ACCEPTED)


@pytest.fixture
def cleared(service: Service) -> Iterator[None]:
    """Each case is judged by itself, whatever one before it has left."""
    yield
    service.clear()


@pytest.mark.usefixtures("cleared")
@pytest.mark.parametrize("case", REFUSED, ids=named)
def test_it_is_refused_in_clear_words_and_nothing_is_left(service, case):
    with service.quickly():
        got = service.client.send(case.sent)
    assert wrong_with(case, got, str(service.folder)) == []
    if case.sent.method in ("POST", "PUT", "DELETE"):
        assert service.stored() == service.at_first


@pytest.mark.usefixtures("cleared")
@pytest.mark.parametrize("case", ACCEPTED, ids=named)
def test_it_is_taken(service, case):
    with service.quickly():
        got = service.client.send(case.sent)
    assert wrong_with(case, got, str(service.folder)) == []
    if got.status == 201:
        location = got.headers["location"]
        urdf = service.client.send(Sent("GET", f"{location}/urdf"))
        assert urdf.status == 200
        assert not re.search(rb"passwd|win\.ini|127\.0\.0\.1|/dev/|/proc/", urdf.body)
        assert service.client.send(Sent("DELETE", location)).status == 204
    assert service.stored()[0] == service.at_first[0]


@pytest.mark.parametrize("case", wire.CASES, ids=named)
def test_bytes_on_the_wire(service, case):
    with service.quickly():
        found = wire.answers(service.port, case, PATIENCE)
    assert wire.wrong_with(case, found) == []
    assert service.stored()[0] == service.at_first[0]
