"""What of a URDF is read and probably meant otherwise, and what is left out."""

import pytest

from robots.robot import robot_from_urdf
from robots.shipped import shipped_ids, shipped_robot

URDF = """<robot name="r"><link name="base"/><link name="arm"/><link name="tip"/>
<joint name="j1" type="{type}"><parent link="base"/><child link="arm"/>
<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="0 0 1"/>{limit}</joint>
<joint name="{name}" type="revolute"><parent link="arm"/><child link="tip"/><axis xyz="0 1 0"/>
<origin xyz="0.4 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
LIMIT = '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'


def read(type_="revolute", xyz="0 0 0.3", rpy="0 0 0", limits=(-2, 2), name="j2"):
    limit = LIMIT.format(*limits) if limits else ""
    text = URDF.format(type=type_, xyz=xyz, rpy=rpy, limit=limit, name=name)
    return robot_from_urdf(text)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"rpy": "90 0 0"}, "roll of joint 'j1' is 90 rad, which is 14 turns; degrees?"),
        ({"limits": (-180, 180)}, "lower limit of joint 'j1' is -180 rad"),
        ({"xyz": "0 0 300"}, "z of joint 'j1' is 300 m; millimetres?"),
        ({"type_": "prismatic", "limits": (0, 300)}, "upper limit of joint 'j1' is 300 m"),
    ],
)
def test_values_in_another_unit_are_doubted(given, told):
    robot = read(**given)
    assert told in robot.doubts[0]
    assert robot.warnings[: len(robot.doubts)] == robot.doubts


def test_limits_of_a_continuous_joint_are_told_where_they_say_something():
    (told,) = read("continuous", limits=(-1, 1)).warnings
    assert "'j1' (-1 to 1)" in told
    assert "make them revolute" in told
    for limits in (None, (0, 0)):
        assert read("continuous", limits=limits).warnings == ()


def test_names_that_look_alike_are_told():
    (told,) = read(name="J1").warnings
    assert "joints 'j1' and 'J1' look alike" in told


@pytest.mark.parametrize("robot_id", shipped_ids())
def test_no_shipped_robot_has_a_warning(robot_id):
    robot = shipped_robot(robot_id)
    assert robot.doubts == ()
    assert [one for one in robot.warnings if "mimics" not in one] == []
