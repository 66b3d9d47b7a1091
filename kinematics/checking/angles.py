"""Euler angles: any triple that gives the orientation is right, modulo turns."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations, product

import numpy as np

from dh_to_urdf.messages import say
from kinematics.checking.answers import Entries
from kinematics.checking.comparing import diagnosed
from kinematics.checking.formulas import Scope
from kinematics.checking.ground import ground_of
from kinematics.checking.question import Question
from kinematics.checking.readings import rotation_transposed
from kinematics.checking.rounding import cut_short, thresholds
from kinematics.checking.search import (
    Comparison,
    Explanation,
    Reading,
    Trial,
    explanations,
    independent,
)
from kinematics.checking.situation import situation_of
from kinematics.checking.slips import DEGREE, Slip, slips_of
from kinematics.checking.verdict import EntryError, Verdict, largest, told
from kinematics.errors import InvalidAnswer, InvalidOption
from kinematics.forward import fk
from kinematics.orientation import EulerAngles, euler_angles, rotation_from_euler, wrap
from robots.robot import FloatArray

DEFAULT_SEQUENCE = "ZXZ"
SEQUENCES = tuple(
    "".join(axes) for axes in product("XYZ", repeat=3) if axes[0] != axes[1] and axes[1] != axes[2]
)
DIFFERENT = 1e-6
"""Angle, rad, from which on two triples are two solutions."""
_PLACES = ("first", "second", "third")
Change = Callable[[FloatArray], FloatArray]


def check_angles(question: Question, entries: Entries) -> Verdict:
    """Check one triple of Euler angles, or both.

    Raises:
        InvalidAnswer: Not three angles, or twice three; a formula with joint variables.
        InvalidOption: q is missing.
        UnknownSequence: Not a sequence.
    """
    sequence = question.euler or DEFAULT_SEQUENCE
    robot = question.robot
    frame = question.frame or robot.tip_frame
    if entries.shape not in ((3,), (1, 3), (2, 3)):
        raise InvalidAnswer(
            say("answer is not three angles; give [phi, theta, psi], or both solutions in a list"),
            argument="answer",
        )
    if question.q is None:
        raise InvalidOption(say("q is missing; give the joint values"), argument="q")
    R = fk(robot, question.q, [frame])[frame][:3, :3]
    right = euler_angles(R, sequence)
    given = constants(entries).reshape(-1, 3) * question.angle
    verdicts = [_nearest(row, right, R, sequence, question.tolerance) for row in given]
    errors = tuple(
        EntryError(entries.place(3 * k + j), entries.shown(3 * k + j), told(away / question.angle))
        for k, (differences, is_right) in enumerate(verdicts)
        if not is_right
        for j, away in enumerate(differences)
        if away > question.tolerance
    )
    worst = largest(np.array([away for away, _ in verdicts]) / question.angle)
    good = all(is_right for _, is_right in verdicts)

    def expected() -> FloatArray:
        return np.asarray(right.solutions / question.angle)

    if good and len(given) == 2 and not right.degenerate and _same(given, question.tolerance):
        diagnosis = diagnosed([Explanation((Slip("double_solution", "2", "1"),), 0.0)])
        note = say("this triple is right; the other solution is missing")
        return Verdict(False, worst, (), diagnosis, note, expected)
    if good:
        sums = say("only a sum of two angles is determined here") if right.degenerate else ""
        return Verdict(True, worst, (), (), sums, expected)
    found = _why(question, entries, given, verdicts, right, sequence)
    rights = sum(is_right for _, is_right in verdicts)
    half = say("one of the two triples is right") if rights else _right_angles(verdicts, question)
    return Verdict(False, worst, errors, diagnosed(found), half, expected)


def constants(entries: Entries) -> FloatArray:
    """Return the numbers of an answer without joint variables.

    Raises:
        InvalidAnswer: A formula in it has a name.
    """

    def nothing(word: str) -> FloatArray | None:
        del word
        return None

    return np.asarray(entries.at(Scope(nothing), 1)[0])


def _same(given: FloatArray, tolerance: float) -> bool:
    return bool(np.abs(wrap(given[0] - given[1])).max() <= max(2.0 * tolerance, DIFFERENT))


def _nearest(
    given: FloatArray, right: EulerAngles, R: FloatArray, sequence: str, tolerance: float
) -> tuple[FloatArray, bool]:
    """Return the errors against the nearer solution, modulo turns, and whether it is right."""
    differences = np.abs(wrap(given - right.solutions))
    errors = differences[int(np.argmin(differences.max(axis=1)))]
    if errors.max() <= tolerance:
        return errors, True
    away = R.T @ rotation_from_euler(sequence, given)
    sine = float(np.linalg.norm(away - away.T)) / np.sqrt(8.0)
    turned = float(np.arctan2(sine, (np.trace(away) - 1.0) / 2.0))
    if bool(right.degenerate) and turned <= tolerance:
        return np.full(3, turned), True
    return errors, False


def _right_angles(verdicts: list[tuple[FloatArray, bool]], question: Question) -> str:
    if len(verdicts) != 1:
        return ""
    errors, _ = verdicts[0]
    right = [
        place for place, away in zip(_PLACES, errors, strict=True) if away <= question.tolerance
    ]
    return say("right angles: {right}", right=", ".join(right)) if right else ""


def _why(
    question: Question,
    entries: Entries,
    given: FloatArray,
    verdicts: list[tuple[FloatArray, bool]],
    right: EulerAngles,
    sequence: str,
) -> list[Explanation]:
    """Return what explains the first triple that is wrong."""
    assert question.q is not None
    row = next(k for k, (_, is_right) in enumerate(verdicts) if not is_right)
    triple = given[row]
    own = Entries((3,), entries.values[3 * row : 3 * row + 3])
    nearest = min(right.solutions, key=lambda one: float(np.abs(wrap(triple - one)).max()))
    turned = triple - wrap(triple - nearest)
    cut = cut_short(own, triple / question.angle, turned / question.angle)
    if cut is not None:
        return [Explanation((cut,), 0.0)]
    ground = ground_of(question, question.frame)
    structure, situation = situation_of(
        question.robot, ground.table, question.q[None], ground.frame
    )
    transposed = Slip("transposed", detail="rotation", cost=1.1)
    trial = Trial(
        structure,
        situation,
        slips_of(structure, situation, written=ground.is_written),
        [
            Reading((), lambda motion: motion.pose),
            Reading((transposed,), lambda motion: rotation_transposed(motion.pose)),
        ],
        _comparisons(triple, sequence, question.angle),
        thresholds(own, question.tolerance, question.angle),
        min(3, independent(nearest)),
    )
    return explanations(trial)


def _comparisons(triple: FloatArray, sequence: str, unit: float) -> list[Comparison]:
    """Return the ways in which three numbers may have been meant as angles."""
    changes: list[tuple[Slip, str, Change]] = []
    if unit == 1.0:
        slip = Slip("degrees_for_radians", detail="answer")
        changes.append((slip, sequence, lambda angles: angles * DEGREE))
    else:
        slip = Slip("radians_for_degrees", detail="answer")
        changes.append((slip, sequence, lambda angles: angles / DEGREE))
    for other in (*SEQUENCES, *(one.lower() for one in SEQUENCES)):
        if other == sequence:
            continue
        is_rpy = other in ("xyz", "ZYX") and sequence not in ("xyz", "ZYX")
        code, cost = ("rpy_for_euler", 1.05) if is_rpy else ("other_sequence", 1.3)
        changes.append((Slip(code, detail=other, cost=cost), other, lambda angles: angles))
    slip = Slip("angles_in_other_order", cost=1.2)
    changes.append((slip, sequence, lambda angles: angles[::-1]))
    for k, place in enumerate(_PLACES):
        only = np.arange(3) == k
        slip = Slip("angle_sign", place, cost=1.15)
        changes.append((slip, sequence, _negating(only)))
        slip = Slip("quadrant", place, cost=1.15)
        changes.append((slip, sequence, _turning(only)))
    found = [Comparison((), _distance(triple, sequence))]
    found += [Comparison((slip,), _distance(change(triple), s)) for slip, s, change in changes]
    for (one, first_sequence, first), (two, second_sequence, second) in combinations(changes, 2):
        if one.code == two.code:
            continue
        if first_sequence != sequence and second_sequence != sequence:
            continue
        meant = first_sequence if first_sequence != sequence else second_sequence
        found.append(Comparison((one, two), _distance(second(first(triple)), meant)))
    return found


def _negating(only: FloatArray) -> Change:
    return lambda angles: np.where(only, -angles, angles)


def _turning(only: FloatArray) -> Change:
    return lambda angles: np.where(only, angles + np.pi, angles)


def _distance(angles: FloatArray, sequence: str) -> Change:
    R = rotation_from_euler(sequence, angles)

    def distance(T: FloatArray) -> FloatArray:
        return np.asarray(np.abs(T[..., :3, :3] - R).reshape(len(T), -1).max(axis=1))

    return distance
