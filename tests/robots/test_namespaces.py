"""Namespaces: robots of one name are none of another's; what is shared is seen by all."""

import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.errors import (
    DamagedRobot,
    QuotaReached,
    ReadOnlyRobot,
    RevisionMismatch,
    RobotExists,
    RobotNotFound,
    SharedRobot,
)
from robots.namespaces import Namespaces, folder_of
from robots.storage.usage_record import Quotas, Usage
from robots.store import RobotStore


@pytest.fixture
def spaces(tmp_path):
    return Namespaces(tmp_path, Quotas(), Quotas(holder="namespace"))


def test_each_name_keeps_its_own_robot_of_an_id(spaces, make_robot):
    robots = {f"student{k}": make_robot(k + 1) for k in range(30)}
    with ThreadPoolExecutor(8) as threads:
        stored = list(
            threads.map(lambda item: spaces.of(item[0]).put("my-pa10", item[1]), robots.items())
        )
    assert all(created for _, created in stored)
    for name, robot in robots.items():
        assert spaces.of(name).get("my-pa10").robot.revision == robot.revision
        assert spaces.of(name).ids_after("my-pa10", 1) != ("my-pa10",)
    assert spaces.usage().robots == 30
    assert "my-pa10" not in spaces.shared.ids()
    with pytest.raises(RobotNotFound) as caught:
        spaces.shared.get("my-pa10")
    assert "my-pa10" not in caught.value.valid
    with pytest.raises(RobotNotFound):
        spaces.of("another").delete("my-pa10")
    spaces.of("student3").delete("my-pa10")
    assert spaces.of("student4").get("my-pa10").robot.revision == robots["student4"].revision


def test_what_was_stored_before_is_shared_and_changed_by_no_namespace(tmp_path, make_robot):
    RobotStore(tmp_path).put("old", make_robot(1))
    spaces = Namespaces(tmp_path, Quotas(), Quotas())
    ada, bob = spaces.of("ada"), spaces.of("bob")
    for store in (ada, bob):
        assert "old" in store.ids()
        assert store.get("old") is spaces.shared.get("old")
        assert store.in_memory("old") is spaces.shared.get("old")
        assert store.summary("old").dof == 3
        with pytest.raises(SharedRobot):
            store.delete("old")
    with pytest.raises(ReadOnlyRobot):
        ada.put("pa10", make_robot())
    assert ada.put("old", make_robot(2))[1]
    assert ada.hides_shared("old")
    assert not bob.hides_shared("old")
    assert ada.get("old").robot.revision == make_robot(2).revision
    assert bob.get("old").robot.revision == make_robot(1).revision
    assert ada.ids().count("old") == 1
    ada.delete("old")
    assert ada.get("old").robot.revision == make_robot(1).revision


def test_conditions_look_at_the_robot_that_is_seen(spaces, make_robot):
    shared, ada = make_robot(1), spaces.of("ada")
    spaces.shared.put("arm", shared)
    with pytest.raises(RevisionMismatch):
        ada.put("arm", make_robot(2), if_match=("other",))
    with pytest.raises(RevisionMismatch):
        ada.put("arm", make_robot(2), if_none_match=(shared.revision,))
    assert ada.put("arm", make_robot(2), if_match=(shared.revision,))[1]
    with pytest.raises(RevisionMismatch):
        ada.put("arm", make_robot(3), if_match=(shared.revision,))
    with pytest.raises(RobotExists):
        ada.put("arm", make_robot(3), create_only=True)
    assert spaces.shared.get("arm").robot.revision == shared.revision


def test_other_processes_and_later_starts_see_the_same(tmp_path, spaces, make_robot):
    other = Namespaces(tmp_path, Quotas(), Quotas())
    ada = other.of("ada")
    for tool in (1, 2, 3):
        spaces.of("ada").put("arm", make_robot(tool))
        assert ada.get("arm").robot.revision == make_robot(tool).revision
        assert other.of("bob").in_memory("arm") is None
    spaces.of("ada").delete("arm")
    with pytest.raises(RobotNotFound):
        ada.get("arm")


def test_quotas_are_of_each_namespace_and_of_all(tmp_path, make_robot):
    spaces = Namespaces(tmp_path, Quotas(robots=5), Quotas(robots=3, holder="namespace"))
    for k in range(3):
        spaces.of("ada").put(f"r{k}", make_robot())
    with pytest.raises(QuotaReached) as caught:
        spaces.of("ada").put("r3", make_robot())
    assert (caught.value.holder, caught.value.limit) == ("namespace", 3)
    spaces.of("bob").put("r0", make_robot())
    spaces.shared.put("r0", make_robot())
    for store in (spaces.of("bob"), spaces.of("cleo"), spaces.shared):
        with pytest.raises(QuotaReached) as caught:
            store.put("r9", make_robot())
        assert (caught.value.holder, caught.value.limit) == ("store", 5)
        assert "r9" not in store.ids()
    spaces.of("bob").put("r0", make_robot(2))
    spaces.of("ada").delete("r0")
    spaces.of("cleo").put("r9", make_robot())
    assert spaces.usage().robots == 5


