"""What is stored is counted exactly, listed at once and kept within its quotas."""

import shutil
import subprocess
import sys

import pytest

from robots.errors import QuotaReached
from robots.shipped import shipped_ids
from robots.storage.usage_record import Quotas, Usage
from robots.store import RobotStore
from tests.conftest import PATIENCE


@pytest.fixture
def store(tmp_path):
    return RobotStore(tmp_path)


def files(directory):
    return [path for path in (directory / "robots").iterdir() if path.name.endswith(".json")]


def counted(directory):
    found = files(directory)
    return Usage(len(found), sum(path.stat().st_size for path in found))


def uploads(store):
    return [i for i in store.ids() if i not in shipped_ids()]


def test_what_is_stored_is_counted_through_every_change(tmp_path, store, make_robot):
    other = RobotStore(tmp_path)
    for k in range(12):
        (store, other)[k % 2].put(f"r{k % 5}", make_robot(dof=1 + k % 4))
        assert store.usage() == other.usage() == counted(tmp_path)
    store.delete("r3")
    assert other.usage() == counted(tmp_path)
    assert other.usage().robots == 4


def test_what_others_do_to_the_files_is_counted_too(tmp_path, store, make_robot):
    for k in range(4):
        store.put(f"r{k}", make_robot())
    (tmp_path / "robots" / "r0.json").unlink()
    assert store.usage() == counted(tmp_path)
    shutil.copy(tmp_path / "robots" / "r1.json", tmp_path / "robots" / "copy.json")
    assert store.usage() == counted(tmp_path)
    assert uploads(store) == ["copy", "r1", "r2", "r3"]


def test_the_ledger_of_a_killed_writer_is_not_believed(tmp_path, store, make_robot):
    store.put("r0", make_robot())
    blanked = """
import os, sys
from pathlib import Path
from robots.storage.directory import RobotDirectory
from robots.storage.usage_record import Quotas, blank
directory = RobotDirectory(Path(sys.argv[1]), Quotas())
with directory.write_transaction() as turn:
    blank(turn._descriptor, turn._record)
    (Path(sys.argv[1]) / "robots" / "r1.json").write_bytes(b"x")
    os.kill(os.getpid(), 9)
"""
    subprocess.run([sys.executable, "-c", blanked, str(tmp_path)], check=False, timeout=PATIENCE)
    assert store.usage() == counted(tmp_path) == Usage(2, counted(tmp_path).bytes)


def test_the_list_is_not_read_anew_until_something_changes(tmp_path, store, make_robot):
    store.put("r0", make_robot())
    assert store.ids() is store.ids()
    RobotStore(tmp_path).put("r1", make_robot())
    assert uploads(store) == ["r0", "r1"]
    RobotStore(tmp_path).delete("r0")
    assert uploads(store) == ["r1"]
    for k in range(20):
        RobotStore(tmp_path).put(f"new{k}", make_robot())
        assert f"new{k}" in store.ids()


def test_ids_after_one_that_need_not_exist(store, make_robot):
    for name in ("zza", "zzb", "zzc"):
        store.put(name, make_robot())
    assert store.ids_after("zzaa", 2) == ("zzb", "zzc")
    assert store.ids_after("zzb", 1) == ("zzc",)
    assert store.ids_after("zzz", 5) == ()


def test_no_more_robots_than_the_quota(tmp_path, make_robot):
    store = RobotStore(tmp_path, Quotas(robots=2))
    store.put("a", make_robot())
    store.put("b", make_robot())
    with pytest.raises(QuotaReached, match="2 uploaded robots at most") as caught:
        store.put("c", make_robot())
    assert (caught.value.quota, caught.value.limit) == ("robots", 2)
    store.put("b", make_robot(2))
    store.delete("a")
    store.put("c", make_robot())
    assert uploads(store) == ["b", "c"]


def test_no_more_bytes_than_the_quota_and_a_replacement_counts_its_difference(tmp_path, make_robot):
    small, large = make_robot(dof=1), make_robot(dof=6)
    store = RobotStore(tmp_path)
    store.put("a", small)
    store.put("b", large)
    quota = store.usage().bytes
    store = RobotStore(tmp_path, Quotas(bytes=quota))
    with pytest.raises(QuotaReached, match=rf"{quota} bytes of uploaded robots") as caught:
        store.put("a", large)
    assert (caught.value.quota, caught.value.limit) == ("bytes", quota)
    assert store.get("a").robot.revision == small.revision
    store.put("b", small)
    store.put("a", large)
    assert store.usage() == counted(tmp_path) == Usage(2, quota)


def test_beyond_a_lowered_quota_robots_are_served_and_may_shrink(tmp_path, make_robot):
    store = RobotStore(tmp_path)
    for name in ("a", "b"):
        store.put(name, make_robot(dof=5))
    store = RobotStore(tmp_path, Quotas(robots=1, bytes=10))
    store.put("a", make_robot(dof=1))
    assert store.get("b").robot.dof == 5
    for name, dof in (("a", 3), ("c", 1)):
        with pytest.raises(QuotaReached):
            store.put(name, make_robot(dof=dof))
    store.delete("b")


RACERS = """
import os, sys
from pathlib import Path
from dh_to_urdf import read_mapping
from robots.errors import QuotaReached
from robots.robot import robot_from_table
from robots.storage.usage_record import Quotas
from robots.store import RobotStore
robot = robot_from_table(read_mapping(
    {"convention": "dh", "joints": [{"type": "R", "alpha": 0, "a": 1, "d": 0}]}))
directory = Path(sys.argv[1])
wait, gun = os.pipe()
children = []
for k in range(4):
    children.append(os.fork())
    if children[-1] == 0:
        os.close(gun)
        os.read(wait, 1)
        store = RobotStore(directory, Quotas(robots=25))
        for n in range(20):
            try:
                store.put(f"r{k}-{n}", robot)
                os.write(1, b"stored\\n")
            except QuotaReached:
                os.write(1, b"refused\\n")
        os._exit(0)
os.close(gun)
sys.exit(any(os.waitpid(child, 0)[1] for child in children))
"""


def test_the_quota_is_exact_among_processes(tmp_path):
    ran = subprocess.run(
        [sys.executable, "-c", RACERS, str(tmp_path)],
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE,
    )
    assert sorted(ran.stdout.split()) == ["refused"] * 55 + ["stored"] * 25
    assert len(files(tmp_path)) == 25
