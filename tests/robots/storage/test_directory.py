"""Directories that vanish, locks that are held, disks that are full: nothing is lost or half."""

import os
import resource
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from robots.errors import RobotNotFound, StorageFull, StorageUnavailable
from robots.shipped import shipped_ids
from robots.storage.durable import write_durably
from robots.storage.usage_record import Usage
from robots.store import RobotStore
from tests.torture.disks import small_disk


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


def open_files():
    return sorted(path.name for path in Path("/proc/self/fd").iterdir())


def wait_for_a_turn(store, seconds):
    with store._directory.write_transaction(seconds):
        pass


def test_no_two_versions_of_a_file_look_the_same(tmp_path):
    path, seen = tmp_path / "file", set()
    for k in range(50):
        write_durably(path, b"%03d" % k)
        status = path.stat()
        assert all(status.st_mtime_ns > earlier for earlier in seen)
        seen.add(status.st_mtime_ns)
    future = time.time_ns() + 10**12
    os.utime(path, ns=(future, future))
    write_durably(path, b"new")
    assert path.stat().st_mtime_ns == future + 1


def test_a_directory_removed_under_the_service_is_an_empty_one(tmp_path, make_robot):
    store = RobotStore(tmp_path / "data")
    store.put("probe", make_robot())
    store.get("probe")
    shutil.rmtree(tmp_path / "data")
    assert store.ids() == shipped_ids()
    assert store.damaged() == ()
    with pytest.raises(RobotNotFound):
        store.get("probe")
    with pytest.raises(RobotNotFound):
        store.delete("probe")
    assert store.get("pa10").robot.dof == 7
    store.put("probe", make_robot(2))
    assert RobotStore(tmp_path / "data").get("probe").robot.revision == make_robot(2).revision


def test_a_removed_lock_file_parts_no_writers(tmp_path, store, make_robot):
    """A writer that waits for a lock that is removed takes the new one, with all others."""
    order = []

    def write():
        with RobotStore(tmp_path)._directory.write_transaction():
            order.append("second")

    with store._directory.write_transaction():
        thread = threading.Thread(target=write)
        thread.start()
        time.sleep(0.2)
        (tmp_path / "robots.lock").unlink()
        assert order == []
        order.append("first")
    thread.join()
    assert order == ["first", "second"]
    other = RobotStore(tmp_path)
    with store._directory.write_transaction(), pytest.raises(StorageUnavailable):
        wait_for_a_turn(other, 0.05)


@pytest.mark.parametrize("kind", ["directory", "pipe", "link"])
def test_a_lock_that_is_no_file_stops_writers_only(tmp_path, store, make_robot, kind):
    store.put("probe", make_robot())
    lock = tmp_path / "robots.lock"
    lock.unlink()
    {
        "directory": lock.mkdir,
        "pipe": lambda: os.mkfifo(lock),
        "link": lambda: lock.symlink_to("/etc/passwd"),
    }[kind]()
    fresh = RobotStore(tmp_path)
    assert fresh.get("probe").robot.revision == make_robot().revision
    assert uploads(fresh) == ["probe"]
    for write in (lambda: fresh.put("probe", make_robot(2)), lambda: fresh.delete("probe")):
        with pytest.raises(StorageUnavailable, match="the data directory of the service") as caught:
            write()
        assert caught.value.retry_after == 5.0
    assert RobotStore(tmp_path).get("probe").robot.revision == make_robot().revision


