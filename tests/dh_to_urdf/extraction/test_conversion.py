"""Standard <-> modified <-> khalil: the same kinematics and the same bodies, trees by their tip."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import Convention, DHError, read_mapping, to_convention

TREE = {
    "convention": "khalil",
    "tool": {"xyz": [0, 0, 0.1]},
    "joints": [
        {"name": "trunk", "type": "R", "alpha": 0, "d": 0, "r": 0.5},
        {"name": "left", "type": "R", "alpha": 1, "d": 0.1, "r": 0, "gamma": 0.4, "b": 0.2},
        {"name": "left_hand", "type": "P", "alpha": 0.5, "d": 0.3, "theta": 0.3},
        {
            "name": "right",
            "type": "R",
            "alpha": -1,
            "d": 0.1,
            "r": 0,
            "ant": 1,
            "gamma": -0.4,
            "limits": {"lower": -1, "upper": 2},
        },
    ],
}


def bodies(elementary, table, q):
    """Centres of mass and inertias of all bodies in base axes."""
    found = []
    for frame, row in zip(elementary.frames(table, q)[1:], table.rows, strict=True):
        if row.inertial is not None:
            T = table.base @ frame
            com = T @ [*row.inertial.com, 1.0]
            inertia = T[:3, :3] @ np.array(row.inertial.inertia) @ T[:3, :3].T
            found.append((row.inertial.mass, com[:3], inertia))
    return found


@settings(deadline=None, max_examples=40)
@given(st.data())
def test_fk_bodies_and_limits_survive_any_way_round(elementary, tables, configurations, data):
    table = data.draw(tables(trees=False, inertials=data.draw(st.booleans())))
    if table.convention is Convention.KHALIL:
        # A chain may still have γ and b.
        rows = [
            replace(row, gamma=data.draw(st.sampled_from([0.0, 0.7])), b=0.2 * k)
            for k, row in enumerate(table.rows)
        ]
        table = replace(table, rows=tuple(rows))
    q = data.draw(configurations(table))
    expected = elementary.tip(table, q)
    others = [other for other in Convention if other is not table.convention]
    for convention in (*others, table.convention, *reversed(others)):
        before, table = table, to_convention(table, convention)
        assert table.convention is convention
        np.testing.assert_allclose(elementary.tip(table, q), expected, atol=1e-12, rtol=0)
        for (m, com, inertia), (m2, com2, inertia2) in zip(
            bodies(elementary, before, q), bodies(elementary, table, q), strict=True
        ):
            assert m == m2
            np.testing.assert_allclose(com, com2, atol=1e-11, rtol=0)
            np.testing.assert_allclose(inertia, inertia2, atol=1e-11, rtol=0)
        kept = [(r.name, r.type, r.sign, r.limits) for r in before.rows]
        assert kept == [(r.name, r.type, r.sign, r.limits) for r in table.rows]


@settings(deadline=None, max_examples=30)
@given(st.data())
def test_standard_comes_back_from_modified_bit_for_bit(tables, data):
    table = data.draw(tables(conventions=(Convention.STANDARD,), trees=False))
    table = replace(table, tool=np.eye(4), base=np.eye(4))
    there = to_convention(table, Convention.MODIFIED)
    back = to_convention(there, Convention.STANDARD)
    for row, again in zip(table.rows, back.rows, strict=True):
        for column in ("a", "d", "theta", "offset"):
            assert getattr(again, column) == getattr(row, column)
        assert again.alpha == pytest.approx(row.alpha, abs=1e-15)
    np.testing.assert_allclose(back.tool, np.eye(4), atol=0)


def test_a_tree_is_cut_down_to_the_chain_to_a_tip(elementary):
    tree = read_mapping(TREE)
    with pytest.raises(DHError, match="tree") as refused:
        to_convention(tree, Convention.STANDARD)
    assert refused.value.faults[0].location == ("tip",)
    assert "left_hand" in str(refused.value)
    assert "right" in str(refused.value)
    q = [0.3, -0.5, 0.2, 0.9]
    frames = elementary.frames(tree, q)
    for tip, own, expected in (
        ("left_hand", q[:3], frames[3] @ tree.tool),
        ("right", [q[0], q[3]], frames[4]),
        ("frame_2", q[:2], frames[2]),
    ):
        chain = to_convention(tree, Convention.STANDARD, tip)
        np.testing.assert_allclose(elementary.tip(chain, own), expected, atol=1e-14)
    assert to_convention(tree, Convention.KHALIL) is tree
    with pytest.raises(DHError, match="name a joint"):
        to_convention(tree, Convention.MODIFIED, "nobody")
