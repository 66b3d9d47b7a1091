"""The memory of a worker follows from what the container allows."""

import pytest

from app.admission.machine import IDLE, SUPERVISOR, request_bytes, worker_bytes

GB = 1_000_000_000


@pytest.fixture
def root(tmp_path):
    (tmp_path / "proc/self").mkdir(parents=True)
    return tmp_path


def put(root, path, text):
    file = root / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def test_the_second_version_of_control_groups_and_the_groups_above(root):
    put(root, "proc/self/cgroup", "0::/system/denavit\n")
    put(root, "sys/fs/cgroup/system/denavit/memory.max", "max\n")
    put(root, "sys/fs/cgroup/system/memory.max", f"{2 * GB}\n")
    assert worker_bytes(1, root) == 2 * GB
    assert worker_bytes(2, root) == (2 * GB - SUPERVISOR) // 2


def test_the_first_version_as_containers_see_it(root):
    put(root, "proc/self/cgroup", "5:cpu,cpuacct:/docker/1\n4:memory:/docker/1\n0::/\n")
    put(root, "sys/fs/cgroup/memory/memory.limit_in_bytes", f"{GB}\n")
    assert worker_bytes(1, root) == GB


def test_without_a_limit_it_is_the_memory_of_the_machine(root):
    put(root, "proc/self/cgroup", "4:memory:/\n")
    put(root, "sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n")
    assert GB // 4 < worker_bytes(1, root) == worker_bytes(1, root / "nowhere") < 1 << 50


def test_what_a_worker_takes_idle_is_not_for_requests():
    assert request_bytes(2 * GB) == 2 * GB - IDLE
    assert request_bytes(IDLE // 2) > 0