def test_a_writer_that_hangs_is_waited_for_so_long_and_readers_go_on(tmp_path, store, make_robot):
    store.put("probe", make_robot())
    hangs = """
import sys, time
from pathlib import Path
from robots.storage.directory import RobotDirectory
from robots.storage.usage_record import Quotas
with RobotDirectory(Path(sys.argv[1]), Quotas()).write_transaction():
    print("held", flush=True)
    time.sleep(600)
"""
    command = [sys.executable, "-c", hangs, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline() == "held\n"
            with pytest.raises(StorageUnavailable, match="has been writing robots for too long"):
                wait_for_a_turn(store, 0.3)
            fresh = RobotStore(tmp_path)
            assert fresh.get("probe").robot.revision == make_robot().revision
            assert "probe" in fresh.ids()
        finally:
            process.kill()
    store.put("probe", make_robot(2))


def test_without_free_file_descriptors_nothing_is_lost_damaged_or_leaked(
    tmp_path, store, make_robot
):
    for name in ("probe", "cold"):
        store.put(name, make_robot())
    store.get("probe")
    before, (soft, hard) = open_files(), resource.getrlimit(resource.RLIMIT_NOFILE)
    filler = []
    resource.setrlimit(resource.RLIMIT_NOFILE, (len(before) + 20, hard))
    try:
        while True:
            try:
                filler.append(os.open("/dev/null", os.O_RDONLY))
            except OSError:
                break
        for call in (
            lambda: store.put("new", make_robot()),
            lambda: store.get("cold"),
            lambda: store.summary("cold"),
            lambda: store.delete("cold"),
            lambda: RobotStore(tmp_path).ids(),
        ):
            with pytest.raises(StorageUnavailable):
                call()
        assert store.get("probe").robot.revision == make_robot().revision
        # One or two are free: the lock can be opened, the temporary file perhaps not.
        for _ in range(3):
            os.close(filler.pop())
            try:
                store.put("probe", make_robot(2))
            except StorageUnavailable:
                assert RobotStore(tmp_path).in_memory("probe") is None
    finally:
        for descriptor in filler:
            os.close(descriptor)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert open_files() == before
    assert store.damaged() == ()
    assert not (tmp_path / "quarantine").exists()
    assert store.get("cold").robot.revision == make_robot().revision
    assert sorted(path.name for path in (tmp_path / "robots").iterdir()) == [
        "cold.json",
        "probe.json",
    ]


@pytest.mark.parametrize(
    "limit", [{"size": "96k"}, {"size": "8m", "nr_inodes": 12}], ids=["space", "inodes"]
)
def test_a_full_disk_refuses_and_keeps_what_it_has(tmp_path, make_robot, limit):
    with small_disk(tmp_path / "disk", **limit) as directory:
        if directory is None:
            pytest.skip("mounting a small disk takes more rights than this process has")
        store, stored, before = RobotStore(directory), {}, open_files()

        def fill():
            for k in range(1000):
                robot = make_robot(k, dof=1 + k % 7)
                store.put(f"r{k}", robot)
                stored[f"r{k}"] = robot.revision

        with pytest.raises(StorageFull, match="was not stored"):
            fill()
        large = make_robot(dof=60)
        for name in stored:
            with pytest.raises(StorageFull):
                store.put("another", large)
            assert RobotStore(directory).get(name).robot.revision == stored[name]
        fresh = RobotStore(directory)
        assert uploads(fresh) == sorted(stored)
        assert fresh.usage() == counted(directory)
        assert {path.suffix for path in (directory / "robots").iterdir()} == {".json"}
        assert open_files() == before
        for name in list(stored)[:6]:
            fresh.delete(name)
        fresh.put("again", make_robot(dof=4))
        assert fresh.get("again").robot.dof == 4


def test_a_file_size_limit_is_a_full_disk_too(tmp_path, store, make_robot):
    store.put("probe", make_robot())
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (900, hard))
    try:
        with pytest.raises(StorageFull):
            store.put("probe", make_robot(dof=30))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert RobotStore(tmp_path).get("probe").robot.revision == make_robot().revision
    assert [path.name for path in (tmp_path / "robots").iterdir()] == ["probe.json"]


@pytest.mark.parametrize("step", ["fsync", "replace", "utime"])
def test_whatever_step_fails_the_old_robot_stays(tmp_path, store, make_robot, monkeypatch, step):
    store.put("probe", make_robot())
    before = open_files()

    def fail(*arguments, **named):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(os, step, fail)
        with pytest.raises(StorageFull):
            store.put("probe", make_robot(2))
        with pytest.raises(StorageFull):
            store.put("new", make_robot(2))
    fresh = RobotStore(tmp_path)
    assert fresh.get("probe").robot.revision == make_robot().revision
    assert [path.name for path in (tmp_path / "robots").iterdir()] == ["probe.json"]
    assert fresh.usage() == counted(tmp_path)
    assert open_files() == before


def test_an_unwritable_place_is_no_hindrance_to_reading(tmp_path):
    (tmp_path / "file").write_text("not a directory")
    store = RobotStore(tmp_path / "file" / "data")
    assert store.get("pa10").robot.dof == 7
    assert store.ids() == shipped_ids()
