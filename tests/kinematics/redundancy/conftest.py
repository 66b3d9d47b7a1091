"""Arms and problems that the tests of this folder share."""

import numpy as np
import pytest

from dh_to_urdf import read_mapping
from kinematics.forward import fk
from kinematics.redundancy.arm import Arm
from kinematics.redundancy.clearance.obstacles import encoded
from kinematics.redundancy.path.geometry import Sampling, polyline
from kinematics.redundancy.problem import PathProblem
from kinematics.task import task_from
from robots.robot import robot_from_table


@pytest.fixture(scope="session")
def planar():
    """A planar N-R arm of given lengths, with limits in degrees and speeds in deg/s."""

    def build(lengths, limits=None, velocity=None):
        joints = []
        for k in range(len(lengths)):
            row = {"type": "R", "alpha": 0, "a": lengths[k - 1] if k else 0, "d": 0}
            if limits is not None:
                row["limits"] = {"lower": limits[k][0], "upper": limits[k][1]}
                if velocity is not None:
                    row["limits"]["velocity"] = velocity
            joints.append(row)
        tool = {"xyz": [lengths[-1], 0, 0], "rpy": [0, 0, 0]}
        units = {"angle": "deg", "length": "m"}
        head = {"name": "planar", "convention": "modified", "units": units, "tool": tool}
        return robot_from_table(read_mapping({**head, "joints": joints}))

    return build


@pytest.fixture(scope="session")
def line():
    """A problem: a straight line by a shift (and turned not at all) from q."""

    def build(robot, q, shift, task="position", obstacles=(), samples=101, tf=4.0, **more):
        q = np.asarray(q, dtype=np.float64)
        space = task_from(task)
        start = fk(robot, q)[robot.tip_frame]
        goal = start.copy()
        goal[:3, 3] += shift
        path = polyline(start, [goal], space, Sampling(samples=samples, tf=tf))
        return PathProblem(Arm.of(robot, None, space), q, path, encoded(obstacles), **more)

    return build
