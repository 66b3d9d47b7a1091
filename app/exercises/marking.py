"""From the answers of a student to marks: part by part, each right or not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NoReturn

from app.exercises.catalogue import Part
from app.exercises.drawing import Drawn
from app.http.pointers import json_pointer
from app.http.problems import INVALID_REQUEST, RequestProblem
from app.operations.check import verdict_view
from dh_to_urdf import DHError
from dh_to_urdf.messages import say
from kinematics.checking.answers import read_entries
from kinematics.checking.check import check_answer
from kinematics.checking.question import Quantity, Question
from kinematics.checking.verdict import Verdict
from kinematics.errors import InvalidAnswer, KinematicsError
from robots.errors import hint

NO_ANSWER = say("no answer")
_SHAPES = {"xy": ((2,),), "xyz": ((3,),), "rotation": ((3, 3),), None: ((4, 4), (3, 4))}


def check_names(found: Drawn, answers: Mapping[str, Any]) -> None:
    """Refuse answers to parts that the exercise does not have.

    Raises:
        RequestProblem: 422, with the name.
    """
    known = tuple(part.name for part in found.declaration.parts)
    for name in answers:
        if name not in known:
            raise RequestProblem(
                INVALID_REQUEST,
                say("there is no part {name!r}; {hint}", name=name[:64], hint=hint(name, known)),
                json_pointer(("answers", name)),
            )


def marked(found: Drawn, answers: Mapping[str, Any], *, reveal: bool = False) -> dict[str, Any]:
    """Return the marks of all parts, each with what was found of its answer.

    Args:
        found: The numbers of the student.
        answers: By name of the part; one that is missing is worth nothing.
        reveal: Whether also what is right.
    """
    parts = [
        _marked_part(part, question, answers.get(part.name), reveal=reveal)
        for part, question in found.questions
    ]
    return {
        "name": found.name,
        "seed": found.seed,
        "marks": sum(part["marks"] for part in parts),
        "out_of": found.declaration.marks,
        "parts": parts,
    }


def _marked_part(part: Part, question: Question, answer: Any, *, reveal: bool) -> dict[str, Any]:
    view: dict[str, Any] = {"name": part.name, "marks": 0.0, "out_of": part.marks}
    if answer is None:
        return view | {
            "correct": False,
            "largest_error": None,
            "errors": [],
            "diagnosis": [],
            "note": NO_ANSWER,
        }
    place = ("answers", part.name)
    try:
        found = verdict_view(_checked(part, question, answer), reveal=reveal, within=place)
    except (KinematicsError, DHError) as error:
        found = _unreadable(error, place)
    return view | {"marks": part.marks if found["correct"] else 0.0} | found


def _checked(part: Part, question: Question, answer: Any) -> Verdict:
    if part.quantity is Quantity.TABLE:
        # Which convention is asked stands in the exercise: the answer is read in it.
        document = {"joints": answer} if isinstance(answer, list) else answer
        if isinstance(document, Mapping) and part.convention is not None:
            answer = {**document, "convention": part.convention}
        return check_answer(question, answer)
    entries = read_entries(answer)
    if part.quantity is Quantity.T and entries.shape not in _SHAPES[part.shape]:
        _of_other_form(part)
    if part.formula and not entries.formulas:
        _of_other_form(part)
    if part.both and entries.shape != (2, 3):
        _of_other_form(part)
    if part.solutions == "all" and len(entries.shape) == 1:
        answer = [answer]
    return check_answer(question, answer)


def _of_other_form(part: Part) -> NoReturn:
    forms = {
        "xy": "[x, y]",
        "xyz": say("[x, y, z]"),
        "rotation": say("3 rows of 3"),
        None: say("4 rows of 4"),
    }
    wanted = say("two triples in a list") if part.both else forms[part.shape]
    if part.formula:
        wanted = say("formulas of q1, q2, … that hold at every q")
    raise InvalidAnswer(
        say("answer has another form; give {wanted}", wanted=wanted), argument="answer"
    )


def _unreadable(error: KinematicsError | DHError, place: tuple[str, str]) -> dict[str, Any]:
    """Return what is found of an answer that cannot be read: wrong, with the reason."""
    location = error.faults[0].location if isinstance(error, DHError) else error.location
    message = error.faults[0].message if isinstance(error, DHError) else str(error)
    within = location[1:] if location[:1] == ("answer",) else ()
    return {
        "correct": False,
        "largest_error": None,
        "errors": [{"pointer": json_pointer((*place, *within)), "given": None, "off_by": None}],
        "diagnosis": [{"code": "unreadable", "message": message, "explanation": 1}],
        "note": "",
    }
