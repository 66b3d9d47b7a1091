import copy
import math
import re
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf.table import Mimic
from robots.errors import InvalidURDF, RobotError, RobotTooLarge
from robots.robot import robot_from_urdf
from robots.urdf import read_urdf


def chain(joints, type_="revolute"):
    """A chain of so many joints."""
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    return (
        '<robot name="chain"><link name="l0"/>'
        + "".join(
            f'<link name="l{k}"/><joint name="j{k}" type="{type_}">'
            f'<parent link="l{k - 1}"/><child link="l{k}"/>{limit}</joint>'
            for k in range(1, joints + 1)
        )
        + "</robot>"
    )


def joint(name, parent, child):
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="fixed">{ends}</joint></robot>'


def refusal(text):
    with pytest.raises(RobotError) as caught:
        read_urdf(text)
    return str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('<robot name="arm">', "<robot>", ("root element", "no name", "give it one")),
        ('<robot name="arm">', '<robot name=" ">', ("root element", "no name")),
        ('name="arm"', 'name="a&#10;b"', ("control characters",)),
        ('name="arm"', f'name="{"x" * 129}"', ("over 128 characters",)),
        ('<link name="boom"/>', "<link/>", ("<link>", "no name", "give it one")),
        (
            '<link name="boom"/>',
            '<link name="boom"/><link name="boom"/>',
            ("two links are called 'boom'", "its own name"),
        ),
        ('name="reach"', 'name="turn"', ("two joints are called 'turn'", "its own name")),
        ('name="reach" type', "type", ("<joint>", "no name", "give it one")),
        ('name="turn"', 'name="universe"', ("joint 'universe'", "Pinocchio", "give it another")),
        ('<link name="finger"/>', "", ("joint 'grip'", "child link 'finger' does not exist")),
        ('<parent link="flange"/>', "", ("joint 'grip'", "<parent link=…> is missing")),
        ('<child link="finger"/>', "<child/>", ("joint 'grip'", "<child link=…> is missing")),
        (
            '<parent link="flange"/>',
            '<parent link="nil"/>',
            ("joint 'grip'", "parent link 'nil' does not exist"),
        ),
        (
            '<child link="finger"/>',
            '<child link="boom"/>',
            ("link 'boom' is the child of two joints", "'reach'", "'grip'", "a robot is a tree"),
        ),
        (
            '<link name="finger"/>',
            '<link name="finger"/><link name="stray"/>',
            ("2 root links", "'world', 'stray'", "join them by a joint"),
        ),
        (
            "</robot>",
            joint("back", "finger", "world"),
            ("the joints form a loop", "'back', 'grip', 'mount', 'reach', …", "a robot is a tree"),
        ),
        (
            "</robot>",
            '<link name="x"/><link name="y"/>'
            + joint("a", "x", "y").removesuffix("</robot>")
            + joint("b", "y", "x"),
            ("link 'x' is not connected to the root 'world'", "loop ('b', 'a')"),
        ),
        (
            "</robot>",
            '<link name="x"/>' + joint("self", "x", "x"),
            ("joint 'self' joins link 'x' to itself", "a robot is a tree"),
        ),
        (
            '<axis xyz="1 1 0"/>',
            '<axis xyz="0 0 0"/>',
            ("joint 'grip'", "axis is zero", "give a direction such as 0 0 1"),
        ),
        (
            '<axis xyz="1 1 0"/>',
            '<axis xyz="1 1"/>',
            ("joint 'grip'", "xyz of <axis> is '1 1'", "give 3 numbers"),
        ),
        ('<axis xyz="1 1 0"/>', '<axis xyz="1,1,0"/>', ("joint 'grip'", "give 3 numbers")),
        (
            '<axis xyz="1 1 0"/>',
            '<axis xyz="1 nan 0"/>',
            ("joint 'grip'", "'nan'", "give a finite number"),
        ),
        (
            '<limit lower="-1.5" upper="1.5" effort="10" velocity="2"/>',
            "",
            ("joint 'grip'", "needs <limit lower upper effort velocity>", "continuous"),
        ),
        (
            '<limit lower="0" upper="0.5" effort="100" velocity="1"/>',
            "",
            ("joint 'reach'", "a prismatic joint needs <limit", "add it"),
        ),
        (' effort="10"', "", ("joint 'grip'", "<limit> lacks effort", "add it")),
        (' velocity="2"', "", ("joint 'grip'", "<limit> lacks velocity", "add it")),
        (' lower="-1.5"', "", ("joint 'grip'", "lacks lower", "freeze", "give lower and upper")),
        (' upper="1.5"', "", ("joint 'grip'", "lacks upper", "give lower and upper")),
        (
            'lower="-1.5"',
            'lower="1.6"',
            ("joint 'grip'", "lower limit 1.6 is above upper 1.5", "swap them"),
        ),
        (
            'lower="-1.5"',
            'lower="-1,5"',
            ("joint 'grip'", "lower of <limit>", "'-1,5'", "write a decimal point"),
        ),
        ('lower="-1.5"', 'lower="-inf"', ("joint 'grip'", "'-inf'", "give a finite number")),
        ('lower="-1.5"', 'lower=""', ("joint 'grip'", "lower of <limit> is ''", "give 1 number")),
        ('effort="10"', 'effort="-1"', ("joint 'grip'", "limit effort -1 is negative")),
        ('velocity="2"', 'velocity="NaN"', ("joint 'grip'", "'NaN'", "give a finite number")),
        ('xyz="0 0.2 0"', 'xyz="0 nan 0"', ("joint 'reach'", "xyz of <origin>", "'nan'", "finite")),
        ('xyz="0 0.2 0"', 'xyz="0 inf 0"', ("joint 'reach'", "'inf'", "give a finite number")),
        ('xyz="0 0.2 0"', 'xyz="0 0x10 0"', ("joint 'reach'", "'0x10'", "give a finite number")),
        ('xyz="0 0.2 0"', 'xyz="0 0,2 0"', ("joint 'reach'", "'0,2'", "write a decimal point")),
        ('xyz="0 0.2 0"', 'xyz="0 1e308 0"', ("joint 'reach'", "beyond ±1e+06", "check the unit")),
        ('xyz="0 0.2 0"', 'xyz="0 1e999 0"', ("joint 'reach'", "beyond ±1e+06", "check the unit")),
        ('xyz="0 0.2 0"', 'xyz="0 1_0 0"', ("joint 'reach'", "'1_0'", "give a finite number")),
        ('xyz="0 0.2 0"', 'xyz="${x} 0 0"', ("joint 'reach'", "'${x}'", "give a finite number")),
        ('rpy="0.1 0.2 0.3"', 'rpy="0.1 0.2"', ("joint 'turn'", "rpy of <origin>", "give 3")),
        (
            'type="revolute"',
            'type="floating"',
            ("joint 'grip'", "type floating is not supported", "revolute and prismatic", "fixed"),
        ),
        ('type="revolute"', 'type="hinge"', ("joint 'grip'", "'hinge'", "give revolute")),
        (' type="revolute"', "", ("joint 'grip'", "its type is missing", "give revolute")),
        ("<robot ", "<model ", ("not well-formed", "mismatch")),
    ],
)
def test_a_refusal_names_the_element_the_value_and_a_remedy(arm_urdf, old, new, words):
    assert old in arm_urdf
    message = refusal(arm_urdf.replace(old, new, 1))
    assert [word for word in words if word not in message] == []
    assert len(message) < 300


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "not well-formed"),
        ("hello", "not well-formed"),
        ("<robot", "not well-formed"),
        ("<robot name='a'/><robot name='b'/>", "not well-formed"),
        ("<robot name='a'>\x00</robot>", "not well-formed"),
        (b"\x00" * 10, "not well-formed"),
        (b"<robot name='\xff'/>", "not well-formed"),
        ("<robot name='a'>&undefined;</robot>", "not well-formed"),
        ("<robot name='a'>" + "<x>" * 1000 + "</x>" * 1000 + "</robot>", "not well-formed"),
        ("<sdf version='1.9'/>", "the root element is <sdf>; a URDF starts with <robot name=…>"),
        ("<robot name='a'/>", "has no <link>"),
        ("<robot name='a'><link name='l'/></robot>", "no joint that moves"),
        (chain(2, "fixed"), "no joint that moves"),
    ],
)
def test_a_text_that_is_no_robot_is_refused(text, words):
    assert words in refusal(text)


