"""URDFs: hostile, broken, lying; and right ones that look odd."""

from __future__ import annotations

import json
from collections.abc import Iterator

from tests.corpus.case import MINE, XML, Case, body
from tests.torture.large_urdfs import chain, star, too_large

LIMIT = '<limit lower="-1" upper="1" effort="10" velocity="2"/>'
ARM = f"""<?xml version="1.0"?>
<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0 0 0.1"/><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <visual><geometry><mesh filename="package://arm/upper.stl"/></geometry>
      <material name="grey"/></visual>
    <collision><geometry><cylinder radius="0.1" length="0.4"/></geometry></collision>
  </link>
  <link name="lower"/>
  <link name="hand"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.3" rpy="0.1 0 0"/><axis xyz="0 0 1"/>{LIMIT}</joint>
  <joint name="slide" type="prismatic"><parent link="upper"/><child link="lower"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 1 0"/>{LIMIT}</joint>
  <joint name="wrist" type="continuous"><parent link="lower"/><child link="hand"/></joint>
</robot>
"""
OUTSIDE = "</robot>"
JOINT = '<joint name="x" type="fixed"><parent link="{}"/><child link="{}"/></joint>'

SLIPS: dict[str, tuple[str, str, tuple[str, ...]]] = {
    # Lies: what other readers accept and compute another robot from.
    "zero axis": ('xyz="0 0 1"', 'xyz="0 0 0"', ("shoulder", "axis is zero")),
    "tiny axis": ('xyz="0 0 1"', 'xyz="0 0 1e-9"', ("shoulder", "axis is zero")),
    "axis of two numbers": ('xyz="0 0 1"', 'xyz="0 1"', ("shoulder", "give 3 numbers")),
    "axis of four numbers": ('xyz="0 0 1"', 'xyz="0 0 1 0"', ("shoulder", "give 3 numbers")),
    "axis nan": ('xyz="0 0 1"', 'xyz="nan 0 1"', ("shoulder", "'nan'")),
    "axis infinite": ('xyz="0 0 1"', 'xyz="inf 0 1"', ("shoulder", "'inf'")),
    "axis with commas": ('xyz="0 0 1"', 'xyz="0,0,1"', ("shoulder", "3 numbers")),
    "axis in words": ('xyz="0 0 1"', 'xyz="z"', ("shoulder", "'z'")),
    "axis empty": ('xyz="0 0 1"', 'xyz=""', ("shoulder", "3 numbers")),
    "axis misspelt attribute": ('axis xyz="0 0 1"', 'axis xzy="0 0 1"', ("shoulder", "xzy")),
    "axis misspelt": ('<axis xyz="0 0 1"/>', '<axsi xyz="0 0 1"/>', ("shoulder", "<axis>")),
    "two axes": ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><axis/>', ("shoulder", "two <axis>")),
    "origin nan": ('xyz="0 0 0.3"', 'xyz="0 NaN 0.3"', ("shoulder", "'NaN'")),
    "origin infinite": ('xyz="0 0 0.3"', 'xyz="0 -Infinity 0"', ("shoulder", "'-Infinity'")),
    "origin 1e308": ('xyz="0 0 0.3"', 'xyz="0 1e308 0"', ("shoulder", "check the unit")),
    "origin 1e999": ('xyz="0 0 0.3"', 'xyz="0 1e999 0"', ("shoulder", "check the unit")),
    "origin in km by mistake": ('xyz="0 0 0.3"', 'xyz="0 0 3e6"', ("shoulder", "the unit")),
    "origin hexadecimal": ('xyz="0 0 0.3"', 'xyz="0 0 0x1p3"', ("shoulder", "'0x1p3'")),
    "origin decimal comma": ('xyz="0 0 0.3"', 'xyz="0 0 0,3"', ("shoulder", "decimal point")),
    "origin with a unit": ('xyz="0 0 0.3"', 'xyz="0 0 0.3m"', ("shoulder", "'0.3m'")),
    "origin in other digits": ('xyz="0 0 0.3"', 'xyz="0 0 ٠.٣"', ("shoulder", "finite number")),
    "origin in wide digits": ('xyz="0 0 0.3"', 'xyz="0 0 ０.３"', ("shoulder", "finite number")),
    "origin with underscores": ('xyz="0 0 0.3"', 'xyz="0 0 1_0"', ("shoulder", "'1_0'")),
    "origin with minus sign": ('xyz="0 0 0.3"', 'xyz="0 0 −0.3"', ("shoulder", "finite number")),
    "origin unexpanded": ('xyz="0 0 0.3"', 'xyz="0 0 ${h}"', ("shoulder", "${h}")),
    "origin of two numbers": ('xyz="0 0 0.3"', 'xyz="0 0"', ("shoulder", "3 numbers")),
    "origin missing digits": ('xyz="0 0 0.3"', 'xyz="0 0 ."', ("shoulder", "'.'")),
    "origin e without digits": ('xyz="0 0 0.3"', 'xyz="0 0 1e"', ("shoulder", "'1e'")),
    "origin two signs": ('xyz="0 0 0.3"', 'xyz="0 0 --1"', ("shoulder", "'--1'")),
    "origin of a no-break space": ('xyz="0 0 0.3"', 'xyz="0 0\u00a00.3"', ("shoulder",)),
    "origin of a long number": ('xyz="0 0 0.3"', f'xyz="0 0 0.{"3" * 5000}"', ("shoulder",)),
    "origin of many numbers": ('xyz="0 0 0.3"', f'xyz="{"0 " * 50_000}"', ("shoulder", "3 num")),
    "rpy of four": ('rpy="0.1 0 0"', 'rpy="0.1 0 0 0"', ("shoulder", "rpy", "3 numbers")),
    "rpy misspelt": ('rpy="0.1 0 0"', 'ryp="0.1 0 0"', ("shoulder", "'ryp'", "xyz, rpy")),
    "quaternion": ('rpy="0.1 0 0"', 'quat="0 0 0 1"', ("shoulder", "'quat'")),
    "two origins": (
        '<origin xyz="0.4 0 0"/>',
        '<origin/><origin xyz="0.4 0 0"/>',
        ("slide", "two <origin>"),
    ),
    "origin misspelt": ('<origin xyz="0.4 0 0"/>', '<orgin xyz="0.4 0 0"/>', ("<origin>",)),
    "no limit": (
        f'<axis xyz="0 0 1"/>{LIMIT}',
        '<axis xyz="0 0 1"/>',
        ("shoulder", "needs <limit", "continuous"),
    ),
    "no limit of a slide": (
        f'<axis xyz="0 1 0"/>{LIMIT}',
        '<axis xyz="0 1 0"/>',
        ("slide", "needs <limit"),
    ),
    "no lower": (' lower="-1"', "", ("shoulder", "lacks lower")),
    "no upper": (' upper="1"', "", ("shoulder", "lacks upper")),
    "no effort": (' effort="10"', "", ("shoulder", "lacks effort")),
    "no velocity": (' velocity="2"', "", ("shoulder", "lacks velocity")),
    "lower above upper": ('lower="-1"', 'lower="2"', ("shoulder", "above upper", "swap")),
    "lower nan": ('lower="-1"', 'lower="nan"', ("shoulder", "'nan'")),
    "upper infinite": ('upper="1"', 'upper="inf"', ("shoulder", "'inf'")),
    "upper 1e308": ('upper="1"', 'upper="1e308"', ("shoulder", "beyond")),
    "upper in degrees": ('upper="1"', 'upper="90deg"', ("shoulder", "'90deg'")),
    "upper an expression": ('upper="1"', 'upper="pi/2"', ("shoulder", "'pi/2'")),
    "effort negative": ('effort="10"', 'effort="-10"', ("shoulder", "effort", "negative")),
    "velocity negative": ('velocity="2"', 'velocity="-2"', ("shoulder", "velocity", "negative")),
    "velocity nan": ('velocity="2"', 'velocity="NaN"', ("shoulder", "'NaN'")),
    "two limits": (LIMIT, f"{LIMIT}{LIMIT}", ("shoulder", "two <limit>")),
    "limits": ("<limit ", "<limits ", ("shoulder", "<limit>")),
    "floating": ('type="continuous"', 'type="floating"', ("wrist", "floating", "not supported")),
    "planar": ('type="continuous"', 'type="planar"', ("wrist", "planar", "not supported")),
    "ball": ('type="continuous"', 'type="ball"', ("wrist", "'ball'", "revolute")),
    "spherical": ('type="continuous"', 'type="spherical"', ("wrist", "'spherical'")),
    "type in capitals": ('type="continuous"', 'type="Continuous"', ("wrist", "'Continuous'")),
    "no type": (' type="continuous"', "", ("wrist", "type is missing")),
    "empty type": ('type="continuous"', 'type=""', ("wrist", "''")),
    # Trees that are none.
    "two roots": (
        '<link name="hand"/>',
        '<link name="hand"/><link name="stray"/>',
        ("2 root links", "stray"),
    ),
    "many roots": (
        '<link name="hand"/>',
        "".join(f'<link name="s{k}"/>' for k in range(99)) + '<link name="hand"/>',
        ("100 root links",),
    ),
    "child of two joints": (
        OUTSIDE,
        f"{JOINT.format('base', 'hand')}</robot>",
        ("'hand'", "two joints"),
    ),
    "joint to itself": (OUTSIDE, f"{JOINT.format('hand', 'hand')}</robot>", ("'x'", "itself")),
    "loop to the root": (OUTSIDE, f"{JOINT.format('hand', 'base')}</robot>", ("loop",)),
    "loop beside the root": (
        OUTSIDE,
        '<link name="p"/><link name="q"/>'
        + JOINT.format("p", "q")
        + JOINT.format("q", "p").replace('"x"', '"y"')
        + "</robot>",
        ("'p'", "loop"),
    ),
    "no such parent": ('<parent link="upper"/>', '<parent link="nil"/>', ("slide", "'nil'")),
    "no such child": ('<child link="lower"/>', '<child link="nil"/>', ("slide", "'nil'")),
    "parent in capitals": ('<parent link="upper"/>', '<parent link="Upper"/>', ("slide", "Upper")),
    "parent with a blank": ('<parent link="upper"/>', '<parent link="upper "/>', ("slide",)),
    "no parent": ('<parent link="upper"/>', "", ("slide", "<parent link=…> is missing")),
    "no child": ('<child link="lower"/>', "", ("slide", "<child link=…> is missing")),
    "parent without link": ('<parent link="upper"/>', "<parent/>", ("slide", "<parent link=…>")),
    "two parents": (
        '<parent link="upper"/>',
        '<parent link="upper"/><parent link="base"/>',
        ("slide", "two <parent>"),
    ),
    "two children": (
        '<child link="lower"/>',
        '<child link="lower"/><child link="hand"/>',
        ("slide", "two <child>"),
    ),
    "link twice": (
        '<link name="hand"/>',
        '<link name="hand"/><link name="hand"/>',
        ("two links", "'hand'"),
    ),
    "joint twice": ('name="slide"', 'name="shoulder"', ("two joints", "'shoulder'")),
    # Names.
    "robot without name": ('<robot name="arm">', "<robot>", ("no name",)),
    "robot with a blank name": ('<robot name="arm">', '<robot name="  ">', ("no name",)),
    "link without name": ('<link name="hand"/>', "<link/>", ("<link>", "no name")),
    "joint without name": ('<joint name="wrist"', "<joint", ("<joint>", "no name")),
    "joint of an empty name": ('name="wrist"', 'name=""', ("<joint>", "no name")),
    "joint universe": ('name="wrist"', 'name="universe"', ("universe", "another")),
    "newline in a name": ('name="wrist"', 'name="wr&#10;ist"', ("control",)),
    "forged log line": (
        'name="wrist"',
        'name="w&#13;&#10;{&quot;level&quot;: &quot;error&quot;}"',
        ("control",),
    ),
    "escape in a name": ('name="wrist"', 'name="w&#x9b;2J"', ("control",)),
    "direction in a name": ('name="wrist"', 'name="wr\u202etsi"', ("cannot be seen",)),
    "zero width in a name": ('name="wrist"', 'name="wr\u200bist"', ("cannot be seen",)),
    "line separator in a name": ('name="wrist"', 'name="wr\u2028ist"', ("cannot be seen",)),
    "tag letters in a name": ('name="wrist"', 'name="wrist\U000e0041"', ("cannot be seen",)),
    "private letters in a name": ('name="wrist"', 'name="wr\ue000ist"', ("cannot be seen",)),
    "filler for a name": ('name="wrist"', 'name="\u3164"', ("cannot be seen",)),
    "selector in a name": ('name="wrist"', 'name="slide\ufe0f"', ("cannot be seen",)),
    "joiner in a name": ('name="wrist"', 'name="sl\u034fide"', ("cannot be seen",)),
    "decomposed accents": ('name="wrist"', 'name="wri\u0301st"', ("NFC",)),
    "blank at the end": ('name="wrist"', 'name="wrist "', ("blanks at its ends",)),
    "long name": ('name="wrist"', f'name="{"w" * 129}"', ("over 128 characters",)),
    "name of a megabyte": ('name="wrist"', f'name="{"w" * 1_000_000}"', ("over 128",)),
    # Bodies.
    "mass nan": ('value="2"', 'value="nan"', ("upper", "'nan'")),
    "mass negative": ('value="2"', 'value="-2"', ("upper", "mass", "negative")),
    "mass 1e308": ('value="2"', 'value="1e308"', ("upper", "beyond")),
    "mass empty": ('value="2"', 'value=""', ("upper", "<mass>")),
    "inertia nan": ('ixx="0.1"', 'ixx="nan"', ("upper", "'nan'")),
    "inertia negative": ('ixx="0.1"', 'ixx="-1"', ("upper", "negative")),
    "inertial twice": ("<inertial>", "<inertial/><inertial>", ("upper", "two <inertial>")),
    "radius negative": ('radius="0.1"', 'radius="-0.1"', ("upper", "radius", "negative")),
    "radius nan": ('radius="0.1"', 'radius="nan"', ("upper", "'nan'")),
    "length missing": (' length="0.4"', "", ("upper", "length")),
    "box of two": ('<cylinder radius="0.1" length="0.4"/>', '<box size="1 1"/>', ("upper", "3")),
    "no geometry": (
        '<geometry><cylinder radius="0.1" length="0.4"/></geometry>',
        "",
        ("upper", "no geometry"),
    ),
    "two geometries": ("<cylinder ", "<sphere radius='1'/><cylinder ", ("upper", "two geom")),
    "mesh without a name": (
        '<mesh filename="package://arm/upper.stl"/>',
        "<mesh/>",
        ("upper", "filename"),
    ),
    "mesh scale nan": ('upper.stl"', 'upper.stl" scale="nan 1 1"', ("upper", "'nan'")),
    "colour of three": ('rgba="0.5 0.5 0.5 1"', 'rgba="1 0 0"', ("grey", "4 numbers")),
    # Mimic.
    "mimic of none": ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><mimic/>', ("<mimic>", "joint=")),
    "mimic of an unknown joint": (
        '<axis xyz="0 0 1"/>',
        '<axis xyz="0 0 1"/><mimic joint="nil"/>',
        ("'nil'",),
    ),
    "mimic of itself": (
        '<axis xyz="0 0 1"/>',
        '<axis xyz="0 0 1"/><mimic joint="shoulder"/>',
        ("shoulder", "itself"),
    ),
    "mimic of a fixed joint": (
        '<joint name="wrist" type="continuous">',
        '<link name="pad"/><joint name="still" type="fixed"><parent link="upper"/>'
        '<child link="pad"/></joint><joint name="wrist" type="continuous"><mimic joint="still"/>',
        ("'wrist' mimics 'still', which does not move",),
    ),
    "mimic nan": (
        '<axis xyz="0 0 1"/>',
        '<axis xyz="0 0 1"/><mimic joint="slide" multiplier="nan"/>',
        ("'nan'",),
    ),
    # Structure.
    "link in a link": (
        '<link name="hand"/>',
        '<link name="hand"><link name="x"/></link>',
        ("hand", "cannot stand"),
    ),
    "joint in a link": (
        '<link name="hand"/>',
        '<link name="hand"><joint name="x"/></link>',
        ("hand", "cannot stand"),
    ),
    "robot in a robot": (OUTSIDE, '<robot name="b"/></robot>', ("<robot>", "cannot stand")),
    "links in a group": (OUTSIDE, '<group><link name="b"/></group></robot>', ("<group>",)),
    "text between tags": ('<link name="hand"/>', 'oops<link name="hand"/>', ("'oops'",)),
    "escaped tag": ('<axis xyz="0 0 1"/>', "&lt;axis/>", ("shoulder", "<axis")),
    "xacro left": (
        OUTSIDE,
        '<xacro:arm xmlns:xacro="http://www.ros.org/wiki/xacro"/></robot>',
        ("xacro is never evaluated",),
    ),
    "xacro undeclared": (OUTSIDE, "<xacro:arm/></robot>", ("xacro",)),
    "include": (OUTSIDE, '<include filename="b.urdf"/></robot>', ("<include>",)),
    "xinclude": (
        OUTSIDE,
        '<i:include xmlns:i="http://www.w3.org/2001/XInclude"'
        ' href="file:///etc/passwd" parse="text"/></robot>',
        ("<include>",),
    ),
    "loop joint": (OUTSIDE, '<loop_joint name="l"/></robot>', ("<loop_joint>", "tree")),
    "unknown kinds": (OUTSIDE, "".join(f"<k{k}/>" for k in range(40)) + "</robot>", ("20 kinds",)),
    # XML.
    "cut": ('  <link name="lower"/>', "<!--", ("XML",)),
    "mismatched": ("</link>", "</lnk>", ("mismatched", "line")),
    "attribute twice": ('<link name="hand"', '<link name="hand" name="hand"', ("twice",)),
    "no quotes": ('name="wrist"', "name=wrist", ("quotes",)),
    "bare ampersand": ('name="wrist"', 'name="a&b"', ("&amp;",)),
    "undeclared entity": ('name="wrist"', 'name="&wrist;"', ("entity",)),
    "character 0": ('name="wrist"', 'name="&#0;"', ("a character that XML",)),
    "second root": (OUTSIDE, '</robot><robot name="b"/>', ("after the root",)),
    "XML 1.1": ('version="1.0"', 'version="1.1"', ("XML 1.0",)),
    "declared UTF-7": ('version="1.0"', 'version="1.0" encoding="UTF-7"', ("UTF-8",)),
    "declared EBCDIC": ('version="1.0"', 'version="1.0" encoding="IBM037"', ("UTF-8",)),
    "late declaration": ("<robot ", '<!-- a --><?xml version="1.0"?><robot ', ("<?xml",)),
    "doctype": ("<robot ", "<!DOCTYPE robot><robot ", ("DOCTYPE",)),
    "doctype in small letters": ("<robot ", "<!doctype robot><robot ", ("DOCTYPE",)),
    "external DTD": (
        "<robot ",
        '<!DOCTYPE r SYSTEM "arm.dtd"><robot ',
        ("DOCTYPE",),
    ),
    "parameter entity": (
        "<robot ",
        '<!DOCTYPE r [<!ENTITY % x SYSTEM "arm.dtd"> %x;]><robot ',
        ("DOCTYPE",),
    ),
    "external entity": (
        "<robot ",
        '<!DOCTYPE r [<!ENTITY x SYSTEM "arm.dtd">]><robot ',
        ("DOCTYPE",),
    ),
    "default attributes": (
        "<robot ",
        '<!DOCTYPE r [<!ATTLIST axis xyz CDATA "1 0 0">]><robot ',
        ("DOCTYPE",),
    ),
    "entities of entities": (
        "<robot ",
        '<!DOCTYPE r [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><robot ',
        ("DOCTYPE",),
    ),
    "deep": (
        OUTSIDE,
        "<gazebo>" + "<a>" * 5000 + "</a>" * 5000 + "</gazebo></robot>",
        ("nested too deeply",),
    ),
    "attributes": (
        "<axis ",
        "<axis " + " ".join(f'a{k}="1"' for k in range(50_000)) + " ",
        ("attributes",),
    ),
}
WHOLE: dict[str, tuple[bytes, tuple[str, ...]]] = {
    "nothing": (b"", ("no element",)),
    "blanks": (b" \n\t ", ("no element",)),
    "no XML": (b"hello", ("XML",)),
    "JSON": (b'{"robot": "arm"}', ("XML",)),
    "YAML": (b"robot:\n  name: arm\n", ("XML",)),
    "HTML": (b"<html><body><p>no</body></html>", ("XML",)),
    "SDF": (b'<sdf version="1.9"><model name="a"/></sdf>', ("<sdf>", "<robot name=")),
    "MJCF": (b'<mujoco model="a"><worldbody/></mujoco>', ("<mujoco>", "<robot name=")),
    "a picture": (b"\x89PNG\r\n\x1a\n" + bytes(300), ("XML",)),
    "gzip": (b"\x1f\x8b\x08\x00" + bytes(range(200)), ("XML",)),
    "zip": (b"PK\x03\x04" + bytes(100), ("XML",)),
    "NUL bytes": (bytes(10_000), ("U+0000",)),
    "NUL between": (
        ARM.encode().replace(b'<link name="hand"', b'\0<link name="hand"'),
        ("U+0000",),
    ),
    "NUL after": (ARM.encode() + b"\0", ("U+0000",)),
    "NUL then another robot": (ARM.encode() + b"\0" + ARM.encode(), ("U+0000",)),
    "bytes that are no UTF-8": (ARM.encode().replace(b"wrist", b"wr\xffst"), ("UTF-8", "line")),
    "overlong UTF-8": (ARM.encode().replace(b"wrist", b"wr\xc0\xafst"), ("UTF-8",)),
    "surrogates in UTF-8": (ARM.encode().replace(b"wrist", b"wr\xed\xa0\x80st"), ("UTF-8",)),
    "UTF-16 without a mark": (ARM.encode("utf-16-le"), ("XML",)),
    "UTF-32": (ARM.encode("utf-32"), ("UTF-32",)),
    "UTF-16 cut": (ARM.encode("utf-16")[:-1], ("UTF-16",)),
    "doctype in UTF-16": (
        "<!DOCTYPE r>".encode("utf-16") + ARM[22:].encode("utf-16-le"),
        ("DOCTYPE",),
    ),
    "half": (ARM.encode()[: len(ARM) // 2], ("line",)),
    "without its end": (ARM.strip().removesuffix("</robot>").encode(), ("line", "closed")),
    "declared twice": (b'<?xml version="1.0"?>' + ARM.encode(), ("<?xml stands twice",)),
    "declared twice, apart": (b'<?xml version="1.0"?>\n' + ARM.encode(), ("<?xml stands twice",)),
    "two marks": (b"\xef\xbb\xbf" * 2 + ARM.encode(), ("two byte order marks",)),
    "only a declaration": (b'<?xml version="1.0"?>', ("no element",)),
    "no links": (b'<robot name="a"/>', ("no <link>",)),
    "one link": (b'<robot name="a"><link name="l"/></robot>', ("no joint that moves",)),
    "all fixed": (
        ARM.replace("continuous", "fixed")
        .replace("revolute", "fixed")
        .replace("prismatic", "fixed")
        .encode(),
        ("no joint that moves",),
    ),
    "65 joints": (chain(66, moving=65).encode(), ("65 joints", "64")),
    "301 links": (chain(301).encode(), ("301 links", "300")),
    "3,812 joints": (chain(3813, moving=3812).encode(), ("at most",)),
    "a star of 3,000": (star(3000, moving=3000).encode(), ("at most",)),
    "1,001 shapes": (
        chain(
            3, inside='<visual><geometry><sphere radius="1"/></geometry></visual>' * 1001
        ).encode(),
        ("1001", "shapes"),
    ),
    "20,000 collisions": (
        chain(
            3, inside='<collision><geometry><sphere radius="1"/></geometry></collision>' * 20_000
        ).encode(),
        ("elements",),
    ),
    "a comment that is not closed": (ARM.encode() + b"<!--" + b"-" * 100_000, ("XML",)),
    "a million brackets": (b"<" * 1_000_000, ("XML",)),
    "a million ends": (b"]]>" * 300_000, ("XML",)),
    "instructions": (b"<?a?>" * 300_000, ("no element",)),
    "CDATA that is not closed": (b"<robot><![CDATA[" + b"]" * 500_000, ("CDATA",)),
    "one tag of a megabyte": (b"<" + b"r" * 1_000_000 + b"/>", ("name is too long",)),
    "one attribute of a megabyte": (b"<robot name='" + b"r" * 1_000_000 + b"'/>", ("no <link>",)),
}
MESHES = (
    "/etc/passwd",
    "//host/share/a.stl",
    "file:///etc/passwd",
    "file://../../etc/passwd",
    "FILE:///ETC/PASSWD",
    "package://../../etc/passwd",
    "package://arm/../../../etc/passwd",
    "package:////etc/passwd",
    "package://arm/..%2f..%2fetc/passwd",
    "../../../etc/passwd",
    "..\\..\\windows\\win.ini",
    "C:\\secret.stl",
    "\\\\host\\share",
    "http://127.0.0.1:9/a.stl",
    "https://169.254.169.254/latest",
    "ftp://host/a.dae",
    "data:model/stl;base64,AAAA",
    "javascript:alert(1)",
    "/dev/zero",
    "/proc/self/environ",
    "~/.ssh/id_rsa",
    "$HOME/a.stl",
    "`id`.stl",
    "a|b.stl",
    "a;b.stl",
    "%2e%2e/%2e%2e/etc/passwd",
    "a" * 600,
    "",
    "model://arm/a.dae",
    "a\u202e.stl",
)
MESH_FILES = {
    "COLLADA": (
        "model/vnd.collada+xml",
        b'<?xml version="1.0"?><COLLADA version="1.4.1"><library_'
        b'geometries><geometry id="g"><mesh><source id="s"><float_array count="999999999">1'
        b"</float_array></source></mesh></geometry></library_geometries></COLLADA>",
    ),
    "GLB of 2 GB": ("model/gltf-binary", b"glTF\x02\0\0\0\xff\xff\xff\x7f\xf0\xff\xff\x7fJSON{}"),
    "glTF": ("model/gltf+json", b'{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 9e9}]}'),
    "STL of 4 thousand million": ("model/stl", bytes(80) + b"\xff\xff\xff\xff"),
    "STL as text": ("model/stl", b"solid a\nfacet normal nan nan nan\n" * 1000),
    "OBJ": ("model/obj", b"v 1e999 0 0\nf 1 999999999 -5\n"),
    "PLY": ("application/ply", b"ply\nformat ascii 1.0\nelement vertex 4294967295\nend_header\n"),
    "ZIP of a mesh": ("application/zip", b"PK\x03\x04" + bytes(60)),
}
"""Files that take down or fill the memory of programs that read meshes."""
ODD_BUT_RIGHT: dict[str, tuple[bytes, tuple[str, ...]]] = {
    "as it is": (ARM.encode(), ()),
    "mass missing": (ARM.replace('<mass value="2"/>', "").encode(), ("<inertial> is incomplete",)),
    "inertia missing": (ARM.replace('ixx="0.1" ', "").encode(), ("<inertial>", "ixx")),
    "cone": (
        ARM.replace('<cylinder radius="0.1" length="0.4"/>', "<cone/>").encode(),
        ("cone",),
    ),
    "mesh scale of one": (
        ARM.replace('upper.stl"', 'upper.stl" scale="1"').encode(),
        ("one scale, which is taken for x, y, z",),
    ),
    "two materials": (
        ARM.replace(
            '<material name="grey"/>', '<material name="grey"/><material name="b"/>', 1
        ).encode(),
        ("2 materials",),
    ),
    "an undeclared prefix": (ARM.replace("<axis", '<axis drake:a="1"', 1).encode(), ("drake:",)),
    "XML 0.0": (ARM.replace('"1.0"', '"0.0"', 1).encode(), ()),
    "UTF-8 with a mark": (b"\xef\xbb\xbf" + ARM.encode(), ()),
    "UTF-16": (ARM.encode("utf-16"), ()),
    "CRLF": (ARM.replace("\n", "\r\n").encode(), ()),
    "one line": (ARM.replace("\n", " ").encode(), ()),
    "no declaration": (ARM.split("\n", 1)[1].encode(), ()),
    "blanks before the declaration": (b"\n\n " + ARM.encode(), ()),
    "ISO-8859-1": (
        ARM.replace('"1.0"', '"1.0" encoding="ISO-8859-1"')
        .replace("wrist", "poignée")
        .encode("latin-1"),
        ("poignée",),
    ),
    "Windows-1252": (ARM.replace('"1.0"', '"1.0" encoding="windows-1252"').encode(), ()),
    "comments everywhere": (
        ARM.replace(">", "><!-- - > < & -->").replace("?><!-- - > < & -->", "?>", 1).encode(),
        (),
    ),
    "the banner of xacro": (
        ARM.replace(
            "<robot ",
            "<!-- === | This document was autogenerated by"
            " xacro from arm.urdf.xacro | EDITING THIS FILE BY HAND IS NOT | -->"
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ',
        ).encode(),
        (),
    ),
    "a default namespace": (
        ARM.replace("<robot ", '<robot xmlns="http://www.ros.org" ').encode(),
        (),
    ),
    "the namespaces of old files": (
        ARM.replace(
            "<robot ",
            '<robot xmlns:sensor="http://playerstage.sourceforge.net/gazebo/xmlschema/'
            '#sensor" xmlns:controller="http://playerstage.sourceforge.net/gazebo/xmlschema/'
            '#controller" xmlns:interface="http://playerstage.sourceforge.net/gazebo/xmlschema/'
            '#interface" ',
        ).encode(),
        (),
    ),
    "drake": (
        ARM.replace("<robot ", '<robot xmlns:drake="http://drake.mit.edu" ')
        .replace(
            OUTSIDE,
            '<drake:collision_filter_group name="g"><drake:member link="hand"/>'
            "</drake:collision_filter_group></robot>",
        )
        .encode(),
        ("collision_filter_group",),
    ),
    "gazebo": (
        ARM.replace(
            OUTSIDE,
            '<gazebo reference="hand"><material>Gazebo/Red</material><mu1>'
            '0.2</mu1><sensor type="ray"><ray><min>0</min></ray></sensor></gazebo>'
            '<gazebo><plugin name="p" filename="libp.so"><robotNamespace>/a</robotNamespace>'
            "</plugin></gazebo></robot>",
        ).encode(),
        ("<gazebo>",),
    ),
    "transmission": (
        ARM.replace(
            OUTSIDE,
            '<transmission name="t"><type>transmission_interface/'
            'SimpleTransmission</type><joint name="shoulder"><hardwareInterface>Position'
            '</hardwareInterface></joint><actuator name="m"><mechanicalReduction>1'
            "</mechanicalReduction></actuator></transmission></robot>",
        ).encode(),
        ("<transmission>",),
    ),
    "ros2_control": (
        ARM.replace(
            OUTSIDE,
            '<ros2_control name="c" type="system"><hardware><plugin>'
            'mock/System</plugin></hardware><joint name="shoulder"><command_interface'
            ' name="position"><param name="min">-1</param></command_interface></joint>'
            "</ros2_control></robot>",
        ).encode(),
        ("<ros2_control>",),
    ),
    "dynamics, safety, calibration": (
        ARM.replace(
            '<axis xyz="0 0 1"/>',
            '<axis xyz="0 0 1"/><dynamics damping="0.1" friction="0"/>'
            '<safety_controller k_position="20" k_velocity="20" soft_lower_limit="-0.9"'
            ' soft_upper_limit="0.9"/><calibration rising="0.0"/>',
        ).encode(),
        ("<dynamics>",),
    ),
    "mimic": (
        ARM.replace(
            '<axis xyz="0 0 1"/>',
            '<axis xyz="0 0 1"/><mimic joint="slide" multiplier="-1" offset="0"/>',
        ).encode(),
        (),
    ),
    "mimic before its joint": (
        ARM.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><mimic joint="wrist"/>').encode(),
        (),
    ),
    "continuous with limits": (
        ARM.replace(
            '<child link="hand"/>',
            '<child link="hand"/><limit effort="5" velocity="1" lower="0" upper="0"/>',
        ).encode(),
        (),
    ),
    "fixed with a zero axis": (
        ARM.replace("continuous", "fixed")
        .replace('<child link="hand"/>', '<child link="hand"/><axis xyz="0 0 0"/>')
        .encode(),
        (),
    ),
    "axis not of length one": (ARM.replace('xyz="0 0 1"', 'xyz="0 0 2"').encode(), ()),
    "no axis": (ARM.replace('<axis xyz="0 0 1"/>', "").encode(), ()),
    "children before links": (ARM.encode(), ()),
    "numbers of every form": (
        ARM.replace('xyz="0 0 0.3"', 'xyz=" +1. \t -.5e-3\n1E2 "').encode(),
        (),
    ),
    "limits that stand for none": (
        ARM.replace('lower="-1" upper="1"', 'lower="-1e16" upper="1e16"').encode(),
        (),
    ),
    "no inertia at all": (
        ARM.replace('mass value="2"', 'mass value="0"').replace('"0.1" ', '"0" ').encode(),
        (),
    ),
    "names in Chinese, with blanks": (ARM.replace("wrist", "手腕 1").encode(), ("手腕 1",)),
    "names with every sign": (ARM.replace("wrist", "a.b-c_d:e/f+g[0]{x}@").encode(), ()),
    "a joint called as its link": (ARM.replace('name="wrist"', 'name="hand"').encode(), ()),
    "a link called universe": (ARM.replace('"hand"', '"universe"').encode(), ("universe",)),
    "a link called world": (ARM.replace('"base"', '"world"').encode(), ("world",)),
    "material of SolidWorks": (
        ARM.replace(
            '<material name="grey"/>',
            '<material name=""><color rgba="0.7 0.7 0.7 1"/><texture filename=""/></material>',
        ).encode(),
        (),
    ),
    "a capsule": (ARM.replace("<cylinder ", "<capsule ").encode(), ()),
    "sizes of zero": (ARM.replace('radius="0.1"', 'radius="0"').encode(), ()),
    "64 joints": (chain(65, moving=64).encode(), ()),
    "300 links": (chain(300).encode(), ()),
    "two megabytes of blanks": (ARM.replace(OUTSIDE, "\n" * 1_900_000 + OUTSIDE).encode(), ()),
}


FORGIVEN = {
    "two limits": ("shoulder", "2 equal <limit>"),
    "planar": ("wrist", "planar"),
    "links in a group": ("<group>",),
    "text between tags": ("'oops'",),
    "unknown kinds": ("<k0>",),
    "mass nan": ("upper", "'nan'"),
    "mass negative": ("upper", "mass", "negative"),
    "mass 1e308": ("upper", "beyond"),
    "mass empty": ("upper", "<mass>"),
    "inertia nan": ("upper", "'nan'"),
    "inertia negative": ("upper", "negative"),
    "inertial twice": ("upper", "2 <inertial>"),
    "radius nan": ("upper", "'nan'"),
    "radius negative": ("upper", "radius", "negative"),
    "length missing": ("upper", "length"),
    "box of two": ("upper", "size of <box>"),
    "no geometry": ("upper", "left out"),
    "two geometries": ("upper", "2 <geometry>"),
    "mesh without a name": ("upper", "filename"),
    "mesh scale nan": ("upper", "'nan'"),
    "colour of three": ("left out",),
    "XML 1.1": (),
    "late declaration": ("XML declaration",),
    "declared twice": ("XML declaration",),
    "declared twice, apart": ("XML declaration",),
    "1,001 shapes": ("shapes beyond 1000",),
}
"""Slips of drawing and decoration, which are told in a warning."""


def _documents() -> dict[str, tuple[bytes, tuple[str, ...]]]:
    documents = {name: (changed(old, new), words) for name, (old, new, words) in SLIPS.items()}
    return documents | WHOLE


def refused() -> Iterator[Case]:
    """Every document through one of the doors, in turn."""
    documents = {name: one for name, one in _documents().items() if name not in FORGIVEN}
    documents |= {
        f"too large: {name}": (text.encode(), (words[-8:],))
        for name, (text, words) in too_large().items()
    }
    for k, (name, (document, words)) in enumerate(documents.items()):
        # Of text in JSON the encoding does not matter.
        yield _through(0 if "declared" in name else k, f"urdf: {name}", document, words)
    path = f"/v1/robots?name={MINE}"
    for name, (kind, content) in MESH_FILES.items():
        if kind == "application/zip":
            yield body(f"mesh file: {name}", path, content, 422, "zip", kind=kind)
        else:
            yield body(f"mesh file: {name}", path, content, 415, "send", kind=kind)
        yield body(f"mesh file as XML: {name}", path, content, 422, kind=XML)
        path_of_mesh = f"/v1/robots/ur5/meshes/{name.partition(' ')[0].lower()}"
        yield body(f"mesh file put: {name}", path_of_mesh, content, 409, kind=kind, method="PUT")


def changed(old: str, new: str) -> bytes:
    assert old in ARM, old
    if old == OUTSIDE:
        return (ARM.strip().removesuffix(OUTSIDE) + new).encode()
    return ARM.replace(old, new, 1).encode()


def _through(door: int, name: str, document: bytes, words: tuple[str, ...]) -> Case:
    status = 413 if len(document) > 2_000_000 else 422
    said = ("larger",) if status == 413 else words
    if door % 4 == 0:
        return body(name, f"/v1/robots?name={MINE}", document, status, *said, kind=XML)
    if door % 4 == 1:
        return body(name, f"/v1/robots/{MINE}", document, status, *said, kind=XML, method="PUT")
    if door % 4 == 2:
        path = "/v1/urdf-to-dh?convention=standard"
        return body(name, path, document, status, *said, kind=XML)
    try:
        text = document.decode()
    except UnicodeDecodeError:
        return _through(door + 1, name, document, words)
    asked = json.dumps({"robot": {"urdf": text}, "q": [0.1, 0.2, 0.3]})
    if len(asked) > 2_000_000:
        return _through(door + 1, name, document, words)
    return body(name, "/v1/fk", asked, 422, *words)


def meshes() -> Iterator[Case]:
    """Names of meshes that lead elsewhere: the robot is taken, the mesh is not."""
    from xml.sax.saxutils import quoteattr

    for filename in MESHES:
        text = ARM.replace('"package://arm/upper.stl"', quoteattr(filename))
        yield body(
            f"mesh: {filename[:40]!r}",
            f"/v1/robots?name={MINE}",
            text,
            201,
            "meshes of link 'upper' are left out",
            kind=XML,
            secret=("root:", "PATH="),
        )


def accepted() -> Iterator[Case]:
    """Documents that must not be refused."""
    for name, (document, words) in ODD_BUT_RIGHT.items():
        path = f"/v1/robots?name={MINE}"
        yield body(f"urdf, right: {name}", path, document, 201, *words, kind=XML)
    documents = _documents()
    for name, words in FORGIVEN.items():
        document = documents[name][0]
        yield body(f"urdf, forgiven: {name}", path, document, 201, *words, kind=XML)
