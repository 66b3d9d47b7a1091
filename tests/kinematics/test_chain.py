import numpy as np
import pytest

from kinematics.chain import chain_of
from kinematics.forward import fk
from robots.robot import robot_from_urdf
from robots.shipped import shipped_robot


def product(chain, q):
    """C_0 M(q_1) C_1 … by plain 4x4 products."""
    T = np.eye(4)
    for constant, turns, value in zip(chain.placements, chain.is_revolute, q, strict=False):
        C, M = np.eye(4), np.eye(4)
        C[:3] = constant.reshape(3, 4)
        if turns:
            M[:2, :2] = [[np.cos(value), -np.sin(value)], [np.sin(value), np.cos(value)]]
        else:
            M[2, 3] = value
        T = T @ C @ M
    last = np.eye(4)
    last[:3] = chain.placements[-1].reshape(3, 4)
    return T @ last


@pytest.mark.parametrize("name", ["puma560", "stanford", "kinova", "talos_arm", "tiago_no_hand"])
def test_the_product_is_the_pose(name):
    robot = shipped_robot(name)
    chain = chain_of(robot, robot.tip_frame)
    for q in np.random.default_rng(0).uniform(-1, 1, (10, robot.dof)):
        q = np.clip(q, robot.lower, robot.upper)
        T = fk(robot, q)[robot.tip_frame]
        np.testing.assert_allclose(product(chain, q[chain.columns]), T, atol=1e-12)
        assert np.linalg.norm(T[:3, 3] - chain.placements[0, [3, 7, 11]]) <= chain.reach


def test_from_one_branch_to_another():
    robot = robot_from_urdf(shipped_robot("baxter").urdf, base="left_wrist", tip="right_gripper")
    chain = chain_of(robot, "right_gripper")
    for q in np.random.default_rng(1).uniform(-1, 1, (10, robot.dof)):
        T = fk(robot, q)["right_gripper"]
        np.testing.assert_allclose(product(chain, q[chain.columns]), T, atol=1e-12)
