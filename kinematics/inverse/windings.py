"""Whole turns of angles, and limits that solutions touch."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinematics.chain import Chain
from kinematics.inverse.damped_step import TURN
from kinematics.inverse.elimination.finishing import turned_all
from kinematics.inverse.result import Tolerance
from kinematics.inverse.task_error import residual, task_chain, workspace
from kinematics.task import Task
from robots.robot import FloatArray, Robot

TOUCH = 1e-6
"""Largest excess of a limit that may be rounding, rad or m: measured before it counts as met."""


def on_circle(difference: FloatArray, is_revolute: NDArray[np.bool_]) -> FloatArray:
    """Return differences of joint values, (…, K), those of angles in [-pi, pi]."""
    turns = np.round(difference / TURN) * TURN
    return np.asarray(np.where(is_revolute, difference - turns, difference))


def turned(robot: Robot, q: FloatArray, reference: FloatArray, chain: Chain) -> FloatArray:
    """Turn the angles of a chain by whole turns as near to a reference as the limits allow.

    Args:
        robot: The robot.
        q: Shape (..., dof), rad and m.
        reference: Shape (dof,), rad and m.
        chain: Whose joints are turned.
    """
    rows = np.array(q, dtype=np.float64, ndmin=2)
    turns = np.zeros(rows.shape[1])
    turns[chain.columns[chain.is_periodic]] = 1.0
    turned_all(rows, reference, np.stack((robot.lower, robot.upper)), turns)
    return rows.reshape(q.shape)


def on_limits(
    robot: Robot,
    chain: Chain,
    target: FloatArray,
    task: Task,
    q: FloatArray,
    tolerance: Tolerance,
) -> tuple[FloatArray, tuple[float, float]] | None:
    """Return q with joints that touch their limits put on them, and its measured errors.

    None where none does, another joint is beyond its limits, or q then misses the target.
    """
    inside = np.clip(q, robot.lower, robot.upper)
    if np.array_equal(inside, q) or np.abs(inside - q).max() > TOUCH:
        return None
    position, orientation = task_errors(chain, target, task, inside[chain.columns])
    if position > tolerance.position or orientation > tolerance.orientation:
        return None
    return inside, (position, orientation)


def task_errors(chain: Chain, target: FloatArray, task: Task, q: FloatArray) -> tuple[float, float]:
    """Return the position error, m, and the rotation error, rad, of a chain's q, shape (K,)."""
    pose = np.array(target, dtype=np.float64).reshape(16)
    position, rotation = residual(
        task_chain(chain, task), pose, np.array(q), workspace(chain.length)
    )
    return float(np.sqrt(position)), float(np.sqrt(rotation))


def within_limits(robot: Robot, q: FloatArray) -> bool:
    """Return whether every entry of q, shape (dof,), is within its limits."""
    return bool(((q >= robot.lower) & (q <= robot.upper)).all())


def apart(robot: Robot, q: FloatArray, other: FloatArray) -> float:
    """Return the largest difference of two configurations, angles by the shorter way."""
    return float(np.abs(on_circle(q - other, robot.is_periodic)).max())
