"""Arms without limits: no method leaps from a sample to the next, and what prevents it is named."""

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.obstacles import CircleObstacle, Sphere, encoded
from kinematics.redundancy.follow import followed
from kinematics.redundancy.measure import clearances_at
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import (
    LONGEST_STEP,
    NEAR_STEP,
    PathOptions,
    PathProblem,
    SecondaryTask,
)
from kinematics.task import task_from
from robots.robot import robot_from_table

ALIKE = 3.0
"""Largest step of a method that is constrained, relative to that of qp."""


def free_arm(joints, tool=0.3):
    rows = [{"type": "R", "alpha": alpha, "a": a, "d": d, "theta": 0} for alpha, a, d in joints]
    document = {"convention": "modified", "tool": {"xyz": [tool, 0, 0]}, "joints": rows}
    return robot_from_table(read_mapping(document))


def random_problem(seed):
    """A 3R, 4R or 6R without limits on a line, often past an obstacle or out of reach."""
    rng = np.random.default_rng(seed)
    count, planar = int(rng.choice([3, 4, 6])), rng.random() < 0.5
    joints = []
    for k in range(count):
        alpha = 0.0 if planar else float(rng.choice([0, np.pi / 2, -np.pi / 2]))
        a = float(rng.uniform(0.1, 0.6)) if k else 0.0
        joints.append((alpha, a, 0.0 if planar else float(rng.choice([0, 0.2, -0.2]))))
    robot = free_arm(joints)
    task = task_from("xy" if planar or count < 4 else "position")
    q = rng.uniform(-1.5, 1.5, count)
    start = fk(robot, q)[robot.tip_frame]
    end = start.copy()
    shift = rng.normal(size=3) * (1, 1, 0 if planar else 1)
    end[:3, 3] += shift / np.linalg.norm(shift) * rng.uniform(0.1, 1.0)
    path = polyline(start, [end], task, Sampling(samples=61, tf=4.0))
    middle = (start + end)[:3, 3] / 2 + rng.normal(size=3) * 0.15
    solid = CircleObstacle(middle[:2], 0.05) if planar else Sphere(middle, 0.05)
    obstacles = encoded([solid] if rng.random() < 0.8 else [])
    arm = Arm.of(robot, None, task)
    return PathProblem(arm, q, path, obstacles, link_radius=0.02, d_safe=0.02)


def followed_by(problem, method):
    secondary = ()
    if method == "task_priority":
        secondary = (SecondaryTask(problem.arm, problem.path.targets[0]),)
    return followed(problem, METHODS[method], PathOptions(secondary=secondary))


@pytest.mark.parametrize("seed", range(16))
def test_no_method_leaps(seed):
    problem = random_problem(seed)
    most = problem.longest_step.max()
    assert most <= max(LONGEST_STEP, 10 * problem.largest_increment / problem.scale)
    qp = followed_by(problem, "qp")
    assert qp.measures.largest_step <= most * (1 + 1e-9)
    for name in ("sqp", "damped", "null_space", "pseudo_inverse", "task_priority"):
        found = followed_by(problem, name)
        step = found.measures.largest_step
        assert step <= most * (1 + 1e-9)
        if METHODS[name].constrained or found.verdict.success:
            assert step <= max(ALIKE * qp.measures.largest_step, NEAR_STEP), name
        if found.verdict.reason == "diverged" and len(found.q) < problem.path.samples:
            assert "out of its branch" in found.verdict.message
            assert any(joint.name in found.verdict.message for joint in problem.arm.robot.joints)


@pytest.fixture(scope="module")
def past_a_circle():
    """A 3R on a line past a disc on which sqp leapt by 1,360 rad."""
    robot = free_arm([(0, 0, 0), (0, 0.5, 0), (0, 0.4, 0)])
    q, task = np.array([0.3, 0.6, 0.5]), task_from("xy")
    start = fk(robot, q)[robot.tip_frame]
    end = start.copy()
    end[:2, 3] = -0.06, 0.87
    path = polyline(start, [end], task, Sampling())
    solid = encoded([CircleObstacle((0.34, 0.64), 0.05)])
    arm = Arm.of(robot, None, task)
    return PathProblem(arm, q, path, solid, link_radius=0.02, d_safe=0.02)


def test_sqp_stays_as_near_as_qp(past_a_circle):
    qp, sqp = (followed_by(past_a_circle, name) for name in ("qp", "sqp"))
    assert sqp.measures.largest_step == pytest.approx(qp.measures.largest_step, rel=0.05)
    assert sqp.verdict.first_lost == qp.verdict.first_lost
    # No sample after the obstacle counts as tracked.
    assert sqp.measures.off_path(past_a_circle.tolerance)[sqp.verdict.first_lost :].all()
    assert "(held: link 2 by obstacle 0)" in sqp.verdict.message


def test_the_least_clearance_is_named_where_it_is(past_a_circle):
    result = followed_by(past_a_circle, "damped")
    Q = past_a_circle.arm.reduced(result.q)
    at = int(np.argmin(result.measures.swept))
    assert f"between samples {at} and {at + 1}" in result.verdict.message
    between = Q[at] + np.linspace(0, 1, 500)[:, None] * (Q[at + 1] - Q[at])
    least, _ = clearances_at(past_a_circle, between)
    assert least.min() == pytest.approx(result.measures.min_swept, abs=2e-5)
    assert least.min() < result.measures.clearance.min() - 1e-5


def test_a_coarse_path_leaves_room_for_its_own_steps():
    robot = free_arm([(0, 0, 0), (0, 0.5, 0), (0, 0.4, 0)])
    q, task = np.array([0.3, 0.6, 0.5]), task_from("xy")
    start = fk(robot, q)[robot.tip_frame]
    end = start.copy()
    end[:2, 3] = -start[1, 3], start[0, 3]
    for samples in (2, 3, 5):
        path = polyline(start, [end], task, Sampling(samples=samples))
        problem = PathProblem(Arm.of(robot, None, task), q, path, encoded([]))
        for name in ("qp", "sqp", *(("damped", "null_space") if samples > 3 else ())):
            assert followed_by(problem, name).verdict.success, (samples, name)
