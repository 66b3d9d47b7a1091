import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import DHError, compare, read_chain, read_mapping, table_to_urdf
from dh_to_urdf.extraction.comparison_result import Verdict
from dh_to_urdf.table import JointType

ALPHA = [math.pi / 2, 0, 0, math.pi / 2, -math.pi / 2, 0]


def ur5(base=None, tool=None, offsets=(0,) * 6, signs=(1,) * 6, **changes):
    columns = {
        "a": [0, -0.42500, -0.39225, 0, 0, 0],
        "d": [0.089159, 0, 0, 0.10915, 0.09465, 0.0823],
        "alpha": list(ALPHA),
    }
    for name, value in changes.items():
        columns[name[:-1]][int(name[-1]) - 1] = value
    rows = [
        {
            "type": "R",
            "offset": offsets[k],
            "sign": signs[k],
            **{name: column[k] for name, column in columns.items()},
        }
        for k in range(6)
    ]
    document = {"convention": "dh", "joints": rows}
    document |= {key: value for key, value in (("base", base), ("tool", tool)) if value}
    return read_chain(table_to_urdf(read_mapping(document)))


def test_the_ur5_of_the_toolbox_is_three_tenths_of_a_millimetre_off():
    from robots.chains import chain_of_robot
    from robots.shipped import shipped_robot

    for name in ("ur5", "ur5_urdf"):
        found = compare(chain_of_robot(shipped_robot(name)), ur5(d1=0.089459))
        assert found.verdict is Verdict.EQUIVALENT
        (only,) = found.differences
        assert (only.joint, only.parameter, only.absorbed_by) == (1, "d", "base")
        assert only.difference == pytest.approx(0.0003, abs=1e-12)
        assert found.joints[0].position == pytest.approx(0.0003, abs=1e-9)
        assert found.residual.position <= 1e-12
        assert "0.0003 m" in found.words


@pytest.mark.parametrize(
    ("change", "joint", "parameter", "absorbed"),
    [
        ({"a2": -0.4251}, 2, "a", None),
        ({"a3": -0.39224}, 3, "a", None),
        ({"d4": 0.10916}, 4, "d", None),
        ({"d5": 0.09464}, 5, "d", None),
        ({"d6": 0.0825}, 6, "d", "tool"),
        ({"a6": 0.001}, 6, "a", "tool"),
        ({"a1": 0.001}, 1, "a", None),
        ({"alpha1": math.pi / 2 + 1e-5}, 1, "alpha", None),
        ({"alpha2": 1e-5}, 2, "alpha", None),
        ({"alpha5": -math.pi / 2 + 1e-5}, 5, "alpha", None),
    ],
)
def test_a_change_is_found_at_its_joint_and_parameter(change, joint, parameter, absorbed):
    plain = {"a2": -0.425, "d4": 0.10915}
    known = ur5()
    found = compare(known, ur5(**(plain | change)))
    first = found.differences[0]
    assert (first.joint, first.parameter, first.absorbed_by) == (joint, parameter, absorbed)
    value = next(iter(change.values()))
    reference = {
        "a": [0, -0.425, -0.39225, 0, 0, 0],
        "d": [0.089159, 0, 0, 0.10915, 0.09465, 0.0823],
        "alpha": ALPHA,
    }[parameter][joint - 1]
    assert abs(first.difference) == pytest.approx(abs(value - reference), rel=1e-6)
    assert found.verdict is (Verdict.EQUIVALENT if absorbed else Verdict.DIFFERENT)
    # Nothing diverges before that joint.
    assert all(frame.position < 1e-12 for frame in found.joints[: joint - 1])
    assert (found.residual.position > 1e-7 or found.residual.orientation > 1e-7) is (not absorbed)


@settings(deadline=None, max_examples=25)
@given(st.lists(st.floats(-3, 3), min_size=6, max_size=6), st.floats(-3, 3), st.floats(-1, 1))
def test_base_tool_and_zero_offsets_do_not_matter(offsets, angle, shift):
    base = {"xyz": [shift, 0.3, 0], "rpy": [angle, 0.2, 0.1]}
    tool = {"xyz": [0.1, shift, 0.2], "rpy": [0.1, angle, 0]}
    found = compare(ur5(), ur5(base=base, tool=tool, offsets=offsets))
    assert found.verdict in (Verdict.EQUIVALENT, Verdict.IDENTICAL)
    assert all(one.absorbed_by for one in found.differences)
    assert found.residual.position <= 1e-11
    assert found.residual.orientation <= 1e-11


