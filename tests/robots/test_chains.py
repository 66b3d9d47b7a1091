"""URDF -> D-H -> URDF: the same forward kinematics, by Pinocchio, for every chain there is."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import Convention, JointType, extract, table_to_urdf
from robots.chains import chain_of_robot, chain_of_urdf
from robots.errors import InvalidURDF, UnknownFrame
from robots.robot import robot_from_table, robot_from_urdf
from robots.shipped import shipped_ids, shipped_robot

AXES = ["0 0 1", "0 0 -1", "1 0 0", "0 1 0", "0 -1 0", "1 1 0", "0.3 -0.2 0.9"]
ROUND = [0.0, 0.0, math.pi / 2, -math.pi / 2, math.pi]
# What people write for π/2 and π, and tilts on both sides of every threshold.
ROUNDED = [1.5708, 3.14159, 1.57, 1e-3, 1e-5, 1e-7, 2e-8]
LENGTHS = [0.0, 0.0, 0.4, -0.15, 1.0, 1e-6]


def angles(tilts):
    return st.sampled_from(ROUND + tilts) | st.floats(-3.2, 3.2, allow_nan=False)


@st.composite
def urdfs(draw, tilts=tuple(ROUNDED)):
    """A URDF of one chain: moving joints of all types with fixed ones between, all degeneracies."""
    count = draw(st.integers(1, 7))
    lines = ['<robot name="chain"><link name="l0"/>']
    for k in range(count):
        last = k == count - 1
        type_ = draw(st.sampled_from(["revolute", "revolute", "prismatic", "continuous", "fixed"]))
        if last and "axis" not in "".join(lines):
            type_ = "revolute"
        xyz = [draw(st.sampled_from(LENGTHS) | st.floats(-1, 1)) for _ in range(3)]
        rpy = [draw(angles(list(tilts))) if draw(st.booleans()) else 0.0 for _ in range(3)]
        lines.append(
            f'<link name="l{k + 1}"/><joint name="j{k}" type="{type_}"><parent link="l{k}"/>'
            f'<child link="l{k + 1}"/><origin xyz="{" ".join(map(repr, xyz))}"'
            f' rpy="{" ".join(map(repr, rpy))}"/>'
        )
        if type_ != "fixed":
            lines.append(f'<axis xyz="{draw(st.sampled_from(AXES))}"/>')
        if type_ in ("revolute", "prismatic"):
            lines.append('<limit lower="-1.5" upper="2.5" velocity="3" effort="4"/>')
        lines.append("</joint>")
    return "".join([*lines, "</robot>"])


def assert_same_kinematics(poses, source, chain, found, bound=1e-12):
    """The written URDF of a table against the source, at random q, by Pinocchio."""
    target = robot_from_table(found.table)
    free = [joint.name for joint in chain.joints if joint.mimic is None]
    assert [joint.name for joint in target.joints] == free
    assert [joint.name for joint in target.moving] == [joint.name for joint in chain.joints]
    names = [joint.name for joint in source.joints]
    rng = np.random.default_rng(7)
    for _ in range(4):
        q = np.array([rng.uniform(-1.5, 1.5) for _ in names])
        q_table = q[[names.index(name) for name in free]]
        there = poses(source, q, [chain.base, chain.tip])
        expected = np.linalg.inv(there[chain.base]) @ there[chain.tip]
        got = poses(target, q_table, ["tool"])["tool"]
        assert np.abs(got - expected).max() <= bound
    # Limits, and with them the types, survive.
    for joint, end in zip(chain.joints, target.moving, strict=True):
        assert (joint.limits.lower, joint.limits.upper) == (end.lower, end.upper)
        assert (joint.limits.velocity, joint.limits.effort) == (end.velocity, end.effort)
        assert joint.type is end.type or (joint.type.is_revolute and end.lower is None)


@pytest.mark.parametrize("name", shipped_ids())
def test_every_shipped_robot_in_every_convention(poses, name):
    robot = shipped_robot(name)
    chain = chain_of_robot(robot)
    for convention in Convention:
        found = extract(chain, convention)
        assert found.table.convention is convention
        assert max(found.residual.position, found.residual.orientation) <= 1e-12
        assert_same_kinematics(poses, robot, chain, found)


def test_every_chain_of_robots_with_many(poses):
    chains = 0
    for name in ("icub", "tiago", "allegro_left_hand", "pr2", "romeo"):
        robot = shipped_robot(name)
        for tip in robot.frames[:: max(1, len(robot.frames) // 12)]:
            try:
                chain = chain_of_robot(robot, tip=tip)
            except InvalidURDF:
                continue
            found = extract(chain, Convention.MODIFIED, positive_a=True)
            assert all(row.a >= -1e-13 for row in found.table.rows)
            assert_same_kinematics(poses, robot, chain, found)
            chains += 1
    assert chains > 30


@settings(deadline=None, max_examples=60)
@given(st.data())
def test_random_chains_are_exact(poses, data):
    text = data.draw(urdfs())
    chain = chain_of_urdf(text)
    source = robot_from_urdf(text)
    found = extract(chain, data.draw(st.sampled_from(list(Convention))))
    # Nothing is snapped but the odd tilt below 1e-8 that was drawn on purpose.
    taken_for_zero = sum(finding.snapped for finding in found.findings[:-1])
    bound = 1e-12 + 10 * taken_for_zero * (1 + chain.size)
    assert max(found.residual.position, found.residual.orientation) <= bound
    assert_same_kinematics(poses, source, chain, found, bound)
    assert found.chain.tip == source.tip_frame
    assert table_to_urdf(found.table)


@settings(deadline=None, max_examples=40)
@given(st.data())
def test_what_snapping_costs_is_told(poses, data):
    text = data.draw(urdfs(tilts=(1e-9, 3e-9, 1e-5)))
    chain, source = chain_of_urdf(text), robot_from_urdf(text)
    exact = extract(chain, Convention.MODIFIED, snap=0.0)
    assert max(exact.residual.position, exact.residual.orientation) <= 1e-12
    found = extract(chain, Convention.MODIFIED, snap=1e-4)
    snapped = [finding.snapped for finding in found.findings[:-1] if finding.snapped > 1e-12]
    told = " ".join(found.table.warnings)
    assert told.count("taken as parallel") >= len(snapped)
    cost = sum(finding.snapped for finding in found.findings[:-1]) * 4 * (1 + chain.size)
    assert max(found.residual.position, found.residual.orientation) <= cost + 1e-12
    reported = max(found.residual.position, found.residual.orientation)
    # Limits bound what was measured, and what is measured here: no worse than a few times it.
    assert_same_kinematics(poses, source, chain, found, bound=20 * reported + 1e-12)


def test_a_chain_runs_up_and_down_again(poses):
    robot = shipped_robot("baxter")
    chain = chain_of_robot(robot, base="left_gripper", tip="right_gripper")
    assert len(chain.joints) == 14
    for convention in Convention:
        assert_same_kinematics(poses, robot, chain, extract(chain, convention))


def test_parallel_axes_written_with_six_digits_get_a_fixed_row(poses):
    text = (
        '<robot name="r"><link name="a"/><link name="b"/><link name="c"/>'
        '<joint name="j1" type="continuous"><parent link="a"/><child link="b"/>'
        '<axis xyz="0 0 1"/></joint><joint name="j2" type="continuous"><parent link="b"/>'
        '<child link="c"/><origin xyz="0.5 0.1 0" rpy="3.14159 0 0"/><axis xyz="0 0 1"/></joint>'
        "</robot>"
    )
    chain, source = chain_of_urdf(text), robot_from_urdf(text)
    found = extract(chain, Convention.STANDARD)
    assert [row.type for row in found.table.rows] == [
        JointType.CONTINUOUS,
        JointType.FIXED,
        JointType.CONTINUOUS,
    ]
    assert max(abs(row.d) for row in found.table.rows) < 1.0
    assert any("2.7e-06 rad from parallel" in warning for warning in found.table.warnings)
    assert_same_kinematics(poses, source, chain, found)
    classical = extract(chain, Convention.STANDARD, bridge=False)
    assert len(classical.table.rows) == 2
    assert max(abs(row.d) for row in classical.table.rows) > 1e4
    snapped = extract(chain, Convention.STANDARD, snap=1e-5)
    assert len(snapped.table.rows) == 2
    assert 1e-7 < snapped.residual.orientation < 1e-5


def test_what_cannot_be_extracted_is_refused(arm_urdf):
    with pytest.raises(UnknownFrame) as unknown:
        chain_of_urdf(arm_urdf, tip="flangee")
    assert (unknown.value.argument, unknown.value.index) == ("tip", ())
    with pytest.raises(InvalidURDF, match="no joint moves between"):
        chain_of_urdf(arm_urdf, base="boom", tip="flange")
    with pytest.raises(UnknownFrame):
        chain_of_robot(shipped_robot("ur5"), base="nowhere")
