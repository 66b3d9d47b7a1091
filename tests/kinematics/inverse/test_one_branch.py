"""Sequences of targets on one branch: no jump between samples, honest ends, known branches."""

from __future__ import annotations

import numpy as np
import pytest

from kinematics.forward import fk
from kinematics.inverse import IKOptions
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.one_branch import follow_branch
from kinematics.jacobian import jacobian
from kinematics.task import POSE, TASKS
from robots.shipped import shipped_robot
from tests.kinematics.inverse.test_self_motion import gen3


def along(robot, start, end, count):
    """Targets of a straight line in q, and its q: a branch that is known."""
    rows = start + np.linspace(0, 1, count)[:, None] * (end - start)
    return rows, np.array([fk(robot, q)[robot.tip_frame] for q in rows])


def followed(robot, targets, seed=None):
    return follow_branch(robot, targets, task=POSE, seed=seed, options=IKOptions())


def is_reached(robot, found, targets):
    reached = np.array([fk(robot, q)[robot.tip_frame] for q in found.q[: found.reached]])
    np.testing.assert_allclose(reached, targets[: found.reached], atol=2e-6)
    assert (found.q >= robot.lower).all()
    assert (found.q <= robot.upper).all()


@pytest.mark.parametrize("name", ["puma560", "ur5", "kr6_r900"])
def test_a_branch_that_is_known_is_held(name):
    robot, rng = shipped_robot(name), np.random.default_rng(2)
    for _ in range(4):
        start = rng.uniform(-1, 1, 6) + np.array([0, 0, 0, 0, 1.4, 0])
        rows, targets = along(robot, start, start + rng.uniform(-0.3, 0.3, 6), 9)
        inside = ((rows >= robot.lower) & (rows <= robot.upper)).all()
        signs = {np.sign(np.linalg.det(jacobian(robot, q))) for q in rows}
        if not inside or len(signs) > 1:
            continue
        found = followed(robot, targets, seed=start)
        assert found.reached == 9
        assert found.branches[-1].index is None
        # The frame goes straight between the targets, so that only these are alike.
        np.testing.assert_allclose(found.q, rows, atol=1e-5)


@pytest.mark.parametrize(
    "make", [lambda: shipped_robot("panda"), lambda: shipped_robot("iiwa14"), gen3]
)
def test_redundant_arms_move_without_jumps(make):
    robot, rng = make(), np.random.default_rng(4)
    middle = np.clip(np.array([0.1, 0.5, 0.2, -1.3, 0.3, 1.1, 0.2]), robot.lower, robot.upper)
    _, targets = along(
        robot, middle, np.clip(middle + rng.uniform(-0.4, 0.4, 7), robot.lower, robot.upper), 11
    )
    found = followed(robot, targets, seed=middle)
    assert found.reached == 11
    is_reached(robot, found, targets)
    assert np.abs(np.diff(found.q, axis=0)).max() < 0.5


def test_the_limit_that_ends_each_branch_is_named():
    """A turn of the hand about its own axis moves the last joint alone."""
    robot = shipped_robot("puma560")
    start = np.array([0.2, -0.5, 0.4, 0.3, 0.7, 0.0])
    k = 5
    end = start.copy()
    end[k] = robot.upper[k] + 0.5
    rows, targets = along(robot, start, end, 41)
    found = followed(robot, targets, seed=start)
    first = int(np.argmax(rows[:, k] > robot.upper[k]))
    own = found.branches[0]
    np.testing.assert_allclose(own.start, start, atol=1e-9)
    assert (own.index, own.reason, own.joint, own.limit) == (
        first,
        "limit",
        robot.joints[k].name,
        "upper",
    )
    if found.branches[-1].index is not None:
        assert found.reached == max(one.index for one in found.branches)
    is_reached(robot, found, targets)


def test_a_target_out_of_reach_ends_every_branch():
    robot = shipped_robot("ur5")
    start = np.array([0.3, -1.2, 1.4, -0.5, 1.2, 0.2])
    first = fk(robot, start)[robot.tip_frame]
    targets = np.repeat(first[None], 4, axis=0)
    targets[:, 0, 3] += [0.0, 0.01, 3.0, 0.0]
    found = followed(robot, targets, seed=start)
    assert found.reached == 2
    assert len(found.branches) > 1
    assert all(one.index == 2 for one in found.branches)
    assert {one.reason for one in found.branches} <= {"unreachable", "limit"}
    assert "unreachable" in {one.reason for one in found.branches}
    targets[0, 0, 3] = 9.0
    none = followed(robot, targets, seed=start)
    assert none.reached == 0
    assert none.branches[0].index == 0
    assert none.branches[0].reason == "unreachable"


def test_no_leap_to_another_branch_between_far_targets():
    """Two targets whose nearest solutions are on different branches: the first branch is held, or
    its end is told; what is between the targets decides."""
    robot = shipped_robot("planar_2r")
    targets = np.repeat(np.eye(4)[None], 2, axis=0)
    # Straight through the base's axis, where both links of a planar arm lie on each other.
    targets[0, :2, 3], targets[1, :2, 3] = (1.2, 0.3), (-1.2, 0.3)
    found = follow_branch(
        robot, targets, task=TASKS["xy"], seed=np.array([0.1, 0.5]), options=IKOptions()
    )
    for end in found.branches:
        if end.index is None:
            assert np.sign(found.q[0, 1]) == np.sign(found.q[1, 1])


def test_the_seed_chooses_the_branch():
    robot = shipped_robot("puma560")
    start = np.array([0.2, -0.5, 0.4, 0.3, 0.7, 0.1])
    _, targets = along(robot, start, start + 0.1, 3)
    found = followed(robot, targets, seed=start)
    np.testing.assert_allclose(found.q[0], start, atol=1e-9)
    known = all_solutions(robot, targets[0], seed=start).solutions
    other = next(one.q for one in known if one.within_limits and np.abs(one.q - start).max() > 0.5)
    found = followed(robot, targets, seed=other)
    np.testing.assert_allclose(found.branches[0].start, other, atol=1e-9)
