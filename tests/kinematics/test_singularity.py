import numpy as np
import pytest

from kinematics.errors import UnknownTask
from kinematics.jacobian import jacobian
from kinematics.singularity import singularity_report
from kinematics.task import TASKS, task_from
from robots.shipped import shipped_robot


def test_a_stretched_planar_arm_is_singular_in_the_plane_only():
    robot, q = shipped_robot("planar_2r"), np.array([np.pi / 6, 0.0])
    planar = singularity_report(robot, q, TASKS["xy"])
    assert planar.rank == 1
    assert planar.singular
    assert planar.condition_number is None
    np.testing.assert_allclose(planar.lost_directions, [[np.sqrt(3) / 2, 0.5]], atol=1e-12)
    spatial = singularity_report(robot, q)
    assert spatial.rank == 2
    assert not spatial.singular
    assert any("choose a smaller task" in warning for warning in spatial.warnings)


@pytest.mark.parametrize("name", ["puma560", "pa10", "scara", "kinova", "planar_8r"])
@pytest.mark.parametrize("task", ["pose", "position", "xy", "xy_phi"])
def test_the_report_is_true_of_the_jacobian(name, task):
    robot = shipped_robot(name)
    rng = np.random.default_rng(0)
    for _ in range(10):
        q = rng.uniform(-1, 1, robot.dof)
        report = singularity_report(robot, q, TASKS[task])
        J = jacobian(robot, q)[list(TASKS[task].rows)]
        assert report.rank == np.linalg.matrix_rank(J, tol=1e-9)
        assert len(report.null_motions) == robot.dof - report.rank
        assert len(report.lost_directions) == len(J) - report.rank
        np.testing.assert_allclose(J @ report.null_motions.T, 0, atol=1e-9)
        np.testing.assert_allclose(report.lost_directions @ J, 0, atol=1e-9)
        if not report.singular and robot.dof >= len(J):
            w = np.sqrt(np.linalg.det(J @ J.T))
            assert report.manipulability == pytest.approx(w, rel=1e-7, abs=1e-12)


def test_masks_and_names_are_one_thing():
    assert task_from([1, 1, 0, 0, 0, 1]) is TASKS["xy_phi"]
    assert task_from([0, 0, 1, 1, 0, 0]).row_names == ("vz", "wx")
    for bad in ("poze", [1, 1], [0] * 6, [2, 0, 0, 0, 0, 0]):
        with pytest.raises(UnknownTask):
            task_from(bad)
