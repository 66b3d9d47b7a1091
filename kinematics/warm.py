"""Compiles, or takes from the cache, what requests will call, so that none of them pays for it."""

from __future__ import annotations

import numpy as np

from kinematics.forward import fk
from kinematics.inverse import IKOptions, solve_ik, solve_ik_batch
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.bounds import JointBounds
from kinematics.jacobian import jacobian
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.distances import pair_distance
from kinematics.redundancy.clearance.obstacles import Sphere, encoded
from kinematics.redundancy.follow import followed
from kinematics.redundancy.measure import ends_of_links
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import Gains, PathOptions, PathProblem
from kinematics.task import POSE
from robots.robot import Robot
from robots.shipped import shipped_robot


def warm_up() -> None:
    """Run each compiled function once; seconds the first time, a moment with its cache."""
    robot = shipped_robot("puma560")
    pose = fk(robot, np.full(robot.dof, 0.5))[robot.tip_frame]
    solve_ik(robot, pose)
    solve_ik_batch(robot, pose[None], options=IKOptions(max_restarts=1))
    for name in ("panda", "puma560", "ur5", "scara", "pa10"):
        robot = shipped_robot(name)
        batch = np.full((2, robot.dof), 0.3)
        jacobian(robot, batch)
        pose = fk(robot, batch)[robot.tip_frame][0]
        solve_ik(robot, pose)
        all_solutions(robot, pose)
    _follow_a_path()


def _follow_a_path() -> None:
    """Every compiled method on a short path past a ball."""
    robot = shipped_robot("panda")
    q = np.clip(np.full(robot.dof, 0.3), robot.lower, robot.upper)
    arm = Arm.of(robot, None, POSE)
    start, goal = fk(robot, np.array([q, q + 0.02]))[robot.tip_frame]
    path = polyline(start, [goal], POSE, Sampling(samples=4))
    ball = encoded([Sphere(start[:3, 3] + [0.0, 0.0, 0.5], 0.1)])
    problem = PathProblem(arm, q, path, ball)
    options = PathOptions(gains=Gains(1.0, 1.0, 1.0, 1.0), obstacle_weight=1e-3)
    for name in ("pseudo_inverse", "damped", "null_space", "sqp", "qp"):
        followed(problem, METHODS[name], options)
    (link,) = ends_of_links(problem, arm.reduced(q)[None])[0, :1]
    pair_distance(link[0].copy(), link[1].copy(), ball[0], np.empty(4))


def warm_up_on(robot: Robot) -> None:
    """Computes with a robot once: what is kept of it is made now, not in a request."""
    middle = JointBounds.of(robot).middle()
    pose = fk(robot, middle)[robot.tip_frame]
    jacobian(robot, middle)
    solve_ik(robot, pose, options=IKOptions(max_restarts=0, max_iterations=1))


if __name__ == "__main__":
    warm_up()
