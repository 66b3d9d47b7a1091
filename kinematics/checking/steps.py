"""Differential steps of the joints: J† Δx, with a motion in the null space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from dh_to_urdf.messages import say
from kinematics.checking.answers import Entries
from kinematics.checking.comparing import Measure, check_entries
from kinematics.checking.jacobians import readings_of, right_values, task_of
from kinematics.checking.question import Question
from kinematics.checking.readings import step_readings
from kinematics.checking.search import Reading
from kinematics.checking.situation import Motion, Structure
from kinematics.checking.slips import Slip
from kinematics.checking.verdict import Verdict
from kinematics.errors import InvalidAnswer, InvalidOption
from kinematics.redundancy.step import StepTask, differential_step
from robots.robot import FloatArray

SMALL_STEP = 10.0
"""The tolerance of a step below 1/10 rad, in parts of its largest entry and of the tolerance."""


def check_step(question: Question, entries: Entries) -> Verdict:
    """Check the differential step ``J† Δx + (I − J†J) z``.

    Raises:
        InvalidAnswer: The answer has another form.
        InvalidOption: q or delta_x is missing.
        RankDeficient: J lacks full row rank, and there is no damping.
    """
    robot = question.robot
    if question.delta_x is None:
        raise InvalidOption(say("delta_x is missing; give the wanted motion"), argument="delta_x")
    if question.q is None:
        raise InvalidOption(say("q is missing; give the joint values"), argument="q")
    if entries.shape != (robot.dof,):
        raise InvalidAnswer(
            say("answer is not {dof} values, one a joint", dof=robot.dof), argument="answer"
        )
    dx = question.delta_x
    task = task_of(question, len(dx))
    right = differential_step(
        robot, question.q, StepTask(dx, task, question.frame), z=question.z,
        damping=question.damping,
    )  # fmt: skip
    z = np.zeros(robot.dof) if question.z is None else question.z
    damped = question.damping**2 * np.eye(len(task.rows))

    def step(J: FloatArray) -> FloatArray:
        Jt = np.swapaxes(J, -1, -2)
        inverse = Jt @ np.linalg.pinv(J @ Jt + damped) if damped.any() else np.linalg.pinv(J)
        return (inverse @ dx) + z - (np.linalg.pinv(J) @ (J @ z)[..., None])[..., 0]

    rows = readings_of(replace(question, euler=None), task)

    def readings(structure: Structure) -> list[Reading]:
        found = step_readings(rows(structure), step, lambda J: np.swapaxes(J, -1, -2) @ dx)
        first = found[0]
        degrees = Slip("degrees_for_radians", detail="answer")
        found.append(_scaled(degrees, first, 180 / np.pi, structure))
        if question.angle != 1.0:
            radians = Slip("radians_for_degrees", detail="answer")
            found.append(_scaled(radians, first, np.pi / 180, structure))
        if z.any():
            for slip, rest in (
                (Slip("null_motion_forgotten"), np.zeros_like(z)),
                (Slip("null_motion_not_projected"), z),
            ):
                found.append(_with_null_motion(slip, rows, step, z, rest))
        return found

    unit = np.where(robot.is_revolute, question.angle, question.length)
    most = float(np.abs(right.delta_q).max(initial=0.0))

    def allowed(expected: FloatArray, tolerance: float) -> FloatArray:
        # Steps are small: of one far below 1 rad the tolerance is a part of its largest entry.
        return np.full(expected.shape, tolerance * min(1.0, SMALL_STEP * most) + 1e-12)

    measure = Measure(
        values=lambda motion: step(right_values(rows, motion)),
        exact=lambda q: np.broadcast_to(right.delta_q, q.shape),
        readings=readings,
        allowed=allowed,
        unit=unit,
        note=lambda _: "",
        frame=question.frame,
        product=False,
    )
    return check_entries(question, entries, measure)


def _scaled(slip: Slip, reading: Reading, factor: float, structure: Structure) -> Reading:
    factors = np.where(structure.turning, factor, 1.0)
    return Reading((slip,), lambda motion: reading.values(motion) * factors)


def _with_null_motion(
    slip: Slip,
    rows: Callable[[Structure], list[Reading]],
    step: Callable[[FloatArray], FloatArray],
    z: FloatArray,
    rest: FloatArray,
) -> Reading:
    """Return the reading of a step that has something else in the place of its null motion."""

    def values(motion: Motion) -> FloatArray:
        J = right_values(rows, motion)
        projected = z - (np.linalg.pinv(J) @ (J @ z)[..., None])[..., 0]
        return step(J) - projected + rest

    return Reading((slip,), values)
