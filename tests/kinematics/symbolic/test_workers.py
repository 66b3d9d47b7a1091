"""Processes for symbolic work: answers kept, time and memory bounded, killed when late."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections import OrderedDict
from contextlib import closing

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.errors import WorkersBusy
from kinematics.forward import fk
from kinematics.processes import pool as pools
from kinematics.processes import process as processes
from kinematics.processes.protocol import ANSWER, framed
from kinematics.symbolic import Quantity, SymbolicRequest, SymbolicWorkers, workers
from kinematics.symbolic.polynomial import TooManyTerms
from kinematics.symbolic.time_limit import Unfinished, limited
from robots.shipped import shipped_robot
from tests.conftest import PATIENCE
from tests.kinematics.symbolic.formulas import evaluator


@pytest.fixture
def pool():
    with closing(SymbolicWorkers()) as made:
        yield made


def wild_table(n, seed=0):
    """An arm whose formulas are too long for anyone."""
    values = np.random.default_rng(seed).uniform(0.1, 1, (n, 3)).tolist()
    rows = [{"type": "R", "alpha": alpha, "a": a, "d": d} for alpha, a, d in values]
    return read_mapping({"name": "wild", "convention": "standard", "joints": rows})


def test_the_whole_pa10_in_time_then_from_memory(pool, monkeypatch):
    robot = shipped_robot("pa10")
    request = SymbolicRequest(quantities=tuple(Quantity), time_budget=PATIENCE)
    answer = pool.run(robot.table, request)
    assert all(answer["simplified"].values())
    q = np.random.default_rng(0).uniform(-3, 3, (100, 7))
    np.testing.assert_allclose(
        evaluator(answer, q)(answer["T"]), fk(robot, q)["tool"], atol=1e-12, rtol=0
    )
    monkeypatch.setattr(SymbolicWorkers, "_work", None)
    assert pool.run(robot.table, request) == answer


def test_out_of_time_gives_what_holds_and_says_so(pool):
    robot = shipped_robot("pa10")
    request = SymbolicRequest(quantities=tuple(Quantity), time_budget=1e-6)
    answer = pool.run(robot.table, request)
    assert not any(answer["simplified"].values())
    assert "not finished: out of time" in answer["notes"][0]
    q = np.random.default_rng(0).uniform(-3, 3, (10, 7))
    T = evaluator(answer, q)(answer["T"])
    np.testing.assert_allclose(T, fk(robot, q)["tool"], atol=1e-12, rtol=0)
    request = SymbolicRequest(quantities=tuple(Quantity), time_budget=PATIENCE)
    longer = pool.run(robot.table, request)
    assert all(longer["simplified"].values()), "a larger budget is not served from memory"


def test_a_determinant_without_time_gives_its_matrix(pool):
    request = SymbolicRequest(quantities=(Quantity.DET_JACOBIAN,), time_budget=0.3)
    answer = pool.run(wild_table(6), request)
    found = answer["det_jacobian"]
    assert found["expression"] is None
    assert "not finished" in answer["notes"][0]
    if "determinant_of" in found:
        assert np.shape(found["determinant_of"]["matrix"]) == (6, 6)


def test_a_worker_that_is_killed_is_replaced(pool, monkeypatch):
    table = wild_table(6)
    request = SymbolicRequest(quantities=(Quantity.DET_JACOBIAN,), time_budget=30.0)
    started = []
    original = processes.started

    def recorded(*told):
        process = original(*told)
        started.append(process)
        return process

    monkeypatch.setattr(processes, "started", recorded)

    def kill():
        for attempt in range(pools.ATTEMPTS):
            while len(started) == attempt:
                time.sleep(0.01)
            time.sleep(0.3)
            os.kill(started[attempt].pid, signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    with pytest.raises(WorkersBusy) as caught:
        pool.run(table, request)
    killer.join()
    assert caught.value.retry_after > 0
    answer = pool.run(shipped_robot("planar_2r").table, SymbolicRequest())
    assert answer["simplified"] == {"T": True}


def test_a_worker_that_dies_as_it_is_given_its_task_is_replaced(pool, monkeypatch):
    table = shipped_robot("planar_2r").table
    pool.run(table, SymbolicRequest())
    original = processes.Process.is_alive

    def dies_now(worker):
        monkeypatch.setattr(processes.Process, "is_alive", original)
        os.kill(worker._process.pid, signal.SIGKILL)
        os.waitid(os.P_PID, worker._process.pid, os.WEXITED | os.WNOWAIT)
        return True

    monkeypatch.setattr(processes.Process, "is_alive", dies_now)
    answer = pool.run(table, SymbolicRequest(quantities=(Quantity.POSITION,)))
    assert answer["simplified"] == {"position": True}


def test_a_late_worker_is_killed():
    message = "import time, sys; sys.stdout.buffer.write(%r); sys.stdout.flush(); time.sleep(600)"
    sleeping = subprocess.Popen(
        [sys.executable, "-c", message % framed(b"{}", ANSWER)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    with sleeping:
        found = processes.outcome(sleeping, b"task", time.monotonic() + 1.0)
        assert (found.answers, found.finished) == ([b"{}"], False)
        sleeping.kill()
    assert sleeping.returncode == -signal.SIGKILL


def test_too_many_requests_are_turned_away(pool, monkeypatch):
    busy, release = threading.Event(), threading.Event()

    def work(self, session, table, request):
        busy.set()
        release.wait(PATIENCE)
        return '{"simplified": {}, "notes": []}'

    monkeypatch.setattr(SymbolicWorkers, "_work", work)
    table = shipped_robot("scara").table
    budgets = range(1, 2 + workers.WAITING)
    threads = [
        threading.Thread(target=pool.run, args=(table, SymbolicRequest(time_budget=float(b))))
        for b in budgets
    ]
    for thread in threads:
        thread.start()
    busy.wait(PATIENCE)
    while pool._pool._places._value:
        time.sleep(0.01)
    with pytest.raises(WorkersBusy) as caught:
        pool.run(table, SymbolicRequest(time_budget=50.0))
    assert caught.value.retry_after > 0
    release.set()
    for thread in threads:
        thread.join(PATIENCE)
    answer = pool.run(table, SymbolicRequest(time_budget=60.0))
    assert answer == {"simplified": {}, "notes": []}


def test_without_sympy_it_says_how_to_get_it(pool, monkeypatch):
    monkeypatch.setattr(workers, "find_spec", lambda name: None)
    with pytest.raises(workers.SymbolicUnavailable, match=r"pip install 'denavit\[symbolic\]'"):
        pool.run(shipped_robot("scara").table, SymbolicRequest())


def test_a_worker_ends_with_its_input():
    with processes.started(workers.WORKER) as process:
        process.stdin.close()
        assert process.wait(PATIENCE) == 0


def test_one_process_does_task_after_task(pool, monkeypatch):
    started = []
    original = processes.started
    monkeypatch.setattr(processes, "started", lambda *told: started.append(1) or original(*told))
    for name in ("planar_2r", "scara", "planar_2r", "stanford"):
        table = shipped_robot(name).table
        found = pool.run(table, SymbolicRequest(quantities=(Quantity.POSITION,)))
        assert found["simplified"] == {"position": True}
        assert len(found["columns"]) == table.dof
    assert len(started) == 1


def test_a_task_whose_worker_dies_is_given_to_another_one(pool, monkeypatch):
    started = []
    original = processes.started

    def dying_first(*told):
        process = original(*told)
        started.append(process)
        if len(started) == 1:
            process.kill()
        return process

    monkeypatch.setattr(processes, "started", dying_first)
    answer = pool.run(shipped_robot("planar_2r").table, SymbolicRequest())
    assert answer["simplified"] == {"T": True}
    assert len(started) == 2


def test_a_worker_is_replaced_between_tasks(pool, monkeypatch):
    """No task is ever given to one that is about to end."""
    monkeypatch.setattr(pools, "TASKS", 2)
    started = []
    original = processes.started
    monkeypatch.setattr(processes, "started", lambda *told: started.append(1) or original(*told))
    table = shipped_robot("planar_2r").table
    for seconds in range(1, 6):
        monkeypatch.setattr(pool, "_answers", OrderedDict())
        assert pool.run(table, SymbolicRequest(time_budget=float(100 + seconds)))
    assert len(started) == 3


def test_what_a_worker_says_before_it_dies_is_logged(caplog, monkeypatch):
    monkeypatch.setattr(processes, "START", "raise SystemExit('no such thing')")
    with closing(SymbolicWorkers()) as pool, pytest.raises(WorkersBusy):
        pool.run(shipped_robot("planar_2r").table, SymbolicRequest())
    assert "no such thing" in caplog.text


def test_limited_ends_a_call():
    def forever():
        while True:
            pass

    def large():
        raise TooManyTerms("too large")

    with pytest.raises(Unfinished, match="out of time"):
        limited(0.05, forever)
    with pytest.raises(Unfinished, match="too large"):
        limited(PATIENCE, large)
    assert limited(PATIENCE, lambda: 3) == 3
