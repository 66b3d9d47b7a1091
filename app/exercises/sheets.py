"""An exercise as it is handed out: as data, and as a sheet to read."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from typing import Any

import numpy as np

from app.exercises.catalogue import Part, exercises
from app.exercises.drawing import Drawn
from app.exercises.texts import texts
from dh_to_urdf.documents.layouts import to_text
from dh_to_urdf.messages import say
from kinematics.checking.question import Quantity, Question
from kinematics.orientation import euler_angles
from robots.robot import FloatArray

DECIMALS = 6
_TASK_ROWS = {
    None: "vx vy vz wx wy wz",
    "xy": "vx vy",
    "xy_phi": "vx vy wz",
    "position": "vx vy vz",
}


def catalogue_view(language: str) -> list[dict[str, Any]]:
    """Return a line for each exercise."""
    words = texts(language)["exercises"]
    return [
        {
            "name": name,
            "title": words[name]["title"],
            "parts": [part.name for part in one.parts],
            "marks": one.marks,
        }
        for name, one in exercises().items()
    ]


def exercise_view(found: Drawn, language: str, address: str) -> dict[str, Any]:
    """Return an exercise with the numbers of one student.

    Args:
        found: The numbers.
        language: Of the texts.
        address: Of the service, with a slash at the end.
    """
    words = texts(language)["exercises"][found.name]
    return {
        "name": found.name,
        "seed": found.seed,
        "title": words["title"],
        "text": words["text"],
        "units": {"angle": "deg", "length": "m"},
        "robot": found.document,
        "lengths": found.lengths,
        **({"q": _shown(np.rad2deg(found.q))} if found.shows_q else {}),
        **({"delta_x": _shown(found.delta_x)} if found.delta_x.size else {}),
        **({"z": _shown(np.rad2deg(found.z))} if found.z.size else {}),
        "parts": [
            _part_view(part, question, language, found) for part, question in found.questions
        ],
        "marks": found.declaration.marks,
        "send": command(found, address),
    }


def _part_view(part: Part, question: Question, language: str, found: Drawn) -> dict[str, Any]:
    view: dict[str, Any] = {
        "name": part.name,
        "text": texts(language)["exercises"][found.name]["parts"][part.name],
        "quantity": part.quantity.value,
        "form": form_of(part, language),
        "marks": part.marks,
    }
    for name in ("index", "frame", "reference_frame", "task", "euler", "convention"):
        value = getattr(part, name)
        if value is not None:
            view[name] = value
    if part.quantity is Quantity.IK:
        view["target"] = question_target(question)
    return view


def form_of(part: Part, language: str) -> str:
    """Return in which form a part is answered."""
    forms = texts(language)["forms"]
    match part.quantity:
        case Quantity.JACOBIAN:
            form = forms["jacobian"].format(rows=_TASK_ROWS[part.task])
        case Quantity.DET_JACOBIAN:
            return str(forms["formula" if part.formula else "number"])
        case Quantity.EULER:
            return str(forms["both" if part.both else "angles"])
        case Quantity.IK:
            return str(forms["solutions" if part.solutions == "all" else "solution"])
        case Quantity.DELTA_Q:
            return str(forms["solution"])
        case Quantity.TABLE:
            return str(forms["table"])
        case _:
            form = forms[part.shape or "pose"]
    return f"{form}; {forms['formulas']}" if part.formula else str(form)


def question_target(question: Question) -> dict[str, Any]:
    """Return what a posture is to reach, degrees and m."""
    assert question.target is not None
    assert question.task is not None
    rows = [row for row in question.task.rows if row < 3]
    target: dict[str, Any] = {"position": _shown(question.target[rows, 3])}
    if question.task.rotations:
        angles = euler_angles(question.target[:3, :3], "ZXZ").solutions[0]
        target["euler"] = {"sequence": "ZXZ", "angles": _shown(np.rad2deg(angles))}
    return target


def _shown(values: FloatArray) -> list[float]:
    return [round(float(value), DECIMALS) + 0.0 for value in values]


def command(found: Drawn, address: str) -> str:
    """Return the command that sends answers."""
    url = shlex.quote(f"{address}v1/exercises/{found.name}/check?format=text")
    return f"curl -s -H 'Content-Type: application/json' -d @answers.json {url}"


def example_answers(found: Drawn) -> str:
    """Return what a file of answers looks like."""
    answers = {part.name: "…" for part in found.declaration.parts}
    return json.dumps({"seed": found.seed, "answers": answers}, ensure_ascii=False)


def sheet(found: Drawn, language: str, address: str) -> str:
    """Return an exercise as a sheet for a terminal or for paper.

    Args:
        found: The numbers.
        language: Of the texts.
        address: Of the service, with a slash at the end.
    """
    view, words = exercise_view(found, language, address), texts(language)["words"]
    table = found.robot.table
    assert table is not None

    colon = words["colon"]

    def numbers(values: list[float]) -> str:
        return "  ".join(f"{value:.10g}" for value in values)

    lengths = ", ".join(f"{name} = {value:g}" for name, value in found.lengths.items())
    lines = [
        f"{words['exercise']}{colon} {view['title']} ({found.name})",
        f"{words['student']}{colon} {found.seed}",
        "",
        view["text"],
        words["units"],
        words["tolerance"],
        words["formulas"],
        "",
        f"{words['lengths']}{colon} {lengths}",
    ]
    given = [("joints", "q"), ("delta_x", "delta_x"), ("z", "z")]
    lines += [f"{words[word]}{colon} {numbers(view[key])}" for word, key in given if key in view]
    lines += ["", f"{words['table']}{colon}", to_text(table, degrees=True)]
    for number, part in enumerate(view["parts"], start=1):
        lines += [
            f"{number}. {part['name']} ({part['marks']:g} {words['marks']})",
            f"   {part['text']}",
            *_target_lines(part, words, numbers),
            f"   {part['form']}",
        ]
    lines += [
        "",
        f"{words['send']}{colon}",
        "",
        f"  {example_answers(found)}",
        "",
        f"  {view['send']}",
    ]
    return "\n".join(lines) + "\n"


def _target_lines(
    part: dict[str, Any], words: dict[str, str], numbers: Callable[[list[float]], str]
) -> list[str]:
    if "target" not in part:
        return []
    target = part["target"]
    angles = (
        say("; ZXZ {target}", target=numbers(target["euler"]["angles"]))
        if "euler" in target
        else ""
    )
    return [f"   {words['target']}{words['colon']} {numbers(target['position'])}{angles}"]
