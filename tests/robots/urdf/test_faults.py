"""All that is wrong with a file, in one answer: each with line, element, joint and remedy."""

import pytest
from lxml import etree

from robots.errors import InvalidURDF
from robots.urdf.reading import read_urdf

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
THIRTEEN = f"""<?xml version="1.0"?>
<robot name="arm">
  <link name="l0"/> <link name="l1"/> <link name="l2"/> <link name="l3"/> <link name="l4"/>
  <link name="l5"/> <link name="l6"/> <link name="l7"/> <link name="l8"/> <link name="l9"/>
  <joint name="j1" type="revolute"><parent link="l0"/><child link="l1"/>
    <axis xyz="0 0 0"/>{LIMIT}</joint>
  <joint name="j2" type="revolute"><parent link="l1"/><child link="l2"/>
    <origin xyz="0 0 nan"/>{LIMIT}</joint>
  <joint name="j3" type="hinge"><parent link="l2"/><child link="l3"/></joint>
  <joint name="j4" type="revolute"><parent link="l3"/><child link="l4"/>
  </joint>
  <joint name="j5" type="revolute"><parent link="l4"/><child link="l5"/>
    <limit lower="1" upper="-1" effort="1" velocity="1"/></joint>
  <joint name="j6" type="prismatic"><parent link="l5"/><child link="l6"/>
    <limit upper="1,5" effort="1" velocity="1"/></joint>
  <joint name="j7" type="continuous"><parent link="l6"/><child link="l7"/>
    <orgin xyz="0 0 1"/></joint>
  <joint name="j8" type="continuous"><parent link="l7"/><child link="elbow"/></joint>
  <joint name="j9" type="continuous"><parent link="l8"/>
    <axis xzy="0 0 1"/></joint>
  <joint name="j9" type="continuous"><parent link="l8"/><child link="l9"/></joint>
</robot>
"""
TOLD = [
    (6, "/robot/joint[@name='j1']/axis", "joint 'j1': its axis is zero"),
    (8, "/robot/joint[@name='j2']/origin", "joint 'j2': xyz of <origin> has 'nan'"),
    (9, "/robot/joint[@name='j3']", "joint 'j3': its type is 'hinge'"),
    (10, "/robot/joint[@name='j4']", "joint 'j4': a revolute joint needs <limit"),
    (13, "/robot/joint[@name='j5']/limit", "joint 'j5': lower limit 1 is above upper -1"),
    (15, "/robot/joint[@name='j6']/limit", "joint 'j6': <limit> lacks lower"),
    (15, "/robot/joint[@name='j6']/limit", "joint 'j6': upper of <limit> has '1,5'"),
    (17, "/robot/joint[@name='j7']/orgin", "joint 'j7': <orgin> is unknown; did you mean <orig"),
    (18, "/robot/joint[@name='j8']/child", "joint 'j8': its child link 'elbow' does not exist"),
    (19, "/robot/joint[9]", "joint 'j9': <child link=…> is missing"),
    (20, "/robot/joint[9]/axis", "joint 'j9': <axis> has an attribute 'xzy'"),
    (21, "/robot/joint[10]", "two joints are called 'j9'"),
]


def faults_of(text):
    with pytest.raises(InvalidURDF) as caught:
        read_urdf(text)
    return caught.value.faults


def test_every_fault_is_told_with_its_place():
    found = faults_of(THIRTEEN)
    assert len(found) == len(TOLD)
    root = etree.fromstring(THIRTEEN.encode())
    for fault, (line, xpath, words) in zip(found, TOLD, strict=True):
        assert (fault.line, fault.xpath) == (line, xpath)
        assert fault.message.startswith(words)
        assert len(root.xpath(fault.xpath)) == 1


def test_each_mended_fault_leaves_the_others():
    text = THIRTEEN.replace("orgin", "origin").replace("1,5", "1.5").replace("hinge", "continuous")
    assert len(faults_of(text)) == len(TOLD) - 3


def test_the_error_counts_what_it_does_not_show():
    with pytest.raises(InvalidURDF, match=r"joint 'j1': its axis is zero; .* \(and 11 more\)"):
        read_urdf(THIRTEEN)


FOLLOWERS = (
    '<robot name="r">\n'
    + "".join(f'<link name="l{k}"/>' for k in range(4))
    + "".join(
        f'\n<joint name="j{k}" type="revolute"><parent link="l{k - 1}"/><child link="l{k}"/>{LIMIT}'
        f'<mimic joint="{other}"/></joint>'
        for k, other in ((1, "nil"), (2, "j1"), (3, "j3"))
    )
    + "</robot>"
)


def test_faults_of_followers_and_of_the_tree_are_told_at_once():
    told = [(fault.line, fault.message[:18]) for fault in faults_of(FOLLOWERS)]
    assert told == [(3, "joint 'j1' mimics "), (5, "joint 'j3' mimics ")]
    broken = FOLLOWERS.replace('child link="l2"', 'child link="l3"')
    told = [(fault.line, fault.message[:18]) for fault in faults_of(broken)]
    assert told == [
        (3, "joint 'j1' mimics "),
        (5, "link 'l3' is the c"),
        (5, "joint 'j3' mimics "),
    ]


def test_xml_that_is_none_is_told_with_its_line():
    (fault,) = faults_of("<robot name='a'>\n<link>\n</robot>")
    assert fault.line == 3
    (fault,) = faults_of("\n\n<?xml version='1.0'?>\n<robot name='a'>\n<link>\n</robot>")
    assert fault.line == 6
