"""Rate limits of all workers of a service together."""

import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, closing

import httpx

from app.access.rates import RateLimits
from app.access.shared_counters import BUCKETS, SLOTS, SharedCounters, create_counters
from tests.app.access.requests import FK
from tests.conftest import PATIENCE, until
from tests.processes import workers_of

OTHER = """
import sys
from pathlib import Path
from app.access.shared_counters import SharedCounters

counters = SharedCounters(Path(sys.argv[1]))
HOW
"""


def other(path, how):
    code = OTHER.replace("HOW", how)
    return subprocess.Popen(
        [sys.executable, "-c", code, str(path)], stdout=subprocess.PIPE, text=True
    )


def test_the_limit_is_of_the_service_whatever_the_workers(serve):
    with serve("--workers", "2", rate_limit="40/hour") as server:
        workers = workers_of(server.pid)
        assert len(workers) == 2
        statuses, left = [], []
        for _ in range(60):  # each on a connection of its own, so that both workers answer
            answer = httpx.get(f"{server.address}{FK}", timeout=PATIENCE)
            statuses.append(answer.status_code)
            left.append(int(answer.headers["ratelimit-remaining"]))
        assert statuses == [200] * 40 + [429] * 20
        assert left[:40] == list(range(39, -1, -1))
        os.kill(workers[0], signal.SIGKILL)
        until(lambda: len(workers_of(server.pid)) == 2 and workers_of(server.pid) != workers)
        until(lambda: httpx.get(f"{server.address}/health/ready").status_code == 200)
        for _ in range(8):
            assert httpx.get(f"{server.address}{FK}", timeout=PATIENCE).status_code == 429


def test_processes_that_count_at_once_lose_no_request(tmp_path):
    path = tmp_path / "rates"
    create_counters(path)
    how = "for _ in range(2000): counters.count('one', (3600,))"
    with ExitStack() as stack:
        processes = [stack.enter_context(other(path, how)) for _ in range(3)]
        assert [process.wait(PATIENCE) for process in processes] == [0] * 3
    with closing(SharedCounters(path)) as counters:
        assert counters.count("one", (3600,))[0][0] == 6001


def test_a_killed_process_leaves_no_lock_and_a_stopped_one_is_not_waited_for(tmp_path):
    path = tmp_path / "rates"
    create_counters(path)
    how = (
        "import time\ncounters.count('one', (3600,))\n"
        f"for bucket in range({BUCKETS}): counters._lock(64 + {32 * SLOTS} * bucket)\n"
        "print('held', flush=True)\ntime.sleep(600)"
    )
    with other(path, how) as holder, closing(SharedCounters(path)) as counters:
        assert holder.stdout.readline() == "held\n"
        os.kill(holder.pid, signal.SIGSTOP)
        started = time.monotonic()
        assert counters.count("one", (3600,))[0][0] == 2
        assert time.monotonic() - started < PATIENCE
        assert not counters._lock(64)
        os.kill(holder.pid, signal.SIGKILL)
        holder.wait()
        assert counters._lock(64)


def test_memory_is_bounded_and_a_flood_does_not_push_out_who_asks_much(tmp_path):
    path = tmp_path / "rates"
    create_counters(path)
    size = path.stat().st_size
    with closing(SharedCounters(path)) as counters:
        for _ in range(50):
            counters.count("busy", (3600,))
        for k in range(2 * BUCKETS * SLOTS):
            counters.count(f"flood {k}", (3600,))
        assert counters.count("busy", (3600,))[0][0] == 51
    assert path.stat().st_size == size < 5_000_000


def test_windows_end_and_begin_with_the_next_request(tmp_path):
    path = tmp_path / "rates"
    create_counters(path)
    with closing(SharedCounters(path)) as counters:
        assert counters.count("one", (0.05, 3600))[0][0] == 1
        time.sleep(0.1)
        (short, _), (long, end) = counters.count("one", (0.05, 3600))
        assert (short, long) == (1, 2)
        assert 3500 < end - time.time() <= 3600
        limits = RateLimits("3/hour; 5/day", counters)
        allowed = [limits.count("two").allowed for _ in range(4)]
        assert allowed == [True, True, True, False]
        assert limits.count("three").remaining == 2
