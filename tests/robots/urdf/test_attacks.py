"""Texts that other readers take for a robot, or that take other readers down."""

import re
import unicodedata
from xml.etree import ElementTree as ET

import pytest

from robots.errors import InvalidURDF, RobotError
from robots.robot import robot_from_urdf
from robots.urdf import read_urdf


def refusal(document):
    with pytest.raises(RobotError) as caught:
        robot_from_urdf(document)
    message = str(caught.value)
    assert 0 < len(message) < 300
    assert not any(unicodedata.category(c) in ("Cc", "Cf", "Zl", "Zp", "Cs") for c in message)
    assert "lxml" not in message
    assert "<string>" not in message
    return message


def with_declaration(text, declaration):
    return text.replace('<?xml version="1.0"?>', declaration)


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ("", "there is no element"),
        ("   ", "there is no element"),
        ("<robot", "line 1, column 7: a tag lacks its >"),
        ("<robot name='a'>", "line 1, column 17: a tag is not closed; the text ends too soon"),
        ("<robot name='a'>\n<link>\n</robot>", "line 3, column 9: mismatched tag"),
        ("<robot name='a'/><robot name='b'/>", "something stands after the root element"),
        ("<robot name='a'/>rest", "something stands after the root element"),
        ("<robot name='a' name='b'/>", "an attribute stands twice in one tag"),
        ("<robot name=a/>", "the value of an attribute has no quotes"),
        ("<robot name='a<b'/>", "write &lt;"),
        ("<robot name='a&b'/>", "write &amp;"),
        ("<robot name='&b;'/>", "write & as &amp;"),
        ("<robot name='&#0;'/>", "a character that XML does not have"),
        ("<robot name='&#xD800;'/>", "a character that XML does not have"),
        ("<robot><![CDATA[</robot>", "CDATA section is not closed"),
        ("<robot name='a'>\n\x00</robot>", "line 2 holds the character U+0000"),
        ("<robot name='a'>\x1b[2J</robot>", "U+001B"),
        ("<robot name='a'/>\x00<robot name='b'/>", "U+0000"),
        ("<robot name='\ufffe'/>", "U+FFFE"),
        ("<robot><xacro:macro name='a'/></robot>", "denavit push robot.urdf.xacro"),
        ("<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arm/></robot>", "expand"),
        ("<x:robot xmlns:x='http://www.ros.org' name='a'/>", "without a prefix"),
        ("<robot>" + "<x>" * 300 + "</x>" * 300 + "</robot>", "nested too deeply"),
        ("<" + "r" * 60_000 + "/>", "a name is too long"),
        ("\ud800", "no Unicode text"),
    ],
)
def test_what_is_no_xml_is_refused_with_its_place(document, words):
    assert words in refusal(document)
    if "\ud800" not in document:
        assert words in refusal(document.encode())


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("before", ["", "<!-- a -->", "<?pi?>", "\n\n", "<!-- > --><?x y?> "])
def test_a_doctype_is_seen_in_every_encoding(arm_urdf, encoding, before):
    doctype = '<!DOCTYPE robot [<!ENTITY x SYSTEM "name.txt">]>'
    body = arm_urdf.replace('<?xml version="1.0"?>', f"{before}{doctype}")
    marks = {"utf-16-le": b"\xff\xfe", "utf-16-be": b"\xfe\xff"}
    assert "DOCTYPE" in refusal(marks.get(encoding, b"") + body.encode(encoding))
    assert "DOCTYPE" in refusal(body)


def test_the_word_doctype_in_a_comment_is_none(arm_urdf):
    text = arm_urdf.replace("<link", "<!-- <!DOCTYPE x> <!ENTITY y> --><link", 1)
    assert read_urdf(text).canonical == read_urdf(arm_urdf).canonical


@pytest.mark.parametrize(
    ("declared", "encoded", "mark", "words"),
    [
        ("utf-7", "utf-7", b"", "encoding 'utf-7', which is not read here"),
        ("utf-32", "utf-32", b"", "the URDF is UTF-32"),
        ("ebcdic-cp-us", "utf-8", b"", "which is not read here; save the URDF as UTF-8"),
        ("gb18030", "gb18030", b"", "not read here"),
        ("utf-16", "utf-8", b"", "not read here"),
        ("utf-8", "utf-16-le", b"\xff\xfe", "is not that of its byte order mark"),
        ("utf-16", "utf-8", b"\xef\xbb\xbf", "is not that of its byte order mark"),
        ("x" * 150, "utf-8", b"", "not read here"),
    ],
)
def test_other_encodings_are_refused(arm_urdf, declared, encoded, mark, words):
    text = with_declaration(arm_urdf, f'<?xml version="1.0" encoding="{declared}"?>')
    assert words in refusal(mark + text.encode(encoded))


