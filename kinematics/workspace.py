"""Workspace: positions of a frame at joint values drawn within the limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dh_to_urdf.messages import say
from kinematics.bounds import Bounds
from kinematics.errors import InvalidOption
from kinematics.forward import fk
from kinematics.slices import SLICE_BYTES, slices
from robots.robot import FloatArray, Robot

SAMPLES = Bounds(1, 200_000)
"""Bounds of the number of points."""


@dataclass(frozen=True, eq=False)
class Workspace:
    """A cloud of reached points.

    Attributes:
        points: Positions of the frame in the axes of the base frame, shape (n, 3), m.
        low: Least coordinates, shape (3,), m.
        high: Greatest coordinates, shape (3,), m.
        assumed: Assumptions about joints without limits, in words.
    """

    points: FloatArray
    low: FloatArray
    high: FloatArray
    assumed: tuple[str, ...]


def workspace(
    robot: Robot, samples: int, frame: str | None = None, random_seed: int = 0
) -> Workspace:
    """Draw joint values uniformly within the limits, and return the positions of the frame.

    Revolute joints without limits cover a whole turn.

    Args:
        robot: The robot.
        samples: Number of points, within ``SAMPLES``.
        frame: Frame name; default the tip.
        random_seed: Seed of the draw; the same seed gives the same points.

    Returns:
        The cloud.

    Raises:
        UnknownFrame: The robot has no such frame.
        InvalidOption: A prismatic joint without limits, or samples out of range.
    """
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
    name = robot.tip_frame if frame is None else frame
    robot.frame_id(name)
    lower, upper, assumed = drawn_bounds(robot)
    generator = np.random.default_rng(random_seed)
    points = np.empty((samples, 3))
    for part in slices(samples, 2 * robot.dof + 16):
        drawn = generator.random((part.stop - part.start, robot.dof))
        q = lower + (upper - lower) * drawn
        points[part] = fk(robot, q, [name])[name][:, :3, 3]
    return Workspace(points, points.min(axis=0), points.max(axis=0), assumed)


def peak_bytes(samples: int) -> int:
    """Return the bytes that a cloud takes while it is drawn."""
    return 2 * 3 * 8 * samples + SLICE_BYTES


def drawn_bounds(
    robot: Robot, columns: Sequence[int] | None = None
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Return bounds of the drawn joint values, shape (dof,) each, and assumptions in words.

    Args:
        robot: The robot.
        columns: Entries of q that are drawn; default all.

    Raises:
        InvalidOption: A prismatic joint has no limits.
    """
    lower, upper = robot.lower.copy(), robot.upper.copy()
    assumed = []
    for k in range(robot.dof) if columns is None else columns:
        joint = robot.joints[k]
        if math.isfinite(lower[k]) and math.isfinite(upper[k]):
            continue
        if not joint.type.is_revolute:
            raise InvalidOption(
                say(
                    "joint {joint} slides without limits; give it lower and upper", joint=joint.name
                ),
                argument="robot",
                value=joint.name,
            )
        if math.isfinite(lower[k]):
            upper[k] = lower[k] + 2 * math.pi
        elif math.isfinite(upper[k]):
            lower[k] = upper[k] - 2 * math.pi
        else:
            lower[k], upper[k] = -math.pi, math.pi
        assumed.append(
            say("joint {joint} has no limits; it goes through a whole turn", joint=joint.name)
        )
    return lower, upper, tuple(assumed)
