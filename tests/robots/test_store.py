import hashlib
import os
import random
import subprocess
import sys
import threading
from contextlib import contextmanager

import pytest

from robots.errors import (
    DAMAGED,
    DamagedRobot,
    InvalidRobotId,
    ReadOnlyRobot,
    RevisionMismatch,
    RobotExists,
    RobotNotFound,
    StorageFull,
)
from robots.revisions import ANY
from robots.robot import robot_from_urdf
from robots.shipped import shipped_ids
from robots.store import RobotStore
from tests.conftest import PATIENCE

OTHER_PROCESS = """
import os, sys
from pathlib import Path
from dh_to_urdf import read_mapping
from robots.errors import RevisionMismatch, RobotExists
from robots.robot import robot_from_table
from robots.store import RobotStore
from tests.conftest import PATIENCE

def robot(height):
    row = {"type": "R", "alpha": 0, "a": 1, "d": 0}
    tool = {"xyz": [0, 0, height]}
    return robot_from_table(read_mapping({"convention": "dh", "joints": [row], "tool": tool}))

def height(robot):
    return round(robot.table.tool[2, 3])

def say(*words):
    os.write(1, (" ".join(map(str, words)) + "\\n").encode())

directory = Path(sys.argv[1])
"""
CREATE = """
made = [robot(k) for k in range(2)]

def race(store):
    for k in range(20):
        try:
            store.put(f"r{k}", made[k % 2], create_only=True)
            say(k)
        except RobotExists:
            pass
"""
INCREMENT = """
def race(store):
    done = 0
    while done < 10:
        seen = store.get("counter").robot
        try:
            store.put("counter", robot(height(seen) + 1), if_match=(seen.revision,))
            done += 1
        except RevisionMismatch:
            pass
"""
RACE = """
wait, gun = os.pipe()
children = []
for _ in range(4):
    children.append(os.fork())
    if children[-1] == 0:
        os.close(gun)
        os.read(wait, 1)
        race(RobotStore(directory))
        os._exit(0)
os.close(gun)
sys.exit(any(os.waitpid(child, 0)[1] for child in children))
"""


@contextmanager
def other_process(code, directory):
    command = [sys.executable, "-c", OTHER_PROCESS + code, str(directory)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
    ) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.fixture
def store(tmp_path):
    return RobotStore(tmp_path)


def file_of(directory, robot_id):
    return directory / "robots" / f"{robot_id}.json"


def test_a_robot_comes_back_as_it_went_in(store, make_robot, assert_same_robot):
    robot = make_robot()
    stored, created = store.put("probe", robot)
    assert (stored.id, stored.robot, stored.shipped, stored.title) == (
        "probe",
        robot,
        False,
        "probe",
    )
    assert created
    assert_same_robot(store.get("probe").robot, robot)
    assert store.get("probe") is store.get("probe")
    assert not store.put("probe", robot)[1]


def test_a_urdf_comes_back_with_its_base_tip_and_warnings(
    tmp_path, store, arm_urdf, assert_same_robot
):
    text = arm_urdf.replace('upper="1.5"', 'upper="1e9"').replace(
        '<axis xyz="1 1 0"/>', '<axis xyz="1 1 0"/><mimic joint="turn"/>'
    )
    robot = robot_from_urdf(text, base="turret", tip="boom")
    assert robot.dof == 2
    store.put("arm", robot)
    assert_same_robot(RobotStore(tmp_path).get("arm").robot, robot)


def test_a_stored_robot_is_there_for_every_store_of_the_directory(
    tmp_path, store, make_robot, assert_same_robot
):
    store.put("probe", make_robot())
    assert_same_robot(RobotStore(tmp_path).get("probe").robot, make_robot())


def test_another_store_sees_every_change_at_once(tmp_path, store, make_robot):
    other = RobotStore(tmp_path)
    with pytest.raises(RobotNotFound):
        other.get("probe")
    robots = [make_robot(tool) for tool in (1, 2)]
    for count in range(30):
        robot = robots[count % 2]
        store.put("probe", robot)
        assert other.get("probe").robot.revision == robot.revision
        assert other.in_memory("probe").robot.revision == robot.revision
    store.delete("probe")
    assert other.in_memory("probe") is None
    with pytest.raises(RobotNotFound):
        other.get("probe")


def test_shipped_and_stored_robots_are_listed_in_order(store, make_robot):
    assert store.ids() == shipped_ids()
    store.put("zeta", make_robot())
    store.put("Alpha", make_robot())
    assert store.ids() == tuple(sorted(("Alpha", "zeta", *shipped_ids())))


def test_foreign_files_are_not_listed(tmp_path, store):
    for name in ("notes.txt", ".hidden.json", "a b.json", "é.json", ".json", "-x.json"):
        (tmp_path / "robots" / name).write_text("x")
    assert store.ids() == shipped_ids()


