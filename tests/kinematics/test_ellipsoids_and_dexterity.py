"""Ellipsoids, dexterity and words."""

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.dexterity import characteristic_length, dexterity
from kinematics.ellipsoids import ellipsoids
from kinematics.errors import InvalidOption
from kinematics.explanation import lost_direction_in_words, null_motion_in_words
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from kinematics.singularity import singularity_report
from kinematics.task import TASKS
from robots.robot import robot_from_table
from robots.shipped import shipped_robot


def scaled_puma(factor):
    document = {
        "name": "scaled",
        "convention": "standard",
        "joints": [
            {"type": "R", "alpha": alpha, "a": a * factor, "d": d * factor}
            for alpha, a, d in (
                ("pi/2", 0, 0.7),
                (0, 0.43, 0),
                ("-pi/2", 0.02, 0.15),
                ("pi/2", 0, 0.43),
                ("-pi/2", 0, 0),
                (0, 0, 0.1),
            )
        ],
    }
    return robot_from_table(read_mapping(document))


@pytest.mark.parametrize("name", ["puma560", "pa10", "scara", "planar_2r", "stanford"])
@pytest.mark.parametrize("task", ["pose", "position", "orientation", "xy_phi"])
def test_ellipsoids_hold_what_unit_joint_velocities_do(name, task):
    robot, task = shipped_robot(name), TASKS[task]
    q = np.full(robot.dof, 0.4)
    J = jacobian(robot, q)
    unit = np.random.default_rng(0).normal(size=(2000, robot.dof))
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    found = ellipsoids(J[list(task.rows)], task)
    for ellipsoid, rows, offset in zip(
        found, (task.positions, task.rotations), (0, 3), strict=True
    ):
        if not rows:
            assert ellipsoid is None
            continue
        block = np.zeros((3, robot.dof))
        block[list(rows)] = J[[row + offset for row in rows]]
        assert ellipsoid.axes.shape == (len(rows), 3)
        np.testing.assert_allclose(ellipsoid.axes @ ellipsoid.axes.T, np.eye(len(rows)), atol=1e-12)
        # The farthest along each axis is the semi-axis, and nothing is beyond the ellipsoid.
        np.testing.assert_allclose(
            np.linalg.norm(ellipsoid.axes @ block, axis=1), ellipsoid.velocity, atol=1e-12
        )
        along = unit @ (ellipsoid.axes @ block).T
        regular = np.isfinite(ellipsoid.force)
        inside = (along[:, regular] * ellipsoid.force[regular]) ** 2
        assert (inside.sum(axis=1) <= 1 + 1e-9).all()
        np.testing.assert_allclose(along[:, ~regular], 0, atol=1e-9)
        # The force at the end of a semi-axis takes torques of norm one.
        for axis, force in zip(ellipsoid.axes[regular], ellipsoid.force[regular], strict=True):
            assert np.linalg.norm(block.T @ axis * force) == pytest.approx(1, abs=1e-9)


def test_batches_of_ellipsoids():
    robot, task = shipped_robot("puma560"), TASKS["pose"]
    q = np.random.default_rng(1).uniform(-1, 1, (4, 6))
    J = jacobian(robot, q)
    many = ellipsoids(J, task)
    for k in range(4):
        for one, all_ in zip(ellipsoids(J[k], task), many, strict=True):
            np.testing.assert_allclose(all_.axes[k], one.axes, atol=1e-10)
            np.testing.assert_allclose(all_.velocity[k], one.velocity, atol=1e-12)


@pytest.mark.parametrize("name", ["puma560", "pa10", "planar_3r", "ur5"])
def test_characteristic_length_is_the_mean_lever(name):
    robot = shipped_robot(name)
    q = np.random.default_rng(2).uniform(-np.pi, np.pi, (60_000, robot.dof))
    mean = (jacobian(robot, q)[:, :3] ** 2).sum(axis=(1, 2)).mean() / robot.dof
    assert characteristic_length(robot) == pytest.approx(np.sqrt(mean), rel=5e-3)


def test_slides_spread_the_levers_over_their_extent():
    robot = shipped_robot("stanford")
    rng = np.random.default_rng(3)
    q = rng.uniform(-np.pi, np.pi, (60_000, 6))
    q[:, 2] = rng.uniform(robot.lower[2], robot.upper[2], 60_000)
    J = jacobian(robot, q)[:, :3][:, :, robot.is_revolute]
    mean = (J**2).sum(axis=(1, 2)).mean() / 5
    assert characteristic_length(robot) == pytest.approx(np.sqrt(mean), rel=5e-3)
    free = {
        "name": "free",
        "convention": "standard",
        "joints": [{"type": "P", "alpha": 0, "a": 1, "theta": 0}],
    }
    assert characteristic_length(robot_from_table(read_mapping(free))) == 1.0


