"""Few samples close to obstacles: the way between two samples, and programs that nearly fail."""

from itertools import pairwise

import numpy as np
import pytest

from kinematics.forward import fk
from kinematics.redundancy.clearance.obstacles import Box, Sphere
from kinematics.redundancy.follow import followed
from kinematics.redundancy.measure import clearances_at
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.methods.whole_path import kept_until
from kinematics.redundancy.problem import PathOptions
from robots.shipped import shipped_robot


def to(line, robot, q, end, task, obstacles, **more):
    start = fk(robot, np.array(q))[robot.tip_frame][:3, 3]
    shift = np.array([*end, start[2]][:3]) - start
    return line(robot, q, shift, task, obstacles, **more)


def done(problem, method):
    """The task is done, and the clearance holds at places between samples, looked at anew."""
    result = followed(problem, METHODS[method], PathOptions())
    assert result.verdict.success, result.verdict.message
    Q = problem.arm.reduced(result.q)
    parts = np.linspace(0, 1, 50)[:, None]
    for a, b in pairwise(Q):
        clearance, _ = clearances_at(problem, a + parts * (b - a))
        assert clearance.min() >= problem.d_safe


def boxed(line):
    """The Panda dips towards a box between two samples."""
    solids = [
        Box((0.0712, 0.2048, 0.8663), (0.1661, 0.0882, 0.1124), turned(-1.1811, -0.7366, -2.9769)),
        Sphere((-0.1961, 0.5264, 0.6225), 0.0586),
        Box((-0.1218, 0.3344, 0.8377), (0.0671, 0.2193, 0.0757), turned(-1.8617, -0.342, 1.7477)),
    ]
    q = [0.6286, 1.0156, 2.0017, -1.4928, -1.1353, 1.4329, -1.3801]
    end = (0.1093, 0.3263, 0.8737)
    return to(
        line, shipped_robot("panda"), q, end, "position", solids, samples=15, link_radius=0.0431
    )


def balls(line):
    """The Panda must swing its elbow past a ball within one sample."""
    solids = [
        Sphere((-0.2782, 0.1553, 0.3845), 0.119),
        Sphere((-0.7003, -0.2762, 0.5958), 0.057),
        Sphere((-0.4644, -0.2081, 0.7863), 0.0505),
        Sphere((-0.647, -0.013, 1.035), 0.0682),
    ]
    q = [0.2291, -1.3873, 0.6785, -0.6413, -0.7562, 1.2312, 1.3224]
    end = (-0.5635, -0.4264, 0.6155)
    return to(
        line, shipped_robot("panda"), q, end, "position", solids, samples=15, link_radius=0.0454
    )


def turned(roll, pitch, yaw):
    (a, b, c), (d, e, f) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return np.array(
        [
            [c * b, c * e * d - f * a, c * e * a + f * d],
            [f * b, f * e * d + c * a, f * e * a - c * d],
            [-e, b * d, b * a],
        ]
    )


@pytest.mark.parametrize("method", ["sqp", "qp", "whole_path"])
@pytest.mark.parametrize("scenario", [boxed, balls])
def test_few_samples_close_to_obstacles(line, scenario, method):
    done(scenario(line), method)


def test_how_far_a_path_holds(line):
    """Error, clearance at and between samples, and limits: from the first that does not."""
    problem = balls(line)
    result = followed(problem, METHODS["qp"], PathOptions())
    Q = problem.arm.reduced(result.q)
    assert kept_until(problem, Q) == len(Q)
    for sample, change in ((4, 1e-2), (6, 10.0)):
        broken = Q.copy()
        broken[sample, 3] += change
        assert kept_until(problem, broken) == sample
    # the arm turned about its wrist roll stays on the path, but not within the limits
    beyond = Q.copy()
    beyond[9:, 6] = problem.arm.chain.upper[6] + 0.1
    assert kept_until(problem, beyond) == 9