def test_a_summary_says_what_a_list_shows(tmp_path, store, make_robot):
    store.put("probe", make_robot(name="My probe", dof=5))
    mine, theirs = store.summary("probe"), store.summary("talos")
    assert (mine.id, mine.kind, mine.title, mine.dof) == ("probe", "dh", "My probe", 5)
    assert not mine.shipped
    assert (theirs.kind, theirs.dof, theirs.shipped) == ("urdf", 32, True)
    assert store.in_memory("talos") is None
    RobotStore(tmp_path).put("probe", make_robot(dof=2))
    assert store.summary("probe").dof == 2
    RobotStore(tmp_path).delete("probe")
    with pytest.raises(RobotNotFound):
        store.summary("probe")
    with pytest.raises(RobotNotFound):
        store.summary("nobody")


def test_a_shipped_robot_is_served_and_read_only(store, make_robot):
    assert store.get("ur5").shipped
    assert store.get("ur5").source
    with pytest.raises(ReadOnlyRobot, match="'ur5' is shipped"):
        store.put("ur5", make_robot())
    with pytest.raises(ReadOnlyRobot, match="'ur5' is shipped"):
        store.delete("ur5")


ESCAPES = ("", ".", "..", "../x", "a/b", "/etc/passwd", "a\x00")
BAD_IDS = (*ESCAPES, "x" * 65, ".a", "-a", "a b", "é", "a\n")


@pytest.mark.parametrize("robot_id", BAD_IDS)
def test_ids_that_are_no_file_names_are_refused(tmp_path, store, make_robot, robot_id):
    with pytest.raises(InvalidRobotId, match="letters, digits") as caught:
        store.put(robot_id, make_robot())
    assert (caught.value.robot_id, caught.value.argument) == (robot_id, "name")
    for call in (store.get, store.delete, store.summary):
        with pytest.raises(RobotNotFound):
            call(robot_id)
    assert store.in_memory(robot_id) is None
    assert not list((tmp_path / "robots").iterdir())


@pytest.mark.parametrize("robot_id", ["a", "9", "x" * 64, "a.json", "a..b", "A-b_c.d", "con"])
def test_other_ids_are_accepted(tmp_path, store, make_robot, robot_id):
    store.put(robot_id, make_robot())
    assert robot_id in RobotStore(tmp_path).ids()
    assert RobotStore(tmp_path).get(robot_id).robot.dof == 3
    store.delete(robot_id)
    assert robot_id not in store.ids()


def test_an_unknown_robot_is_refused_with_the_nearest_names(store):
    with pytest.raises(RobotNotFound, match="did you mean puma560") as caught:
        store.get("puma56")
    assert caught.value.robot_id == "puma56"
    assert "puma560" in caught.value.valid
    assert caught.value.total == len(store.ids())


def test_a_robot_is_created_only_once(store, make_robot):
    store.put("probe", make_robot(), create_only=True)
    with pytest.raises(RobotExists, match="'probe' exists already") as caught:
        store.put("probe", make_robot(2), create_only=True)
    assert caught.value.robot_id == "probe"
    assert store.get("probe").robot.revision == make_robot().revision


def test_a_robot_is_replaced_only_at_the_revision_that_was_read(store, make_robot):
    first, second = make_robot(1), make_robot(2)
    with pytest.raises(RevisionMismatch, match="does not exist"):
        store.put("probe", first, if_match=(first.revision,))
    with pytest.raises(RevisionMismatch, match="does not exist"):
        store.put("probe", first, if_match=(ANY,))
    store.put("probe", first)
    with pytest.raises(RevisionMismatch, match="'probe' is at revision") as caught:
        store.put("probe", second, if_match=(second.revision,))
    assert caught.value.current == first.revision
    store.put("probe", second, if_match=(first.revision,))
    store.put("probe", first, if_match=(ANY,))
    store.put("probe", second, if_match=(second.revision, first.revision))
    store.put("probe", first)
    with pytest.raises(RevisionMismatch):
        store.delete("probe", if_match=(second.revision,))
    for met in ((first.revision,), (ANY,)):
        with pytest.raises(RevisionMismatch):
            store.put("probe", second, if_match=(ANY,), if_none_match=met)
        with pytest.raises(RevisionMismatch):
            store.delete("probe", if_none_match=met)
    store.put("probe", first, if_none_match=(second.revision,))
    store.delete("probe", if_match=(first.revision,))
    with pytest.raises(RobotNotFound):
        store.delete("probe")


def test_a_file_with_any_byte_changed_is_never_served_and_put_heals_it(tmp_path, store, make_robot):
    robot = make_robot()
    store.put("probe", robot)
    path = file_of(tmp_path, "probe")
    sound, rng = path.read_bytes(), random.Random(0)
    for _ in range(40):
        damaged = bytearray(sound)
        damaged[rng.randrange(len(sound))] ^= 1 << rng.randrange(8)
        path.write_bytes(damaged)
        for _ in range(2):
            with pytest.raises(DamagedRobot, match="; it was moved to quarantine"):
                RobotStore(tmp_path).get("probe")
    with pytest.raises(DamagedRobot):
        store.get("probe")
    assert "probe" not in store.ids()
    assert store.damaged() == ("probe",)
    store.put("probe", robot)
    assert path.read_bytes() == sound
    assert store.get("probe").robot.revision == robot.revision
    assert store.damaged() == ()