def test_dexterity_does_not_depend_on_the_unit_of_length():
    q = np.array([0.1, 0.5, -1.1, 0.4, 0.9, 0.3])
    found = []
    for factor in (1.0, 1000.0):
        robot = scaled_puma(factor)
        length = characteristic_length(robot)
        found.append(dexterity(jacobian(robot, q), robot.is_revolute, TASKS["pose"], length))
    assert found[1].characteristic_length == pytest.approx(1000 * found[0].characteristic_length)
    assert found[1].condition_number == pytest.approx(found[0].condition_number, rel=1e-9)
    assert found[0].isotropy == pytest.approx(1 / found[0].condition_number)
    plain = [np.linalg.cond(jacobian(scaled_puma(factor), q)) for factor in (1.0, 1000.0)]
    assert plain[1] > 10 * plain[0]


def test_an_isotropic_posture():
    """Two links of 1 and sqrt(2)/2 bent by 135 degrees (Salisbury and Craig, 1982)."""
    joints = [{"type": "R", "alpha": 0, "a": a, "d": 0} for a in (1.0, np.sqrt(0.5))]
    document = {"name": "iso", "convention": "standard", "joints": joints}
    robot, task = robot_from_table(read_mapping(document)), TASKS["xy"]
    J = jacobian(robot, np.array([0.3, 3 * np.pi / 4]))[:2]
    found = dexterity(J, robot.is_revolute, task, 1.0)
    assert found.condition_number == pytest.approx(1, abs=1e-12)
    singular = dexterity(jacobian(robot, np.zeros(2))[:2], robot.is_revolute, task, 1.0)
    assert singular.condition_number == np.inf
    assert singular.isotropy == 0
    for length in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InvalidOption, match="characteristic_length"):
            dexterity(J, robot.is_revolute, task, length)


def test_words():
    robot = shipped_robot("puma560")
    q = np.deg2rad([10, 20, -100, 30, 0, 40])
    report, J = singularity_report(robot, q), jacobian(robot, q)
    text = null_motion_in_words(robot, report.null_motions[0], J)
    assert text == "joints j4 and j6 turn against each other and do nothing to the task"
    arm = shipped_robot("planar_2r")
    stretched = singularity_report(arm, np.array([0.0, 0.0]), TASKS["xy"])
    assert lost_direction_in_words(TASKS["xy"], stretched.lost_directions[0]) == (
        "the frame cannot move along (1, 0, 0)"
    )
    words = null_motion_in_words(arm, stretched.null_motions[0], jacobian(arm, np.zeros(2)))
    assert "as 1 : -2.25" in words
    scara = shipped_robot("scara")
    J = jacobian(scara, np.zeros(4))
    last = null_motion_in_words(scara, np.array([0, 0, 0, 1.0]), J)
    assert last == f"joint {scara.joints[3].name} turns alone and does nothing to the task"
    slide = null_motion_in_words(scara, np.array([0, 0, 1.0, 0]), J)
    assert "slides alone" in slide
    both = null_motion_in_words(scara, np.array([0, 0, 0.6, 0.8]), J)
    assert "move as 1 : 1.333" in both
    turning = lost_direction_in_words(TASKS["orientation"], np.array([0.0, 0.6, 0.8]))
    assert turning == "the frame cannot turn about (0, 0.6, 0.8)"
    for vector, expected in (
        ([0, 1, 0, 0, 0, 0], "move along (0, 1, 0)"),
        ([0, 0, 0, 0, 0, 1], "turn about (0, 0, 1)"),
        ([0.6, 0, 0, 0, 0, 0.8], "w = (0, 0, 0.8)"),
    ):
        assert expected in lost_direction_in_words(TASKS["pose"], np.array(vector, dtype=float))


def test_a_lost_direction_is_a_wrench_that_needs_no_torque():
    robot = shipped_robot("ur5")
    q = np.array([0.2, -1.0, 0.0, 0.3, 0.7, 0.1])
    report = singularity_report(robot, q)
    assert report.singular
    np.testing.assert_allclose(jacobian(robot, q).T @ report.lost_directions[0], 0, atol=1e-12)
    p = fk(robot, q)["tool"]
    assert np.isfinite(p).all()
