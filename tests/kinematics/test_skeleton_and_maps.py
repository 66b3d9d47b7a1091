"""Skeletons, workspaces and maps agree with Jacobians and forward kinematics."""

import numpy as np
import pytest

from dh_to_urdf import read_json
from kinematics.chain import chain_of
from kinematics.errors import InvalidOption
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from kinematics.manipulability_map import manipulability_map
from kinematics.singularity import singularity_report
from kinematics.skeleton import skeleton_of
from kinematics.task import task_from
from kinematics.workspace import workspace
from robots.robot import robot_from_table
from robots.shipped import shipped_ids, shipped_robot

SLIDE = b"""{"name": "slide", "convention": "standard", "joints": [
  {"type": "R", "alpha": 0, "a": 1, "d": 0, "theta": 0},
  {"type": "P", "alpha": 0, "a": 0, "d": 0, "theta": 0}]}"""


@pytest.mark.parametrize("robot_id", shipped_ids())
def test_axes_of_every_shipped_robot_are_those_of_its_jacobian(robot_id):
    robot = shipped_robot(robot_id)
    q = np.random.default_rng(1).uniform(-1, 1, robot.dof)
    skeleton = skeleton_of(robot, q)
    J, p = jacobian(robot, q), fk(robot, q)[robot.tip_frame][:3, 3]
    if robot.coupled is not None:
        names = [joint.name for joint in robot.moving]
        columns = np.zeros((6, len(names)))
        for k in map(names.index, chain_of(robot, robot.tip_frame).names):
            axis, origin = skeleton.axes[k], skeleton.origins[k]
            turn = np.r_[np.cross(axis, p - origin), axis]
            columns[:, k] = turn if skeleton.is_revolute[k] else np.r_[axis, np.zeros(3)]
        assert np.abs(columns @ robot.coupled.matrix - J).max() < 1e-10
        return
    for k in np.flatnonzero(np.abs(J).max(axis=0) > 1e-12):
        axis, origin = skeleton.axes[k], skeleton.origins[k]
        if skeleton.is_revolute[k]:
            # Joints of the chain before the base frame turn it the other way.
            sign = np.sign(axis @ J[3:, k])
            assert np.abs(J[3:, k] - sign * axis).max() < 1e-12
            assert np.abs(J[:3, k] - sign * np.cross(axis, p - origin)).max() < 1e-10
        else:
            assert np.abs(np.abs(axis @ J[:3, k]) - 1).max() < 1e-12


@pytest.mark.parametrize("robot_id", ["puma560", "pa10", "panda", "scara", "planar_3r"])
def test_bones_of_a_table_are_its_lengths(robot_id):
    robot = shipped_robot(robot_id)
    q = np.full(robot.dof, 0.2)
    for bone, row in zip(skeleton_of(robot, q).bones[1:], robot.table.rows, strict=False):
        lengths = np.linalg.norm(np.diff(bone, axis=0), axis=1)
        slides = row.type == "prismatic"
        d = row.sign * 0.2 + row.offset if slides else row.d
        expected = [abs(d), abs(row.a)]
        if robot.table.convention != "standard":
            expected.reverse()
        assert lengths == pytest.approx(expected, abs=1e-12)


def test_bones_of_a_urdf_join_parent_and_child():
    robot = shipped_robot("panda_urdf" if "panda_urdf" in shipped_ids() else "iiwa14")
    skeleton = skeleton_of(robot, np.zeros(robot.dof))
    assert len(skeleton.bones) == len(robot.frames) - 1


def test_a_workspace_is_drawn_within_the_limits_and_again_the_same():
    robot = shipped_robot("planar_3r")
    cloud = workspace(robot, 5000, random_seed=3)
    again = workspace(robot, 5000, random_seed=3)
    assert np.array_equal(cloud.points, again.points)
    lengths = np.linalg.norm(cloud.points, axis=1)
    reach = sum(row.a for row in robot.table.rows) + robot.table.tool[0, 3]
    assert lengths.max() <= reach + 1e-12
    assert lengths.max() > 0.95 * reach
    assert np.array_equal(cloud.low, cloud.points.min(axis=0))


def test_a_slide_without_limits_is_refused():
    robot = robot_from_table(read_json(SLIDE))
    with pytest.raises(InvalidOption, match="slides without limits"):
        workspace(robot, 10)
    with pytest.raises(InvalidOption, match="slides without limits"):
        manipulability_map(robot, np.zeros(2), ("j1", "j2"), 10)


@pytest.mark.parametrize(("robot_id", "task"), [("planar_3r", "xy"), ("ur5", "pose")])
def test_a_map_is_the_report_at_each_point(robot_id, task):
    robot, task = shipped_robot(robot_id), task_from(task)
    names = [joint.name for joint in robot.joints]
    q = np.full(robot.dof, 0.4)
    found = manipulability_map(robot, q, (names[1], names[2]), 7, task)
    for row, column in ((0, 0), (2, 5), (6, 1)):
        at = q.copy()
        at[1], at[2] = found.x[column], found.y[row]
        report = singularity_report(robot, at, task)
        sigma = report.singular_values
        assert found.manipulability[row, column] == pytest.approx(report.manipulability, abs=1e-13)
        assert found.inverse_condition[row, column] == pytest.approx(sigma[-1] / sigma[0])


def test_a_map_over_one_joint_twice_or_none_is_refused():
    robot = shipped_robot("planar_3r")
    with pytest.raises(InvalidOption, match="one joint twice"):
        manipulability_map(robot, np.zeros(3), ("j1", "j1"), 5)
    with pytest.raises(InvalidOption, match="no joint 'elbow'"):
        manipulability_map(robot, np.zeros(3), ("elbow", "j1"), 5)
