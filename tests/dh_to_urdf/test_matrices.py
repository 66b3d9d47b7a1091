import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import (
    Convention,
    DHRow,
    DHTable,
    JointType,
    dh_matrices,
    link_matrix,
    read_mapping,
)


def planar(*lengths):
    """Table 1 of the planar arms: modified, the last length in the tool."""
    rows = [{"type": "R", "alpha": 0, "a": a, "d": 0, "theta": 0} for a in (0, *lengths[:-1])]
    return read_mapping({"convention": "mdh", "tool": {"xyz": [lengths[-1], 0, 0]}, "joints": rows})


@settings(deadline=None, max_examples=60)
@given(st.data())
def test_every_matrix_is_the_product_of_its_elementary_ones(
    tables, configurations, elementary, data
):
    table = data.draw(tables())
    q = data.draw(configurations(table))
    matrices = dh_matrices(table, q)
    frames = elementary.frames(table, q)
    assert np.abs(matrices.T0 - frames[1:]).max() < 1e-13
    for k, row in enumerate(table.rows):
        A = np.linalg.inv(frames[row.parent]) @ frames[k + 1]
        assert np.abs(matrices.A[k] - A).max() < 1e-13
    tip = frames[table.tip_row]
    assert np.abs(matrices.T - table.base @ tip @ table.tool).max() < 1e-13


@settings(deadline=None, max_examples=30)
@given(st.data())
def test_a_batch_gives_what_its_configurations_give(tables, data):
    table = data.draw(tables())
    q = np.random.default_rng(0).uniform(-3, 3, (2, 5, table.dof))
    batch = dh_matrices(table, q)
    assert batch.A.shape == batch.T0.shape == (2, 5, len(table.rows), 4, 4)
    assert batch.T.shape == (2, 5, 4, 4)
    for place in np.ndindex(2, 5):
        single = dh_matrices(table, q[place])
        assert np.abs(batch.A[place] - single.A).max() < 1e-15
        assert np.abs(batch.T0[place] - single.T0).max() < 1e-14
        assert np.abs(batch.T[place] - single.T).max() < 1e-14


def test_an_empty_batch_is_empty():
    assert dh_matrices(planar(1, 1), np.zeros((0, 2))).T.shape == (0, 4, 4)


@pytest.mark.parametrize("q", [[], [1], [1, 2, 3], 1.0, [[1], [2]]])
def test_a_configuration_of_another_length_is_refused(q):
    with pytest.raises(ValueError, match="must hold 2 values"):
        dh_matrices(planar(1, 1), q)


ROW = DHRow("j", JointType.REVOLUTE, alpha=0.3, a=0.2, d=0.1, theta=0.0, parent=0)


@pytest.mark.parametrize("convention", list(Convention))
@pytest.mark.parametrize("type_", ["revolute", "continuous", "prismatic"])
def test_sign_and_offset_make_the_variable(convention, type_, elementary):
    row = replace(ROW, type=JointType(type_), sign=-1, offset=0.7)
    table = DHTable("r", convention, (row,))
    A = dh_matrices(table, [0.4]).A[0]
    assert np.array_equal(A, link_matrix(row, convention, -0.4 + 0.7))
    plain = replace(row, sign=1, offset=0.0)
    assert np.abs(A - elementary.link(convention, plain, 0.3)).max() < 1e-15


@pytest.mark.parametrize("convention", list(Convention))
def test_a_fixed_row_takes_no_variable(convention, elementary):
    fixed = replace(ROW, type=JointType.FIXED, theta=0.5)
    table = DHTable("r", convention, (fixed, replace(ROW, parent=1)))
    assert table.dof == 1
    A = dh_matrices(table, [0.4]).A
    as_revolute = elementary.link(convention, replace(ROW, offset=0.5), 0.0)
    assert np.abs(A[0] - as_revolute).max() < 1e-15
    assert np.abs(A[1] - elementary.link(convention, ROW, 0.4)).max() < 1e-15


def test_khalil_without_branches_is_modified():
    rng = np.random.default_rng(1)
    rows = tuple(
        replace(ROW, alpha=alpha, a=a, d=d, parent=k)
        for k, (alpha, a, d) in enumerate(rng.uniform(-1, 1, (5, 3)))
    )
    q = rng.uniform(-3, 3, 5)
    modified, khalil = (DHTable("r", c, rows) for c in (Convention.MODIFIED, Convention.KHALIL))
    assert np.array_equal(dh_matrices(modified, q).T0, dh_matrices(khalil, q).T0)


