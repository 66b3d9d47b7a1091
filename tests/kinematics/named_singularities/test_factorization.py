"""Factors of determinants against the model, and what they mean."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dh_to_urdf import read_mapping
from kinematics.jacobian import jacobian
from kinematics.named_singularities import factorization
from kinematics.singularity import singularity_report
from kinematics.task import TASKS
from robots.robot import robot_from_table, robot_from_urdf
from robots.shipped import shipped_ids, shipped_robot

SIX = [
    "puma560",
    "rx90",
    "abb_irb140",
    "kr6_r900",
    "stanford",
    "z1",
    "b1_z1",
    "talos_left_arm",
    "ur3",
    "ur3e",
    "ur5",
    "ur5e",
    "ur10",
    "ur10e",
    "ur5_urdf",
    "ur10_urdf",
    "ur3_gripper",
]
OTHERS = [
    ("pa10", "pose"),
    ("iiwa14", "pose"),
    ("planar_2r", "xy"),
    ("planar_2r", "position"),
    ("planar_3r", "xy_phi"),
    ("planar_3r", "pose"),
    ("scara", "xyz_phi"),
    ("scara", "pose"),
    ("solo12", "position"),
    ("go1", "position"),
    ("finger_edu", "position"),
    ("asr_twodof", "xy"),
]


def sampled(robot, seed, n):
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return np.random.default_rng(seed).uniform(low, high, (n, robot.dof))


def moving_columns(robot, frame=None):
    from kinematics.chain import chain_of

    return chain_of(robot, frame or robot.tip_frame).columns


def check(robot, q, task, relative=1e-12):
    found = factorization(robot, q, TASKS[task])
    assert found.structure is not None, found.reason
    J = jacobian(robot, q)[:, list(TASKS[task].rows)][:, :, moving_columns(robot)]
    for k, one in enumerate(J):
        square = one.shape[0] == one.shape[1]
        expected = (
            np.linalg.det(one)
            if square
            else np.sqrt(np.linalg.det(one @ one.T if one.shape[0] < one.shape[1] else one.T @ one))
        )
        product = found.constant[k] * np.prod([factor.value[k] for factor in found.factors])
        product = product if square else abs(product)
        assert abs(product - expected) <= relative * max(abs(expected), 1e-3)
        assert found.product[k] == pytest.approx(product, rel=1e-13)
    for factor in found.factors:
        assert (np.abs(factor.value) <= factor.largest * (1 + 1e-9)).all(), factor.name
    assert np.ptp(found.constant) <= 1e-12 * np.abs(found.constant).max()
    assert found.exact.all()
    return found


@pytest.mark.parametrize("name", SIX)
def test_the_product_is_the_determinant(name):
    robot = shipped_robot(name)
    found = check(robot, sampled(robot, 1, 100), "pose")
    names = {factor.name for factor in found.factors}
    assert names == {"shoulder", "slide" if name == "stanford" else "elbow", "wrist"}


@pytest.mark.parametrize(("name", "task"), OTHERS)
def test_the_product_is_the_manipulability(name, task):
    robot = shipped_robot(name)
    check(robot, sampled(robot, 2, 40), task, 1e-9 if task == "pose" else 1e-11)


def test_every_shipped_arm_is_factored_truly_or_not_at_all():
    factored = set()
    for name in shipped_ids():
        robot = shipped_robot(name)
        q = sampled(robot, 3, 20)
        for task in ("pose", "position", "xy", "xy_phi", "orientation"):
            found = factorization(robot, q, TASKS[task])
            if found.structure is None:
                assert found.reason
                assert not found.factors
                continue
            factored.add((name, task))
            assert (found.difference <= 1e-7 * np.abs(found.product) + 1e-14).all()
    assert {(name, "pose") for name in SIX} <= factored
    # The file's angles are rounded: axes meet only nearly, and the answer says so.
    kinova = shipped_robot("kinova")
    found = factorization(kinova, sampled(kinova, 3, 20))
    assert not found.exact.all()
    assert factorization(shipped_robot("panda"), np.zeros(7)).structure is None


def test_puma_by_its_formulas():
    robot = shipped_robot("puma560")
    q = sampled(robot, 4, 50)
    a2, a3, d4 = 0.4318, 0.0203, 0.4318
    q2, q3, q5 = q[:, 1], q[:, 2], q[:, 4]
    shoulder, elbow, wrist = factorization(robot, q).factors
    expected = a2 * np.cos(q2) + a3 * np.cos(q2 + q3) - d4 * np.sin(q2 + q3)
    np.testing.assert_allclose(shoulder.value, expected, atol=1e-14)
    np.testing.assert_allclose(elbow.value, a3 * np.sin(q3) + d4 * np.cos(q3), atol=1e-14)
    np.testing.assert_allclose(wrist.value, np.sin(q5), atol=1e-14)
    np.testing.assert_allclose(elbow.largest, np.hypot(a3, d4), atol=1e-14)


@pytest.mark.parametrize("name", ["ur5", "ur10e"])
def test_ur_by_its_formulas(name):
    robot = shipped_robot(name)
    q = sampled(robot, 5, 50)
    shoulder, elbow, wrist = factorization(robot, q).factors
    a3 = abs(robot.table.rows[2].a)
    np.testing.assert_allclose(np.abs(elbow.value), np.abs(a3 * np.sin(q[:, 2])), atol=1e-13)
    np.testing.assert_allclose(np.abs(wrist.value), np.abs(np.sin(q[:, 4])), atol=1e-13)
    assert shoulder.unit == "m"


@pytest.mark.parametrize("name", ["puma560", "ur5", "abb_irb140"])
def test_where_one_factor_vanishes_the_arm_is_singular(name):
    """Each factor alone, by bisection along a joint that it depends on."""
    robot = shipped_robot(name)
    (q,) = sampled(robot, 6, 1)
    for index, joint in ((0, 1), (1, 2), (2, 4)):
        grid = np.repeat(q[None], 4001, axis=0)
        grid[:, joint] = np.linspace(-3.1, 3.0, 4001)
        values = factorization(robot, grid).factors[index].value
        change = np.flatnonzero(values[:-1] * values[1:] < 0)[0]
        low, high = grid[change].copy(), grid[change + 1].copy()
        for _ in range(60):
            middle = (low + high) / 2
            value = factorization(robot, middle).factors[index].value
            if value * factorization(robot, low).factors[index].value > 0:
                low = middle
            else:
                high = middle
        assert singularity_report(robot, low).singular
        others = [
            abs(f.normalised) for k, f in enumerate(factorization(robot, low).factors) if k != index
        ]
        assert min(others) > 1e-6


ANGLES = st.sampled_from([0.0, math.pi / 2, -math.pi / 2, 0.7, -2.0])
LENGTHS = st.sampled_from([0.0, 0.0, 0.3, -0.4, 1.2])


@st.composite
def wrist_partitioned(draw):
    """Any three joints, then a wrist; the tool and the zero positions anyhow."""
    joints = [
        {
            "type": draw(st.sampled_from("RRP")),
            "alpha": draw(ANGLES),
            "a": draw(LENGTHS),
            "d": draw(LENGTHS),
            "theta": 0,
        }
        for _ in range(3)
    ]
    for joint in joints:
        joint["theta" if joint["type"] == "P" else "offset"] = draw(ANGLES)
        if joint["type"] == "P":
            joint["d"] = 0
    joints += [
        {
            "type": "R",
            "alpha": draw(ANGLES),
            "a": 0,
            "d": draw(LENGTHS) if k == 0 else 0,
            "offset": draw(ANGLES),
            "sign": draw(st.sampled_from([1, -1])),
        }
        for k in range(3)
    ]
    tool = {"xyz": [draw(LENGTHS) for _ in range(3)], "rpy": [0.1, draw(ANGLES), 0.2]}
    document = {"name": "arm", "convention": "standard", "joints": joints, "tool": tool}
    return robot_from_table(read_mapping(document))


@settings(max_examples=150, deadline=None)
@given(wrist_partitioned(), st.integers(0, 10**6))
def test_random_arms_with_a_wrist(robot, seed):
    q = np.random.default_rng(seed).uniform(-3, 3, (5, robot.dof))
    found = factorization(robot, q)
    measured = np.linalg.det(jacobian(robot, q))
    if found.structure is None:
        centre_or_always_singular = np.abs(measured).max() < 1e-9
        flat_wrist = "no factors" in found.reason
        assert centre_or_always_singular or flat_wrist, found.reason
        return
    np.testing.assert_allclose(found.product, measured, rtol=1e-11, atol=1e-13)
    assert found.exact.all()


@settings(max_examples=80, deadline=None)
@given(
    st.lists(st.sampled_from([1, -1]), min_size=6, max_size=6),
    st.lists(st.floats(-2, 2), min_size=6, max_size=6),
    st.sampled_from([math.pi / 2, 0.6, 2.0]),
    st.sampled_from([0.0, 0.11]),
    st.integers(0, 10**6),
)
def test_random_arms_with_three_parallel_axes(signs, offsets, alpha, apart, seed):
    twists = [alpha, 0, 0, math.pi / 2, -alpha, 0]
    lengths = [0.05, -0.425, 0.39, 0, apart, 0]
    joints = [
        {"type": "R", "alpha": twist, "a": a, "d": 0.1, "sign": sign, "offset": offset}
        for twist, a, sign, offset in zip(twists, lengths, signs, offsets, strict=True)
    ]
    robot = robot_from_table(
        read_mapping({"name": "arm", "convention": "standard", "joints": joints})
    )
    q = np.random.default_rng(seed).uniform(-3, 3, (5, 6))
    found = factorization(robot, q)
    assert found.structure == "axes 2, 3 and 4 parallel"
    assert len(found.factors) == (2 if apart else 3)
    np.testing.assert_allclose(
        found.product, np.linalg.det(jacobian(robot, q)), rtol=1e-11, atol=1e-15
    )


def test_a_chain_seen_from_its_tip():
    """Base and tip exchanged, the first three axes meet instead of the last: told or not known."""
    text = shipped_robot("puma560").urdf
    robot = robot_from_urdf(text, base="tool", tip="base_link")
    q = sampled(shipped_robot("puma560"), 7, 5)
    found = factorization(robot, q)
    assert found.structure is None
    assert "no factors" in found.reason


def test_seven_joints_lose_a_direction_where_the_elbow_is_straight():
    robot = shipped_robot("pa10")
    q = np.array([0.3, 0.5, -0.2, 0.0, 0.4, 0.6, 0.1])
    elbow, rest = factorization(robot, q).factors
    assert elbow.value == pytest.approx(0, abs=1e-15)
    assert rest.value > 0.01
    assert singularity_report(robot, q).rank == 5
    q[3], q[1], q[2] = 0.7, 0.0, np.pi / 2
    elbow, rest = factorization(robot, q).factors
    assert abs(elbow.value) > 0.1
    assert rest.value == pytest.approx(singularity_report(robot, q).singular_values[-1], abs=1e-12)
