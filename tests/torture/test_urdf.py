"""The short form of ``python -m tests.torture.urdf``, and the same by hypothesis."""

import random

import pytest
from hypothesis import given, note, settings
from hypothesis import strategies as st

from tests.torture.urdf import document, real_urdfs
from tests.torture.urdf_grammar import random_urdf
from tests.torture.urdf_mutations import mutate
from tests.torture.urdf_oracle import frames, judge


@pytest.mark.parametrize("hundred", range(4))
def test_mutated_urdfs_are_refused_or_computed_right(hundred):
    outcomes = [judge(*document(0, case)) for case in range(100 * hundred, 100 * hundred + 100)]
    assert {"refused", "accepted"} == set(outcomes)


@settings(max_examples=100, deadline=None)
@given(st.randoms())
def test_right_urdfs_are_read(chance):
    assert judge(random_urdf(chance).encode(), random.Random(0)) == "accepted"


@settings(max_examples=100, deadline=None)
@given(st.randoms())
def test_urdfs_with_something_wrong_are_refused_or_computed_right(chance):
    document = mutate(chance, random_urdf(chance, 3).encode())
    note(repr(document))
    judge(document, random.Random(0))


def test_every_real_urdf_is_accepted():
    assert len(real_urdfs()) > 30
    for text in real_urdfs():
        assert judge(text, random.Random(0)) == "accepted"


def test_cases_are_the_same_in_every_run():
    assert document(3, 7)[0] == document(3, 7)[0] != document(3, 8)[0]


ARM = """<robot name="arm"><link name="a"/><link name="b"/><link name="c"/>
<joint name="turn" type="revolute"><parent link="a"/><child link="b"/><axis xyz="1 1 0"/>
<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="mount" type="fixed"><parent link="b"/><child link="c"/><origin xyz="0 0 0.1"/></joint>
</robot>"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('xyz="1 1 0"', 'xyz="1 1 1e-7"'),
        ("0.1 0.2 0.3", "0.1 0.2 0.3000001"),
        ('upper="1"', 'upper="1.00001"'),
        ("0 0 0.1", "0 0 0.100001"),
        ('"c"', '"d"'),
        ('"turn"', '"tern"'),
        (
            "</robot>",
            '<link name="d"/><joint name="x" type="fixed"><parent link="b"/>'
            '<child link="d"/></joint></robot>',
        ),
        ('type="revolute"', 'type="prismatic"'),
    ],
)
def test_the_judge_sees_a_gate_that_lies(monkeypatch, old, new):
    from robots.robot import robot_from_urdf
    from tests.torture import urdf_oracle

    assert judge(ARM.encode(), random.Random(0)) == "accepted"
    told = ARM.replace(old, new)
    assert told != ARM
    monkeypatch.setattr(urdf_oracle, "robot_from_urdf", lambda *_, **__: robot_from_urdf(told))
    with pytest.raises((AssertionError, KeyError)):
        judge(ARM.encode(), random.Random(0))


def test_the_second_reading_knows_its_kinematics():
    from xml.etree import ElementTree as ET

    root = ET.fromstring(
        '<robot><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>'
        '<child link="b"/><origin xyz="1 2 3" rpy="0 0 1.5707963267948966"/><axis xyz="1 0 0"/>'
        "</joint></robot>"
    )
    T = frames(root, {"j": 1.5707963267948966})["b"]
    expected = [[0, 0, 1, 1], [1, 0, 0, 2], [0, 1, 0, 3], [0, 0, 0, 1]]
    assert abs(T - expected).max() < 1e-15
