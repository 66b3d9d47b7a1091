"""Poses, link matrices and their products, in numbers or formulas."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dh_to_urdf.messages import say
from kinematics.checking.answers import Entries
from kinematics.checking.comparing import Measure, check_entries, without_base
from kinematics.checking.question import Quantity, Question
from kinematics.checking.readings import pose_readings
from kinematics.checking.search import Reading
from kinematics.checking.situation import Motion, Structure, rows_to
from kinematics.checking.slips import Slip
from kinematics.checking.verdict import Verdict
from kinematics.errors import InvalidAnswer, InvalidOption
from kinematics.forward import fk
from robots.robot import FloatArray

Project = Callable[[FloatArray], FloatArray]
_PLANES = {(0, 1): "xy", (0, 2): "xz", (1, 2): "yz"}


def absolute(expected: FloatArray, tolerance: float) -> FloatArray:
    """Return what is allowed: the tolerance, relative to entries over 1."""
    return tolerance * np.maximum(1.0, np.abs(expected))


def check_matrices(question: Question, entries: Entries) -> Verdict:
    """Check a pose, a link matrix, a product of them, or all of them.

    Raises:
        InvalidAnswer: The answer has another form.
        InvalidOption: The robot has no table, or no row of this number.
    """
    if question.quantity is Quantity.T:
        return _check_pose(question, entries)
    if question.quantity is Quantity.T0 and question.index is None and len(entries.shape) < 3:
        return _check_pose(replace(question, q=np.zeros(question.robot.dof)), entries)
    return _check_links(question, entries)


def _check_pose(question: Question, entries: Entries) -> Verdict:
    project, unit, note = _part(question, entries.shape)
    robot = question.robot
    frame = question.frame or robot.tip_frame

    def pose(motion: Motion) -> FloatArray:
        return motion.pose

    measure = Measure(
        values=lambda motion: project(motion.pose),
        exact=lambda q: project(fk(robot, q, [frame])[frame]),
        readings=lambda _: pose_readings(pose, project),
        allowed=absolute,
        unit=unit,
        note=note,
        frame=question.frame,
    )
    return check_entries(question, entries, measure)


def _part(
    question: Question, shape: tuple[int, ...]
) -> tuple[Project, FloatArray, Callable[[NDArray[np.bool_]], str]]:
    """Return what of a pose an answer of this shape is, its units, and what a note says."""
    lengths = np.ones((4, 4))
    lengths[:3, 3] = question.length
    if shape in ((4, 4), (3, 4)):
        rows = shape[0]
        return lambda T: T[..., :rows, :], lengths[:rows], _pose_note
    if shape == (3, 3):
        return lambda T: T[..., :3, :3], np.ones((3, 3)), lambda _: ""
    wanted: tuple[int, ...] = (0, 1, 2)
    if question.task is not None and question.task.positions:
        wanted = question.task.positions
    elif shape == (2,):
        wanted = _plane_of(question)
    if shape != (len(wanted),):
        raise InvalidAnswer(
            say(
                "answer has {shape}; a pose is 4 rows of 4 (or 3 of 4), a rotation 3 of"
                " 3, a position 3 numbers",
                shape=_shape(shape),
            ),
            argument="answer",
        )
    columns = list(wanted)
    return lambda T: T[..., columns, 3], lengths[columns, 3], lambda _: ""


def _plane_of(question: Question) -> tuple[int, ...]:
    """Return the two coordinates in which a planar arm moves, else x and y."""
    robot = question.robot
    frame = question.frame or robot.tip_frame
    q = np.random.default_rng(1).uniform(-1.0, 1.0, (6, robot.dof))
    moved = np.ptp(fk(robot, q, [frame])[frame][:, :3, 3], axis=0) > 1e-9
    found = tuple(int(k) for k in np.flatnonzero(moved))
    return found if found in _PLANES else (0, 1)


def _pose_note(wrong: NDArray[np.bool_]) -> str:
    rotation, position = wrong[:3, :3].any(), wrong[:3, 3].any()
    if position and not rotation:
        return say("the rotation is right, the position is not")
    if rotation and not position:
        return say("the position is right, the rotation is not")
    if not rotation:
        return say("only the last row is wrong: it is 0 0 0 1")
    return ""


def _check_links(question: Question, entries: Entries) -> Verdict:
    table = question.robot.table
    if table is None:
        raise InvalidOption(
            say("this robot was made from a URDF and has no D-H table; check T instead"),
            argument="quantity",
        )
    count, shape = len(table.rows), entries.shape
    single = shape in ((4, 4), (3, 4), (3, 3))
    index = question.index if question.index is not None else 1 if count == 1 and single else None
    if index is not None and not 1 <= index <= count:
        raise InvalidOption(
            say(
                "index is {index}; the table has {count} rows, give 1 to {count}",
                index=index,
                count=count,
            ),
            argument="index",
            lower=1,
            upper=count,
        )
    if single and index is None:
        raise InvalidOption(
            say(
                "index is missing; say which of the {count} matrices this is, or give all of them",
                count=count,
            ),
            argument="index",
            lower=1,
            upper=count,
        )
    number = say("one matrix") if index is not None else say("{count} matrices", count=count)
    if (index is None and shape not in ((count, 4, 4), (count, 3, 4))) or (
        index is not None and not single
    ):
        raise InvalidAnswer(
            say(
                "answer has {shape}; give {number} of 4 rows of 4",
                shape=_shape(shape),
                number=number,
            ),
            argument="answer",
        )
    if question.quantity is Quantity.T0 and index is not None:
        return _check_product(question, entries, index)
    return _check_all(question, entries, index)


def _check_product(question: Question, entries: Entries, index: int) -> Verdict:
    project, unit, note = _part(question, entries.shape)

    def pose(motion: Motion) -> FloatArray:
        return motion.pose

    measure = Measure(
        values=lambda motion: project(motion.pose),
        exact=_no_table,
        readings=lambda _: pose_readings(pose, project),
        allowed=absolute,
        unit=unit,
        note=note,
        frame=f"frame_{index}",
        prepared=without_base,
    )
    return check_entries(question, entries, measure)


def _check_all(question: Question, entries: Entries, index: int | None) -> Verdict:
    """Check all link matrices or one, or all products."""
    table = question.robot.table
    assert table is not None
    products = question.quantity is Quantity.T0
    rows = list(range(len(table.rows)))
    if products and rows_to(table, "tool") != rows:
        raise InvalidOption(
            say("the table is a tree; check its products one by one, with index"), argument="index"
        )
    height = entries.shape[-2]
    width = entries.shape[-1]
    unit = np.ones((4, 4))
    unit[:3, 3] = question.length

    def all_of(motion: Motion) -> FloatArray:
        found = motion.after if products else motion.A
        return found if index is None else found[..., index - 1, :, :]

    def project(T: FloatArray) -> FloatArray:
        return T[..., :height, :width]

    def readings(structure: Structure) -> list[Reading]:
        found = pose_readings(all_of, project)
        if index is not None:
            for k, name in enumerate(structure.rows):
                if k != index - 1:
                    found.append(_other_row(k, name, project))
        return found

    def note(wrong: NDArray[np.bool_]) -> str:
        if index is not None:
            return _pose_note(wrong) if wrong.shape[-1] == 4 else ""
        right = [str(k + 1) for k in range(len(wrong)) if not wrong[k].any()]
        return (
            say("right: {which} {right}", which="T0" if products else "A", right=", ".join(right))
            if right
            else ""
        )

    measure = Measure(
        values=lambda motion: project(all_of(motion)),
        exact=_no_table,
        readings=readings,
        allowed=absolute,
        unit=unit[:height, :width],
        note=note,
        rows=rows,
        product=products,
        prepared=without_base,
    )
    return check_entries(question, entries, measure)


def _other_row(k: int, name: str, project: Project) -> Reading:
    slip = Slip("other_index", name, cost=1.2)
    return Reading((slip,), lambda motion: project(motion.A[..., k, :, :]))


def _no_table(q: FloatArray) -> FloatArray:
    raise AssertionError(f"a table gives the matrices at {len(q)} q")


def _shape(shape: tuple[int, ...]) -> str:
    if not shape:
        return say("one entry")
    if len(shape) == 1:
        return say("{shape} entries", shape=shape[0])
    if len(shape) == 2:
        return say("{shape} rows of {shape_2}", shape=shape[0], shape_2=shape[1])
    return say(
        "{shape} matrices of {shape_2} rows of {shape_3}",
        shape=shape[0],
        shape_2=shape[1],
        shape_3=shape[2],
    )
