"""Manipulability over the ranges of two joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinematics.bounds import Bounds
from kinematics.configuration import configuration
from kinematics.deadline import svd
from kinematics.errors import InvalidOption
from kinematics.jacobian import task_jacobian
from kinematics.task import POSE, Task
from kinematics.workspace import drawn_bounds
from robots.errors import hint
from robots.robot import FloatArray, Robot

SAMPLES = Bounds(2, 400)
"""Bounds of the number of values of each joint."""


@dataclass(frozen=True, eq=False)
class ManipulabilityMap:
    """Measures over a grid of two joint values; the other joints are fixed.

    Attributes:
        joints: Names of the two joints.
        x: Values of the first, shape (n,), rad or m.
        y: Values of the second, shape (n,), rad or m.
        manipulability: Yoshikawa's w at (x_i, y_j), shape (n, n): rows by y, columns by x.
        inverse_condition: Smallest over largest singular value, 0 where singular, shape (n, n).
        assumed: Assumptions about joints without limits, in words.
    """

    joints: tuple[str, str]
    x: FloatArray
    y: FloatArray
    manipulability: FloatArray
    inverse_condition: FloatArray
    assumed: tuple[str, ...]


def manipulability_map(
    robot: Robot,
    q: FloatArray,
    joints: tuple[str, str],
    samples: int,
    task: Task = POSE,
    frame: str | None = None,
) -> ManipulabilityMap:
    """Return measures of the task Jacobian over the whole ranges of two joints.

    Args:
        robot: The robot.
        q: Values of the other joints, shape (dof,), rad and m.
        joints: Names of two joints.
        samples: Values of each, within ``SAMPLES``.
        task: The task space, in base axes.
        frame: Frame name; default the tip.

    Returns:
        The map.

    Raises:
        UnknownFrame: The robot has no such frame.
        WrongConfiguration: q has a wrong shape or is not finite.
        InvalidOption: No such joint, one joint twice, a prismatic joint without limits, or
            samples out of range.
    """
    q = configuration(robot, q)
    if samples not in SAMPLES:
        raise SAMPLES.refusal(
            f"samples is {samples}; give {SAMPLES.lower} to {SAMPLES.upper}", samples, "samples"
        )
    columns = _columns(robot, joints)
    lower, upper, assumed = drawn_bounds(robot, columns)
    x, y = (np.linspace(lower[k], upper[k], samples) for k in columns)
    grid = np.tile(q, (samples * samples, 1))
    grid[:, columns[0]] = np.tile(x, samples)
    grid[:, columns[1]] = np.repeat(y, samples)
    sigma = svd(task_jacobian(robot, grid, task, frame), compute_uv=False)
    largest = sigma[:, 0]
    inverse = np.divide(sigma[:, -1], largest, out=np.zeros_like(largest), where=largest > 0)
    shape = (samples, samples)
    return ManipulabilityMap(
        joints, x, y, np.prod(sigma, axis=1).reshape(shape), inverse.reshape(shape), assumed
    )


def _columns(robot: Robot, joints: tuple[str, str]) -> tuple[int, int]:
    names = tuple(joint.name for joint in robot.joints)
    for index, name in enumerate(joints):
        if name not in names:
            raise InvalidOption(
                f"there is no joint {name[:64]!r}; {hint(name, names)}",
                argument="joints",
                index=(index,),
                value=name,
                known=names,
            )
    if joints[0] == joints[1]:
        raise InvalidOption(
            "joints names one joint twice; give two",
            argument="joints",
            index=(1,),
            value=joints[1],
            known=tuple(name for name in names if name != joints[0]),
        )
    return names.index(joints[0]), names.index(joints[1])