ENTITIES = """<!DOCTYPE robot [<!ENTITY a "a"><!ENTITY b "&a;&a;">]>
<robot name="&b;"><link name="&b;"/></robot>"""
EXTERNAL = '<!DOCTYPE robot [<!ENTITY x SYSTEM "name.txt">]><robot name="a">&x;</robot>'
PLAIN = '<!DOCTYPE robot><robot name="a"/>'


@pytest.mark.parametrize(
    "doctype", [ENTITIES, EXTERNAL, PLAIN], ids=["entities", "external", "plain"]
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "utf-32", "utf-7"])
def test_doctypes_and_entities_are_refused_in_every_encoding(doctype, encoding):
    declaration = f'<?xml version="1.0" encoding="{encoding}"?>'
    for text in (doctype, declaration + doctype):
        message = refusal(text.encode(encoding))
        assert any(
            w in message
            for w in ("DOCTYPE", "not well-formed", "save it as UTF-8", "save the URDF")
        )


def test_sixty_four_joints_of_a_chain_are_read_and_no_more():
    assert len(read_urdf(chain(64)).moving) == 64
    with pytest.raises(RobotTooLarge, match="'l0' to 'l65' has 65 joints; at most 64"):
        read_urdf(chain(65))
    # From the middle, no chain has more than 64.
    assert len(read_urdf(chain(65), base="l30").moving) == 65


