"""Jacobians, their determinants and the steps that follow from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.checking.answers import Entries
from kinematics.checking.comparing import Measure, check_entries, diagnosed
from kinematics.checking.matrices import absolute
from kinematics.checking.question import Question
from kinematics.checking.readings import (
    Project,
    jacobian_readings,
    jacobian_values,
)
from kinematics.checking.search import Explanation, Reading
from kinematics.checking.situation import Motion, Structure
from kinematics.checking.slips import Slip
from kinematics.checking.verdict import Verdict
from kinematics.errors import InvalidAnswer, InvalidOption, UnknownTask
from kinematics.forward import fk
from kinematics.jacobian import ReferenceFrame, jacobian
from kinematics.orientation import analytic_map, euler_angles, euler_rates_matrix
from kinematics.task import POSE, TASKS, Task, task_from
from robots.robot import FloatArray

STILL = 1e-9
"""Entries of a row of a Jacobian below which the frame does not move in it."""


def task_of(question: Question, rows: int) -> Task:
    """Return the task space of a Jacobian with so many rows.

    Where none is given: all six; the rows in which the frame moves at all, of a planar arm x, y
    and the turn about z; of these those of velocity; or the position.

    Raises:
        UnknownTask: None has so many rows.
    """
    if question.task is not None:
        return question.task
    if rows == 6:
        return POSE
    robot = question.robot
    q = np.random.default_rng(2).uniform(-1.0, 1.0, (5, robot.dof))
    moves = np.abs(jacobian(robot, q, question.frame)).max(axis=(0, 2)) > STILL
    if question.euler is None:
        linear = [bool(one) and k < 3 for k, one in enumerate(moves)]
        for mask in (moves.tolist(), linear):
            if sum(mask) == rows:
                return task_from([int(one) for one in mask])
    if rows == 3:
        return TASKS["position"]
    raise UnknownTask(
        say(
            "say which rows are meant: no usual task of this robot has {rows}; give"
            " task, such as xy, position or a mask of six 0 or 1 for vx, vy, vz,"
            " wx, wy, wz",
            rows=rows,
        ),
        argument="task",
        known=tuple(TASKS),
    )


def _projection(task: Task, reference: ReferenceFrame) -> Project:
    """Return the function that takes the rows of a task out of 6-row Jacobians."""

    def project(J: FloatArray, motion: Motion) -> FloatArray:
        if task.own_axes and reference is not ReferenceFrame.LOCAL:
            return task.of(J, motion.pose[..., :3, :3])
        return J[..., list(task.rows), :]

    return project


def _analytic(sequence: str) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """Return the function that turns angular rows into rates of Euler angles."""

    def turned(J: FloatArray, R: FloatArray) -> FloatArray:
        E = euler_rates_matrix(sequence, euler_angles(R, sequence).solutions[..., 0, :])
        return np.concatenate((J[..., :3, :], np.linalg.pinv(E) @ J[..., 3:, :]), axis=-2)

    return turned


def _exact(question: Question, task: Task) -> Callable[[FloatArray], FloatArray]:
    """Return the function that gives the task's Jacobian from the robot, q (P, dof)."""
    robot, frame = question.robot, question.frame or question.robot.tip_frame
    reference = question.reference_frame

    def exact(q: FloatArray) -> FloatArray:
        J = jacobian(robot, q, frame, reference)
        R = fk(robot, q, [frame])[frame][..., :3, :3]
        if question.euler is not None:
            J = _analytic(question.euler)(J, R)
        elif task.own_axes and reference is not ReferenceFrame.LOCAL:
            return task.of(J, R)
        return np.asarray(J[..., list(task.rows), :])

    return exact


def readings_of(
    question: Question, task: Task, *, square: bool = False
) -> Callable[[Structure], list[Reading]]:
    """Return the function that gives the Jacobian and what may be taken for it."""
    project = _projection(task, question.reference_frame)
    sequence = question.euler

    def readings(structure: Structure) -> list[Reading]:
        if sequence is None:
            return jacobian_readings(structure, question.reference_frame, project, square=square)
        turned = _analytic(sequence)

        def analytic(J: FloatArray, motion: Motion) -> FloatArray:
            return project(turned(J, motion.pose[..., :3, :3]), motion)

        found = jacobian_readings(structure, question.reference_frame, analytic, square=square)
        geometric = jacobian_values(question.reference_frame)
        slip = Slip("geometric_for_analytic")
        return [*found, Reading((slip,), lambda motion: project(geometric(motion), motion))]

    return readings


