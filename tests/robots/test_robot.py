import math
import threading
from dataclasses import FrozenInstanceError
from itertools import pairwise

import numpy as np
import pytest

from dh_to_urdf import dh_matrices, read_mapping
from robots.errors import InvalidURDF, RobotTooLarge, UnknownFrame
from robots.robot import robot_from_table, robot_from_urdf


def link_and_joint(name, type_, parent, child, axis="0 0 1"):
    return (
        f'<link name="{child}"/><joint name="{name}" type="{type_}"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="0.3 0.2 0.1" rpy="0.4 -0.5 0.6"/>'
        f'<axis xyz="{axis}"/><limit lower="-1" upper="1" effort="5" velocity="2"/></joint>'
    )


BRANCHED = (
    '<robot name="branched"><link name="root"/>'
    + link_and_joint("z", "revolute", "root", "l9")
    + link_and_joint("joint_10", "continuous", "l9", "l8", "0 1 0")
    + link_and_joint("left_2", "prismatic", "root", "l7", "1 0 0")
    + link_and_joint("joint_2", "revolute", "l8", "l6", "1 2 3")
    + link_and_joint("weld", "fixed", "l6", "l5")
    + link_and_joint("left_1", "continuous", "l7", "l4", "0 0 -1")
    + link_and_joint("a", "prismatic", "l5", "l3", "0 1 1")
    + link_and_joint("left_10", "revolute", "l7", "l2")
    + "</robot>"
)
ORDER = ("z", "joint_10", "left_2", "joint_2", "left_1", "a", "left_10")


def table_of(*rows, **fields):
    rows = [{"type": "R", "alpha": 0, "a": 1, "d": 0, "theta": 0, **row} for row in rows]
    return read_mapping({"convention": "dh", "joints": rows, **fields})


def test_q_follows_the_file_and_not_the_alphabet(urdf_frames, poses):
    robot = robot_from_urdf(BRANCHED)
    assert tuple(joint.name for joint in robot.joints) == ORDER
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = rng.uniform(-3, 3, 7)
        expected = urdf_frames(BRANCHED, dict(zip(ORDER, q, strict=True)))
        found = poses(robot, q)
        assert max(np.abs(found[name] - T).max() for name, T in expected.items()) < 1e-14


def test_columns_of_the_tangent_space_follow_the_file(poses):
    robot = robot_from_urdf(BRANCHED)
    assert sorted(robot.velocity_columns) == list(range(7))
    for entry, column in enumerate(robot.velocity_columns):
        joint = robot.model.joints[robot.model.getJointId(ORDER[entry])]
        assert column == joint.idx_v


def test_continuous_joints_take_angles_of_any_size(poses):
    robot = robot_from_urdf(BRANCHED)
    assert robot.is_revolute.tolist() == [True, True, False, True, True, False, True]
    q = np.array([0.1, 100.0, 0.2, 0.3, -50.0, 0.4, 0.5])
    turned = q + 2 * math.pi * np.array([0, 1, 0, 0, -2, 0, 0])
    for name, T in poses(robot, q).items():
        assert np.abs(poses(robot, turned)[name] - T).max() < 1e-13
    assert robot.configuration(q).shape == (robot.model.nq,) == (7,)


def test_rows_of_a_table_are_q_even_with_names_in_reverse(poses):
    rows = [{"name": f"j{9 - k}", "alpha": 0.3 * k, "d": 0.1} for k in range(9)]
    rows[3]["type"], rows[5]["type"] = "F", "P"
    table = table_of(*rows, base={"xyz": [1, 2, 3], "rpy": [0.1, 0.2, 0.3]})
    robot = robot_from_table(table)
    assert [joint.name for joint in robot.joints] == [f"j{9 - k}" for k in range(9) if k != 3]
    q = np.random.default_rng(0).uniform(-3, 3, 8)
    found, expected = poses(robot, q), dh_matrices(table, q)
    assert np.abs(found["tool"] - expected.T).max() < 1e-14
    for k in range(9):
        assert np.abs(found[f"frame_{k + 1}"] - table.base @ expected.T0[k]).max() < 1e-14


