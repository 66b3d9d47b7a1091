"""Faults that kinematics does not depend on: the robot is read, and it is said what was odd."""

import math

import pytest

from robots.errors import InvalidURDF
from robots.urdf.reading import read_urdf

ARM = """<?xml version="1.0"?>
<robot name="r"><link name="b"/><link name="c"/><joint name="j" type="revolute"><parent link="b"/>
<child link="c"/><origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
BOX = '<link name="b"><visual><geometry><box size="1 1 1"/></geometry>{}</visual></link>'
PLAIN = '<link name="b"/>'
RED, BLUE = (f'<material name="m{k}"><color rgba="1 0 0 1"/></material>' for k in (1, 2))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (PLAIN, BOX.format(RED + BLUE), "link 'b': a <visual> has 2 materials"),
        (PLAIN, BOX.replace("box size", "plane normal").format(""), "'b': <plane> in <geometry>"),
        (PLAIN, BOX.format("").replace("<box", "<cdf/><box"), "<cdf> in <geometry>"),
        (PLAIN, BOX.format("").replace("/></geo", "/><declare_convex/></geo"), "<declare_convex>"),
        (
            PLAIN,
            BOX.format("").replace('box size="1 1 1"', 'mesh filename="a.stl" scale="0.001"'),
            "one scale, which is taken for x, y, z",
        ),
        (PLAIN, '<link name="b"><inertial><mass value="1"/></inertial></link>', "is incomplete"),
        (
            PLAIN,
            '<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/>'
            "</inertial></link>",
            "is incomplete",
        ),
        ('<axis xyz="0 0 1"/>', '<axis rpy="0 0 0" xyz="0 0 1"/>', "'rpy' of <axis> is left out"),
        (PLAIN, f"{PLAIN}-", "the stray text '-'"),
        ('velocity="1"', 'velocity="1" acceleration="3" jerk="9"', "acceleration and jerk"),
        (
            'velocity="1"',
            'velocity="1" drake:acceleration="3"',
            "the prefix drake: is not declared",
        ),
        (PLAIN, f"{PLAIN}<sensor:camera/>", "the prefix sensor: is not declared"),
        (
            PLAIN,
            f'{PLAIN}<link name="w"/><joint name="f" type="floating"><parent link="w"/>'
            '<child link="b"/></joint>',
            "link 'b' is taken as the base",
        ),
    ],
)
def test_a_fault_of_no_account_is_told_and_the_robot_read(old, new, words):
    found = read_urdf(ARM.replace(old, new, 1))
    assert [(joint.name, joint.origin.xyz) for joint in found.joints] == [("j", (0.0, 0.0, 1.0))]
    assert found.root == "b"
    assert any(words in warning for warning in found.warnings), found.warnings
    assert read_urdf(found.canonical).joints == found.joints


def test_a_declaration_of_version_0_is_read():
    assert read_urdf(ARM.replace('"1.0"?', '"0.0" ?', 1)).warnings == ()


def test_a_quaternion_turns_the_joint_where_the_version_has_it():
    turned = ARM.replace('rpy="0 0 0"', f'quat_xyzw="0 0 {math.sqrt(0.5)} {math.sqrt(0.5)}"')
    later = turned.replace('name="r"', 'name="r" version="1.2"')
    joint = read_urdf(later).joints[0]
    assert joint.origin.rpy == pytest.approx((0, 0, math.pi / 2), abs=1e-15)
    for text, words in (
        (turned, "quat_xyzw"),
        (later.replace("quat_xyzw", 'rpy="0 0 0" quat_xyzw'), "rpy and quat_xyzw; keep one"),
        (later.replace(f"{math.sqrt(0.5)}", "1"), "no unit quaternion"),
    ):
        with pytest.raises(InvalidURDF, match=words):
            read_urdf(text)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (PLAIN, f"{PLAIN}limit lower=1", "holds the text"),
        (PLAIN, f"{PLAIN}<xacro:macro/>", "xacro"),
        (PLAIN, BOX.replace("box size", "bo size").format(""), "is unknown"),
        ('type="revolute"', 'type="floating"', "floating is not supported"),
        (
            PLAIN,
            f'{PLAIN}<link name="w"/><joint name="f" type="floating"><parent link="c"/>'
            '<child link="w"/></joint>',
            "floating is not supported",
        ),
    ],
)
def test_what_may_be_another_robot_is_refused_still(old, new, words):
    with pytest.raises(InvalidURDF, match=words):
        read_urdf(ARM.replace(old, new, 1))
