"""Analytic gradients against finite differences."""

import numpy as np
import pytest

from kinematics.inverse.task_error import columns, residual
from kinematics.jacobian import task_jacobian
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.distances import Pairs, Scene, near_pairs
from kinematics.redundancy.clearance.links import skeleton
from kinematics.redundancy.clearance.obstacles import (
    Box,
    Capsule,
    CircleObstacle,
    HalfSpace,
    Sphere,
    encoded,
)
from kinematics.redundancy.kernel import exact_error_columns, task_rows, workspace
from kinematics.redundancy.steps.gradients import (
    Repulsion,
    limit_potential,
    manipulability_potential,
    obstacle_potential,
    posture_potential,
)
from kinematics.task import task_from
from robots.shipped import shipped_robot

ROBOTS = ["planar_8r", "pa10", "panda", "scara"]
WORLD = encoded(
    [
        Sphere((0.3, 0.2, 0.4), 0.1),
        CircleObstacle((0.5, -0.3), 0.1),
        Capsule((0.4, -0.4, 0.1), (0.2, 0.5, 0.9), 0.05),
        HalfSpace((0.1, 0.2, 1.0), -0.4),
        Box((0.0, 0.5, 0.3), (0.2, 0.1, 0.3)),
    ]
)


def numeric(function, q, h=1e-3):
    """A derivative of sixth order: one number or vector a joint, stacked."""
    columns = []
    for d in np.eye(len(q)) * h:
        value = sum(
            c * (np.asarray(function(q + k * d)) - np.asarray(function(q - k * d)))
            for k, c in ((1, 0.75), (2, -0.15), (3, 1 / 60))
        )
        columns.append(value / h)
    return np.array(columns)


def close(found, expected):
    np.testing.assert_allclose(found, expected, atol=1e-7 * max(1.0, np.abs(expected).max()))


@pytest.fixture(params=ROBOTS)
def arm(request):
    return Arm.of(shipped_robot(request.param), None, task_from("position"))


def samples(arm, count=10):
    return np.random.default_rng(arm.K).uniform(-1, 1, (count, arm.K))


def test_limits_and_posture(arm):
    g, lower, upper = np.empty(arm.K), arm.chain.lower, arm.chain.upper
    for q in samples(arm):
        limit_potential(q, lower, upper, g)
        close(g.copy(), numeric(lambda x: limit_potential(x, lower, upper, np.empty(arm.K)), q))
        posture_potential(q, q * 0.5, g)
        wanted = q * 0.5
        close(g, numeric(lambda x, w=wanted: posture_potential(x, w, np.empty(arm.K)), q))


SPATIAL = ["position", "pose", "xy", "xy_phi", "position_direction"]


@pytest.mark.parametrize(
    ("name", "task"),
    [("planar_8r", "xy"), ("planar_8r", "xy_phi")]
    + [(name, task) for name in ("pa10", "panda") for task in SPATIAL],
)
def test_manipulability(name, task):
    robot = shipped_robot(name)
    arm = Arm.of(robot, None, task_from(task))
    constants = arm.constants
    G, W, g = np.zeros(12), workspace(arm.K), np.empty(arm.K)
    G[[0, 5, 10]] = 1.0

    def w(q):
        J = task_jacobian(robot, q, arm.task)
        return np.sqrt(np.linalg.det(J @ J.T))

    for q in samples(arm):
        residual(constants.chain, G, q, W)
        value = manipulability_potential(constants, W, g)
        assert -value == pytest.approx(w(q), rel=1e-9)
        close(-g, numeric(w, q))


def test_distances_and_repulsion(arm):
    chain, S = arm.constants.chain, skeleton(arm, 0.02).rows
    scene, K, most = Scene(WORLD, S), arm.K, len(S) * len(WORLD)
    W = workspace(K, len(S))

    def room():
        return Pairs(np.empty(most), np.empty((most, K)), np.empty((most, 2), dtype=np.int64))

    def all_distances(q):
        found = room()
        near_pairs(chain, q, scene, 1e9, workspace(K, len(S)), found)
        return found.d

    checked = 0
    for q in samples(arm):
        pairs = room()
        count, least = near_pairs(chain, q, scene, 1e9, W, pairs)
        d, g, _ = pairs
        assert count == most
        assert least == d.min()
        coarse, fine = numeric(all_distances, q, 1e-4).T, numeric(all_distances, q, 3e-5).T
        smooth = np.abs(coarse - fine).max(axis=1) < 1e-8  # not where the witness changes sides
        smooth &= d > -0.02
        np.testing.assert_allclose(g[smooth], fine[smooth], atol=1e-7)
        checked += smooth.sum()
        total = np.empty(K)
        if d.min() > 0.0 and smooth.all():
            arguments = scene, Repulsion(0.01, 0.3), workspace(K, len(S))
            obstacle_potential(chain, q, *arguments, total)
            expected = numeric(
                lambda x, a=arguments: obstacle_potential(chain, x, *a, np.empty(K)), q, 1e-4
            )
            close(total, expected)
    assert checked > 5 * most


@pytest.mark.parametrize("task", ["pose", "xy_phi", "orientation"])
def test_the_error_of_the_program_has_its_exact_derivative(task):
    arm = Arm.of(shipped_robot("panda"), None, task_from(task))
    constants, chain = arm.constants, arm.constants.chain
    every = chain._replace(mask=np.array([1.0] * 6 + [0.0]))

    def error(q, goal):
        W, e, J = workspace(arm.K), np.empty(arm.m), np.empty((arm.m, arm.K))
        residual(every, goal, q, W)
        columns(every, W)
        exact_error_columns(chain, W)
        task_rows(constants, W, e, J)
        return e, J

    for q in samples(arm):
        _, _, goal = arm.task_at(q + 0.2, np.eye(4)[:3].reshape(12).copy())
        e, J = error(q, goal)
        assert np.abs(e).max() > 0.05
        close(-J.T, numeric(lambda x, G=goal: error(x, G)[0], q))
