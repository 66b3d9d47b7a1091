"""Solutions of inverse kinematics: in any order, modulo turns; false, double and missing ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from dh_to_urdf.messages import chained, say
from kinematics.chain import chain_of
from kinematics.checking.angles import constants
from kinematics.checking.answers import Entries
from kinematics.checking.comparing import diagnosed
from kinematics.checking.ground import ground_of
from kinematics.checking.question import Question
from kinematics.checking.rounding import thresholds
from kinematics.checking.search import Comparison, Explanation, Reading, Trial, explanations
from kinematics.checking.situation import Situation, Structure, situation_of
from kinematics.checking.slips import DEGREE, SituationSlip, Slip, slips_of
from kinematics.checking.verdict import MAX_ERRORS, Diagnosis, EntryError, Verdict, told
from kinematics.errors import InvalidAnswer, InvalidOption
from kinematics.forward import fk
from kinematics.inverse.all_solutions import all_solutions
from kinematics.inverse.solutions import IKSolutions
from kinematics.orientation import wrap
from kinematics.task import POSE, Task
from robots.robot import FloatArray, Robot

MAX_SOLUTIONS = 64
DISTINCT = 1e-6
LOOSE = 20.0
"""Error of a pose per error of a joint value, m/rad or rad/rad, that few digits can make."""


@dataclass(frozen=True, eq=False)
class _Given:
    """One solution of the answer.

    Attributes:
        nearest: Number of the nearest right one; None where there is none.
        errors: Joint by joint against it, shape (dof,); rad and m.
        position_error: Of the pose that it reaches, m.
        orientation_error: Likewise, rad.
        is_right: Whether it is a solution.
    """

    nearest: int | None
    errors: FloatArray
    position_error: float
    orientation_error: float
    is_right: bool


def check_solutions(question: Question, entries: Entries) -> Verdict:
    """Check one q that reaches a target, or all of them; an empty list says that none does.

    Raises:
        InvalidAnswer: Not one value a joint, or a list of such lists.
        InvalidOption: Neither a target nor q is given.
    """
    robot = question.robot
    frame = question.frame or robot.tip_frame
    if entries.shape[-1:] != (robot.dof,) or len(entries.shape) > 2:
        raise InvalidAnswer(
            say(
                "answer is no list of solutions; give {dof} values, one a joint, or a"
                " list of such lists",
                dof=robot.dof,
            ),
            argument="answer",
        )
    if entries.shape[0] > MAX_SOLUTIONS and len(entries.shape) == 2:
        raise InvalidAnswer(
            say("answer has more than {max_solutions} solutions", max_solutions=MAX_SOLUTIONS),
            argument="answer",
        )
    task = question.task or POSE
    target = question.target
    if target is None:
        if question.q is None:
            raise InvalidOption(say("target is missing; give the pose to reach"), argument="target")
        target = fk(robot, question.q, [frame])[frame]
    every = len(entries.shape) == 2 if question.every is None else question.every
    unit = np.where(robot.is_revolute, question.angle, question.length)
    rows = np.zeros((0, robot.dof)) if not entries.values else constants(entries)
    rows = rows.reshape(-1, robot.dof) * unit
    known = all_solutions(robot, target, frame=frame, task=task)
    found = [_held(question, row, known, target, task, frame) for row in rows]
    return _judged(question, entries, found, known, rows, target, task, every=every, unit=unit)


def _is_exact(known: IKSolutions) -> bool:
    """Return whether the known solutions are isolated and all that there are."""
    isolated = all(not one.free and one.swivel is None for one in known.solutions)
    return known.complete and isolated and bool(known.solutions)


def _held(
    question: Question,
    q: FloatArray,
    known: IKSolutions,
    target: FloatArray,
    task: Task,
    frame: str,
) -> _Given:
    robot = question.robot
    moving = np.zeros(robot.dof, dtype=bool)
    moving[list(chain_of(robot, frame).columns)] = True
    differences = [_difference(robot, q, one.q, moving) for one in known.solutions]
    nearest, errors = None, np.zeros(robot.dof)
    if differences:
        nearest = int(np.argmin([one.max() for one in differences]))
        errors = differences[nearest]
    position, orientation = _residual(robot, q, target, task, frame)
    is_near = nearest is not None and errors.max() <= question.tolerance
    reaches = max(position, orientation) <= question.tolerance
    is_right = is_near if _is_exact(known) else (is_near or reaches)
    return _Given(nearest, errors, position, orientation, is_right)


def _difference(robot: Robot, q: FloatArray, other: FloatArray, moving: FloatArray) -> FloatArray:
    away = q - other
    away = np.where(robot.is_periodic, wrap(away), away)
    return np.where(moving, np.abs(away), 0.0)


def _residual(
    robot: Robot, q: FloatArray, target: FloatArray, task: Task, frame: str
) -> tuple[float, float]:
    """Return how far a q is from the target in what the task counts, m and rad."""
    errors = _pose_errors(fk(robot, q, [frame])[frame][None], target, task)[0]
    linear = [k for k, row in enumerate(task.rows) if row < 3]
    position = float(np.abs(errors[linear]).max(initial=0.0))
    angular = [k for k, row in enumerate(task.rows) if row >= 3]
    return position, float(np.abs(errors[angular]).max(initial=0.0))


def _pose_errors(T: FloatArray, target: FloatArray, task: Task) -> FloatArray:
    """Return errors of poses row by row of the task, shape (N, rows), m and rad."""
    position = T[:, :3, 3] - target[:3, 3]
    if task.own_axes:
        turned = np.swapaxes(T[:, :3, :3], -1, -2) @ target[:3, 2]
        rotation = np.stack((-turned[:, 1], turned[:, 0], np.zeros(len(T))), axis=-1)
        behind = turned[:, 2] < 0.0
        rotation[behind, :2] += np.pi
    else:
        R = T[:, :3, :3] @ target[:3, :3].T
        rotation = _rotation_vectors(R)
    return np.concatenate((position, rotation), axis=-1)[:, list(task.rows)]


def _rotation_vectors(R: FloatArray) -> FloatArray:
    skew = np.stack(
        (R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]), axis=-1
    )
    sine = np.linalg.norm(skew, axis=-1) / 2.0
    angle = np.arctan2(sine, (np.trace(R, axis1=-2, axis2=-1) - 1.0) / 2.0)
    # Half a turn has no skew part: there the size alone tells that it is wrong.
    axis = np.where(sine[:, None] > 1e-9, skew / (2.0 * np.maximum(sine, 1e-12))[:, None], 0.6)
    return np.asarray(axis * angle[:, None])


def _judged(
    question: Question,
    entries: Entries,
    found: list[_Given],
    known: IKSolutions,
    rows: FloatArray,
    target: FloatArray,
    task: Task,
    *,
    every: bool,
    unit: FloatArray,
) -> Verdict:
    robot = question.robot
    exact = _is_exact(known)
    false = [k for k, one in enumerate(found) if not one.is_right]
    doubles = _doubles(robot, rows, found, question.tolerance)
    missing = _missing(known, found) if every else 0
    errors = tuple(_errors(question, entries, found, false, unit, exact=exact))[:MAX_ERRORS]
    sizes = [
        float((one.errors / unit).max())
        if exact
        else max(one.position_error, one.orientation_error)
        for one in found
    ]
    lists = [] if len(found) == 1 else [Slip("false_solution", str(k + 1)) for k in false]
    lists += [Slip("double_solution", str(b + 1), str(a + 1)) for a, b in doubles]
    if missing:
        code = "missing_solution" if missing == 1 else "missing_solutions"
        lists.append(Slip(code, detail=str(missing)))
    why = _why(question, entries, rows[false], target, task) if false else []
    diagnosis = _numbered(diagnosed(why), diagnosed([Explanation((one,), 0.0) for one in lists]))
    correct = not false and not doubles and not missing

    def expected() -> list[FloatArray]:
        return [one.q / unit for one in known.solutions]

    return Verdict(
        correct,
        told(max(sizes, default=0.0)),
        errors,
        diagnosis,
        _note(known, found, every=every),
        expected,
    )


def _numbered(first: tuple[Diagnosis, ...], second: tuple[Diagnosis, ...]) -> tuple[Diagnosis, ...]:
    """Return the explanations of the numbers, then what is wrong with the list."""
    last = max((one.explanation for one in first), default=0)
    return (*first, *(replace(one, explanation=last + one.explanation) for one in second))


def _doubles(
    robot: Robot, rows: FloatArray, found: list[_Given], tolerance: float
) -> list[tuple[int, int]]:
    pairs = []
    every = np.ones(robot.dof, dtype=bool)
    for b in range(len(rows)):
        for a in range(b):
            if not (found[a].is_right and found[b].is_right):
                continue
            away = float(_difference(robot, rows[a], rows[b], every).max())
            if away <= max(2.0 * tolerance, DISTINCT):
                pairs.append((a, b))
                break
    return pairs


def _missing(known: IKSolutions, found: list[_Given]) -> int:
    """Return how many solutions within the limits are not among the answer."""
    inside = [k for k, one in enumerate(known.solutions) if one.within_limits]
    asked = inside or list(range(len(known.solutions)))
    named = {one.nearest for one in found if one.is_right}
    # Of a redundant arm there are infinitely many, of which no list is complete.
    if any(one.swivel is not None for one in known.solutions):
        return 0
    return sum(k not in named for k in asked)


def _note(known: IKSolutions, found: list[_Given], *, every: bool) -> str:
    right = sum(one.is_right for one in found)
    beyond = sum(
        one.is_right and one.nearest is not None and not known.solutions[one.nearest].within_limits
        for one in found
    )
    parts = []
    if len(found) > 1 or (every and right):
        parts.append(
            say(
                "{right} of {count} given solutions reach the target", right=right, count=len(found)
            )
        )
    if beyond:
        parts.append(say("{beyond} of them beyond the joint limits", beyond=beyond))
    if every and not known.complete:
        parts.append(say("there may be more solutions than are known"))
    return chained(", ", parts)


def _errors(
    question: Question,
    entries: Entries,
    found: list[_Given],
    false: list[int],
    unit: FloatArray,
    *,
    exact: bool,
) -> list[EntryError]:
    listed: list[EntryError] = []
    many = len(entries.shape) == 2
    for k in false:
        one = found[k]
        place = (k,) if many else ()
        if exact:
            for j, away in enumerate(one.errors):
                if away > question.tolerance:
                    shown = entries.shown(k * len(one.errors) + j)
                    listed.append(EntryError((*place, j), shown, told(float(away / unit[j]))))
        else:
            off = one.position_error / question.length or one.orientation_error / question.angle
            listed.append(EntryError(place, None, told(off)))
    return listed


def _why(
    question: Question, entries: Entries, false: FloatArray, target: FloatArray, task: Task
) -> list[Explanation]:
    """Return what explains the false solutions: all of them, else the first."""
    own = thresholds(entries, question.tolerance, max(question.angle, 1e-3))
    limits = tuple(sorted({1e-6, *(LOOSE * one for one in own if one > 1e-8)}))
    ground = ground_of(question, question.frame)
    for rows in [false] if len(false) == 1 else [false, false[:1]]:
        structure, situation = situation_of(question.robot, ground.table, rows, ground.frame)
        slips = slips_of(structure, situation, written=ground.is_written, units=False)
        slips = [*_in_wrong_unit(question, structure), *slips]

        def distance(T: FloatArray) -> FloatArray:
            errors = _pose_errors(T.reshape(-1, 4, 4), target, task)
            return np.asarray(np.abs(errors).reshape(len(T), -1).max(axis=1))

        trial = Trial(
            structure,
            situation,
            slips,
            [Reading((), lambda motion: motion.pose)],
            [Comparison((), distance)],
            limits,
            len(task.rows) * len(rows),
        )
        found = explanations(trial)
        if found:
            return found
    return []


def _in_wrong_unit(question: Question, structure: Structure) -> list[SituationSlip]:
    """Return the slips of giving joint values in another unit than asked."""

    def scaled(factor: float, turning: bool, one: Situation) -> Situation:
        chosen = structure.turning if turning else ~structure.turning
        return replace(one, q=np.where(chosen, one.q * factor, one.q))

    found = []
    if structure.turning.any():
        if question.angle == 1.0:
            slip, factor = Slip("degrees_for_radians", detail="answer"), DEGREE
        else:
            slip, factor = Slip("radians_for_degrees", detail="answer"), 1 / DEGREE
        found.append(SituationSlip(slip, partial(scaled, factor, True)))
    if not structure.turning.all():
        slip = Slip("mm_for_m", detail="q", cost=1.1)
        found.append(SituationSlip(slip, partial(scaled, 1e-3, False)))
    return found