def test_two_hundred_joints_of_a_robot_are_read_and_no_more():
    def fingers(count):
        limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
        ends = '<parent link="palm"/><child link="l{k}"/>'
        return (
            '<robot name="hand"><link name="palm"/>'
            + "".join(
                f'<link name="l{k}"/><joint name="j{k}" type="revolute">{ends.format(k=k)}{limit}'
                "</joint>"
                for k in range(count)
            )
            + "</robot>"
        )

    assert len(read_urdf(fingers(200)).moving) == 200
    with pytest.raises(RobotTooLarge, match="201 joints; at most 200"):
        read_urdf(fingers(201))


def test_three_hundred_links_are_read_and_no_more():
    moving = chain(1).removesuffix("</robot>")
    fixed = "".join(
        f'<link name="f{k}"/>' + joint(f"f{k}", "l1", f"f{k}").removesuffix("</robot>")
        for k in range(298)
    )
    assert len(read_urdf(f"{moving}{fixed}</robot>").links) == 300
    with pytest.raises(RobotTooLarge, match="301 links; at most 300"):
        read_urdf(f'{moving}{fixed}<link name="z"/>{joint("z", "l1", "z")}')


def test_two_megabytes_are_read_and_no_more(arm_urdf):
    comment = f"<!--{'x' * (2_000_000 - len(arm_urdf) - 7)}-->"
    assert read_urdf(arm_urdf + comment).name == "arm"
    with pytest.raises(RobotTooLarge, match="2000001 bytes; at most 2000000"):
        read_urdf(arm_urdf + comment + " ")


def test_a_thousand_shapes_are_kept_and_no_more(arm_urdf):
    shape = '<visual><geometry><sphere radius="1"/></geometry></visual>'
    with_shapes = arm_urdf.replace('"boom"/>', f'"boom">{shape * 998}</link>', 1)
    assert read_urdf(with_shapes).canonical.count("<visual>") == 999
    more = read_urdf(with_shapes.replace(shape, shape * 2, 1))
    assert more.canonical.count("<visual>") + more.canonical.count("<collision>") == 1000
    assert more.warnings == ("shapes beyond 1000 are left out",)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1"])
