"""The construction on chains whose tables are known, and what it says of itself."""

import math

import numpy as np
import pytest

from dh_to_urdf import Convention, DHError, explain, extract, read_axes, read_mapping
from dh_to_urdf.extraction.axes import ChainJoint, SerialChain
from dh_to_urdf.extraction.extract import deviation
from dh_to_urdf.extraction.normals import Case
from dh_to_urdf.table import JointType

UR5 = {"d": [0.089159, 0, 0, 0.10915, 0.09465, 0.0823], "a": [0, -0.425, -0.39225, 0, 0, 0]}
UR5_ALPHA = [math.pi / 2, 0, 0, math.pi / 2, -math.pi / 2, 0]


def chain_of(elementary, table):
    """A table as a chain of placements, without the code under test."""
    joints, before = [], table.base
    for row in table.rows:
        joints.append(ChainJoint(row.name, row.type, before, np.array([0, 0, float(row.sign)])))
        before = elementary.link(Convention.STANDARD, row, 0.0)
    return SerialChain(table.name, "base", "tip", tuple(joints), before @ table.tool)


def axes(*joints, tip=None, types="RRRRRRR"):
    document = {
        "joints": [
            {"type": type_, "point": list(point), "direction": list(direction)}
            for (point, direction), type_ in zip(joints, types, strict=False)
        ]
    }
    return read_axes(document | ({"tip": tip} if tip else {}))


def test_the_published_table_of_the_ur5_comes_back(elementary):
    rows = [
        {"type": "R", "a": a, "alpha": alpha, "d": d}
        for a, alpha, d in zip(UR5["a"], UR5_ALPHA, UR5["d"], strict=True)
    ]
    published = read_mapping({"convention": "dh", "joints": rows})
    found = extract(chain_of(elementary, published), Convention.STANDARD).table
    np.testing.assert_allclose([row.d for row in found.rows], UR5["d"], atol=1e-14)
    # Each x may point the other way, which turns the signs of its a and alpha together.
    senses = [
        1 if row.alpha * alpha > 0 or row.a * a > 0 else -1
        for row, a, alpha in zip(found.rows, UR5["a"], UR5_ALPHA, strict=True)
    ]
    for row, a, alpha, sense in zip(found.rows, UR5["a"], UR5_ALPHA, senses, strict=True):
        assert row.a == pytest.approx(sense * a, abs=1e-14)
        assert row.alpha == pytest.approx(sense * alpha, abs=1e-14)
    np.testing.assert_array_equal(found.base, np.eye(4))
    np.testing.assert_array_equal(found.tool, np.eye(4))


def test_the_published_table_of_the_panda_comes_back_from_its_urdf():
    from robots.chains import chain_of_robot
    from robots.shipped import shipped_robot

    published = shipped_robot("panda").table
    chain = chain_of_robot(shipped_robot("panda_urdf"), tip="panda_link8")
    found = extract(chain, Convention.MODIFIED).table
    for row, known in zip(found.rows, published.rows, strict=True):
        for column in ("alpha", "a", "d", "offset"):
            assert getattr(row, column) == pytest.approx(getattr(known, column), abs=1e-14)
        assert (row.name, row.sign, row.limits) == (known.name, known.sign, known.limits)
    np.testing.assert_array_equal(found.base, np.eye(4))
    np.testing.assert_allclose(found.tool, published.tool, atol=1e-15)


@pytest.mark.parametrize(
    ("first", "second", "case", "feet"),
    [
        (
            ((0, 0, 5), (0, 0, 1)),
            ((0.3, 9, 0.2), (0, 2, 0)),
            Case.SKEW,
            ((0, 0, 0.2), (0.3, 0, 0.2)),
        ),
        (
            ((0, 0, 0), (0, 0, 1)),
            ((0, 4, 0.7), (0, -1, 0)),
            Case.INTERSECTING,
            ((0, 0, 0.7), (0, 0, 0.7)),
        ),
        (
            ((0, 0, 0), (0, 0, 1)),
            ((0.5, 0, 3), (0, 0, -1)),
            Case.PARALLEL,
            ((0, 0, 0), (0.5, 0, 0)),
        ),
        (((0, 0, 0), (0, 0, 1)), ((0, 0, 3), (0, 0, 1)), Case.COINCIDENT, ((0, 0, 0), (0, 0, 0))),
    ],
)
def test_every_case_is_named_and_its_feet_are_told(first, second, case, feet):
    found = extract(axes(first, second), Convention.STANDARD)
    _, step, _ = explain(found)
    assert step.case is case
    np.testing.assert_allclose(step.foot_on_first, feet[0], atol=1e-15)
    np.testing.assert_allclose(step.foot_on_second, feet[1], atol=1e-15)
    word = {Case.INTERSECTING: "intersect", Case.COINCIDENT: "coincident"}.get(case, case.value)
    assert word in step.words
    assert found.residual.position <= 1e-14
    row = found.table.rows[0]
    assert row.a == pytest.approx(math.dist(*feet), abs=1e-15)
    assert f"d_1 = {row.d:.6g} m" in step.words


