"""Manipulability over the ranges of two joints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.configuration import configuration
from kinematics.deadline import svd
from kinematics.errors import InvalidOption
from kinematics.jacobian import task_jacobian
from kinematics.slices import SLICE_BYTES, slices
from kinematics.task import POSE, Task
from kinematics.workspace import drawn_bounds
from robots.errors import hint
from robots.robot import FloatArray, Robot

SAMPLES = Bounds(2, 400)
"""Bounds of the number of values of each joint."""
NUMBERS_A_POINT = 8
"""Rows of the Jacobian of a point, its q, and its poses."""


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
            say(
                "samples is {samples}; give {lower} to {upper}",
                samples=samples,
                lower=SAMPLES.lower,
                upper=SAMPLES.upper,
            ),
            samples,
            "samples",
        )
    columns = _columns(robot, joints)
    lower, upper, assumed = drawn_bounds(robot, columns)
    x, y = (np.linspace(lower[k], upper[k], samples) for k in columns)
    w, inverse = np.empty(samples * samples), np.zeros(samples * samples)
    for part in slices(len(w), NUMBERS_A_POINT * robot.dof):
        grid = np.tile(q, (part.stop - part.start, 1))
        point = np.arange(part.start, part.stop)
        grid[:, columns[0]] = x[point % samples]
        grid[:, columns[1]] = y[point // samples]
        sigma = svd(task_jacobian(robot, grid, task, frame), compute_uv=False)
        largest = sigma[:, 0]
        np.divide(sigma[:, -1], largest, out=inverse[part], where=largest > 0)
        w[part] = np.prod(sigma, axis=1)
    shape = (samples, samples)
    return ManipulabilityMap(joints, x, y, w.reshape(shape), inverse.reshape(shape), assumed)


def peak_bytes(samples: int) -> int:
    """Return the bytes that a map takes while it is computed."""
    return 3 * 8 * samples**2 + SLICE_BYTES


def _columns(robot: Robot, joints: tuple[str, str]) -> tuple[int, int]:
    names = tuple(joint.name for joint in robot.joints)
    for index, name in enumerate(joints):
        if name not in names:
            raise InvalidOption(
                say("there is no joint {name!r}; {hint}", name=name[:64], hint=hint(name, names)),
                argument="joints",
                index=(index,),
                value=name,
                known=names,
            )
    if joints[0] == joints[1]:
        raise InvalidOption(
            say("joints names one joint twice; give two"),
            argument="joints",
            index=(1,),
            value=joints[1],
            known=tuple(name for name in names if name != joints[0]),
        )
    return names.index(joints[0]), names.index(joints[1])
