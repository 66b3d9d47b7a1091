"""Singularities in words: lost directions, and joint motions that do not move the frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dh_to_urdf.messages import say
from kinematics.task import Task
from robots.robot import FloatArray, Robot

MAX_NAMED = 8
NEGLIGIBLE = 1e-6
"""Part of the largest joint velocity that is not told."""
NONE = 1e-9
"""Velocity, per unit of joint velocity and of the Jacobian, that is rounding."""


def null_motion_in_words(
    robot: Robot, motion: FloatArray, J: FloatArray, task: FloatArray | None = None
) -> str:
    """Describe a joint motion that does not move the task, in words.

    Two joints that cancel in space turn by values of opposite signs where their axes point the
    same way, and by values of the same sign where they point opposite ways: the words tell both.

    Args:
        robot: The robot.
        motion: Unit joint velocities, shape (dof,).
        J: Geometric Jacobian in base axes, shape (6, dof), for the placement of the joint axes.
        task: Task Jacobian, shape (rows, dof); says how little the motion does to the task. None:
            the motion is exact.
    """
    moving = np.flatnonzero(np.abs(motion) > NEGLIGIBLE * np.abs(motion).max())
    names = [robot.joints[k].name for k in moving]
    nothing = say("nothing to the task") if task is None else _nothing(motion, task)
    turns = robot.is_revolute[moving]
    if len(moving) == 1:
        verb = say("turns") if turns[0] else say("slides")
        return say(
            "joint {name} {verb} alone and does {nothing}",
            name=names[0],
            verb=verb,
            nothing=nothing,
        )
    verb = say("turn") if turns.all() else say("move") if turns.any() else say("slide")
    listed = say("joints {names}", names=_listed(names))
    if len(moving) > MAX_NAMED:
        return say(
            "{count} joints {verb} together and do {nothing}",
            count=len(moving),
            verb=verb,
            nothing=nothing,
        )
    ratios = " : ".join(f"{x + 0.0:.4g}" for x in motion[moving] / motion[moving[0]])
    if turns.any() and not turns.all():
        ratios += say(" (rad and m)")
    if len(moving) == 2 and turns.all():
        turning = J[3:, moving] * motion[moving]
        if np.linalg.norm(turning.sum(axis=1)) <= 1e-6 * np.linalg.norm(turning[:, 0]):
            if motion[moving[0]] * motion[moving[1]] < 0.0:
                return say(
                    "{listed} turn against each other and do {nothing}",
                    listed=listed,
                    nothing=nothing,
                )
            return say(
                "{listed} turn the same way by value, about axes that point opposite"
                " ways, and do {nothing}",
                listed=listed,
                nothing=nothing,
            )
    return say(
        "{listed} {verb} as {ratios} and do {nothing}",
        listed=listed,
        verb=verb,
        ratios=ratios,
        nothing=nothing,
    )


def lost_direction_in_words(task: Task, direction: FloatArray, J: FloatArray | None = None) -> str:
    """Describe a direction in which the frame cannot move, in words.

    Args:
        task: The task space.
        direction: Unit vector of the task space, shape (rows,).
        J: Task Jacobian, shape (rows, dof); says how little the frame moves that way. None: the
            direction is exact.
    """
    left = 0.0 if J is None else float(np.linalg.norm(direction @ J))
    lost = J is None or left <= NONE * _scale(J)
    cannot = say("cannot") if lost else say("can hardly (by {left:.2g} a unit of q)", left=left)
    if not task.rotations:
        return say(
            "the frame {cannot} move along {vector}",
            cannot=cannot,
            vector=_vector(task.positions, direction),
        )
    if not task.positions:
        return say(
            "the frame {cannot} turn about {turning}",
            cannot=cannot,
            turning=_turning(task, direction),
        )
    split = len(task.positions)
    v, w = direction[:split], direction[split:]
    if np.abs(w).max() < 1e-9:
        return say(
            "the frame {cannot} move along {vector}",
            cannot=cannot,
            vector=_vector(task.positions, v),
        )
    if np.abs(v).max() < 1e-9:
        return say(
            "the frame {cannot} turn about {turning}", cannot=cannot, turning=_turning(task, w)
        )
    wrench = say("v = {v}, w = {w}", v=_vector(task.positions, v), w=_turning(task, w))
    if not lost:
        return say(
            "twists of the frame have a part along {wrench}, of at most {left:.2g} a unit of q",
            wrench=wrench,
            left=left,
        )
    return say(
        "no twist of the frame has a part along {wrench}; that wrench is"
        " carried without joint torques",
        wrench=wrench,
    )


def _nothing(motion: FloatArray, J: FloatArray) -> str:
    """Say that a motion does nothing to the task, or how little."""
    left = float(np.linalg.norm(J @ motion))
    if left <= NONE * _scale(J):
        return say("nothing to the task")
    return say("next to nothing to the task ({left:.2g} a unit)", left=left)


def _scale(J: FloatArray) -> float:
    return max(1.0, float(np.abs(J).max(initial=0.0)))


def _turning(task: Task, values: FloatArray) -> str:
    vector = _vector(task.rotations, values)
    return say("{vector} in its own axes", vector=vector) if task.own_axes else vector


def _vector(rows: Sequence[int], values: FloatArray) -> str:
    full = np.zeros(3)
    full[list(rows)] = values
    return "(" + ", ".join(f"{x + 0.0:.6g}" if abs(x) > 1e-12 else "0" for x in full) + ")"


def _listed(names: Sequence[str]) -> str:
    return say("{names} and {name}", names=", ".join(names[:-1]), name=names[-1])
