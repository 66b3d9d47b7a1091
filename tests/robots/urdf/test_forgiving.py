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
            "ixy of <inertia> is missing",
        ),
        ('<axis xyz="0 0 1"/>', '<axis rpy="0 0 0" xyz="0 0 1"/>', "'rpy' of <axis> is left out"),
        (PLAIN, f"{PLAIN}-", "the stray text '-'"),
        (PLAIN, BOX.format("").replace("size", "siz"), "size of <box> is missing"),
        (PLAIN, BOX.format("").replace("<box", "<bo"), "<bo> in <geometry> is no part of URDF"),
        (PLAIN, BOX.format('<material name="m"><color rgba="1 0"/></material>'), "rgba of <color>"),
        (PLAIN, BOX.format("") + '<material name="m"><color rgba="1"/></material>', "rgba of <col"),
        (PLAIN, BOX.format("").replace("/></g", "/><sphere/></g"), "has 2 <geometry>"),
        (PLAIN, '<link name="b"><visual/></link>', "a <visual> is left out: it has no geometry"),
        (PLAIN, '<link name="b"><origin xyz="0 0 1"/></link>', "an <origin> in <link>"),
        (PLAIN, f'{PLAIN}<inertial><mass value="1"/></inertial>', "does not use it: <inertial>"),
        (PLAIN, f"{PLAIN}<RefLink/>", "does not use it: <RefLink>"),
        (PLAIN, f'{PLAIN}<group><link name="b"/><joint name="j"/></group>', "use it: <group>"),
        (PLAIN, f'{PLAIN}<x:link xmlns:x="y" name="b"/>', "use it: <link>"),
        (PLAIN, f"{PLAIN}limit lower=1", "the stray text 'limit lower=1'"),
        (PLAIN, f"{PLAIN}<!-- a -- b -->", "comments that XML does not allow"),
        (PLAIN, f"{PLAIN}<!--- a --->", "comments that XML does not allow"),
        (PLAIN, f"{PLAIN}<!- a ->", "comments that XML does not allow"),
        ("<axis", "# about the vertical <axis", "the stray text '# about the vertical'"),
        ("<axis", '<axis xyz="0 0  1"/><axis', "joint 'j': has 2 equal <axis>"),
        ("<axis", "<dynamics><joint/></dynamics><axis", "use it: <dynamics>"),
        ("<limit", '<limit soft="1"', "'soft' of <limit> is left out"),
        ('velocity="1"', 'velocity="1" jerk="-9"', "jerk of <limit> is no number above 0"),
        ('xyz="0 0 1" rpy', 'xyz="0 0 1" scale="2" rpy', "'scale' of <origin> is left out"),
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


@pytest.mark.parametrize(
    "declaration",
    [
        '<?xml version="0.0" ?>',
        '<?xml version="1.1"?>',
        "<?xml version='1'?>",
        '<?xml encoding="utf-8"?>',
        '<?xml encoding="utf-8" version="1.0" standalone="no" ?>',
        "<?xml?>",
        '\n <?xml version="1.0"?>',
    ],
)
def test_declarations_of_any_version_are_read(declaration):
    assert read_urdf(ARM.replace('<?xml version="1.0"?>', declaration, 1)).warnings == ()


def test_a_declaration_behind_a_comment_is_passed_over():
    (warning,) = read_urdf(f"<!-- (c) maker -->{ARM}").warnings
    assert "an XML declaration after the start" in warning


def test_limits_of_acceleration_and_jerk_are_kept():
    found = read_urdf(ARM.replace('velocity="1"', 'velocity="1" acceleration="3" jerk="9"'))
    assert (found.joints[0].acceleration, found.joints[0].jerk) == (3.0, 9.0)
    assert found.warnings == ()
    assert read_urdf(found.canonical).joints == found.joints


def test_what_a_fixed_joint_cannot_have_is_told_and_never_refused():
    text = ARM.replace(
        "</robot>",
        '<link name="t"/><joint name="f" type="fixed"><parent link="c"/><child link="t"/>'
        '<axis xzy="0 0 nan"/><axis/><limit lower="x"/><mimic/></joint></robot>',
    )
    assert read_urdf(text).warnings == tuple(
        f"joint 'f': <{tag}> of a fixed joint is left out" for tag in ("axis", "limit", "mimic")
    )


def test_text_of_extensions_is_their_own():
    text = ARM.replace(PLAIN, '<link name="b"><gazebo><mu>0.5</mu></gazebo></link>')
    assert read_urdf(text).warnings == ("left out, since kinematics does not use it: <gazebo>",)


def test_names_in_any_script_are_kept():
    found = read_urdf(ARM.replace('"b"', '"\u57fa\u90e8 \u00e9"'))
    assert found.root == "\u57fa\u90e8 \u00e9"
    assert read_urdf(found.canonical) == found


def test_many_kinds_of_what_is_left_out_are_counted():
    odd = "".join(f'<visual><geometry><box size="{k}"/></geometry></visual>' for k in range(40))
    warnings = read_urdf(ARM.replace(PLAIN, f'<link name="b">{odd}</link>')).warnings
    assert len(warnings) == 21
    assert warnings[-1].startswith("20 more such parts are left out")
    many = "".join(f"<kind{k}/>" for k in range(40))
    assert "<kind7>, …" in read_urdf(ARM.replace(PLAIN, f"{PLAIN}{many}")).warnings[0]


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
        ("<limit", 'origin xyz="1 0 0"/&gt;<limit', "holds the text"),
        ('<axis xyz="0 0 1"/>', "<axis>0 0 1</axis>", "holds the text '0 0 1' in <axis>"),
        ('<axis xyz="0 0 1"/>', '<Axis xyz="0 0 1"/>', "did you mean <axis>"),
        (PLAIN, f'{PLAIN}<axis xyz="0 0 1"/>', "<axis> cannot stand in <robot>"),
        ("<axis", '<axis xyz="1 0 0"/><axis', "has two <axis>"),
        (PLAIN, f"{PLAIN}<xacro:macro/>", "xacro"),
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
