"""What forbids a target: each kind on arms where it is known, with its size."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.forward import fk
from kinematics.inverse import IKOptions
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.forbidden import Forbids
from kinematics.inverse.unreached import why_unreached
from kinematics.task import POSE, TASKS
from robots.shipped import shipped_robot
from tests.kinematics.inverse.test_self_motion import IIWA, TIGHT, robot_of


def why(robot, target, task=POSE, **options):
    return why_unreached(robot, target, task=task, options=IKOptions(), **options).forbidden


def test_too_far_is_the_position_by_the_rest_of_the_way():
    robot, target = shipped_robot("planar_2r"), np.eye(4)
    target[0, 3] = 5.0
    reach = np.linalg.norm(fk(robot, np.zeros(2))[robot.tip_frame][:2, 3])
    found = why(robot, target, TASKS["xy"])
    assert (found.by, found.proven) == (Forbids.POSITION, True)
    assert found.position_miss == pytest.approx(5.0 - reach)


def test_a_plane_forbids_a_tilt_by_its_angle():
    robot, q = shipped_robot("planar_3r"), np.array([0.3, 0.5, -0.4])
    target = fk(robot, q)[robot.tip_frame]
    c, s = np.cos(0.25), np.sin(0.25)
    target[:3, :3] = np.array([[1, 0, 0], [0, c, -s], [0, s, c]]) @ target[:3, :3]
    found = why(robot, target)
    assert (found.by, found.proven) == (Forbids.ORIENTATION, True)
    assert found.orientation_miss == pytest.approx(0.25, abs=1e-9)


def test_limits_name_the_joint_of_each_branch_and_its_excess():
    robot = shipped_robot("puma560")
    rng, found = np.random.default_rng(1), None
    while found is None:
        q = rng.uniform(robot.lower, robot.upper)
        q[0] = robot.upper[0] + 0.15
        found = why(robot, fk(robot, q)[robot.tip_frame])
    assert (found.by, found.proven) == (Forbids.LIMITS, True)
    assert len({one.posture for one in found.branches}) == len(found.branches)
    for one in found.branches:
        assert one.joints
        for joint in one.joints:
            k = [each.name for each in robot.joints].index(joint.joint)
            assert joint.value == one.q[k]
            assert joint.limit in (robot.lower[k], robot.upper[k])
            assert joint.excess == pytest.approx(abs(joint.value - joint.limit))
    own = [one for one in found.branches if np.abs(one.q - q).max() < 1e-6]
    assert own
    assert own[0].joints[0].excess == pytest.approx(0.15, abs=1e-6)


def test_limits_of_an_arm_with_a_swivel_are_proved():
    robot = robot_of(*IIWA, TIGHT)
    q = np.array([1.4, 0.6, 0.1, -1.1, 0.3, 0.8, 0.1])
    target = fk(robot, q)[robot.tip_frame]
    solutions = all_solutions(robot, target)
    assert not solutions.self_motion.curves
    found = why(robot, target, found=solutions)
    assert (found.by, found.proven) == (Forbids.LIMITS, True)
    assert found.branches


def test_an_orientation_at_the_edge_of_reach_is_missed_by_what_a_search_found():
    robot = shipped_robot("ur5")
    q = np.array([0.2, -1.0, 0.02, -0.5, 1.2, 0.3])
    target = fk(robot, q)[robot.tip_frame]
    target[:2, 3] *= 1.02
    found = why(robot, target)
    if found.by is Forbids.ORIENTATION:
        assert 0.0 < found.orientation_miss < np.pi
    else:
        assert found.by is Forbids.POSITION
        assert found.position_miss > 0.0


def test_a_miss_is_no_more_than_that_of_what_is_reached():
    robot, target = shipped_robot("kinova"), np.eye(4)
    target[:3] = [
        [0.22602006100851724, 0.9737143999273007, -0.02819928006037917, 0.00043351449144485993],
        [-0.9227364558682165, 0.20472955423214145, -0.32656276982484184, -0.06751177572848224],
        [-0.31220564542216406, 0.09983024089987055, 0.9447547607545591, 1.2569340563561557],
    ]
    told = why_unreached(robot, target, task=POSE, options=IKOptions())
    best = told.reachable[0]
    assert told.forbidden.by is Forbids.ORIENTATION
    assert best.position_error < 1e-9
    assert told.forbidden.orientation_miss <= best.orientation_error
    degrees = f"{np.rad2deg(told.forbidden.orientation_miss):.6g}°"
    assert any(degrees in str(one) for one in told.sentences)
