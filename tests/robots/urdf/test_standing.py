"""Joints that are no single motion: a floating or planar root, planar joints, parts cut off."""

import math

import numpy as np
import pinocchio as pin
import pytest

from kinematics.forward import fk
from robots.chains import chain_of_urdf
from robots.errors import InvalidURDF, UnknownFrame
from robots.robot import robot_from_urdf

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def link(*names):
    return "".join(f'<link name="{name}"/>' for name in names)


def joint(name, type_, parent, child, inside=""):
    return (
        f'<joint name="{name}" type="{type_}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/>{inside}</joint>'
    )


def robot(*parts):
    return f'<robot name="r">{"".join(parts)}</robot>'


ARM = (link("b", "c", "d"), joint("j", "revolute", "b", "c", LIMIT), joint("k", "fixed", "c", "d"))


@pytest.mark.parametrize("type_", ["floating", "planar"])
def test_a_robot_whose_root_floats_stands_on_what_floats(type_):
    text = robot(link("world", "ground"), joint("g", "fixed", "world", "ground"), *ARM)
    found = robot_from_urdf(text.replace("</robot>", joint("f", type_, "world", "b") + "</robot>"))
    assert (found.base_frame, found.frames, found.dof) == ("b", ("b", "c", "d"), 1)
    (warning,) = found.warnings
    assert f"joint 'f' is {type_}" in warning
    assert "link 'b' is taken as the base, and link 'world' is left out, and 1 more" in warning
    expected = robot_from_urdf(robot(*ARM))
    np.testing.assert_array_equal(fk(found, [0.3], ["d"])["d"], fk(expected, [0.3], ["d"])["d"])
    assert robot_from_urdf(found.urdf).urdf == found.urdf


def test_base_cuts_off_what_floats_below():
    text = robot(*ARM, link("ball"), joint("f", "floating", "d", "ball"))
    with pytest.raises(InvalidURDF, match=r"'f': type floating is not supported.*\?base=LINK"):
        robot_from_urdf(text)
    found = robot_from_urdf(text, base="c")
    assert found.frames == ("b", "c", "d")
    assert found.base_frame == "c"
    assert found.warnings == (
        "joint 'f' is floating: link 'ball' and what it carries are left out, as base says",
    )
    with pytest.raises(UnknownFrame):
        robot_from_urdf(text, base="c", tip="ball")
    assert len(chain_of_urdf(text, "b", "d").joints) == 1


def test_of_two_robots_that_float_base_chooses():
    other = (link("e", "g"), joint("i", "revolute", "e", "g", LIMIT))
    free = (joint("f1", "floating", "world", "b"), joint("f2", "floating", "world", "e"))
    text = robot(link("world"), *ARM, *other, *free)
    with pytest.raises(InvalidURDF) as caught:
        robot_from_urdf(text)
    assert [fault.xpath for fault in caught.value.faults] == [
        "/robot/joint[@name='f1']",
        "/robot/joint[@name='f2']",
    ]
    assert robot_from_urdf(text, base="e").frames == ("e", "g")
    assert robot_from_urdf(text, base="c").frames == ("b", "c", "d")


def planar(axis):
    return joint("p", "planar", "d", "e", f'<axis xyz="{axis}"/>')


def test_a_planar_joint_is_two_slides_and_a_turn_as_in_pinocchio():
    text = robot(*ARM, link("e", "t"), planar("0 0 1"), joint("m", "revolute", "e", "t", LIMIT))
    found = robot_from_urdf(text)
    assert [one.name for one in found.joints] == ["j", "p_x", "p_y", "p_turn", "m"]
    assert [one.lower for one in found.joints] == [-1, None, None, None, -1]
    assert "joint 'p' is planar: it is read as the slides 'p_x' and 'p_y', and" in found.warnings[0]
    model = pin.buildModelFromXML(text)
    q = np.array([0.3, 0.7, -0.4, 2.0, 0.2])
    values = {"j": [q[0]], "p": [q[1], q[2], math.cos(q[3]), math.sin(q[3])], "m": [q[4]]}
    configuration = pin.neutral(model)
    for name, value in values.items():
        at = model.joints[model.getJointId(name)].idx_q
        configuration[at : at + len(value)] = value
    data = model.createData()
    pin.framesForwardKinematics(model, data, configuration)
    for name in ("b", "c", "d", "e", "t"):
        expected = data.oMf[model.getFrameId(name, pin.FrameType.BODY)].homogeneous
        np.testing.assert_allclose(fk(found, q, [name])[name], expected, rtol=0, atol=1e-14)
    assert robot_from_urdf(found.urdf).urdf == found.urdf


@pytest.mark.parametrize(
    ("axis", "names"),
    [
        ("1 0 0", ("p_y", "p_z")),
        ("0 1 0", ("p_z", "p_x")),
        ("0 0 -2", ("p_x", "p_y")),
        ("1 2 -3", ("p_u", "p_v")),
        ("0 1e-3 -1", ("p_u", "p_v")),
    ],
)
def test_the_slides_lie_in_the_plane_and_turn_with_its_normal(axis, names):
    found = robot_from_urdf(robot(*ARM, link("e"), planar(axis)))
    assert tuple(one.name for one in found.joints[1:3]) == names
    n = np.array([float(word) for word in axis.split()])
    n /= np.linalg.norm(n)
    zero = fk(found, np.zeros(4), ["e"])["e"]
    u, v = ((np.linalg.inv(zero) @ fk(found, row, ["e"])["e"])[:3, 3] for row in np.eye(4)[1:3])
    np.testing.assert_allclose([u @ u, v @ v, u @ v, u @ n, v @ n], [1, 1, 0, 0, 0], atol=1e-14)
    np.testing.assert_allclose(np.cross(u, v), n, atol=1e-14)
    turned = np.linalg.inv(zero) @ fk(found, np.array([0, 0, 0, 0.5]), ["e"])["e"]
    np.testing.assert_allclose(turned[:3, :3] @ n, n, atol=1e-14)
    np.testing.assert_allclose(np.trace(turned[:3, :3]), 1 + 2 * math.cos(0.5), atol=1e-14)


def test_names_that_are_taken_get_others():
    text = robot(*ARM, link("e", "p_x"), planar("0 0 1"), joint("p_y", "fixed", "e", "p_x"))
    names = [one.name for one in robot_from_urdf(text).joints]
    assert names == ["j", "p_x_", "p_y_", "p_turn"]


def test_a_planar_root_is_kept_where_its_side_is_the_base():
    text = robot(link("world"), *ARM, joint("p", "planar", "world", "b", '<axis xyz="0 0 1"/>'))
    assert robot_from_urdf(text).dof == 1
    assert robot_from_urdf(text, base="c").dof == 1
    driven = robot_from_urdf(text, base="world")
    assert [one.name for one in driven.joints] == ["j", "p_x", "p_y", "p_turn"]


def test_a_robot_that_only_floats_has_no_joint_that_moves():
    text = robot(link("world", "b"), joint("f", "floating", "world", "b"))
    with pytest.raises(InvalidURDF, match="floating is not supported"):
        robot_from_urdf(text)
    with pytest.raises(InvalidURDF, match="no joint that moves"):
        robot_from_urdf(text, base="b")
