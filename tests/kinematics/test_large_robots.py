"""Robots with more joints than Pinocchio's memory is made for: computed chain by chain."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from kinematics.forward import fk, poses
from kinematics.inverse.api import solve_ik
from kinematics.jacobian import ReferenceFrame, jacobian
from kinematics.skeleton import skeleton_of
from robots.robot import robot_from_urdf
from tests.torture.large_urdfs import tree

ROOT = Path(__file__).parents[2]
TEXT = tree(81, lambda k: max(0, k - 5), moving=80)
"""Five chains of 16 joints from one palm: few enough for Pinocchio to compare with."""


@pytest.fixture(scope="module", params=[None, "l17"])
def hand(request):
    return robot_from_urdf(TEXT, base=request.param)


def expected_of(robot, q):
    """Poses and Jacobians of frames against the base, by Pinocchio alone."""
    model = pin.buildModelFromXML(TEXT)
    data = model.createData()
    order = [model.joints[model.getJointId(joint.name)].idx_v for joint in robot.joints]
    configuration = np.empty(model.nq)
    configuration[order] = q
    pin.computeJointJacobians(model, data, configuration)
    pin.updateFramePlacements(model, data)
    base = model.getFrameId(robot.base_frame, pin.FrameType.BODY)
    J_base = pin.getFrameJacobian(model, data, base, pin.LOCAL)[:, order]

    def frame(name):
        number = model.getFrameId(name, pin.FrameType.BODY)
        T = data.oMf[base].actInv(data.oMf[number])
        J = pin.getFrameJacobian(model, data, number, pin.LOCAL)[:, order]
        return T.homogeneous, J - T.inverse().action @ J_base

    return frame


def test_poses_and_jacobians_are_those_of_pinocchio(hand):
    assert hand.dof == 80
    assert hand.is_large
    q = np.random.default_rng(1).uniform(-1, 1, 80)
    expected = expected_of(hand, q)
    found, numbers = fk(hand, q, hand.frames), poses(hand, q, hand.frames)
    for name in hand.frames:
        T, J = expected(name)
        np.testing.assert_allclose(found[name], T, rtol=0, atol=1e-12)
        np.testing.assert_allclose(numbers[name].matrix, T, rtol=0, atol=1e-12)
        J_found = jacobian(hand, q, name, ReferenceFrame.LOCAL)
        np.testing.assert_allclose(J_found, J, rtol=0, atol=1e-11)


def test_inverse_kinematics_moves_the_chain_that_is_asked_for(hand):
    q = np.random.default_rng(2).uniform(-0.5, 0.5, 80)
    target = fk(hand, q, ["l80"])["l80"]
    seed = q + np.random.default_rng(3).uniform(-0.05, 0.05, 80)
    found = solve_ik(hand, target, frame="l80", seed=seed)
    reached = fk(hand, np.asarray(found.q).reshape(-1, 80)[0], ["l80"])["l80"]
    np.testing.assert_allclose(reached, target, rtol=0, atol=1e-5)


def test_a_picture_has_every_joint(hand):
    assert skeleton_of(hand, np.zeros(80)).axes.shape == (80, 3)


MEMORY = """
import resource
import numpy as np
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from kinematics.skeleton import skeleton_of
from robots.robot import robot_from_urdf
from tests.torture.large_urdfs import tree

def use(text):
    robot = robot_from_urdf(text)
    q = np.zeros(robot.dof)
    fk(robot, q, robot.frames)
    jacobian(robot, q)
    skeleton_of(robot, q)

use(tree(11, lambda k: k - 1, moving=10))
use(tree(71, lambda k: max(0, k - 5), moving=70))
started = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
use(tree(201, lambda k: max(0, k - 5), moving=200))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - started)
"""


def test_two_hundred_joints_take_little_memory():
    command = [sys.executable, "-c", MEMORY]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert int(done.stdout) < 20_000