def test_a_tree_branches_at_its_antecedents(elementary):
    rows = tuple(
        replace(ROW, parent=parent, gamma=0.1 * k, b=0.2 * k)
        for k, parent in enumerate((0, 1, 1, 3, 4, 2))
    )
    table = DHTable("tree", Convention.KHALIL, rows)
    q = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
    A = [elementary.link(Convention.KHALIL, row, value) for row, value in zip(rows, q, strict=True)]
    T0 = dh_matrices(table, q).T0
    assert np.abs(T0[4] - A[0] @ A[2] @ A[3] @ A[4]).max() < 1e-15
    assert np.abs(T0[5] - A[0] @ A[1] @ A[5]).max() < 1e-15
    assert table.tip_row == 5


def test_the_tool_of_a_tree_is_on_the_leaf_with_most_moving_joints():
    fixed = replace(ROW, type=JointType.FIXED)
    parents = (0, 1, 1, 3, 4)
    rows = tuple(
        replace(ROW if k < 2 else fixed, parent=parent) for k, parent in enumerate(parents)
    )
    assert DHTable("r", Convention.KHALIL, rows).tip_row == 2
    same_depth = tuple(replace(ROW, parent=parent) for parent in (0, 1, 1))
    assert DHTable("r", Convention.KHALIL, same_depth).tip_row == 3


def test_reference_robots_agree_frame_by_frame(oracle_documents):
    worst = 0.0
    for robot, document in oracle_documents:
        table = read_mapping(document)
        for config in robot["configs"]:
            matrices = dh_matrices(table, config["q"])
            frames = np.array([table.base, *(table.base @ T for T in matrices.T0)])
            worst = max(worst, np.abs(frames - config["fkine_all"]).max())
            worst = max(worst, np.abs(matrices.T - config["fkine"]).max())
    assert worst < 1e-12


def test_reference_robots_agree_as_one_batch(oracle_documents):
    for robot, document in oracle_documents:
        q = [config["q"] for config in robot["configs"]]
        expected = [config["fkine"] for config in robot["configs"]]
        assert np.abs(dh_matrices(read_mapping(document), q).T - expected).max() < 1e-12


def exercise(exercises, number):
    return next(value["value"] for key, value in exercises.items() if key.startswith(f"{number}_"))


def test_exercise_1_the_matrix_of_one_link(exercises):
    row = replace(ROW, d=0.2, a=0.4, alpha=math.pi / 2)
    A = link_matrix(row, Convention.STANDARD, math.radians(30))
    assert np.abs(A - exercise(exercises, "E1")).max() < 1e-9


def test_exercise_2_the_position_of_a_2r(exercises):
    T = dh_matrices(planar(1, 0.8), np.radians([30, 45])).T
    assert np.abs(T[:2, 3] - exercise(exercises, "E2")).max() < 1e-9


def test_exercise_6_the_posture_of_a_3r(exercises):
    T = dh_matrices(planar(0.5, 0.4, 0.3), np.radians([30, -45, 60])).T
    found = (T[0, 3], T[1, 3], math.atan2(T[1, 0], T[0, 0]))
    assert np.abs(np.subtract(found, exercise(exercises, "E6"))).max() < 1e-9


def test_exercise_10_the_position_of_a_pa10(exercises):
    alphas, lengths = (0, -90, 90, -90, 90, -90, 90), (0, 0, 0.45, 0, 0.48, 0, 0)
    rows = [
        {"sigma": 0, "alpha": alpha, "d": 0, "theta": 0, "r": r}
        for alpha, r in zip(alphas, lengths, strict=True)
    ]
    table = read_mapping({"convention": "khalil", "units": {"angle": "deg"}, "joints": rows})
    T = dh_matrices(table, np.radians([10, 20, 30, 40, 50, 60, 70])).T
    assert np.abs(T[:3, 3] - exercise(exercises, "E10")).max() < 1e-12


def test_exercise_13_the_puma_in_its_nominal_configuration(exercises):
    rows = [
        {"type": "R", "theta": 0, "d": d, "a": a, "alpha": alpha}
        for d, a, alpha in (
            (0, 0, 90),
            (0, 0.4318, 0),
            (0.15005, 0.0203, -90),
            (0.4318, 0, 90),
            (0, 0, -90),
            (0, 0, 0),
        )
    ]
    table = read_mapping({"convention": "dh", "units": {"angle": "deg"}, "joints": rows})
    T = dh_matrices(table, np.radians([0, 45, 180, 0, 45, 0])).T
    assert np.abs(T - exercise(exercises, "E13")).max() < 1e-9
