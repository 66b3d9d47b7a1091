"""Compile, or take from the cache, what requests will call, so that none of them pays for it.

``python -m kinematics.warm`` fills the cache, ``--jobs 2`` with two processes.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from kinematics.chain import chain_of
from kinematics.forward import fk
from kinematics.inverse import IKOptions, solve_ik, solve_ik_batch
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.bounds import JointBounds
from kinematics.inverse.continuation.settling import task_columns
from kinematics.inverse.task_error import task_chain
from kinematics.inverse.windings import task_errors
from kinematics.jacobian import jacobian
from kinematics.kernel_cache import is_full, mark_full
from kinematics.named_singularities import factorization
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

CLOSED_FORMS = ("panda", "puma560", "ur5", "scara", "pa10", "so101")
"""Shipped robots: one that is searched, one of each closed form, one with polynomial equations."""


def warm_up() -> None:
    """Run each compiled function once; a minute the first time, a moment with its cache."""
    for half in HALVES:
        half()
    mark_full()


def _solve() -> None:
    """Run forward and inverse kinematics, Jacobians and named singularities, one and many."""
    robot = shipped_robot("puma560")
    batch = np.full((2, robot.dof), 0.5)
    jacobian(robot, batch)
    poses = fk(robot, batch)[robot.tip_frame]
    solve_ik(robot, poses[0])
    solve_ik_batch(robot, poses[:1], options=IKOptions(max_restarts=1))
    factorization(robot, batch, POSE)


def _solve_in_closed_form_and_follow_a_path() -> None:
    """Find all solutions by each closed form, then follow a path."""
    for name in CLOSED_FORMS:
        robot = shipped_robot(name)
        q = np.full(robot.dof, 0.3)
        pose = fk(robot, q)[robot.tip_frame]
        all_solutions(robot, pose)
        chain = chain_of(robot, robot.tip_frame)
        task_errors(chain, pose, POSE, q[chain.columns])
        task_columns(task_chain(chain, POSE), q[chain.columns], np.empty((chain.length, 6)))
    _follow_a_path()


def _follow_a_path() -> None:
    """Follow a short path past a ball by every compiled method."""
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


HALVES = (_solve, _solve_in_closed_form_and_follow_a_path)
"""Two parts that take about as long to compile, and share little."""


def warm_up_on(robot: Robot) -> None:
    """Compute with a robot once, so that what is kept of it is not made in a request."""
    middle = JointBounds.of(robot).middle()
    pose = fk(robot, middle)[robot.tip_frame]
    jacobian(robot, middle)
    solve_ik(robot, pose, options=IKOptions(max_restarts=0, max_iterations=1))


def fill(*options: str, inherited: int | None = None) -> subprocess.Popen[bytes]:
    """Start a process that fills the cache; its exit status is 0 once the cache is full.

    Args:
        options: Of ``python -m kinematics.warm``.
        inherited: A file descriptor that stays open in it.
    """
    # The packages that this process runs, whatever the current directory holds.
    places = (str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", ""))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, places))}
    command = [sys.executable, "-P", "-m", "kinematics.warm", *options]
    kept = () if inherited is None else (inherited,)
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, env=environment, pass_fds=kept)


def main() -> None:
    """Fill the cache, as the command line says."""
    parser = argparse.ArgumentParser(prog="python -m kinematics.warm", description=__doc__)
    parser.add_argument("--jobs", type=int, choices=(1, 2), default=1, help="processes")
    parser.add_argument("--half", type=int, choices=(0, 1), help="one of two halves only")
    parser.add_argument("--nice", type=int, default=0, help="how much lower the priority is")
    chosen = parser.parse_args()
    os.nice(chosen.nice)
    if chosen.half is not None:
        HALVES[chosen.half]()
        return
    if is_full():
        return
    if chosen.jobs == 2:
        halves = [fill("--half", str(half)) for half in range(len(HALVES))]
        statuses = [half.wait() for half in halves]
        if any(statuses):
            sys.exit("the cache is not filled: see above")
    warm_up()


if __name__ == "__main__":
    main()