def test_frames_of_a_table_are_those_of_the_textbook():
    robot = robot_from_table(table_of({}, {"type": "F"}, {"type": "P"}))
    assert robot.frames == ("base_link", "frame_0", "frame_1", "frame_2", "frame_3", "tool")
    assert (robot.base_frame, robot.tip_frame, robot.kind) == ("base_link", "tool", "dh")


def test_eight_threads_compute_what_one_does(poses):
    robot = robot_from_urdf(BRANCHED)
    q = np.random.default_rng(0).uniform(-3, 3, (8, 200, 7))

    def tips(configurations):
        return [poses(robot, row, ["l3", "l4"]) for row in configurations]

    expected = [tips(part) for part in q]
    found, start = [None] * 8, threading.Barrier(8)

    def work(k):
        start.wait()
        found[k] = tips(q[k])

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for left, right in zip(expected, found, strict=True):
        for one, other in zip(left, right, strict=True):
            assert all(np.array_equal(one[name], other[name]) for name in one)


def test_threads_have_working_memory_of_their_own():
    robot = robot_from_urdf(BRANCHED)
    found = []
    thread = threading.Thread(target=lambda: found.append(robot.data()))
    thread.start()
    thread.join()
    assert robot.data() is robot.data()
    assert found[0] is not robot.data()


def test_the_default_tip_is_the_leaf_of_the_chain_with_most_moving_joints():
    robot = robot_from_urdf(BRANCHED)
    assert (robot.base_frame, robot.tip_frame) == ("root", "l3")
    chain = ["root", *(f"m{k}" for k in range(9))]
    fixed = "".join(link_and_joint(f"f_{b}", "fixed", a, b) for a, b in pairwise(chain))
    assert robot_from_urdf(BRANCHED.replace("</robot>", f"{fixed}</robot>")).tip_frame == "l3"


def test_of_equal_chains_the_first_leaf_of_the_file_is_the_tip():
    text = (
        '<robot name="r"><link name="root"/>'
        + link_and_joint("b", "revolute", "root", "second")
        + link_and_joint("a", "revolute", "root", "first")
        + "</robot>"
    )
    assert robot_from_urdf(text).tip_frame == "second"


def test_base_and_tip_may_be_any_links(urdf_frames, poses):
    robot = robot_from_urdf(BRANCHED, base="l7", tip="l6")
    assert (robot.base_frame, robot.tip_frame) == ("l7", "l6")
    q = np.full(7, 0.3)
    frames = urdf_frames(BRANCHED, dict.fromkeys(ORDER, 0.3))
    expected = np.linalg.inv(frames["l7"]) @ frames["l6"]
    assert np.abs(poses(robot, q)["l6"] - expected).max() < 1e-14


@pytest.mark.parametrize("role", ["base", "tip"])
def test_an_unknown_base_or_tip_is_refused_with_the_nearest_names(role):
    with pytest.raises(UnknownFrame, match="did you mean root") as caught:
        robot_from_urdf(BRANCHED, **{role: "rooot"})
    assert (caught.value.argument, caught.value.index) == (role, ())
    assert "l9" in caught.value.valid


def test_an_unknown_frame_is_refused_with_the_names_that_there_are():
    robot = robot_from_table(table_of({}))
    with pytest.raises(UnknownFrame, match="known are base_link, frame_0, frame_1, tool") as caught:
        robot.frame_id("xyz", "frames", (0,))
    assert (caught.value.argument, caught.value.index) == ("frames", (0,))
    with pytest.raises(UnknownFrame, match="unknown"):
        robot.frame_id("link_1")


def test_joints_without_limits_have_none():
    joints = robot_from_urdf(BRANCHED).joints
    assert [joint.lower for joint in joints] == [-1, None, -1, -1, None, -1, -1]
    rows = ({}, {"type": "P"}, {"limits": {"lower": -1, "upper": 2, "velocity": 3, "effort": 4}})
    robot = robot_from_table(table_of(*rows))
    assert [joint.upper for joint in robot.joints] == [None, None, 2]
    assert [joint.velocity for joint in robot.joints] == [None, None, 3]
    assert [joint.effort for joint in robot.joints] == [None, None, 4]
    assert robot.lower.tolist() == [-math.inf, -math.inf, -1]
    assert robot.upper.tolist() == [math.inf, math.inf, 2]


