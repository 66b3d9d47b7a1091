"""Singularities in words: lost directions, and joint motions that do not move the frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinematics.task import Task
from robots.robot import FloatArray, Robot

MAX_NAMED = 8


def null_motion_in_words(robot: Robot, motion: FloatArray, J: FloatArray) -> str:
    """Describe a joint motion that does not move the task, in words.

    Args:
        robot: The robot.
        motion: Unit joint velocities, shape (dof,).
        J: Geometric Jacobian in base axes, shape (6, dof), for the placement of the joint axes.
    """
    moving = np.flatnonzero(np.abs(motion) > 1e-6 * np.abs(motion).max())
    names = [robot.joints[k].name for k in moving]
    if len(moving) == 1:
        verb = "turns" if robot.is_revolute[moving[0]] else "slides"
        return f"joint {names[0]} {verb} alone and does nothing to the task"
    verb = "turn" if robot.is_revolute[moving].all() else "move"
    listed = f"joints {_listed(names)}"
    if len(moving) == 2 and robot.is_revolute[moving].all():
        turning = J[3:, moving] * motion[moving]
        if np.linalg.norm(turning.sum(axis=1)) <= 1e-6 * np.linalg.norm(turning[:, 0]):
            return f"{listed} turn against each other and do nothing to the task"
    if len(moving) > MAX_NAMED:
        return f"{len(moving)} joints {verb} together and do nothing to the task"
    ratios = " : ".join(f"{x + 0.0:.4g}" for x in motion[moving] / motion[moving[0]])
    return f"{listed} {verb} as {ratios} and do nothing to the task"


def lost_direction_in_words(task: Task, direction: FloatArray) -> str:
    """Describe a direction in which the frame cannot move, in words.

    Args:
        task: The task space.
        direction: Unit vector of the task space, shape (rows,).
    """
    if not task.rotations:
        return f"the frame cannot move along {_vector(task.positions, direction)}"
    if not task.positions:
        return f"the frame cannot turn about {_turning(task, direction)}"
    split = len(task.positions)
    v, w = direction[:split], direction[split:]
    if np.abs(w).max() < 1e-9:
        return f"the frame cannot move along {_vector(task.positions, v)}"
    if np.abs(v).max() < 1e-9:
        return f"the frame cannot turn about {_turning(task, w)}"
    return (
        "no twist of the frame has a part along"
        f" v = {_vector(task.positions, v)}, w = {_turning(task, w)};"
        " that wrench is carried without joint torques"
    )


def _turning(task: Task, values: FloatArray) -> str:
    return _vector(task.rotations, values) + (" in its own axes" if task.own_axes else "")


def _vector(rows: Sequence[int], values: FloatArray) -> str:
    full = np.zeros(3)
    full[list(rows)] = values
    return "(" + ", ".join(f"{x + 0.0:.6g}" if abs(x) > 1e-12 else "0" for x in full) + ")"


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
