"""Ten thousand targets that were chosen to mislead: the status is what an own check says."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse import IKOptions, IKStatus, solve_ik, solve_ik_batch
from kinematics.task import TASKS
from robots.shipped import shipped_robot

ROBOTS = ("puma560", "ur5", "panda", "pa10", "scara", "planar_3r", "stanford", "kinova", "xarm7")
PART = 50


def configurations(robot, rng, nearness):
    """At limits, at zero, at right angles: where arms are singular, or a trace beside it."""
    low, high = np.maximum(robot.lower, -3.2), np.minimum(robot.upper, 3.2)
    special = np.stack([low, high, np.zeros(robot.dof), np.full(robot.dof, np.pi / 2)])
    picked = special[rng.integers(0, 4, (PART, robot.dof)), np.arange(robot.dof)]
    free = rng.random((PART, robot.dof)) < 0.5
    q = np.where(free, rng.uniform(low, high, (PART, robot.dof)), picked)
    return np.clip(q + nearness * rng.standard_normal(q.shape), low, high)


def adversaries(robot, rng, kind, nearness):
    poses = fk(robot, configurations(robot, rng, nearness))[robot.tip_frame]
    chain = chain_of(robot, robot.tip_frame)
    centre = chain.placements[0, [3, 7, 11]]
    reach = chain.reach if np.isfinite(chain.reach) else 1.0
    if kind == "border":
        directions = poses[:, :3, 3] - centre + 1e-12
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        signs = rng.choice([-1.0, 0.0, 1.0], (PART, 1))
        poses[:, :3, 3] = centre + directions * reach * (1.0 + signs * nearness)
    elif kind == "far":
        poses[:, :3, 3] *= rng.choice([1e2, 1e4, 1e6], (PART, 1))
    elif kind == "inside":
        poses[:, :3, 3] = centre + nearness * rng.standard_normal((PART, 3))
    elif kind == "turned":
        poses[:, :3, :3] = poses[:, :3, :3] @ np.diag([1.0, -1.0, -1.0])
    return poses


def measured(task, reached, target):
    """Position and rotation errors, by another way than the solver's."""
    difference = target[:3, 3] - reached[:3, 3]
    position = float(np.linalg.norm(difference[list(task.positions)])) if task.positions else 0.0
    if task.own_axes:
        z, goal = reached[:3, 2], target[:3, 2]
        return position, float(np.arctan2(np.linalg.norm(np.cross(z, goal)), z @ goal))
    turn = Rotation.from_matrix(target[:3, :3] @ reached[:3, :3].T).as_rotvec()
    return position, float(np.linalg.norm(turn[list(task.rotations)]))


@settings(max_examples=200, deadline=None)
@given(
    st.sampled_from(ROBOTS),
    st.sampled_from(["singular", "border", "far", "inside", "turned"]),
    st.sampled_from(["pose", "position", "xy", "xy_phi", "direction", "position_direction"]),
    st.sampled_from([0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-4, 1e-2]),
    st.integers(0, 2**32 - 1),
    st.sampled_from([1.0, 0.0]),
)
def test_the_status_is_what_an_own_check_says(name, kind, task_name, nearness, seed, budget):
    robot, task, rng = shipped_robot(name), TASKS[task_name], np.random.default_rng(seed)
    targets = adversaries(robot, rng, kind, nearness)
    options = IKOptions(max_restarts=2, time_budget=budget)
    start = 10.0 * rng.standard_normal(robot.dof)
    batch = solve_ik_batch(robot, targets, task=task, seed=start, options=options)
    assert np.isfinite(batch.q).all()
    assert ((batch.q >= robot.lower) & (batch.q <= robot.upper)).all()
    reached = fk(robot, batch.q)[robot.tip_frame]
    for k, status in enumerate(batch.statuses):
        position, orientation = measured(task, reached[k], targets[k])
        assert batch.position_error[k] == pytest.approx(position, rel=1e-9, abs=1e-12)
        if orientation < 3.1:
            assert batch.orientation_error[k] == pytest.approx(orientation, rel=1e-7, abs=1e-12)
        good = position <= 1e-6 and orientation <= 1e-6
        borderline = abs(position - 1e-6) < 1e-12 or abs(orientation - 1e-6) < 1e-12
        assert (status is IKStatus.CONVERGED) == good or borderline


@pytest.mark.parametrize("name", ["panda", "puma560", "ur5", "planar_3r", "talos_arm"])
@pytest.mark.parametrize("task_name", ["direction", "position_direction"])
def test_a_direction_leaves_the_turn_about_it_open(name, task_name):
    robot, task, rng = shipped_robot(name), TASKS[task_name], np.random.default_rng(5)
    low, high = np.maximum(robot.lower, -3), np.minimum(robot.upper, 3)
    poses = fk(robot, rng.uniform(low, high, (100, robot.dof)))[robot.tip_frame]
    spin = Rotation.from_rotvec([0, 0, 1.0]).as_matrix()
    poses[:, :3, :3] = poses[:, :3, :3] @ spin
    for target in poses:
        result = solve_ik(robot, target, task=task)
        assert result.status is IKStatus.CONVERGED
        errors = measured(task, fk(robot, result.q)[robot.tip_frame], target)
        assert max(errors) <= 1e-6
