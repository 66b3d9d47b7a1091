"""Nearest singular configuration, along each joint alone and in joint space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dh_to_urdf.messages import say
from kinematics.chain import chain_of
from kinematics.configuration import configuration
from kinematics.errors import WrongConfiguration
from kinematics.nearest_singularity.along_joint import SingularAlongJoint, along_joint
from kinematics.nearest_singularity.joint_space import in_joint_space
from kinematics.nearest_singularity.search import Search
from kinematics.singularity import RANK_TOLERANCE
from kinematics.task import POSE, Task
from kinematics.velocity import check_options
from robots.robot import FloatArray, Robot

__all__ = ["NearestSingularity", "SingularAlongJoint", "nearest_singularity"]

LARGEST_VALUE = 1e5


@dataclass(frozen=True, eq=False)
class NearestSingularity:
    """Singular configurations near a q.

    Attributes:
        singular: Whether q itself is singular; then it is the answer everywhere.
        joints: For each joint between base and frame.
        q: The nearest singular configuration found within the limits, shape (dof,); None: none.
        distance: Its Euclidean distance from q, in rad and m.
        singular_value: The smallest singular value there, measured.
    """

    singular: bool
    joints: tuple[SingularAlongJoint, ...]
    q: FloatArray | None
    distance: float | None
    singular_value: float | None


def nearest_singularity(
    robot: Robot,
    q: FloatArray,
    task: Task = POSE,
    frame: str | None = None,
    *,
    tolerance: float = RANK_TOLERANCE,
) -> NearestSingularity:
    """Search for singular configurations near a q.

    Args:
        robot: The robot.
        q: Shape (dof,), rad and m; it may be outside the limits, the results are not.
        task: The task space, in base axes.
        frame: Frame name; default the tip.
        tolerance: A singular value below ``tolerance * max(1, largest)`` counts as zero.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape, is not finite or beyond ±1e5.
        InvalidOption: tolerance out of range.
    """
    check_options(0.0, tolerance)
    frame = frame or robot.tip_frame
    chain = chain_of(robot, frame)
    q = configuration(robot, q)
    if q.ndim != 1:
        raise WrongConfiguration(say("q is a batch; give one q"), argument="q", expected=robot.dof)
    if not np.abs(q).max() <= LARGEST_VALUE:
        joint = robot.joints[int(np.argmax(np.abs(q)))].name
        raise WrongConfiguration(
            say(
                "q of joint {joint} is beyond ±1e5, where no singularities are sought;"
                " give its value within a turn",
                joint=joint,
            ),
            argument="q",
            joint=joint,
            value=float(q[np.argmax(np.abs(q))]),
            lower=-LARGEST_VALUE,
            upper=LARGEST_VALUE,
        )
    if chain.length == 0:
        return NearestSingularity(True, (), q, 0.0, 0.0)
    search = Search(robot, chain, frame, task, q, tolerance)
    sigma, singular = search.decomposed(q)[2:]
    if singular:
        here = tuple(
            SingularAlongJoint(int(k), float(q[k]), 0.0, (float(q[k]),), sigma)
            for k in chain.columns
        )
        return NearestSingularity(True, here, q, 0.0, sigma)
    joints = tuple(along_joint(search, k) for k in range(chain.dof))
    found = in_joint_space(search, joints)
    if found is None:
        return NearestSingularity(False, joints, None, None, None)
    return NearestSingularity(False, joints, found.q, found.distance, found.singular_value)
