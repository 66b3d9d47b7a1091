"""The skeleton of arms with slides follows the way that the table describes."""

import numpy as np
import pytest

from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.distances import Pairs, near_pairs
from kinematics.redundancy.clearance.obstacles import Sphere, encoded
from kinematics.redundancy.clearance.sweep import swept_clearance
from kinematics.redundancy.follow import followed
from kinematics.redundancy.kernel import workspace
from kinematics.redundancy.measure import clearances_at
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.skeleton import skeleton_of
from kinematics.task import task_from
from tests.words.arms import CONVENTIONS, arm_from, axes_of, placement, polyline_of, random_row

LINK, BALL = 0.02, 0.03


def sliding_arm(number):
    """Two to five joints of any kind, one of them a slide at least."""
    generator = np.random.default_rng(number)
    convention = CONVENTIONS[number % 3]
    count = int(generator.integers(2, 6))
    slide = int(generator.integers(count))
    rows = [random_row(generator, "P" if k == slide else "RRP") for k in range(count)]
    tool = placement(generator) if generator.random() < 0.5 else None
    base = placement(generator) if generator.random() < 0.5 else None
    return arm_from(rows, convention, tool, base), generator


def problem_of(robot, q, balls):
    pose = fk(robot, q)["tool"]
    space = task_from("position")
    path = polyline(pose, [pose], space, Sampling(samples=2))
    return PathProblem(Arm.of(robot, None, space), q, path, encoded(balls), link_radius=LINK)


def distance(points, centre):
    """Least distance of a point from a polyline, shape (k, 3)."""
    a, b = points[:-1], points[1:]
    d = b - a
    square = np.maximum((d * d).sum(axis=1), 1e-300)
    t = np.clip(((centre - a) * d).sum(axis=1) / square, 0, 1)
    return np.linalg.norm(a + t[:, None] * d - centre, axis=1).min()


@pytest.mark.parametrize("number", range(60))
def test_clearance_is_that_of_the_polyline(number):
    robot, generator = sliding_arm(number)
    for _ in range(3):
        q = generator.uniform(-1.0, 1.0, robot.dof)
        frames = axes_of(robot, q[None]).frames[0]
        points = polyline_of(robot, frames)
        points = np.concatenate((points, fk(robot, q)["tool"][None, :3, 3]))
        k = int(generator.integers(len(points) - 1))
        on = points[k] + generator.random() * (points[k + 1] - points[k])
        beside = on + generator.uniform(-0.4, 0.4, 3)
        for centre in (on, beside):
            problem = problem_of(robot, q, [Sphere(centre, BALL)])
            (found,), _ = clearances_at(problem, q[None])
            expected = distance(_moved(robot, points), centre) - LINK - BALL
            assert found == pytest.approx(expected, abs=1e-9)
        # The picture shows the same corners.
        drawn = np.concatenate(skeleton_of(robot, q).bones[1:])
        for point in points:
            assert np.linalg.norm(drawn - point, axis=1).min() < 1e-9


def _moved(robot, points):
    """The corners without the first piece where no joint carries it: along x, before joint 1."""
    first = robot.table.convention != "standard"
    return points[1:] if first else points


def test_a_ball_in_the_middle_of_the_scaras_second_link():
    from robots.shipped import shipped_robot

    robot = shipped_robot("scara")
    q = np.array([0.3, 0.5, 0.1, 0.2])
    problem = problem_of(robot, q, [Sphere((0.4063, 0.1947, 0.387), 0.02)])
    frames = fk(robot, q, ["frame_1", "frame_2"])
    middle = (frames["frame_1"][:3, 3] + frames["frame_2"][:3, 3]) / 2
    np.testing.assert_allclose(middle, (0.4063, 0.1947, 0.387), atol=1e-4)
    (found,), _ = clearances_at(problem, q[None])
    assert found == pytest.approx(-0.04, abs=1e-4)


@pytest.mark.parametrize("number", range(12))
def test_gradients_and_sweeps_of_arms_with_slides(number):
    """Gradients by differences; the swept clearance never above that of any q between."""
    robot, generator = sliding_arm(number)
    q = generator.uniform(-0.7, 0.7, robot.dof)
    balls = [Sphere(generator.uniform(-0.8, 0.8, 3), 0.05) for _ in range(3)]
    problem = problem_of(robot, q, balls)
    chain, scene, K = problem.arm.constants.chain, problem.scene, problem.arm.K
    most = len(problem.links) * len(balls)
    pairs = Pairs(np.empty(most), np.empty((most, K)), np.empty((most, 2), dtype=np.int64))
    W = workspace(K, len(problem.links))

    def distances(x):
        room = Pairs(np.empty(most), np.empty((most, K)), np.empty((most, 2), dtype=np.int64))
        near_pairs(chain, x, scene, 1e9, W, room)
        return room.d

    near_pairs(chain, q, scene, 1e9, W, pairs)
    steps = 1e-6 * np.eye(K)
    numeric = np.array([(distances(q + h) - distances(q - h)) / 2e-6 for h in steps]).T
    apart = np.abs(numeric - pairs.g).max(axis=1)
    assert np.sort(apart)[: int(0.9 * most)].max() < 1e-6
    other = q + generator.uniform(-0.5, 0.5, K)
    between = np.linspace(0, 1, 200)[:, None] * (other - q) + q
    least = clearances_at(problem, between)[0].min()
    swept = swept_clearance(chain, q, other, scene, np.inf, W)
    assert least - 2e-3 <= swept <= least + 1e-9


@pytest.mark.parametrize("method", ["qp", "sqp", "whole_path", "null_space"])
def test_methods_keep_the_column_of_a_slide_clear(method):
    """A gantry lowers its tool past a ball beside the way of its last slide."""
    rows = [("P", -np.pi / 2, 0.0, 0.0, 0.0, 1), ("P", np.pi / 2, 0.3, 0.0, 0.0, 1)]
    rows += [("R", 0.0, 0.4, 0.0, 0.0, 1), ("R", 0.0, 0.4, 0.0, 0.0, 1)]
    robot = arm_from(rows)
    q = np.array([0.1, 0.1, 0.4, 0.5])
    pose = fk(robot, q)["tool"]
    goal = pose.copy()
    goal[:3, 3] += [0.1, -0.15, 0.05]
    space = task_from("position")
    path = polyline(pose, [goal], space, Sampling(samples=21))
    ball = Sphere(pose[:3, 3] + [0.3, 0.2, 0.0], 0.05)
    problem = PathProblem(Arm.of(robot, None, space), q, path, encoded([ball]), link_radius=LINK)
    result = followed(problem, METHODS[method], PathOptions())
    assert result.verdict.success, result.verdict.message
    for one, clearance in zip(result.q, result.measures.clearance, strict=True):
        frames = axes_of(robot, one[None]).frames[0]
        expected = distance(polyline_of(robot, frames), ball.center) - LINK - 0.05
        assert clearance == pytest.approx(expected, abs=1e-9)