def test_every_declared_encoding_is_read(arm_urdf, encoding):
    text = arm_urdf.replace('<?xml version="1.0"?>', f'<?xml version="1.0" encoding="{encoding}"?>')
    text = text.replace("utf-8-sig", "utf-8").replace('"arm"', '"bras élévateur"')
    assert read_urdf(text.encode(encoding)).name == "bras élévateur"
    assert read_urdf(text).name == "bras élévateur"


def test_an_axis_is_normalised(arm_urdf):
    canonical = read_urdf(arm_urdf).canonical
    axes = {
        element.get("name"): [float(word) for word in element.find("axis").get("xyz").split()]
        for element in ET.fromstring(canonical).iter("joint")
        if element.get("type") != "fixed"
    }
    assert axes["reach"] == [0, 0, 1]
    assert axes["turn"] == [0, 0, -1]
    assert axes["grip"] == pytest.approx([math.sqrt(0.5), math.sqrt(0.5), 0], rel=1e-15)


def test_a_missing_axis_is_x_as_urdf_says(arm_urdf):
    canonical = read_urdf(arm_urdf.replace('<axis xyz="1 1 0"/>', "")).canonical
    assert ET.fromstring(canonical).find("joint[@name='grip']/axis").get("xyz") == "1.0 0.0 0.0"


def test_limits_are_those_of_the_file(arm_urdf):
    turn, reach, mount, grip = read_urdf(arm_urdf).joints
    assert (turn.lower, turn.upper, turn.velocity, turn.effort) == (None, None, None, None)
    assert (reach.lower, reach.upper, reach.velocity, reach.effort) == (0, 0.5, 1, 100)
    assert (mount.type, mount.lower) == ("fixed", None)
    assert (grip.lower, grip.upper, grip.velocity, grip.effort) == (-1.5, 1.5, 2, 10)


def test_a_mimicking_joint_is_a_follower_of_the_canonical_text_too(arm_urdf):
    mimic = '<mimic joint="turn" multiplier="2" offset="-0.5"/></joint>\n</robot>'
    description = read_urdf(re.sub(r"</joint>\s*</robot>", mimic, arm_urdf))
    assert len(description.moving) == 3
    assert description.moving[-1].mimic == Mimic("turn", 2.0, -0.5)
    assert description.warnings == ()
    assert read_urdf(description.canonical) == description


def test_the_relation_of_a_mimic_is_kept_with_all_digits(arm_urdf):
    mimic = '<mimic joint="reach" multiplier="-0.7320508075688772"/></joint>\n</robot>'
    description = read_urdf(re.sub(r"</joint>\s*</robot>", mimic, arm_urdf))
    assert 'multiplier="-0.7320508075688772"' in description.canonical


def test_a_fraction_of_a_continuous_joint_is_no_follower(arm_urdf):
    mimic = '<mimic joint="turn" multiplier="0.5"/></joint>\n</robot>'
    with pytest.raises(InvalidURDF, match=r"'grip'.*0\.5 times.*'turn'.*continuous"):
        read_urdf(re.sub(r"</joint>\s*</robot>", mimic, arm_urdf))


def test_the_canonical_text_is_its_own_canonical_text(arm_urdf):
    canonical = read_urdf(arm_urdf).canonical
    assert read_urdf(canonical).canonical == canonical


def test_what_is_not_geometry_is_left_out(arm_urdf):
    extra = '<!-- note --><gazebo><plugin filename="evil.so"/></gazebo><transmission/><?pi x?>'
    text = arm_urdf.replace("</robot>", f"{extra}</robot>")
    description = read_urdf(text)
    assert description.canonical == read_urdf(arm_urdf).canonical
    assert description.warnings == (
        "left out, since kinematics does not use it: <gazebo>, <transmission>",
    )


