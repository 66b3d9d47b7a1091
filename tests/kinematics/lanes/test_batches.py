"""Poses and Jacobians of many configurations, against products of matrices and Pinocchio."""

import math

import numpy as np
import pinocchio as pin
import pytest

from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.jacobian import jacobian
from kinematics.lanes.batches import forward_many, jacobian_many
from kinematics.lanes.links import WHOLE, links_of
from robots.shipped import shipped_robot

TWISTS = (0.0, math.pi / 2, -math.pi / 2, math.pi, 3.14159, 1.5708, 1e-3, 1e-8, -1e-7, 0.3, 2.5)
"""Angles between axes, and those that a hand writes; with the ones next to parallel."""


def turn(axis, angle):
    return np.asarray(pin.AngleAxis(angle, np.asarray(axis, float)).matrix())


def placed(R, p):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def random_chain(rng, K):
    """Placements whose axes meet at all sorts of angles, and which joints turn."""
    placements = []
    for _ in range(K + 1):
        R = turn((0, 0, 1), rng.choice([0.0, rng.uniform(-4, 4)]))
        R = R @ turn((1, 0, 0), rng.choice(TWISTS)) @ turn((0, 0, 1), rng.choice([0.0, 1.0, -2.0]))
        placements.append(placed(R, rng.choice([0.0, 1.0], 3) * rng.normal(size=3)))
    return placements, rng.random(K) < 0.75


def product(placements, is_revolute, q):
    """The pose and the Jacobian, one matrix after the other."""
    T, axes = placements[0], []
    for k, value in enumerate(q):
        axes.append((T[:3, 2], T[:3, 3]))
        turned = turn((0, 0, 1), value) if is_revolute[k] else np.eye(3)
        moved = (0, 0, 0) if is_revolute[k] else (0, 0, value)
        T = T @ placed(turned, moved) @ placements[k + 1]
    columns = [
        np.concatenate((np.cross(z, T[:3, 3] - p), z)) if turns else np.concatenate((z, 0 * z))
        for (z, p), turns in zip(axes, is_revolute, strict=True)
    ]
    return T, np.array(columns).reshape(-1, 6).T


@pytest.mark.parametrize("seed", range(60))
def test_any_chain_is_a_product_of_matrices(seed):
    rng = np.random.default_rng(seed)
    K = int(rng.integers(0, 10))
    placements, is_revolute = random_chain(rng, K)
    n = int(rng.integers(1, 20))
    Q = rng.uniform(-7, 7, (n, K))
    links = links_of(np.array([T[:3].reshape(12) for T in placements]), is_revolute)
    poses, again, J = np.empty((n, 16)), np.empty((n, 16)), np.zeros((n, 6 * K))
    forward_many(links, np.arange(K), Q, poses)
    jacobian_many(links, np.arange(K), Q, again, J)
    np.testing.assert_array_equal(poses, again)
    for i in range(n):
        T, wanted = product(placements, is_revolute, Q[i])
        size = 1.0 + np.abs(T).max() + np.abs(Q[i]).max(initial=0.0)
        np.testing.assert_allclose(poses[i].reshape(4, 4), T, rtol=0, atol=2e-14 * size)
        np.testing.assert_allclose(J[i].reshape(6, K), wanted, rtol=0, atol=4e-14 * size)


def test_nearly_parallel_axes_keep_their_placement():
    tilted = placed(turn((1, 0, 0), 1e-7), (0.3, 0.4, 0.5))
    square = placed(turn((1, 0, 0), math.pi / 2), (0.3, 0.0, 0.5))
    placements = np.array([T[:3].reshape(12) for T in (np.eye(4), tilted, square, np.eye(4))])
    links = links_of(placements, np.array([True, True, True]))
    assert links[1:-1, WHOLE].tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize("name", ["panda", "ur5", "scara", "planar_8r", "talos_arm", "so101"])
def test_the_rows_of_a_batch_are_single_ones_whatever_is_beside_them(name):
    robot = shipped_robot(name)
    tip = robot.tip_frame
    Q = np.random.default_rng(3).uniform(-3, 3, (19, robot.dof))
    poses, J = fk(robot, Q)[tip], jacobian(robot, Q)
    for n in range(20):
        np.testing.assert_array_equal(fk(robot, Q[:n])[tip], poses[:n])
        np.testing.assert_array_equal(jacobian(robot, Q[:n]), J[:n])
    order = np.random.default_rng(4).permutation(19)
    np.testing.assert_array_equal(fk(robot, Q[order])[tip], poses[order])
    for q, T, one in zip(Q, poses, J, strict=True):
        np.testing.assert_allclose(T, fk(robot, q)[tip], rtol=0, atol=4e-15)
        np.testing.assert_allclose(one, jacobian(robot, q), rtol=0, atol=4e-15)


def test_a_chain_that_moves_by_some_columns_leaves_the_others_at_0():
    robot = shipped_robot("talos_arm")
    frames = [name for name in robot.frames if chain_of(robot, name).length < robot.dof]
    Q = np.random.default_rng(5).uniform(-1, 1, (9, robot.dof))
    assert frames
    for name in frames[:6]:
        J = jacobian(robot, Q, name)
        still = np.setdiff1d(np.arange(robot.dof), chain_of(robot, name).columns)
        assert not J[:, :, still].any()
        np.testing.assert_allclose(J[2], jacobian(robot, Q[2], name), rtol=0, atol=4e-15)
