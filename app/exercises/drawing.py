"""From a seed to the numbers of an exercise: the same on every machine, in every version.

Numbers come from SHA-256 and not from a library's generator, whose sequence may change. A draw
that is badly conditioned is given up for the next one.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from app.exercises.catalogue import Declaration, Part, Steps, exercise_named
from app.http.problems import INVALID_REQUEST, RequestProblem
from dh_to_urdf import Convention, read_mapping, to_convention
from dh_to_urdf.messages import say
from kinematics.checking.question import Quantity, Question
from kinematics.forward import fk
from kinematics.inverse.all_solutions import all_solutions
from kinematics.jacobian import ReferenceFrame, jacobian, task_jacobian
from kinematics.orientation import euler_angles, rotation_from_euler
from kinematics.symbolic.parameters import lengths_of
from kinematics.task import TASKS
from robots.robot import FloatArray, Robot, robot_from_table

MAX_SEED = 128
DRAWS = 200
CONDITION = 30.0
"""Largest ratio of singular values of a Jacobian that is asked for."""
DEGREE = math.pi / 180
DECIMALS, TARGET_DECIMALS = 9, 4


@dataclass(frozen=True, eq=False)
class Drawn:
    """The numbers of one student.

    Attributes:
        name: Name of the exercise.
        seed: What they are drawn from.
        declaration: The exercise.
        document: The robot's table with these lengths, in degrees.
        lengths: By name, m.
        robot: The robot.
        q: Joint values, shape (dof,), rad.
        questions: What each part asks.
        delta_x: Wanted motion, m; empty where there is none.
        z: Wanted joint motion, rad; likewise.
    """

    name: str
    seed: str
    declaration: Declaration
    document: dict[str, Any]
    lengths: dict[str, float]
    robot: Robot
    q: FloatArray
    questions: tuple[tuple[Part, Question], ...]
    delta_x: FloatArray
    z: FloatArray

    @property
    def shows_q(self) -> bool:
        """Return whether q is given: not where it is what is looked for."""
        return any(part.quantity is not Quantity.IK for part, _ in self.questions)


def check_seed(seed: str) -> None:
    """Refuse a seed that is empty or long, or has characters that cannot be seen.

    Raises:
        RequestProblem: 422.
    """
    if not seed.strip() or len(seed) > MAX_SEED or not seed.isprintable():
        raise RequestProblem(
            INVALID_REQUEST,
            say(
                "seed is empty, longer than {max_seed} characters, or not printable;"
                " give a student's number or name",
                max_seed=MAX_SEED,
            ),
            "/seed",
        )


@lru_cache(maxsize=512)
def drawn(name: str, seed: str) -> Drawn:
    """Return the numbers of a student in an exercise.

    Args:
        name: Name of the exercise.
        seed: Number or name of the student.

    Raises:
        RequestProblem: There is no such exercise, or the seed cannot be one.
    """
    declaration = exercise_named(name)
    check_seed(seed)
    first: Drawn | None = None
    for attempt in range(DRAWS):
        found = _draw(name, seed, declaration, attempt)
        first = first or found
        if _is_well_conditioned(found):
            return found
    assert first is not None
    return first


def _numbers(name: str, seed: str, attempt: int) -> Iterator[int]:
    """Yield integers below 2**32 without end."""
    count = 0
    while True:
        text = f"{name}\n{seed.strip()}\n{attempt}\n{count}"
        digest = hashlib.sha256(text.encode()).digest()
        for k in range(0, len(digest), 4):
            yield int.from_bytes(digest[k : k + 4], "big")
        count += 1


def _value(numbers: Iterator[int], steps: Steps) -> float:
    low, high, step = steps
    choices = round((high - low) / step) + 1
    return round(low + (next(numbers) % choices) * step, DECIMALS)


def _values(numbers: Iterator[int], steps: Sequence[Steps]) -> list[float]:
    return [_value(numbers, one) for one in steps]


def _draw(name: str, seed: str, declaration: Declaration, attempt: int) -> Drawn:
    numbers = _numbers(name, seed, attempt)
    lengths = {one: _value(numbers, steps) for one, steps in declaration.lengths.items()}
    document = {
        "name": name,
        "units": {"angle": "deg", "length": "m"},
        **_filled(declaration.robot, lengths),
    }
    robot = robot_from_table(read_mapping(document))
    q = np.array(_values(numbers, declaration.q)) * DEGREE
    delta_x = np.array(_values(numbers, declaration.delta_x))
    z = np.array(_values(numbers, declaration.z)) * DEGREE
    questions = tuple(
        (part, _question(part, robot, q, delta_x, z, lengths)) for part in declaration.parts
    )
    return Drawn(name, seed, declaration, document, lengths, robot, q, questions, delta_x, z)


def _filled(value: Any, lengths: dict[str, float]) -> Any:
    """Return a document with numbers in the place of names."""
    if isinstance(value, dict):
        return {key: one if key == "name" else _filled(one, lengths) for key, one in value.items()}
    if isinstance(value, list):
        return [_filled(one, lengths) for one in value]
    return lengths.get(value, value) if isinstance(value, str) else value


def _question(
    part: Part,
    robot: Robot,
    q: FloatArray,
    delta_x: FloatArray,
    z: FloatArray,
    lengths: dict[str, float],
) -> Question:
    if part.convention is not None and robot.table is not None:
        robot = robot_from_table(to_convention(robot.table, Convention(part.convention)))
    question = Question(
        quantity=part.quantity,
        robot=robot,
        q=q,
        frame=part.frame,
        task=None if part.task is None else TASKS[part.task],
        euler=part.euler,
        index=part.index,
        symbols=_symbols(robot, lengths),
        every=None if part.solutions is None else part.solutions == "all",
        angle=DEGREE,
    )
    if part.reference_frame is not None:
        question = replace(question, reference_frame=ReferenceFrame(part.reference_frame))
    if part.formula:
        question = replace(question, q=None)
    if part.quantity is Quantity.IK:
        question = replace(question, target=_target(robot, q))
    if part.quantity is Quantity.DELTA_Q:
        question = replace(question, delta_x=delta_x, z=z if part.z else None)
    return question


def _target(robot: Robot, q: FloatArray) -> FloatArray:
    """Return the pose at q, with the few decimals that it is handed out with."""
    T = fk(robot, q)[robot.tip_frame]
    angles = np.rad2deg(euler_angles(T[:3, :3], "ZXZ").solutions[0])
    target = np.eye(4)
    target[:3, :3] = rotation_from_euler("ZXZ", np.deg2rad(np.round(angles, TARGET_DECIMALS)))
    target[:3, 3] = np.round(T[:3, 3], TARGET_DECIMALS)
    return target


def _symbols(robot: Robot, lengths: dict[str, float]) -> dict[str, str]:
    """Return the names of the exercise for the lengths of the table, by their default names."""
    assert robot.table is not None
    found = {}
    for one in lengths_of(robot.table):
        own = [name for name, value in lengths.items() if value == abs(one.value)]
        if len(own) == 1:
            found[one.name] = own[0]
    return found


def _is_well_conditioned(found: Drawn) -> bool:
    """Return whether lengths differ, and no answer is singular or nearly so."""
    lengths = list(found.lengths.values())
    if len(set(lengths)) < len(lengths):
        return False
    if found.declaration.singular:
        return True
    robot, q = found.robot, found.q
    for part, question in found.questions:
        if part.quantity is Quantity.IK and not _has_distinct_solutions(question):
            return False
        if part.quantity in (Quantity.DELTA_Q, Quantity.JACOBIAN, Quantity.DET_JACOBIAN):
            J = (
                task_jacobian(robot, q, TASKS[part.task])
                if part.task is not None
                else jacobian(robot, q)
            )
            sigma = np.linalg.svd(J, compute_uv=False)
            if sigma[0] > CONDITION * sigma[min(J.shape) - 1]:
                return False
    return True


def _has_distinct_solutions(question: Question) -> bool:
    """Return whether the target of a question has several solutions, none of them singular."""
    assert question.target is not None
    assert question.task is not None
    known = all_solutions(question.robot, question.target, task=question.task)
    return (
        known.complete and len(known.solutions) > 1 and not any(one.free for one in known.solutions)
    )