@settings(deadline=None, max_examples=40)
@given(st.data())
def test_random_arms_equal_themselves_behind_other_bases_and_zeros(tables, data):
    table = data.draw(tables(trees=False))
    if table.dof == 0:
        return
    moved = replace(
        table,
        base=np.array([[0, -1, 0, 0.3], [1, 0, 0, 0.1], [0, 0, 1, -0.2], [0, 0, 0, 1.0]]),
        tool=np.array([[0, 0, 1, 0.1], [0, -1, 0, 0.4], [1, 0, 0, 0.2], [0, 0, 0, 1.0]]),
        rows=tuple(
            row
            if row.type is JointType.FIXED
            else replace(row, offset=row.offset + data.draw(st.floats(-1, 1)))
            for row in table.rows
        ),
    )
    found = compare(read_chain(table_to_urdf(table)), read_chain(table_to_urdf(moved)))
    assert found.verdict is not Verdict.DIFFERENT, found.words
    assert all(one.absorbed_by for one in found.differences)
    assert found.residual.position <= 1e-5
    assert found.residual.orientation <= 1e-5


SLIDING = (
    ("RPR", (-math.pi / 2, 1.88, -2.26), (0.615, 0, 0), (0, -0.74, 0.618)),
    ("RRP", (math.pi, 0, math.pi / 2), (0.135, 0.355, 0), (0.068, 0.876, -1.17)),
    ("RPR", (0, math.pi / 2, 0), (0.476, 0, 0), (0.738, 0, 0.864)),
    (
        "RRRPRPR",
        (2.88, 0, -1.75, -0.89, math.pi, 0, 0.3),
        (0.6, 0, 0, 0.8, 0.2, 0.5, 0),
        (0.7, 0, 0.5, 0.9, 0.3, 0, 0.3),
    ),
)


@pytest.mark.parametrize("arm", SLIDING)
def test_where_the_line_of_a_slide_runs_does_not_matter(arm):
    # The tool moves the origin that it is drawn through.
    def chain(offset, tool, change=0.0):
        rows = [
            {"type": t, "alpha": alpha, "a": a, ("d" if t == "R" else "theta"): b, "offset": offset}
            for t, alpha, a, b in zip(*arm, strict=True)
        ]
        rows[0]["alpha"] += change
        document = {
            "convention": "dh",
            "joints": rows,
            "tool": {"xyz": [0.1, tool, 0.2], "rpy": [0.4, tool, 1]},
        }
        return read_chain(table_to_urdf(read_mapping(document)))

    found = compare(chain(0, 0), chain(0.4, -0.9))
    assert found.verdict is Verdict.EQUIVALENT, found.words
    assert found.residual.position <= 1e-9
    assert all(one.absorbed_by for one in found.differences)
    assert compare(chain(0, 0), chain(0.4, -0.9, 0.01)).verdict is Verdict.DIFFERENT


def test_a_joint_that_runs_the_other_way_is_named():
    found = compare(ur5(), ur5(signs=(1, 1, -1, 1, 1, 1)))
    assert found.verdict is Verdict.DIFFERENT
    assert found.reversed == ("j3",)
    assert "runs the other way" in found.words


def test_other_kinds_or_numbers_of_joints_are_said():
    rows = [{"type": t, "alpha": 0.5, "a": 0.2, "d": 0.1, "theta": 0} for t in "RRR"]
    one = read_mapping({"convention": "dh", "joints": rows})
    slide = read_mapping({"convention": "dh", "joints": [*rows[:2], rows[2] | {"type": "P"}]})
    short = read_mapping({"convention": "dh", "joints": rows[:2]})
    chain = read_chain(table_to_urdf(one))
    found = compare(chain, read_chain(table_to_urdf(slide)))
    assert (found.differences[-1].joint, found.differences[-1].parameter) == (3, "type")
    found = compare(chain, read_chain(table_to_urdf(short)))
    assert (found.differences[-1].parameter, found.differences[-1].second) == ("joints", "2")
    assert found.verdict is Verdict.DIFFERENT


def test_a_tolerance_is_positive():
    with pytest.raises(DHError, match="length"):
        compare(ur5(), ur5(), length=0.0)


def test_the_same_arm_elsewhere_is_told_so():
    assert compare(ur5(), ur5()).words == "The same arm."
    for moved in (ur5(base={"xyz": [0.1, 0, 0], "rpy": [0, 0, 0]}), ur5(tool={"xyz": [0, 0, 0.1]})):
        found = compare(ur5(), moved)
        assert found.words != "The same arm."
        assert not found.same_poses
