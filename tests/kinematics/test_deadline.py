"""Every computation that may take long asks, in the middle of its work, whether to go on."""

from contextlib import closing

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.deadline import Cancelled, Deadline, checkpoint, under
from kinematics.derivatives import hessian, jacobian_derivative
from kinematics.errors import OutOfTime
from kinematics.forward import fk
from kinematics.inverse import IKOptions, solve_ik_batch
from kinematics.inverse.all_solutions import all_solutions
from kinematics.nearest_singularity import nearest_singularity
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.obstacles import CircleObstacle, encoded
from kinematics.redundancy.follow import followed
from kinematics.redundancy.methods import METHODS
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import PathOptions, PathProblem
from kinematics.statics import wrench_of
from kinematics.symbolic import Quantity, SymbolicRequest, SymbolicWorkers
from kinematics.task import task_from
from kinematics.velocity import joint_velocities
from robots.robot import robot_from_table
from robots.shipped import shipped_robot

LOOKS = 4


class Counting(Deadline):
    """A deadline that lets a computation look at it so often: whatever the clock says."""

    __slots__ = ("looks",)

    def __init__(self) -> None:
        super().__init__()
        self.looks = 0


class CalledOff(Counting):
    """Nobody waits any more, from the fifth look on."""

    @property
    def is_dropped(self) -> bool:
        self.looks += 1
        return self.looks > LOOKS


class Over(Counting):
    """The time is up, from the fifth look on."""

    def check(self) -> None:
        self.looks += 1
        if self.looks > LOOKS:
            raise OutOfTime

    @property
    def left(self) -> float:
        return 0.0 if self.looks > LOOKS else np.inf


RNG = np.random.default_rng(0)
Q = RNG.uniform(-1, 1, (60_000, 7))
TWIST = np.array([0.1, 0, 0, 0, 0, 0])
ROW = {"type": "R", "a": 0.1, "d": 0.05}
LONG_ARM = {
    "convention": "standard",
    "joints": [{**ROW, "alpha": 0.3 + 0.1 * (k % 7)} for k in range(60)],
}
BENT = RNG.uniform(-2, 2, 60)
PATIENT = IKOptions(max_restarts=10_000, max_iterations=10_000, time_budget=60.0)


def far(robot):
    targets = np.repeat(np.eye(4)[None], 100, axis=0)
    targets[:, :3, 3] = (0.8, 0.0, 0.4)
    return targets


def in_the_plane(method, samples):
    robot, task = shipped_robot("planar_8r"), task_from("xy")
    q = np.array([1.9, -0.25, -0.45, -0.5, -0.5, -0.35, 0, 0.2])
    start = fk(robot, q)[robot.tip_frame]
    goal = start.copy()
    goal[:2, 3] = (1.15, -0.15)
    path = polyline(start, [goal], task, Sampling(samples=samples))
    disc = encoded([CircleObstacle((0.73, 0.22), 0.08)])
    problem = PathProblem(Arm.of(robot, None, task), q, path, disc, d_safe=0.02)
    return followed(problem, METHODS[method], PathOptions())


def determinant():
    values = RNG.uniform(0.1, 1, (6, 3)).tolist()
    rows = [{"type": "R", "alpha": alpha, "a": a, "d": d} for alpha, a, d in values]
    table = read_mapping({"name": "wild", "convention": "standard", "joints": rows})
    with closing(SymbolicWorkers()) as workers:
        return workers.run(table, SymbolicRequest((Quantity.DET_JACOBIAN,), time_budget=60.0))


PANDA = shipped_robot("panda")
COMPUTATIONS = {
    "fk": lambda: fk(PANDA, Q, PANDA.frames),
    "hessian": lambda: hessian(PANDA, Q),
    "jacobian derivative": lambda: jacobian_derivative(PANDA, Q, Q),
    "joint velocities": lambda: joint_velocities(PANDA, Q, np.broadcast_to(TWIST, (len(Q), 6))),
    "wrench": lambda: wrench_of(PANDA, Q, Q),
    "nearest singularity": lambda: nearest_singularity(
        robot_from_table(read_mapping(LONG_ARM)), BENT
    ),
    "many targets": lambda: solve_ik_batch(PANDA, far(PANDA), options=PATIENT),
    "all solutions": lambda: all_solutions(PANDA, fk(PANDA, Q[0])[PANDA.tip_frame]),
    "sqp": lambda: in_the_plane("sqp", 1000),
    "qp": lambda: in_the_plane("qp", 5000),
    "whole path": lambda: in_the_plane("whole_path", 500),
    "determinant": lambda: determinant(),
}


@pytest.mark.parametrize("name", COMPUTATIONS)
def test_it_ends_soon_after_nobody_waits(name):
    deadline = CalledOff()
    with under(deadline), pytest.raises(Cancelled):
        COMPUTATIONS[name]()
    assert deadline.looks <= 2 * LOOKS


@pytest.mark.parametrize(
    "name",
    [
        "fk",
        "hessian",
        "jacobian derivative",
        "joint velocities",
        "wrench",
        "nearest singularity",
        "all solutions",
    ],
)
def test_it_ends_soon_after_its_time_is_up(name):
    """Those that have a part of an answer give it, and are tested where they are."""
    deadline = Over()
    with under(deadline), pytest.raises(OutOfTime):
        COMPUTATIONS[name]()
    assert deadline.looks <= 2 * LOOKS


def test_a_part_is_called_off_with_the_whole():
    whole = Deadline()
    part = Deadline(60.0, of=whole)
    with under(part):
        checkpoint()
        whole.drop()
        with pytest.raises(Cancelled):
            checkpoint()
    assert Deadline(0.0).left == 0.0
    with under(Deadline(-1.0)), pytest.raises(OutOfTime):
        checkpoint()