def test_pinocchio_loads_the_canonical_text(arm_urdf, urdf_frames, poses):
    robot = robot_from_urdf(arm_urdf)
    q = [0.3, 0.4, -0.5]
    expected = urdf_frames(arm_urdf, dict(zip(("turn", "reach", "grip"), q, strict=True)))
    found = poses(robot, q)
    assert list(found) == ["world", "turret", "boom", "flange", "finger"]
    assert max(np.abs(found[name] - T).max() for name, T in expected.items()) < 1e-15
    assert pin.computeTotalMass(pin.buildModelFromXML(robot.urdf)) == 2.5


INTERESTING = st.sampled_from(
    [
        *(
            "",
            "0",
            "0 0 0",
            "1 2 3",
            "0,5",
            "-1",
            "nan",
            "inf",
            "1e308",
            "1e-320 0 0",
            "1e6 1e6 1e6",
        ),
        *(
            "world",
            "boom",
            "finger",
            "turn",
            "grip",
            "universe",
            " x ",
            "é",
            "\x01",
            "\x7f",
            "a\nb",
            "&<>\"'",
        ),
        *("fixed", "revolute", "prismatic", "continuous", "floating", "0.1 -0.2 1e-7", "1e-6 0 0"),
    ]
)
VALUES = INTERESTING | st.text(max_size=20) | st.floats().map(repr)


@st.composite
def mutants(draw, text):
    robot = ET.fromstring(text)
    for _ in range(draw(st.integers(1, 3))):
        parents = [element for element in robot.iter() if len(element)]
        kind = draw(st.sampled_from(["attribute", "attribute", "tag", "remove", "repeat", "move"]))
        parent = draw(st.sampled_from(parents))
        child = draw(st.sampled_from(list(parent)))
        if kind == "attribute":
            element = draw(st.sampled_from(list(robot.iter())))
            known = [*element.keys(), draw(st.sampled_from(["name", "type", "link", "xyz", "rpy"]))]
            element.set(draw(st.sampled_from(known)), draw(VALUES))
        elif kind == "tag":
            child.tag = draw(st.sampled_from(["link", "joint", "origin", "limit", "axis", "box"]))
        elif kind == "remove" and len(parents) > 1:
            parent.remove(child)
        elif kind == "repeat":
            parent.append(child)
        else:
            draw(st.sampled_from(parents)).append(copy.deepcopy(child))
    return ET.tostring(robot, encoding="utf-8")


@settings(max_examples=300, deadline=None)
@given(st.data(), st.integers(0, 2**32 - 1))
def test_a_damaged_urdf_is_refused_or_computed_right(arm_urdf, urdf_frames, poses, data, seed):
    text = data.draw(mutants(arm_urdf))
    try:
        robot = robot_from_urdf(text)
    except RobotError as error:
        message = str(error)
    else:
        q = np.random.default_rng(seed).uniform(-3, 3, robot.dof)
        names = [joint.name for joint in robot.joints]
        expected = urdf_frames(robot.urdf, dict(zip(names, q, strict=True)))
        found = poses(robot, q)
        assert set(found) == set(expected)
        for name, T in expected.items():
            assert np.isfinite(found[name]).all()
            assert np.abs(found[name] - T).max() < 1e-12 * (1 + np.abs(T).max())
        again = robot_from_urdf(robot.urdf, base=robot.base_frame, tip=robot.tip_frame)
        assert again.revision == robot.revision
        return
    assert 0 < len(message) < 400


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=50) | st.text(max_size=50), st.integers(0, 1500), st.integers(0, 1500))
def test_a_urdf_with_a_hole_is_refused_or_read(arm_urdf, scrap, start, length):
    text = arm_urdf.encode() if isinstance(scrap, bytes) else arm_urdf
    try:
        description = read_urdf(text[:start] + scrap + text[start + length :])
    except RobotError:
        return
    assert description.moving


def test_the_error_of_a_urdf_points_at_no_field(arm_urdf):
    with pytest.raises(InvalidURDF) as caught:
        read_urdf(arm_urdf.replace('"turn"', '"reach"'))
    assert caught.value.location == ()
