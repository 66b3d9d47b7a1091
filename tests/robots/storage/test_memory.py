"""What is kept in memory, and what a list reads instead of robots."""

import json

import pytest

from robots.storage.memory import RobotMemory
from robots.store import RobotStore


@pytest.fixture
def store(tmp_path):
    return RobotStore(tmp_path)


def test_robots_in_memory_are_bounded_by_weight_and_the_last_used_stay():
    memory = RobotMemory(10.0)
    for k in range(5):
        memory.keep(f"r{k}", k, 2.0)
    assert [memory.get(f"r{k}") for k in range(5)] == [0, 1, 2, 3, 4]
    memory.get("r0")
    memory.keep("heavy", 9, 7.0)
    assert [memory.get(name) for name in ("r0", "r3", "heavy")] == [0, None, 9]
    memory.keep("huge", 10, 100.0)
    assert (len(memory), memory.get("huge")) == (1, 10)
    memory.keep("huge", 11, 1.0)
    memory.keep("r0", 0, 9.0)
    assert len(memory) == 2
    memory.forget("huge")
    memory.forget("huge")
    assert len(memory) == 1


def test_many_large_robots_do_not_stay_in_memory(store, make_robot):
    for k in range(8):
        store.put(f"r{k}", make_robot(k, dof=64))
        store.get(f"r{k}")
    in_memory = [store.in_memory(f"r{k}") is not None for k in range(8)]
    assert in_memory[-1]
    assert 1 < sum(in_memory) < 8


def test_the_file_says_what_a_list_needs_in_its_second_line(tmp_path, store, make_robot):
    store.put("probe", make_robot(name="Mine", dof=2))
    head = json.loads((tmp_path / "robots" / "probe.json").read_bytes().split(b"\n")[1])
    assert head == {"format": 2, "kind": "dh", "title": "Mine", "dof": 2}