@pytest.mark.parametrize(
    ("declared", "encoded", "mark"),
    [
        ("UTF-8", "utf-8", b""),
        ("UTF-8", "utf-8", b"\xef\xbb\xbf"),
        ("UTF-16", "utf-16-be", b"\xfe\xff"),
        ("utf-16le", "utf-16-le", b"\xff\xfe"),
        ("ISO-8859-1", "latin-1", b""),
        ("Windows-1252", "cp1252", b""),
    ],
)
def test_encodings_that_name_themselves_are_read(arm_urdf, declared, encoded, mark):
    text = arm_urdf.replace('"arm"', '"bras élévateur"')
    text = with_declaration(text, f"<?xml version='1.0' encoding='{declared}' standalone='yes'?>")
    if declared == "utf-16le":
        text = text.replace("utf-16le", "utf-16")
    assert read_urdf(mark + text.encode(encoded)).name == "bras élévateur"


@pytest.mark.parametrize("start", [b"\xff\xfe", b"\xfe\xff", b"\xef\xbb\xbf", b""])
@pytest.mark.parametrize("rest", [b"\xff", b"\x00", b"<\xd8\x00", b"\xed\xa0\x80", b"\x00\xd8"])
def test_torn_bytes_are_refused(start, rest):
    refusal(start + rest)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("<axis", '<axis xyz="0 0 1"/><axis', ("joint 'turn' has two <axis>", "keep one")),
        ("<parent", '<parent link="boom"/><parent', ("joint 'turn' has two <parent>",)),
        ("<child", '<child link="boom"/><child', ("joint 'turn' has two <child>",)),
        ('<origin xyz="0 0.2 0"/>', '<origin xyz="0 0.2 0"/><origin/>', ("two <origin>",)),
        ("<limit", '<limit lower="0" upper="0"/><limit', ("joint 'reach' has two <limit>",)),
        (
            '<link name="boom"/>',
            '<link name="boom"><link name="b"/></link>',
            ("link 'boom': <link> cannot stand in <link>",),
        ),
        ('<link name="boom"/>', '<link name="boom"><joint name="b"/></link>', ("cannot stand in",)),
        (
            "</robot>",
            '<group><joint name="g"><child link="boom"/></joint></group></robot>',
            ("<group> holds a <joint>",),
        ),
        ("</robot>", '<robot name="b"/></robot>', ("<robot> cannot stand in <robot>",)),
        ("</robot>", '<Link name="b"/></robot>', ("<Link> cannot stand in <robot>",)),
        ("</robot>", '<include filename="arm.urdf"/></robot>', ("holds <include>, which is not",)),
        (
            "</robot>",
            '<i:include xmlns:i="http://www.w3.org/2001/XInclude" href="/etc/passwd"/></robot>',
            ("holds <include>, which is not read", "in its place"),
        ),
        (
            "</robot>",
            '<loop_joint name="x"><link1 link="boom"/></loop_joint></robot>',
            ("holds <loop_joint>", "a robot is a tree"),
        ),
        ("<axis", "<axis><joint/></axis><axis", ("<joint> cannot stand in <axis>",)),
        ("<axis", "<mimic/><axis", ("joint 'turn': <mimic> lacks", "give joint=")),
        ("<axis", '<mimic joint="nil"/><axis', ("joint 'turn' mimics 'nil', which does not",)),
        ("<axis", '<mimic joint="turn"/><axis', ("joint 'turn' mimics itself;",)),
        ("<axis", '<mimic joint="reach" multiplier="nan"/><axis', ("joint 'turn'", "'nan'")),
        ("<axis", '<mimic joint="reach" offset="1e7"/><axis', ("offset of <mimic>", "beyond")),
        ("<axis", "<axes", ("joint 'turn': <axes> is unknown", "did you mean <axis>?")),
        ("<limit", "<limits", ("<limits> is unknown; did you mean <limit>?",)),
        ("<axis", "&lt;axis", ("joint 'turn' holds the text '<axis", "mend the tag")),
        ('<origin xyz="0 0.2 0"', '<origin xzy="0 0.2 0"', ("attribute 'xzy'", "xyz, rpy")),
        ('rpy="0.1 0.2 0.3"', 'quat_xyzw="0 0 0 1"', ("quat_xyzw", 'version="1.1"')),
        ('rpy="0.1 0.2 0.3"', 'ryp="0.1 0.2 0.3"', ("attribute 'ryp'", "xyz, rpy")),
        ("<axis", "<axis>0 0 1</axis><axis", ("'turn' holds the text '0 0 1'",)),
        ('<axis xyz="0 0 2"/>', '<axis xyz_="0 0 2"/>', ("<axis> has an attribute 'xyz_'",)),
        ('xyz="0 0.2 0"', 'xyz="0 \u0660.2 0"', ("joint 'reach'", "'٠.2'", "finite number")),
        ('xyz="0 0.2 0"', 'xyz="0\u00a00.2 0"', ("give 3 numbers",)),
        ('xyz="0 0.2 0"', f'xyz="0 0.{"2" * 1000} 0"', ("…; give 3 numbers",)),
        ('xyz="0 0.2 0"', f'xyz="0 0.{"2" * 64} 0"', ("give a finite number",)),
        ('xyz="0 0.2 0"', f'xyz="{"0 " * 600}0 0.2 0"', ("give 3 numbers",)),
        ('xyz="0 0.2 0"', 'xyz="0 0.2d0 0"', ("'0.2d0'",)),
        ('xyz="0 0.2 0"', 'xyz="0 1e+ 0"', ("'1e+'",)),
        ('lower="-1.5"', 'lower="-1e308"', ("joint 'grip'", "lower of <limit>", "beyond ±1e+20")),
        ('velocity="2"', 'velocity="1e21"', ("velocity of <limit>", "beyond ±1e+20")),
        ('<axis xyz="1 1 0"/>', '<axis xyz="1e-320 0 0"/>', ("joint 'grip'", "axis is zero")),
        ('name="turn"', 'name="tu&#10;rn"', ("joint", "'tu\\nrn'", "cannot be seen")),
        ('name="turn"', 'name="tu\u202ern"', ("'tu\\u202ern'", "cannot be seen; remove them")),
        ('name="turn"', 'name="tu\u200brn"', ("'tu\\u200brn'",)),
        ('name="turn"', 'name="tu\u2028rn"', ("'tu\\u2028rn'",)),
        ('name="turn"', 'name="tu\u00a0rn"', ("'tu\\xa0rn'",)),
        ('name="turn"', 'name="turn "', ("'turn '", "blanks at its ends")),
        ('name="turn"', 'name="to\u0308rn"', ("composed form (Unicode NFC)",)),
        ('<parent link="turret"/>', '<parent link="turr\u00e8t"/>', ("parent link 'turrèt' does",)),
        ('<parent link="turret"/>', f'<parent link="{"t" * 500}"/>', ("ttt… does not exist",)),
    ],
)
def test_a_slip_is_refused_and_not_dropped(arm_urdf, old, new, words):
    assert old in arm_urdf
    message = refusal(
        arm_urdf.replace(old, new, 1) if old != "</robot>" else new.join(arm_urdf.rsplit(old, 1))
    )
    assert [word for word in words if word not in message] == []


