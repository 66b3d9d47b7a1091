"""Processes for one kind of work: bounded in memory and time, and one after another."""

import math
import threading
import time
from contextlib import closing

import pytest

from kinematics.deadline import Cancelled, Deadline, under
from kinematics.errors import OutOfMemory, WorkersBusy
from kinematics.processes.pool import ProcessPool, TaskFailed
from kinematics.processes.protocol import Limits
from tests.conftest import PATIENCE
from tests.processes import has_ended

MODULE = "tests.kinematics.processes.tasks"
MB = 1 << 20
LIMITS = Limits(64 * MB, PATIENCE)


@pytest.fixture
def pool():
    with closing(ProcessPool(MODULE)) as made:
        yield made


def done(pool, word, size=0, limits=LIMITS, seconds=PATIENCE):
    with pool.session() as session:
        return session.call((word, size), limits, seconds)


def test_more_than_its_memory_is_refused_and_less_is_not(pool):
    assert done(pool, "fill", 32 * MB) == [str(32 * MB).encode()]
    with pytest.raises(OutOfMemory, match="67 MB"):
        done(pool, "fill", 128 * MB)
    assert done(pool, "fill", 128 * MB, Limits(256 * MB, PATIENCE))
    assert done(pool, "fill", MB, Limits(64 * MB, math.inf)), "without a limit of time"
    assert done(pool, "fill later", 128 * MB) == [b"first"], "what there was is kept"
    with pytest.raises(OutOfMemory, match="67 MB"):
        done(pool, "abort")  # as C++ does


def test_what_is_printed_is_no_answer(pool):
    assert done(pool, "print", 100) == [b"z" * 100]


def test_an_error_is_told_and_a_task_whose_processes_die_is_busy(pool):
    with pytest.raises(TaskFailed, match="no such thing"):
        done(pool, "fail")
    with pytest.raises(WorkersBusy):
        done(pool, "die")
    assert done(pool, "pid")


def test_a_process_is_kept_for_the_next_task_and_killed_when_late(pool):
    (first,) = done(pool, "pid")
    assert done(pool, "pid") == [first]
    assert done(pool, "forever", seconds=0.5) == []
    assert has_ended(int(first))


def test_nobody_waits_for_what_is_called_off(pool):
    deadline = Deadline()
    threading.Timer(0.5, deadline.drop).start()
    with under(deadline), pytest.raises(Cancelled):
        done(pool, "forever")


def test_no_more_than_so_many_idle_ones_are_kept():
    with closing(ProcessPool(MODULE, 2, idle=1)) as pool:
        with pool.session() as one, pool.session() as other:
            pids = [s.call(("pid", 0), LIMITS, PATIENCE)[0] for s in (one, other)]
            assert pids[0] != pids[1]
        deadline = time.monotonic() + PATIENCE
        while not any(has_ended(int(pid)) for pid in pids):
            assert time.monotonic() < deadline
        assert not all(has_ended(int(pid)) for pid in pids)