@pytest.mark.parametrize("content", [b"", b"\n", b"{}", b"\x00" * 500, b"x" * 64 + b"\n{}"])
def test_a_file_of_something_else_is_damaged(tmp_path, store, content):
    file_of(tmp_path, "probe").write_bytes(content)
    with pytest.raises(DamagedRobot):
        store.get("probe")
    with pytest.raises(DamagedRobot):
        store.summary("probe")
    assert [path.read_bytes() for path in (tmp_path / "quarantine").iterdir()] == [content]
    store.delete("probe")
    assert store.damaged() == ()
    assert not list((tmp_path / "quarantine").iterdir())
    with pytest.raises(RobotNotFound):
        store.get("probe")


DOCUMENTS = [
    b"[]",
    b"null",
    b'{"kind": "dh"}',
    b'{"kind": "dh", "table": {"convention": "dh", "joints": []}, "warnings": []}',
    b'{"kind": "urdf", "urdf": "<robot/>", "base": null, "tip": null, "warnings": []}',
]


@pytest.mark.parametrize("body", DOCUMENTS)
def test_a_sound_file_that_holds_no_robot_is_damaged_too(tmp_path, store, make_robot, body):
    checksum = hashlib.sha256(body).hexdigest().encode()
    file_of(tmp_path, "probe").write_bytes(checksum + b"\n" + body)
    with pytest.raises(DamagedRobot, match=r"this version of the service refuses$"):
        store.get("probe")
    assert file_of(tmp_path, "probe").exists()
    assert store.damaged() == ("probe",)
    store.put("probe", make_robot())
    assert store.get("probe").robot.dof == 3
    assert store.damaged() == ()


def test_a_truncated_file_is_damaged(tmp_path, store, make_robot):
    store.put("probe", make_robot())
    path = file_of(tmp_path, "probe")
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(DamagedRobot):
        store.get("probe")


def test_a_damaged_robot_has_no_revision_to_match(tmp_path, store, make_robot):
    file_of(tmp_path, "probe").write_bytes(b"")
    for _ in ("in its place", "in quarantine"):
        with pytest.raises(RobotExists):
            store.put("probe", make_robot(), create_only=True)
        with pytest.raises(RevisionMismatch, match="'probe' is damaged") as caught:
            store.put("probe", make_robot(), if_match=(make_robot().revision,))
        assert caught.value.current == DAMAGED
        with pytest.raises(RevisionMismatch):
            store.delete("probe", if_match=(make_robot().revision,))
        with pytest.raises(DamagedRobot):
            store.get("probe")
    store.put("probe", make_robot(), if_match=(ANY,))
    assert store.get("probe").robot.dof == 3


def test_what_killed_writers_left_behind_is_removed_at_the_start_and_by_the_next_writer(
    tmp_path, store, make_robot
):
    store.put("probe", make_robot())
    leftover = tmp_path / "robots" / ".probe.tmp"
    leftover.write_text("half a robo")
    assert RobotStore(tmp_path).ids() == tuple(sorted(("probe", *shipped_ids())))
    assert not leftover.exists()
    leftover.write_text("half a robo")
    store.put("probe", make_robot(2))
    assert not leftover.exists()
    assert store.get("probe").robot.revision == make_robot(2).revision


def test_a_failed_write_leaves_the_old_robot_and_no_file_behind(
    tmp_path, store, make_robot, monkeypatch
):
    store.put("probe", make_robot(1))

    def no_space_left(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", no_space_left)
    with pytest.raises(StorageFull, match="what was stored before is intact"):
        store.put("probe", make_robot(2))
    assert [path.name for path in (tmp_path / "robots").iterdir()] == ["probe.json"]
    assert RobotStore(tmp_path).get("probe").robot.revision == make_robot(1).revision


def test_threads_of_one_store_never_lose_a_robot(tmp_path, store, make_robot):
    robots = [make_robot(tool) for tool in range(8)]
    revisions = {robot.revision for robot in robots}
    failures = []

    def work(k):
        for _ in range(4):
            store.put(f"own{k}", robots[k])
            store.put("shared", robots[k])
            if store.get(f"own{k}").robot.revision != robots[k].revision:
                failures.append(k)
            if store.get("shared").robot.revision not in revisions:
                failures.append("shared")

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    assert len(RobotStore(tmp_path).ids()) == len(shipped_ids()) + 9


def race(code, directory):
    """Runs four processes from one starting gun; gives the lines that they say."""
    with other_process(code + RACE, directory) as racers:
        lines = racers.communicate(timeout=PATIENCE)[0].splitlines()
        assert racers.returncode == 0
    return lines


def test_of_several_processes_that_create_a_robot_one_wins(tmp_path):
    winners = race(CREATE, tmp_path)
    assert sorted(map(int, winners)) == list(range(20))


def test_processes_that_count_by_revisions_lose_no_step(tmp_path, store, make_robot):
    store.put("counter", make_robot(tool=0))
    race(INCREMENT, tmp_path)
    assert round(store.get("counter").robot.table.tool[2, 3]) == 40