def test_joints_that_mimic_each_other_are_refused(arm_urdf):
    text = arm_urdf.replace("<axis", '<mimic joint="reach"/><axis', 1)
    head, _, rest = text.partition('name="reach"')
    text = head + 'name="reach"' + rest.replace("<axis", '<mimic joint="turn"/><axis', 1)
    assert "mimics itself by way of" in refusal(text)


def test_the_default_namespace_of_a_document_is_no_matter(arm_urdf):
    text = arm_urdf.replace("<robot ", '<robot xmlns="http://www.ros.org" xmlns:a="http://a" ')
    assert read_urdf(text) == read_urdf(arm_urdf)
    other = text.replace('<link name="boom"/>', '<link xmlns="http://b" name="boom"/>')
    with pytest.raises(InvalidURDF) as caught:
        read_urdf(other)
    told = [fault.message for fault in caught.value.faults]
    assert "the robot: <link> cannot stand in <robot>; put it in its place or remove it" in told
    assert any("link 'boom' does not exist" in one for one in told)
    xacro = text.replace("</robot>", '<x:arm xmlns:x="http://www.ros.org/wiki/xacro"/></robot>')
    assert "denavit push" in refusal(xacro)


def test_extensions_are_left_out_and_named_once(arm_urdf):
    extra = (
        "<gazebo><robot><link/><joint/>text</robot></gazebo><gazebo/><transmission><joint/>"
        '</transmission><drake:x xmlns:drake="d">text</drake:x>'
    )
    text = arm_urdf.replace("</robot>", f"{extra}</robot>").replace("<axis", "<dynamics/><axis", 1)
    description = read_urdf(text)
    assert description.canonical == read_urdf(arm_urdf).canonical
    assert description.warnings == (
        "left out, since kinematics does not use it: <gazebo>, <transmission>, <x>, <dynamics>",
    )


def test_an_origin_of_a_link_that_changes_nothing_is_no_matter(arm_urdf):
    text = arm_urdf.replace('"boom"/>', '"boom"><origin xyz="0 0 0" rpy="0 -0 0.0"/></link>', 1)
    assert read_urdf(text) == read_urdf(arm_urdf)


