"""Whose robot may be replaced or deleted unasked."""

import pytest

from robots.errors import AnothersRobot, RevisionMismatch
from robots.revisions import ANY
from robots.store import RobotStore
from robots.writer import Writer

ADA, BOB, NOBODY = (Writer(name, spares=True) for name in ("ada", "bob", None))


@pytest.fixture
def store(tmp_path):
    return RobotStore(tmp_path)


@pytest.mark.parametrize(("maker", "other"), [(ADA, BOB), (ADA, NOBODY), (NOBODY, ADA)])
def test_the_robot_of_another_is_spared(store, make_robot, maker, other):
    tag = store.put("arm", make_robot(1), writer=maker)[0].robot.revision
    assert not store.put("arm", make_robot(1), writer=other)[1]
    with pytest.raises(AnothersRobot):
        store.put("arm", make_robot(2), writer=other)
    with pytest.raises(AnothersRobot):
        store.put("arm", make_robot(2), writer=other, if_none_match=("old",))
    with pytest.raises(AnothersRobot):
        store.delete("arm", writer=other)
    with pytest.raises(RevisionMismatch):
        store.put("arm", make_robot(2), writer=other, if_match=("old",))
    assert store.get("arm").robot.revision == tag
    store.put("arm", make_robot(2), writer=other, if_match=(tag,))
    assert store.get("arm").robot.revision == make_robot(2).revision
    store.delete("arm", writer=maker, if_match=(ANY,))


def test_the_maker_is_known_to_every_process_and_remains_it(tmp_path, store, make_robot):
    store.put("arm", make_robot(1), writer=ADA)
    store.put("arm", make_robot(1), writer=BOB)
    again = RobotStore(tmp_path)
    assert again.get("arm").maker == "ada"
    again.put("arm", make_robot(2), writer=ADA)
    with pytest.raises(AnothersRobot):
        again.put("arm", make_robot(1), writer=BOB)
    again.put("arm", make_robot(1), writer=Writer("bob"))
    assert store.get("arm").maker == "bob"
    store.delete("arm", writer=BOB)


def test_without_names_all_are_others(store, make_robot):
    store.put("arm", make_robot(1), writer=NOBODY)
    store.put("arm", make_robot(1), writer=NOBODY)
    with pytest.raises(AnothersRobot):
        store.put("arm", make_robot(2), writer=NOBODY)


def test_a_damaged_robot_is_replaced_by_anybody(tmp_path, store, make_robot):
    store.put("arm", make_robot(1), writer=ADA)
    (tmp_path / "robots" / "arm.json").write_bytes(b"")
    store.put("arm", make_robot(2), writer=BOB)
    assert store.get("arm").maker == "bob"
