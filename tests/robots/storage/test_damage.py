"""Files that are no robots: never served, moved aside, named until they are replaced or deleted."""

import hashlib
import json
import os
import re
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from robots.errors import DamagedRobot, RobotNotFound
from robots.shipped import shipped_ids
from robots.storage.stored_file import MAX_FILE_BYTES
from robots.store import RobotStore
from tests.conftest import PATIENCE

OUTSIDER = 65534


@pytest.fixture
def store(tmp_path):
    return RobotStore(tmp_path)


def file_of(directory, robot_id):
    return directory / "robots" / f"{robot_id}.json"


def quarantined(directory):
    folder = directory / "quarantine"
    return sorted(path.name for path in folder.iterdir()) if folder.exists() else []


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def truncate(path):
    path.write_bytes(path.read_bytes()[:-20])


def be_foreign(path):
    path.write_text(json.dumps({"name": "x"}))


def be_a_directory(path):
    path.unlink()
    path.mkdir()
    (path / "kept").write_text("of somebody")


def be_a_link(path):
    other = path.with_name("elsewhere")
    path.rename(other)
    path.symlink_to(other)


def be_a_loop(path):
    path.unlink()
    path.symlink_to(path)


def be_a_pipe(path):
    path.unlink()
    os.mkfifo(path)


def be_huge(path):
    with path.open("r+b") as stream:
        stream.truncate(MAX_FILE_BYTES + 1)


DAMAGES = {
    flip: "checksum",
    truncate: "checksum",
    be_foreign: "checksum",
    lambda path: path.write_bytes(b""): "empty",
    be_a_directory: "foreign",
    be_a_link: "foreign",
    be_a_loop: "foreign",
    be_a_pipe: "foreign",
    be_huge: "size",
}
REASONS = list(DAMAGES.values())


@pytest.fixture(params=DAMAGES, ids=lambda damage: damage.__name__.strip("<>"))
def damage(request):
    return request.param


@pytest.mark.parametrize("loaded", [False, True], ids=["cold", "loaded"])
def test_a_damaged_file_is_moved_aside_and_its_robot_refused(
    tmp_path, store, make_robot, damage, loaded
):
    for name in ("probe", "other"):
        store.put(name, make_robot(name=name))
    if loaded:
        store.get("probe")
        store.summary("probe")
    damage(file_of(tmp_path, "probe"))
    for read in (store.get, store.summary, RobotStore(tmp_path).get):
        with pytest.raises(
            DamagedRobot, match=r"robot 'probe' was found .*; it was moved"
        ) as caught:
            read("probe")
        assert (caught.value.robot_id, caught.value.moved) == ("probe", True)
    (name,) = quarantined(tmp_path)
    assert re.fullmatch(rf"probe\.\d{{8}}T\d{{6}}\.\d{{9}}Z\.{DAMAGES[damage]}", name)
    assert name[6:14] == time.strftime("%Y%m%d", time.gmtime())
    assert store.damaged() == RobotStore(tmp_path).damaged() == ("probe",)
    assert store.ids() == tuple(sorted(("other", *shipped_ids())))
    assert store.get("other").robot.revision == make_robot(name="other").revision
    assert store.usage().robots == 1


def test_a_damaged_robot_is_whole_again_once_it_is_uploaded(tmp_path, store, make_robot, damage):
    store.put("probe", make_robot())
    damage(file_of(tmp_path, "probe"))
    with pytest.raises(DamagedRobot):
        store.get("probe")
    _, created = store.put("probe", make_robot(2))
    assert not created
    assert store.get("probe").robot.revision == make_robot(2).revision
    assert store.damaged() == ()


def test_a_damaged_file_that_nobody_has_read_is_replaced_or_deleted_too(
    tmp_path, store, make_robot, damage
):
    for name in ("replaced", "deleted"):
        store.put(name, make_robot())
        damage(file_of(tmp_path, name))
    store.put("replaced", make_robot(2))
    store.delete("deleted")
    assert store.get("replaced").robot.revision == make_robot(2).revision
    with pytest.raises(RobotNotFound):
        store.get("deleted")
    assert store.damaged() == ()
    assert RobotStore(tmp_path).usage().bytes == file_of(tmp_path, "replaced").stat().st_size