def test_a_million_stands_for_no_limit():
    again = robot_from_urdf(robot_from_table(table_of({"type": "P"})).urdf)
    (joint,) = again.joints
    assert (joint.lower, joint.upper, joint.velocity, joint.effort) == (None, None, None, None)


CHANGES = {
    "a": 1.0000000000000002,
    "d": 1e-300,
    "alpha": 0.1,
    "theta": 0.1,
    "offset": 0.2,
    "sign": -1,
    "type": "P",
    "name": "other",
    "limits": {"lower": -1, "upper": 1},
    "inertial": {"mass": 1},
}


@pytest.mark.parametrize("field", CHANGES)
def test_a_revision_changes_with_every_field_of_a_row(field):
    base = robot_from_table(table_of({}, {}))
    assert robot_from_table(table_of({}, {field: CHANGES[field]})).revision != base.revision


@pytest.mark.parametrize(
    "fields",
    [
        {"name": "other"},
        {"convention": "mdh"},
        {"base": {"xyz": [0, 0, 1]}},
        {"tool": {"rpy": [0, 0, 1]}},
    ],
)
def test_a_revision_changes_with_every_field_of_a_table(fields):
    base = robot_from_table(table_of({}))
    assert robot_from_table(table_of({}, **fields)).revision != base.revision


def test_a_revision_tells_modified_from_khalil():
    row = {"name": "j", "type": "R", "alpha": 1, "d": 0, "theta": 0}
    modified = read_mapping({"convention": "mdh", "joints": [{**row, "a": 0}]})
    khalil = read_mapping({"convention": "khalil", "joints": [{**row, "r": 0}]})
    assert robot_from_table(modified).revision != robot_from_table(khalil).revision


def test_a_revision_does_not_change_with_the_way_of_writing():
    plain = table_of({"alpha": math.pi / 2, "theta": 0.5}, title="One", source="here")
    other = table_of({"alpha": "90°", "theta": "q + 0.5", "name": "j1", "type": "revolute"})
    assert robot_from_table(plain).revision == robot_from_table(other).revision
    assert len(robot_from_table(plain).revision) == 64


def test_a_revision_of_a_urdf_changes_with_what_matters_only():
    base = robot_from_urdf(BRANCHED)
    spaced = BRANCHED.replace("<link", "\n  <!-- note -->\n  <link").replace("0.3 0.2", "0.30  .2")
    assert robot_from_urdf(spaced).revision == base.revision
    assert robot_from_urdf(BRANCHED, tip="l3", base="root").revision == base.revision
    others = [
        robot_from_urdf(BRANCHED, tip="l4"),
        robot_from_urdf(BRANCHED, base="l9"),
        robot_from_urdf(BRANCHED.replace("0.3 0.2", "0.3 0.25", 1)),
        robot_from_urdf(BRANCHED.replace('upper="1"', 'upper="1.5"', 1)),
        robot_from_urdf(BRANCHED.replace('name="branched"', 'name="other"')),
    ]
    assert len({base.revision, *(robot.revision for robot in others)}) == 6


def test_a_robot_cannot_be_changed():
    robot = robot_from_table(table_of({}))
    with pytest.raises(FrozenInstanceError):
        robot.name = "other"


def test_a_table_that_does_not_move_is_refused():
    with pytest.raises(InvalidURDF, match="no joint that moves") as caught:
        robot_from_table(table_of({"type": "F"}))
    assert caught.value.location == ("joints",)


def test_sixty_four_joints_are_computed_and_no_more():
    assert robot_from_table(table_of(*[{}] * 64)).dof == 64
    with pytest.raises(RobotTooLarge, match="65 joints; at most 64"):
        robot_from_table(table_of(*[{}] * 65))
