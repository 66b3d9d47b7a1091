"""Workers that die, or never live: replaced, or the service says why it cannot be."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import httpx
import pytest

from tests.app.serving.in_flight import symbolic
from tests.conftest import PATIENCE, until
from tests.processes import has_ended, symbolic_processes, workers_of

DENAVIT = str(Path(sys.executable).parent / "denavit")
FK = "/v1/robots/puma560/fk?q=0,0,0,0,0,0"


def denavit(*arguments, **environment):
    """Runs a server that is to fail; gives its exit status and the events that it wrote."""
    command = [DENAVIT, "serve", *arguments]
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
        env={**os.environ, "DENAVIT_PRELOAD": "false", **environment},
    )
    events = [json.loads(line) for line in done.stderr.splitlines()]
    return done.returncode, events


class Load:
    """Requests one after another on connections that are kept; what became of them."""

    def __init__(self, address, clients):
        self.address, self.going = address, True
        self.statuses, self.lost = [], 0
        self.threads = [threading.Thread(target=self.run, daemon=True) for _ in range(clients)]
        for thread in self.threads:
            thread.start()

    def run(self):
        with httpx.Client(timeout=PATIENCE) as client:
            while self.going:
                try:
                    self.statuses.append(client.get(f"{self.address}{FK}").status_code)
                except httpx.TransportError:
                    self.lost += 1

    def stop(self):
        self.going = False
        for thread in self.threads:
            thread.join(PATIENCE)


def test_a_killed_worker_is_replaced_under_load(tmp_path, start_server):
    with start_server(tmp_path, "--workers", "2") as (address, process):
        until(lambda: len(workers_of(process.pid)) == 2)
        asked = symbolic(address, 60)
        until(lambda: symbolic_processes(process.pid))
        busy = symbolic_processes(process.pid)
        (owner,) = [pid for pid in workers_of(process.pid) if symbolic_processes(pid)]
        load = Load(address, 6)
        until(lambda: len(load.statuses) > 100)
        os.kill(owner, signal.SIGKILL)
        until(lambda: all(map(has_ended, busy)))  # also in the middle of their work
        until(lambda: len(set(workers_of(process.pid)) - {owner}) == 2)
        seen = len(load.statuses)
        until(lambda: len(load.statuses) > seen + 100)
        load.stop()
        asked.join(PATIENCE)
        assert asked.error is not None
        assert set(load.statuses) == {200}
        assert load.lost <= 6  # those that the worker held, once each
        for _ in range(20):
            assert httpx.get(f"{address}{FK}", timeout=PATIENCE).status_code == 200
        process.terminate()
        assert process.wait(PATIENCE) == 0


def test_workers_end_with_their_supervisor(tmp_path, start_server):
    with start_server(tmp_path, "--workers", "2") as (_, process):
        workers = workers_of(process.pid)
        process.kill()
        process.wait(PATIENCE)
        until(lambda: all(map(has_ended, workers)))


@pytest.mark.slow
def test_a_stuck_worker_is_replaced(tmp_path, start_server, monkeypatch):
    """Its threads do not run: the event loop holds the interpreter in C code."""
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
    (tmp_path / "sitecustomize.py").write_text(
        "import re, signal\n"
        "signal.signal(signal.SIGUSR1, lambda *_: re.match('(a+)+$', 'a' * 60 + 'b'))\n"
    )
    log = tmp_path / "log"
    options = ("--workers", "2", "--log-level", "info")
    with (
        log.open("wb") as stderr,
        start_server(tmp_path / "data", *options, stderr=stderr) as (address, process),
    ):
        until(lambda: log.read_text().count('"serving"') == 2)
        time.sleep(5)  # and have told the supervisor so, which they do every second
        (stuck, _) = workers_of(process.pid)
        os.kill(stuck, signal.SIGUSR1)
        until(lambda: has_ended(stuck))
        until(lambda: len(workers_of(process.pid)) == 2)
        assert httpx.get(f"{address}{FK}", timeout=PATIENCE).status_code == 200


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_taken_port_is_told(tmp_path, workers):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        arguments = ("--port", port, "--workers", workers, "--data-dir", str(tmp_path))
        status, events = denavit(*arguments)
    assert status == 1
    assert f"cannot listen on 127.0.0.1, port {port}: Address already in use" in events[-1]["event"]


def test_a_bad_data_directory_or_setting_is_told(tmp_path):
    (tmp_path / "file").write_text("")
    status, events = denavit("--port", "0", "--data-dir", str(tmp_path / "file" / "data"))
    assert status == 1
    assert "the data directory" in events[-1]["event"]
    assert "Not a directory" in events[-1]["event"]
    done = subprocess.run(
        [DENAVIT, "serve"],
        env={**os.environ, "DENAVIT_MAX_BATCH": "many", "DENAVIT_ROOT_PATH": "x\ny"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "DENAVIT_MAX_BATCH: Input should be a valid integer" in done.stderr
    assert "DENAVIT_ROOT_PATH" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_workers_that_cannot_start_end_the_service_after_a_minute(tmp_path):
    """Each is killed as soon as it starts, as by a lack of memory."""
    (tmp_path / "sitecustomize.py").write_text(
        "import os, sys\n"
        "if '--multiprocessing-fork' in sys.orig_argv:\n"
        "    os.kill(os.getpid(), 9)\n"
    )
    path = f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    arguments = ("--port", "0", "--workers", "2", "--data-dir", str(tmp_path / "data"))
    began = time.monotonic()
    status, events = denavit(*arguments, PYTHONPATH=path)
    assert status == 1
    assert time.monotonic() - began > 60
    assert "giving up" in next(e["event"] for e in events if e["level"] == "critical")
    deaths = [event for event in events if "died: killed by SIGKILL" in event["event"]]
    assert len(deaths) >= 3


def test_a_worker_that_serves_makes_up_for_starts_that_failed(tmp_path, start_server):
    """One is killed, then thrice what replaces it while it starts, then the other one."""
    with start_server(tmp_path, "--workers", "2") as (address, process):
        until(lambda: len(workers_of(process.pid)) == 2)
        kept, killed = workers_of(process.pid)
        for _ in range(4):
            os.kill(killed, signal.SIGKILL)
            dead = {kept, killed}
            until(lambda dead=dead: set(workers_of(process.pid)) - dead)
            (killed,) = set(workers_of(process.pid)) - dead
        os.kill(kept, signal.SIGKILL)
        until(lambda: len(set(workers_of(process.pid)) - {kept}) == 2)
        assert httpx.get(f"{address}{FK}", timeout=PATIENCE).status_code == 200
        assert process.poll() is None


def test_a_worker_that_a_signal_has_stopped_is_replaced(tmp_path, start_server):
    with start_server(tmp_path, "--workers", "2") as (address, process):
        until(lambda: len(workers_of(process.pid)) == 2)
        stopped, other = workers_of(process.pid)
        os.kill(stopped, signal.SIGSTOP)
        until(lambda: has_ended(stopped))
        until(lambda: len(workers_of(process.pid)) == 2)
        assert other in workers_of(process.pid)
        assert httpx.get(f"{address}{FK}", timeout=PATIENCE).status_code == 200