def test_a_deleted_robot_leaves_nothing_but_what_may_be_somebodys_folder(
    tmp_path, store, make_robot, damage
):
    store.put("probe", make_robot())
    damage(file_of(tmp_path, "probe"))
    with pytest.raises(DamagedRobot):
        store.get("probe")
    store.delete("probe")
    assert store.damaged() == ()
    left = [tmp_path / "quarantine" / name for name in quarantined(tmp_path)]
    if damage is be_a_directory:
        assert [(path / "kept").read_text() for path in left] == ["of somebody"]
    else:
        assert left == []
    with pytest.raises(RobotNotFound):
        store.delete("probe")


def test_the_check_finds_every_damaged_file_and_fills_the_list(tmp_path, store, make_robot):
    for k in range(9):
        store.put(f"r{k}", make_robot())
    for damage, k in zip(DAMAGES, range(9), strict=True):
        if k % 2:
            damage(file_of(tmp_path, f"r{k}"))
    fresh = RobotStore(tmp_path)
    fresh.check()
    assert fresh.damaged() == ("r1", "r3", "r5", "r7")
    assert [i for i in fresh.ids() if i not in shipped_ids()] == ["r0", "r2", "r4", "r6", "r8"]


def test_a_check_stops_when_it_is_told_to(tmp_path, store, make_robot):
    for k in range(3):
        store.put(f"r{k}", make_robot())
        flip(file_of(tmp_path, f"r{k}"))
    answers = iter([False, True])
    RobotStore(tmp_path).check(lambda: next(answers))
    assert store.damaged() == ("r0",)


def signed(body):
    return hashlib.sha256(body).hexdigest().encode() + b"\n" + body


@pytest.mark.parametrize(
    "body",
    [
        b'{"format": 4, "kind": "dh", "title": "a", "dof": 1}\n{"of": "tomorrow"}',
        b'{"format": 4}\n',
        b'{"format": 4, "kind": "dh", "table": {}}',
    ],
)
def test_a_file_of_another_version_is_refused_and_left_to_that_version(
    tmp_path, store, make_robot, body
):
    file_of(tmp_path, "probe").write_bytes(signed(body))
    for _ in range(2):
        with pytest.raises(DamagedRobot, match=r"by another version of the service$") as caught:
            store.get("probe")
        assert (caught.value.robot_id, caught.value.moved) == ("probe", False)
    assert file_of(tmp_path, "probe").read_bytes() == signed(body)
    assert store.damaged() == ("probe",)
    store.put("probe", make_robot())
    assert store.damaged() == ()


def test_a_file_of_the_first_format_is_read(tmp_path, store, make_robot, assert_same_robot):
    robot = make_robot(name="Mine")
    store.put("probe", robot)
    document = json.loads(file_of(tmp_path, "probe").read_bytes().split(b"\n")[2])
    document["format"] = 1
    file_of(tmp_path, "probe").write_bytes(signed(json.dumps(document).encode()))
    fresh = RobotStore(tmp_path)
    assert (fresh.summary("probe").title, fresh.summary("probe").dof) == ("Mine", robot.dof)
    assert_same_robot(fresh.get("probe").robot, robot)


AS_ANYBODY = """
import os, sys
from pathlib import Path
from robots.errors import DamagedRobot
from robots.store import RobotStore

directory = Path(sys.argv[1])
if os.getuid() == 0:
    os.chown(directory, OUTSIDER, OUTSIDER)
    os.setgid(OUTSIDER)
    os.setuid(OUTSIDER)
"""