def check_jacobian(question: Question, entries: Entries) -> Verdict:
    """Check a Jacobian, the rows of a task.

    Raises:
        InvalidAnswer: The answer has another form.
        UnknownTask: No task has as many rows.
    """
    dof, shape = question.robot.dof, entries.shape
    if len(shape) != 2 or dof not in shape:
        raise InvalidAnswer(
            say("answer is no matrix with {dof} columns, one a joint; give it row by row", dof=dof),
            argument="answer",
        )
    rows = shape[0] if shape[1] == dof else shape[1]
    task = task_of(question, rows)
    if question.euler is not None:
        analytic_map(_orientation(question), question.euler)
    if rows != len(task.rows):
        raise InvalidAnswer(
            say(
                "answer has {rows} rows; the task {task} has {count} ({row_names})",
                rows=rows,
                task=task.name,
                count=len(task.rows),
                row_names=", ".join(task.row_names),
            ),
            argument="answer",
        )
    on_its_side = shape[1] != dof
    upright = _transposed(entries) if on_its_side else entries
    readings = readings_of(question, task, square=shape[0] == shape[1])

    def note(wrong: NDArray[np.bool_]) -> str:
        return _matrix_note(wrong, task, tuple(joint.name for joint in question.robot.joints))

    measure = Measure(
        values=lambda motion: right_values(readings, motion),
        exact=_exact(question, task),
        readings=readings,
        allowed=absolute,
        unit=np.ones((len(task.rows), dof)),
        note=note,
        frame=question.frame,
        product=False,
    )
    found = check_entries(question, upright, measure)
    return _on_its_side(found, shape) if on_its_side else found


def right_values(readings: Callable[[Structure], list[Reading]], motion: Motion) -> FloatArray:
    """Return the values of the reading without slips."""
    return readings(motion.structure)[0].values(motion)


def _orientation(question: Question) -> FloatArray:
    robot = question.robot
    q = np.zeros(robot.dof) + 0.1 if question.q is None else question.q
    frame = question.frame or robot.tip_frame
    return fk(robot, q, [frame])[frame][:3, :3]


def _transposed(entries: Entries) -> Entries:
    rows, columns = entries.shape
    values = tuple(entries.values[r * columns + c] for c in range(columns) for r in range(rows))
    return Entries((columns, rows), values)


def _on_its_side(found: Verdict, shape: tuple[int, ...]) -> Verdict:
    """Return the verdict of a transposed answer: wrong, with what else is wrong in it."""
    slip = Slip("transposed", detail="matrix")
    if found.correct:
        note = say(
            "right but transposed: {shape} rows of {shape_2}, one column a joint is asked",
            shape=shape[0],
            shape_2=shape[1],
        )
        return replace(found, correct=False, diagnosis=_also(slip, ()), note=note)
    errors = tuple(replace(one, index=one.index[::-1]) for one in found.errors)
    return replace(found, errors=errors, diagnosis=_also(slip, found.diagnosis))


def _also(slip: Slip, others: tuple[object, ...]) -> tuple:  # type: ignore[type-arg]
    return (*diagnosed([Explanation((slip,), 0.0)]), *others)


def _matrix_note(wrong: NDArray[np.bool_], task: Task, joints: tuple[str, ...]) -> str:
    rows = [
        name
        for name, bad in zip(task.row_names, np.atleast_1d(wrong.any(axis=1)), strict=True)
        if not bad
    ]
    if rows:
        return say("right rows: {rows}", rows=", ".join(rows))
    columns = [
        name for name, bad in zip(joints, np.atleast_1d(wrong.any(axis=0)), strict=True) if not bad
    ]
    return say("right columns: {columns}", columns=", ".join(columns)) if columns else ""


def check_determinant(question: Question, entries: Entries) -> Verdict:
    """Check the determinant of a square Jacobian, a number or a formula.

    Raises:
        InvalidAnswer: The answer has another form.
        InvalidOption: The Jacobian of the task is not square.
    """
    if entries.shape != ():
        raise InvalidAnswer(say("answer is a list; give one number or formula"), argument="answer")
    dof = question.robot.dof
    task = task_of(question, dof)
    if len(task.rows) != dof:
        raise InvalidOption(
            say(
                "the Jacobian of the task {task} has {count} rows and {dof} columns,"
                " and no determinant; give a task with as many rows as the robot has"
                " joints",
                task=task.name,
                count=len(task.rows),
                dof=dof,
            ),
            argument="task",
        )
    rows = readings_of(question, task)
    exact = _exact(question, task)

    def readings(structure: Structure) -> list[Reading]:
        found = [
            Reading(one.slips, lambda motion, one=one: np.linalg.det(one.values(motion)))  # type: ignore[misc]
            for one in rows(structure)
        ]
        right = found[0]
        opposite, size = Slip("opposite_sign", cost=1.05), Slip("without_sign", cost=1.05)
        return [
            *found,
            Reading((size,), lambda motion: np.abs(right.values(motion))),
            Reading((opposite,), lambda motion: -right.values(motion)),
        ]

    size = 1.0
    if question.q is not None:
        # Hadamard's bound: what the determinant can be with columns of this size.
        size = min(1.0, float(np.linalg.norm(exact(question.q[None]), axis=-2).prod()))

    def allowed(expected: FloatArray, tolerance: float) -> FloatArray:
        return tolerance * np.maximum(np.abs(expected), size)

    measure = Measure(
        values=lambda motion: np.linalg.det(right_values(rows, motion)),
        exact=lambda q: np.linalg.det(exact(q)),
        readings=readings,
        allowed=allowed,
        unit=np.ones(()),
        note=lambda _: "",
        frame=question.frame,
        product=False,
    )
    return check_entries(question, entries, measure)
