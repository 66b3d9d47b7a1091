"""Check an answer against a question."""

from __future__ import annotations

import math

from dh_to_urdf.messages import say
from kinematics.checking.angles import check_angles
from kinematics.checking.answers import Entries, read_entries
from kinematics.checking.jacobians import check_determinant, check_jacobian
from kinematics.checking.matrices import check_matrices
from kinematics.checking.postures import check_solutions
from kinematics.checking.question import Quantity, Question
from kinematics.checking.steps import check_step
from kinematics.checking.tables import check_table
from kinematics.checking.verdict import Verdict
from kinematics.errors import InvalidOption

LEAST_TOLERANCE, MOST_TOLERANCE = 1e-9, 0.1
_CHECKS = {
    Quantity.T: check_matrices,
    Quantity.T0: check_matrices,
    Quantity.A: check_matrices,
    Quantity.JACOBIAN: check_jacobian,
    Quantity.DET_JACOBIAN: check_determinant,
    Quantity.EULER: check_angles,
    Quantity.IK: check_solutions,
    Quantity.DELTA_Q: check_step,
}


def check_answer(question: Question, answer: object) -> Verdict:
    """Say whether an answer is right, where it is not, by how much, and why.

    Args:
        question: What is asked.
        answer: Numbers and formulas in nested lists; for a table its document.

    Raises:
        InvalidAnswer: The answer cannot be read, or has another form than the quantity.
        InvalidOption: Something that the quantity needs is missing.
        DHError: The answer is no table; locations are within the answer.
    """
    tolerance = question.tolerance
    if not (math.isfinite(tolerance) and LEAST_TOLERANCE <= tolerance <= MOST_TOLERANCE):
        raise InvalidOption(
            say(
                "tolerance is {tolerance:g}; give {least_tolerance:g} to {most_tolerance:g}",
                tolerance=tolerance,
                least_tolerance=LEAST_TOLERANCE,
                most_tolerance=MOST_TOLERANCE,
            ),
            argument="tolerance",
            value=tolerance,
            lower=LEAST_TOLERANCE,
            upper=MOST_TOLERANCE,
        )
    if question.quantity is Quantity.TABLE:
        return check_table(question, answer)
    if question.quantity is Quantity.IK and answer == []:
        return check_solutions(question, Entries((0, question.robot.dof), ()))
    return _CHECKS[question.quantity](question, read_entries(answer))