def test_an_inertia_that_no_body_has_is_named_and_kept(arm_urdf):
    text = arm_urdf.replace('ixy="0"', 'ixy="5"')
    robot = robot_from_urdf(text)
    assert robot.warnings == (
        "the inertia of link 'turret' is not positive semi-definite, so no body has it; kinematics"
        " does not use it",
    )
    assert 'ixy="5.0"' in robot.urdf
    slightly = robot_from_urdf(
        arm_urdf.replace('ixx="0.1"', 'ixx="-5e-20"').replace('iyy="0.1"', 'iyy="0"')
    )
    assert slightly.warnings == ()


@pytest.mark.parametrize(
    "filename",
    [
        "/etc/passwd",
        "//host/share",
        "file:///etc/passwd",
        "file://etc/passwd",
        "FILE:///x",
        "http://example.org/a.stl",
        "https://[::1]/a.stl",
        "ftp://a/b",
        "model://a/b",
        "package://../../etc/passwd",
        "package://a/../../b",
        "package:////etc/passwd",
        "../meshes/a.stl",
        "a/../../b",
        "..",
        ".",
        "",
        "a//b",
        "a/./b",
        "..\\..\\boot.ini",
        "C:\\a.stl",
        "C:/a.stl",
        "\\\\host\\a",
        "~/a.stl",
        "$HOME/a.stl",
        "`id`",
        "a|b",
        "package://a/%2e%2e/b",
        "%2e%2e/a",
        "package://a\u202e/b",
        "data:,x",
        "javascript:x",
        "<x>",
        "a'b",
        "a;b",
        "x" * 600,
        " /etc/passwd",
        "package://",
        "package:///",
    ],
)
def test_a_mesh_that_leads_elsewhere_is_not_handed_on(arm_urdf, tmp_path, filename):
    from xml.sax.saxutils import escape

    text = arm_urdf.replace("package://arm/turret.stl", escape(filename, {'"': "&quot;"}))
    robot = robot_from_urdf(text)
    assert "mesh" not in robot.urdf
    assert len(ET.fromstring(robot.urdf).findall(".//visual")) == 0
    assert len(ET.fromstring(robot.urdf).findall(".//collision")) == 1
    (warning,) = robot.warnings
    assert "meshes of link 'turret' are left out" in warning
    assert "package://" in warning
    assert robot_from_urdf(robot.urdf).urdf == robot.urdf


@pytest.mark.parametrize(
    ("filename", "kept"),
    [
        ("package://arm/meshes/a b-1_(2).dae", "package://arm/meshes/a b-1_(2).dae"),
        ("package:///arm/a.stl", "package://arm/a.stl"),
        ("meshes/a.stl", "meshes/a.stl"),
        ("./meshes/a.stl", "meshes/a.stl"),
        ("maße/évidé+1@2,3.obj", "maße/évidé+1@2,3.obj"),
        ("a..b/c.stl", "a..b/c.stl"),
    ],
)
def test_a_mesh_of_a_package_is_kept_as_text(arm_urdf, filename, kept):
    robot = robot_from_urdf(arm_urdf.replace("package://arm/turret.stl", filename))
    assert ET.fromstring(robot.urdf).find(".//mesh").get("filename") == kept
    assert robot.warnings == ()


def test_no_file_that_a_urdf_names_is_opened(arm_urdf, tmp_path):
    fifo = tmp_path / "fifo.stl"
    import os

    os.mkfifo(fifo)  # opening it would wait for ever
    for name in (str(fifo), f"file://{fifo}", f"package://{fifo}"):
        assert robot_from_urdf(arm_urdf.replace("package://arm/turret.stl", name)).dof == 3


def test_limits_far_out_stand_for_none(arm_urdf):
    text = arm_urdf.replace('lower="-1.5"', 'lower="-1e16"').replace('upper="1.5"', 'upper="1e16"')
    joint = robot_from_urdf(text).joints[2]
    assert (joint.lower, joint.upper) == (None, None)


def test_a_material_is_written_where_it_has_a_colour(arm_urdf, capfd):
    import pinocchio as pin

    text = arm_urdf.replace('<material name="grey"/>', '<material name="unknown"/>')
    robot = robot_from_urdf(text)
    assert "unknown" not in robot.urdf
    assert pin.buildModelFromXML(robot.urdf).nv == 3
    twice = re.sub(r"(<material name=.grey.>.*?</material>)", r"\1\1", arm_urdf)
    assert pin.buildModelFromXML(robot_from_urdf(twice).urdf).nv == 3
    assert capfd.readouterr().err == ""


def test_refusals_are_invalid_urdf(arm_urdf):
    with pytest.raises(InvalidURDF):
        robot_from_urdf(arm_urdf[:-20])
