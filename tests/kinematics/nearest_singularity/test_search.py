"""Nearest singular configurations, against formulas and against scans."""

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.errors import WrongConfiguration
from kinematics.jacobian import jacobian
from kinematics.nearest_singularity import nearest_singularity
from kinematics.singularity import singularity_report
from kinematics.task import TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot


def sampled(robot, seed):
    low, high = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return np.random.default_rng(seed).uniform(low, high)


def is_singular(robot, q, task):
    return singularity_report(robot, q, TASKS[task]).singular


@pytest.mark.parametrize(
    ("name", "task"),
    [
        ("puma560", "pose"),
        ("ur5", "pose"),
        ("stanford", "pose"),
        ("pa10", "pose"),
        ("panda", "pose"),
        ("planar_3r", "xy"),
        ("planar_2r", "xy"),
        ("scara", "xyz_phi"),
        ("kinova", "pose"),
        ("talos_left_arm", "pose"),
        ("puma560", "position"),
        ("so101", "position"),
    ],
)
@pytest.mark.parametrize("seed", [0, 1])
def test_what_is_found_is_singular_and_within_the_limits(name, task, seed):
    robot = shipped_robot(name)
    q = sampled(robot, seed)
    found = nearest_singularity(robot, q, TASKS[task])
    distances = []
    for one in found.joints:
        assert (one.value is None) == (not one.values)
        for value in one.values:
            x = q.copy()
            x[one.column] = value
            assert is_singular(robot, x, task)
            assert robot.lower[one.column] <= value <= robot.upper[one.column]
        if one.value is not None:
            assert one.distance == min(abs(value - q[one.column]) for value in one.values)
            assert one.singular_value < 1e-10
            distances.append(one.distance)
    if found.q is not None:
        assert is_singular(robot, found.q, task)
        assert ((found.q >= robot.lower) & (found.q <= robot.upper)).all()
        assert found.distance == pytest.approx(np.linalg.norm(found.q - q), abs=1e-12)
        assert found.singular_value < 1e-10
    if distances:
        assert found.distance <= min(distances) + 1e-12


@pytest.mark.parametrize("name", ["puma560", "ur5", "stanford", "kr6_r900", "scara"])
def test_no_sign_change_of_the_determinant_is_missed(name):
    robot = shipped_robot(name)
    task = TASKS["xyz_phi" if name == "scara" else "pose"]
    q = sampled(robot, 5)
    for one in nearest_singularity(robot, q, task).joints:
        low = max(robot.lower[one.column], q[one.column] - 2 * np.pi)
        high = min(robot.upper[one.column], q[one.column] + 2 * np.pi)
        batch = np.repeat(q[None], 3000, axis=0)
        batch[:, one.column] = grid = np.linspace(low, high, 3000)
        values = np.linalg.det(jacobian(robot, batch)[:, list(task.rows)])
        noise = 1e-12 * np.abs(values).max()
        crossings = np.flatnonzero(
            (values[:-1] * values[1:] < 0) & (np.abs(values[:-1] - values[1:]) > noise)
        )
        if np.abs(values).max() < 1e-15 or np.ptp(values) < 1e-12:
            continue
        for k in crossings:
            assert any(grid[k] - 1e-6 <= value <= grid[k + 1] + 1e-6 for value in one.values)


def test_puma_by_its_formulas():
    robot = shipped_robot("puma560")
    q = np.array([0.1, 0.5, -1.2, 0.3, 0.6, 0.2])
    found = {one.column: one for one in nearest_singularity(robot, q).joints}
    assert found[4].values == (pytest.approx(0, abs=1e-14),)
    elbow = np.arctan2(-0.4318, 0.0203)
    assert found[2].value == pytest.approx(elbow, abs=1e-12)
    for column in (0, 3, 5):
        assert found[column].value is None
        assert found[column].distance is None


def test_two_joints_of_a_plane_arm_are_bent_together():
    """A 3R arm in xy is singular where both elbows are straight or folded."""
    robot = shipped_robot("planar_3r")
    for q in (np.array([0.3, 0.5, -0.4]), np.array([1.0, 2.9, 0.2]), np.array([0.1, -0.7, 3.0])):
        found = nearest_singularity(robot, q, TASKS["xy"])
        bends = np.array([min(abs(x), abs(abs(x) - np.pi)) for x in q[1:]])
        assert all(one.value is None for one in found.joints)
        assert found.distance == pytest.approx(np.linalg.norm(bends), abs=1e-6)


def test_limits_hold():
    """The elbow cannot be stretched but folded; or neither."""

    def arm(lower, upper):
        second = {
            "type": "R",
            "alpha": 0,
            "a": 0.8,
            "d": 0,
            "limits": {"lower": lower, "upper": upper},
        }
        joints = [{"type": "R", "alpha": 0, "a": 1, "d": 0}, second]
        return robot_from_table(
            read_mapping({"name": "arm", "convention": "standard", "joints": joints})
        )

    q, task = np.array([0.0, 0.5]), TASKS["xy"]
    folded = nearest_singularity(arm(0.1, 3.5), q, task)
    assert folded.joints[1].values == (pytest.approx(np.pi, abs=1e-12),)
    assert folded.q[1] == pytest.approx(np.pi, abs=1e-9)
    never = nearest_singularity(arm(0.1, 3.0), q, task)
    assert never.joints[1].value is None
    assert never.q is None
    turns = nearest_singularity(arm(-7, 7), q, task).joints[1]
    np.testing.assert_allclose(turns.values, np.pi * np.array([-1, 0, 1, 2]), atol=1e-12)
    at_the_limit = nearest_singularity(arm(0, 3.0), q, task)
    assert at_the_limit.joints[1].value == pytest.approx(0, abs=1e-12)
    assert at_the_limit.joints[1].value >= 0


def test_a_slide_through_the_shoulder():
    """Stanford-like: the wrist centre level with the shoulder, at a value of the slide."""
    robot = shipped_robot("stanford")
    q = np.array([0.2, 0.9, 0.5, 0.3, 0.6, 0.2])
    document = {
        "name": "free",
        "convention": "standard",
        "joints": [
            {
                "type": "P" if k == 2 else "R",
                "alpha": row.alpha,
                "a": row.a,
                "d": row.d,
                "theta": row.theta,
            }
            | ({"d": 0} if k == 2 else {"theta": 0})
            for k, row in enumerate(robot.table.rows)
        ],
    }
    free = robot_from_table(read_mapping(document))
    slide = next(one for one in nearest_singularity(free, q).joints if one.column == 2)
    assert slide.values
    for value in slide.values:
        assert is_singular(free, np.array([*q[:2], value, *q[3:]]), "pose")
    assert any(value == pytest.approx(0, abs=1e-6) for value in slide.values)


def test_a_singular_q_is_its_own_answer():
    robot = shipped_robot("puma560")
    q = np.array([0.1, 0.5, -1.2, 0.3, 0.0, 0.2])
    found = nearest_singularity(robot, q)
    assert found.singular
    assert found.distance == 0
    np.testing.assert_array_equal(found.q, q)


def test_what_cannot_be_singular_or_asked():
    robot = shipped_robot("planar_2r")
    found = nearest_singularity(robot, np.array([0.3, 0.7]))
    assert not found.singular
    assert found.q is None
    with pytest.raises(WrongConfiguration, match="batch"):
        nearest_singularity(robot, np.zeros((2, 2)))
    outside = shipped_robot("puma560")
    q = np.full(6, 3.5)
    found = nearest_singularity(outside, q)
    assert ((found.q >= outside.lower) & (found.q <= outside.upper)).all()