def as_anybody(code, directory):
    """Runs code in a process that file permissions hold for."""
    source = AS_ANYBODY.replace("OUTSIDER", str(OUTSIDER)) + code
    # Where this folder cannot be entered by anybody, it is not the place for such a test.
    ran = subprocess.run(
        [sys.executable, "-c", source, str(directory)],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.split()


@pytest.fixture
def open_directory():
    """A directory that everybody can reach, as those of pytest cannot."""
    import shutil
    import tempfile

    path = Path(tempfile.mkdtemp())
    path.chmod(0o755)
    yield path
    shutil.rmtree(path)


UNREADABLE = """
from dh_to_urdf import read_mapping
from robots.robot import robot_from_table
joints = [{"type": "R", "alpha": 0, "a": 1, "d": 0}]
robot = robot_from_table(read_mapping({"convention": "dh", "joints": joints}))
store = RobotStore(directory)
store.put("probe", robot)
loaded = store.get("probe")
path = directory / "robots" / "probe.json"
path.chmod(0)
fresh = RobotStore(directory)
for read in (fresh.summary, fresh.get, store.get):
    try:
        print("from-memory" if read("probe") is loaded else "served")
    except DamagedRobot as error:
        print("refused" if "cannot be read" in str(error) else error)
print(*fresh.damaged())
path.chmod(0o600)
print(*fresh.damaged(), "/", fresh.get("probe").id, *fresh.damaged())
"""


def test_an_unreadable_file_is_refused_and_served_again_once_it_can_be_read(open_directory):
    said = as_anybody(UNREADABLE, open_directory)
    assert said == ["refused", "refused", "from-memory", "probe", "/", "probe"]


UNWRITABLE = """
store = RobotStore(directory)
path = directory / "robots" / "probe.json"
path.write_text("damaged")
(directory / "robots").chmod(0o500)
for _ in range(2):
    try:
        store.get("probe")
    except DamagedRobot as error:
        print("moved" if error.moved else "refused")
print(*store.damaged())
(directory / "robots").chmod(0o700)
try:
    store.get("probe")
except DamagedRobot as error:
    print(*store.damaged(), path.exists())
"""


def test_a_damaged_file_that_cannot_be_moved_is_refused_where_it_is(open_directory):
    said = as_anybody(UNWRITABLE, open_directory)
    assert said == ["refused", "refused", "probe", "probe", "False"]


def test_of_many_that_find_a_damaged_file_one_moves_it(tmp_path, store, make_robot):
    stores = [RobotStore(tmp_path) for _ in range(6)]
    for k in range(10):
        name, refused = f"r{k}", []
        store.put(name, make_robot())
        flip(file_of(tmp_path, name))
        start = threading.Barrier(len(stores))

        def read(one, name=name, start=start, refused=refused):
            start.wait()
            try:
                one.get(name)
            except DamagedRobot:
                refused.append(name)

        threads = [threading.Thread(target=read, args=(one,)) for one in stores]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(refused) == len(stores)
        assert len(quarantined(tmp_path)) == k + 1


@pytest.mark.parametrize("then", ["replaced", "deleted"])
def test_a_damaged_file_that_is_replaced_meanwhile_is_not_moved(tmp_path, store, make_robot, then):
    """The reader finds damage and waits for its turn; the writer before it replaces the file."""
    from robots.storage.stored_file import encode

    store.put("probe", make_robot())
    flip(file_of(tmp_path, "probe"))
    reader, seen = RobotStore(tmp_path), []

    def read():
        try:
            seen.append(reader.get("probe").robot.revision)
        except (DamagedRobot, RobotNotFound) as error:
            seen.append(type(error))

    with store._directory.write_transaction() as turn:
        thread = threading.Thread(target=read)
        thread.start()
        time.sleep(0.2)
        assert seen == []
        if then == "replaced":
            turn.write("probe", encode(make_robot(2)))
        else:
            turn.remove("probe")
    thread.join()
    assert seen == [make_robot(2).revision if then == "replaced" else RobotNotFound]
    assert quarantined(tmp_path) == []
    assert store.damaged() == ()
