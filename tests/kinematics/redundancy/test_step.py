"""The differential step and strict priorities, against the KKT conditions."""

import numpy as np
import pytest

from kinematics.errors import InvalidOption, RankDeficient, WrongConfiguration
from kinematics.redundancy.priority import prioritized_step
from kinematics.redundancy.step import StepTask, differential_step
from kinematics.task import task_from
from robots.shipped import shipped_robot

XY, POSE = task_from("xy"), task_from("pose")
Q3 = np.deg2rad([30, -45, 60])


def test_the_step_of_the_course(exercises):
    found = differential_step(shipped_robot("planar_3r"), Q3, StepTask(np.array([0.01, 0]), XY))
    expected = next(e["value"] for k, e in exercises.items() if k.startswith("E7_"))
    np.testing.assert_allclose(found.delta_q, expected["dq"], atol=1e-11)
    np.testing.assert_allclose(found.J, expected["J"], atol=1e-9)
    projector = next(e["value"] for k, e in exercises.items() if k.startswith("E8_"))
    np.testing.assert_allclose(found.N, np.outer(projector["n"], projector["n"]), atol=1e-8)


@pytest.mark.parametrize("name", ["planar_8r", "pa10", "panda"])
def test_the_projector_is_one(name):
    robot, rng = shipped_robot(name), np.random.default_rng(1)
    task = XY if name == "planar_8r" else POSE
    for q in rng.uniform(-1, 1, (20, robot.dof)):
        dx, z = rng.normal(size=len(task.rows)), rng.normal(size=robot.dof)
        found = differential_step(robot, q, StepTask(dx, task), z=z)
        N, J = found.N, found.J
        np.testing.assert_allclose(N @ N, N, atol=1e-12)
        np.testing.assert_allclose(N, N.T, atol=1e-15)
        np.testing.assert_allclose(J @ N, 0, atol=1e-12)
        np.testing.assert_allclose(N, np.eye(robot.dof) - found.J_pinv @ J, atol=1e-10)
        np.testing.assert_allclose(found.achieved, dx, atol=1e-10)
        np.testing.assert_allclose(found.null_motion, N @ z, atol=1e-15)
        np.testing.assert_allclose(J.T @ np.linalg.inv(J @ J.T), found.J_pinv, atol=1e-8)


def test_lost_rank_is_refused_with_its_rank_and_damping_is_not():
    robot, ask = shipped_robot("planar_3r"), StepTask(np.array([-0.01, 0.02]), XY)
    with pytest.raises(RankDeficient, match=r"rank\(J\) = 1 < 2.*damping") as caught:
        differential_step(robot, np.zeros(3), ask)
    assert (caught.value.rank, caught.value.wanted) == (1, 2)
    found = differential_step(robot, np.zeros(3), ask, damping=0.1)
    J = found.J
    expected = J.T @ np.linalg.solve(J @ J.T + 0.01 * np.eye(2), ask.delta_x)
    np.testing.assert_allclose(found.delta_q, expected, atol=1e-14)
    with pytest.raises(RankDeficient, match="another"):
        differential_step(robot, Q3, StepTask(np.zeros(6), POSE))
    with pytest.raises(WrongConfiguration, match="2 rows"):
        differential_step(robot, Q3, StepTask(np.zeros(3), XY))
    with pytest.raises(InvalidOption):
        differential_step(robot, Q3, ask, z=Q3, secondary=[ask])


def kkt(tasks, n):
    """Lexicographic least squares, each level as the KKT system of an equality-constrained one."""
    rows, values = np.zeros((0, n)), np.zeros(0)
    for J, e in tasks:
        m = len(rows)
        # min ‖J q − e‖² s.t. rows q = values; the pseudo-inverse gives the least q of all
        K = np.block([[J.T @ J, rows.T], [rows, np.zeros((m, m))]])
        q = (np.linalg.pinv(K, rcond=1e-11) @ np.r_[J.T @ e, values])[:n]
        rows, values = np.vstack((rows, J)), np.r_[values, J @ q]
    return np.linalg.lstsq(rows, values, rcond=1e-11)[0]


@pytest.mark.parametrize("sizes", [(2, 3), (3, 3, 2), (2, 8), (2, 4, 6)])
def test_strict_priority_is_the_kkt_solution(sizes):
    rng, n = np.random.default_rng(sum(sizes)), 8
    for _ in range(20):
        tasks = [(rng.normal(size=(m, n)), rng.normal(size=m)) for m in sizes]
        q, free = prioritized_step(tasks, n)
        np.testing.assert_allclose(q, kkt(tasks, n), atol=1e-8)
        J, e = tasks[0]
        np.testing.assert_allclose(J @ q, e, atol=1e-12)
        np.testing.assert_allclose(J @ free, 0, atol=1e-12)
        alone, _ = prioritized_step(tasks[:1], n)
        np.testing.assert_allclose(alone, np.linalg.pinv(J) @ e, atol=1e-12)


def test_a_secondary_step_leaves_the_first_alone():
    robot = shipped_robot("planar_8r")
    q = np.linspace(0.2, -0.5, 8)
    first = StepTask(np.array([0.01, -0.02]), XY)
    elbow = StepTask(np.array([0.005, 0.003]), XY, "frame_4")
    found = differential_step(robot, q, first, secondary=[elbow])
    np.testing.assert_allclose(found.residuals[0], 0, atol=1e-12)
    np.testing.assert_allclose(found.residuals[1], 0, atol=1e-12)
    clash = differential_step(robot, q, first, secondary=[StepTask(-first.delta_x, XY)])
    np.testing.assert_allclose(clash.residuals[0], 0, atol=1e-12)
    np.testing.assert_allclose(clash.residuals[1], -2 * first.delta_x, atol=1e-12)