def test_the_total_holds_where_all_write_at_once(tmp_path, make_robot):
    spaces = Namespaces(tmp_path, Quotas(robots=20), Quotas(robots=15))
    robot = make_robot()

    def put(case):
        try:
            return spaces.of(f"s{case[0]}").put(f"r{case[1]}", robot)[1]
        except QuotaReached:
            return False

    with ThreadPoolExecutor(8) as threads:
        assert sum(threads.map(put, product(range(8), range(5)))) == 20
    assert spaces.usage().robots == 20


@given(st.lists(st.text(min_size=1, max_size=64), min_size=2, max_size=2, unique=True))
def test_no_two_names_share_a_folder(names):
    one, two = map(folder_of, names)
    assert one.lower() != two.lower()
    for folder in (one, two):
        assert folder.isascii()
        assert not set(folder) & set("./\\\0:")


def test_names_that_are_paths_stay_in_their_folder(tmp_path, spaces, make_robot):
    names = [".", "..", "...", "Ada", "ada", "robots", "shared", "a.b", "a=2eb", "-", "_", "CON"]
    for k, name in enumerate(names):
        spaces.of(name).put("arm", make_robot(k + 1))
    for k, name in enumerate(names):
        assert spaces.of(name).get("arm").robot.revision == make_robot(k + 1).revision
    assert len(list((tmp_path / "namespaces").iterdir())) == len(names)
    assert sorted(one.name for one in tmp_path.iterdir()) == ["namespaces", "robots", "robots.lock"]
    assert not list((tmp_path / "robots").iterdir())


def test_a_damaged_robot_does_not_bring_the_shared_one_back(tmp_path, spaces, make_robot):
    spaces.shared.put("arm", make_robot(1))
    spaces.of("ada").put("arm", make_robot(2))
    file = tmp_path / "namespaces" / "ada" / "robots" / "arm.json"
    file.write_bytes(file.read_bytes()[:-5])
    again = Namespaces(tmp_path, Quotas(), Quotas())
    again.check()
    with pytest.raises(DamagedRobot):
        again.of("ada").get("arm")
    assert again.of("ada").in_memory("arm") is None
    assert again.damaged() == ((), 1)
    assert list((tmp_path / "namespaces" / "ada" / "quarantine").iterdir())
    assert again.of("bob").get("arm").robot.revision == make_robot(1).revision
    again.of("ada").put("arm", make_robot(3))
    assert again.damaged() == ((), 0)


WRITER = """
import sys
from pathlib import Path
from dh_to_urdf import read_mapping
from robots.namespaces import Namespaces
from robots.robot import robot_from_table
from robots.storage.usage_record import Quotas

row = {"type": "R", "alpha": 0, "a": 1, "d": 0}
robot = robot_from_table(read_mapping({"name": "r", "convention": "dh", "joints": [row]}))
spaces = Namespaces(Path(sys.argv[1]), Quotas(), Quotas())
for k in range(10**6):
    spaces.of(f"s{k % 3}").put(f"r{k}", robot)
    print(k, flush=True)
"""


def test_killed_writers_lose_nothing_that_was_confirmed(tmp_path, make_robot):
    confirmed = []
    for kill in range(4):
        with subprocess.Popen(
            [sys.executable, "-c", WRITER, str(tmp_path)], stdout=subprocess.PIPE, text=True
        ) as process:
            lines = [process.stdout.readline() for _ in range(10 * (kill + 1))]
            os.kill(process.pid, signal.SIGKILL)
            lines += process.stdout.read().splitlines()
            confirmed += [int(line) for line in lines if line.strip().isdecimal()]
    spaces = Namespaces(tmp_path, Quotas(), Quotas())
    spaces.check()
    assert spaces.damaged() == ((), 0)
    for k in set(confirmed):
        assert spaces.of(f"s{k % 3}").get(f"r{k}").robot.dof == 1
    files = list(tmp_path.glob("namespaces/*/robots/*"))
    assert not [file for file in files if file.suffix != ".json"]
    assert spaces.usage() == Usage(len(files), sum(file.stat().st_size for file in files))
