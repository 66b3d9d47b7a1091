import pytest

from dh_to_urdf import DHError, JointType, read_chain
from dh_to_urdf.table import Mimic

LIMIT = '<limit lower="-1" upper="2" effort="3" velocity="4"/>'
URDF = f"""<robot name="tree"><link name="root"/><link name="a"/><link name="b"/><link name="c"/>
<joint name="one" type="revolute"><parent link="root"/><child link="a"/><axis xyz="0 0 2"/>{LIMIT}
</joint><joint name="two" type="fixed"><parent link="a"/><child link="b"/>
<origin xyz="0 0 1"/></joint>
<joint name="three" type="prismatic"><parent link="root"/><child link="c"/>
<mimic joint="one"/>{LIMIT}</joint></robot>"""


def test_a_chain_is_read_with_limits_types_and_folded_fixed_joints():
    chain = read_chain(URDF, tip="b")
    (joint,) = chain.joints
    assert (joint.name, joint.type, joint.limits.upper) == ("one", JointType.REVOLUTE, 2.0)
    assert (joint.limits.velocity, joint.limits.effort) == (4.0, 3.0)
    assert chain.tip_placement[2, 3] == 1.0
    assert joint.axis.tolist() == [0, 0, 1]


def test_defaults_are_the_root_and_the_longest_chain():
    chain = read_chain(URDF)
    assert (chain.base, chain.tip) == ("root", "b")


def test_up_one_branch_and_down_another():
    chain = read_chain(URDF, "b", "c")
    assert [joint.name for joint in chain.joints] == ["one", "three"]
    assert chain.joints[0].axis.tolist() == [0, 0, -1]
    assert chain.joints[1].mimic == Mimic("one")
    with pytest.raises(
        DHError, match="'three' depends on 'one', which is not between base and tip"
    ):
        read_chain(URDF, "root", "c")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("<robot", "<robo", "XML"),
        ('name="tree"', 'name="tree" <', "well-formed"),
        ('xyz="0 0 2"', 'xyz="0 0 0"', "its axis is zero"),
        ('xyz="0 0 2"', 'xyz="0 0 nan"', "finite"),
        ('xyz="0 0 2"', 'xyz="0 0"', "3 finite numbers"),
        ('type="revolute"', 'type="floating"', "'floating' has no D-H row"),
        ('child link="b"', 'child link="x"', "does not exist"),
        ('child link="c"', 'child link="a"', "child of two"),
        ('parent link="root"/><child link="a"', 'parent link="b"/><child link="a"', "loop"),
        ("</robot>", '<link name="other"/></robot>', "2 root links"),
        ('lower="-1"', 'lower="9"', "above the upper"),
        ("<link name=", "<!ENTITY><link name=", "entities"),
    ],
)
def test_a_bad_urdf_is_refused_with_the_reason(old, new, message):
    with pytest.raises(DHError, match=message):
        read_chain(URDF.replace(old, new), tip="b")


@pytest.mark.parametrize(
    ("base", "tip", "location"),
    [("x", None, ("base",)), (None, "y", ("tip",)), ("a", "b", ("tip",))],
)
def test_a_chain_that_is_none_is_refused(base, tip, location):
    with pytest.raises(DHError) as refused:
        read_chain(URDF, base, tip)
    assert refused.value.faults[0].location == location