def test_skew_axes_under_any_angle():
    direction = (0, math.sin(0.7), math.cos(0.7))
    found = extract(axes(((0, 0, 0), (0, 0, 1)), ((0.2, 0, 0.5), direction)), Convention.MODIFIED)
    second = found.table.rows[1]
    assert (second.a, second.alpha) == (pytest.approx(0.2), pytest.approx(-0.7))


def test_a_slide_is_drawn_through_the_next_origin():
    """Stanford: wherever the slide's point is given, its line runs through the wrist."""
    for point in ((0, 0.1, 0.4), (3.0, -2.0, 7.0)):
        found = extract(
            axes(
                ((0, 0, 0), (0, 0, 1)),
                ((0, 0, 0.4), (0, 1, 0)),
                (point, (0, 0, 1)),
                ((0, 0.15, 1), (0, 0, 1)),
                ((0, 0.15, 1), (0, 1, 0)),
                types="RRPRR",
            ),
            Convention.STANDARD,
        )
        slide, after = found.table.rows[2:4]
        assert (slide.a, after.a, after.d) == (0.0, 0.0, 0.0)
        assert slide.offset == pytest.approx(0.6)
        assert found.table.rows[1].d == pytest.approx(0.15)
        assert "slides" in explain(found)[3].words
        assert found.residual.position <= 1e-14


def test_no_negative_a_on_request():
    from robots.chains import chain_of_robot
    from robots.shipped import shipped_robot

    chain = chain_of_robot(shipped_robot("panda_urdf"))
    near = extract(chain, Convention.MODIFIED).table
    positive = extract(chain, Convention.MODIFIED, positive_a=True).table
    assert min(row.a for row in near.rows) < 0 <= min(row.a for row in positive.rows)
    offsets = [sum(abs(row.offset) for row in table.rows) for table in (near, positive)]
    assert offsets[0] < offsets[1]


def test_a_base_whose_z_is_not_axis_1_is_said_and_led_to():
    chain = axes(((0.1, 0, 0.3), (0, 1, 0)), ((0.1, 1, 0.8), (0, 1, 0)))
    found = extract(chain, Convention.STANDARD)
    np.testing.assert_allclose(found.table.base[:3, 2], [0, 1, 0])
    np.testing.assert_allclose(found.table.base[:3, 3], [0.1, 0, 0.3])
    assert "frame 0 is a new one" in explain(found)[0].words


def test_the_residual_is_what_is_measured():
    """An error put into a table shows in its residual to the digit."""
    from dataclasses import replace

    from dh_to_urdf.extraction.extract import measure

    chain = axes(((0, 0, 0), (0, 0, 1)), ((0.4, 0, 0), (0, 0, 1)), tip={"xyz": [0.8, 0, 0]})
    table = extract(chain, Convention.STANDARD).table
    rows = (replace(table.rows[0], a=table.rows[0].a + 1e-5), *table.rows[1:])
    assert measure(chain, replace(table, rows=rows)).position == pytest.approx(1e-5, rel=1e-6)
    rows = (replace(table.rows[0], offset=table.rows[0].offset + 2e-5), *table.rows[1:])
    assert measure(chain, replace(table, rows=rows)).orientation == pytest.approx(2e-5, rel=1e-6)


def test_deviation_of_half_a_turn_is_pi():
    assert deviation(np.eye(4), np.diag([1.0, -1.0, -1.0, 1.0]))[1] == pytest.approx(math.pi)


def test_names_that_no_table_can_hold_are_replaced():
    joint = ChainJoint("a/b\x07", JointType.REVOLUTE, np.eye(4), np.array([0.0, 0.0, 1.0]))
    other = ChainJoint("a_b_", JointType.REVOLUTE, np.eye(4), np.array([0.0, 1.0, 0.0]))
    chain = SerialChain("?", "b", "t", (joint, other), np.eye(4))
    table = extract(chain, Convention.KHALIL).table
    assert [row.name for row in table.rows] == ["a_b_", "a_b__"]
    assert len(table.warnings) == 2


@pytest.mark.parametrize("snap", [-1e-9, 0.2, math.nan])
def test_a_snap_out_of_range_is_refused(snap):
    with pytest.raises(DHError, match="snap"):
        extract(axes(((0, 0, 0), (0, 0, 1))), Convention.STANDARD, snap=snap)


def test_lengths_that_no_table_may_hold_are_refused():
    far = axes(((1e6, 1e6, 0), (1, -1, 1)), ((0, 0, -1e6), (0, 0, 1)))
    with pytest.raises(DHError, match="check the unit"):
        extract(far, Convention.STANDARD)
