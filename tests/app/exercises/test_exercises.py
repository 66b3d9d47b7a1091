"""Exercises: other numbers for each seed, marks for right answers, and a class in CSV."""

import csv
import io
import json
import re
import subprocess

import numpy as np
import pytest

from app.exercises.catalogue import exercises
from app.exercises.drawing import drawn
from app.exercises.marking import marked
from app.exercises.sheets import exercise_view, sheet
from app.exercises.texts import LANGUAGES, texts
from kinematics.checking.check import check_answer
from kinematics.inverse.all_solutions import all_solutions
from tests.conftest import DENAVIT

NAMES = tuple(exercises())
FORMULAS = {
    ("planar-2r", "position"): ["L1*C1 + L2*C12", "L1*S1 + L2*S12"],
    ("planar-2r", "jacobian"): [["-L1*S1 - L2*S12", "-L2*S12"], ["L1*C1 + L2*C12", "L2*C12"]],
    ("planar-2r", "determinant"): "L1*L2*S2",
    ("planar-3r", "position"): ["L1 C1 + L2 C12 + L3 C123", "L1 S1 + L2 S12 + L3 S123"],
    ("planar-3r", "determinant"): "L1 L2 sin(q2)",
    ("pa10-pose", "wrist"): [
        "R5*(S4*C3*C2*C1 - S4*S3*S1 + C4*S2*C1) + R3*C1*S2",
        "R5*(S4*C3*C2*S1 + S4*S3*C1 + C4*S2*S1) + R3*S2*S1",
        "R1 - R5*S4*C3*S2 + R5*C4*C2 + R3*C2",
    ],
    ("singularity", "position"): [
        "C1*(a2*C2 + a3*C23)", "S1*(a2*C2 + a3*C23)", "d1 + a2*S2 + a3*S23",
    ],
    ("singularity", "determinant"): "-a2*a3*S3*(a2*C2 + a3*C23)",
}  # fmt: skip


def right_answers(found):
    """Answers to all parts: formulas by hand, numbers as the service would tell them."""
    answers = {}
    for part, question in found.questions:
        formula = FORMULAS.get((found.name, part.name))
        if formula is not None:
            answers[part.name] = formula
        elif part.quantity.value == "ik":
            known = all_solutions(question.robot, question.target, task=question.task).solutions
            rows = np.rad2deg([one.q for one in known]).round(4)
            answers[part.name] = rows.tolist() if part.solutions == "all" else rows[-1].tolist()
        elif part.quantity.value == "table":
            answers[part.name] = table_of(question)
        else:
            answers[part.name] = shown(part, question)
    return answers


def table_of(question):
    columns = ("alpha", "a", "d", "theta")
    rows = [{name: getattr(row, name) for name in columns} for row in question.robot.table.rows]
    angles = {"alpha", "theta"}
    return [
        {"type": "R"} | {k: float(np.rad2deg(x)) if k in angles else x for k, x in row.items()}
        for row in rows
    ]


def shown(part, question):
    """What is right, by way of a wrong answer of the same form."""
    dof = question.robot.dof
    form = {
        "jacobian": np.zeros((len(question.task.rows) if question.task else 6, dof)),
        "euler": np.zeros(3),
        "delta_q": np.zeros(dof),
        "det_jacobian": np.zeros(()),
    }.get(part.quantity.value, np.zeros((3, 3) if part.shape == "rotation" else (4, 4)))
    right = np.asarray(check_answer(question, form.tolist()).expected())
    if part.quantity.value == "euler" and not part.both:
        right = right[1]
    return right.round(4).tolist()


@pytest.mark.parametrize("name", NAMES)
def test_right_answers_get_all_marks_and_those_of_a_neighbour_none(name):
    for seed in ("20261234", "20261235", "Zoé"):
        found = drawn(name, seed)
        marks = marked(found, right_answers(found))
        assert marks["marks"] == marks["out_of"] == found.declaration.marks, marks
    neighbour = marked(drawn(name, "another"), right_answers(drawn(name, "20261234")))
    numbers = [one for one in neighbour["parts"] if (name, one["name"]) not in FORMULAS]
    general = {("conventions", "modified")}
    assert not any(one["correct"] for one in numbers if (name, one["name"]) not in general)


@pytest.mark.parametrize("name", NAMES)
def test_seeds_draw_other_numbers_and_the_same_seed_the_same(name):
    seen = {json.dumps(exercise_view(drawn(name, str(k)), "en", "/")["robot"]) for k in range(40)}
    assert len(seen) > 5 if name == "euler-zxz" else len(seen) > 15
    drawn.cache_clear()
    first = exercise_view(drawn(name, "7"), "en", "/")
    drawn.cache_clear()
    assert exercise_view(drawn(name, "7"), "en", "/") == first


KEPT = ({"L1": 0.85, "L2": 0.5}, [-15.0, 100.0])


def test_numbers_of_a_seed_are_those_of_every_version():
    # What a student was given once must be marked the same way for ever.
    found = drawn("planar-2r", "20261234")
    assert (found.lengths, np.rad2deg(found.q).round(9).tolist()) == KEPT


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_exercise_has_its_texts(name, language):
    found = drawn(name, "1")
    words = texts(language)["exercises"][name]
    assert set(words["parts"]) == {part.name for part in found.declaration.parts}
    assert set(words) == {"title", "text", "parts"}
    page = sheet(found, language, "http://localhost:8000/")
    for part in found.declaration.parts:
        assert words["parts"][part.name] in page
    assert set(texts("en")["words"]) == set(texts(language)["words"])
    assert set(texts("en")["forms"]) == set(texts(language)["forms"])


def test_inverse_models_do_not_give_their_answer_away():
    for name in ("inverse-2r", "inverse-6r"):
        view = exercise_view(drawn(name, "5"), "en", "/")
        assert "q" not in view
        assert view["parts"][0]["target"]["position"]


def test_an_exercise_over_http(client):
    listed = client.get("/v1/exercises", headers={"Accept-Language": "fr-FR, en;q=0.5"}).json()
    titles = {one["name"]: one["title"] for one in listed["exercises"]}
    assert set(titles) == set(NAMES)
    assert titles["planar-2r"] == "Un bras plan à deux articulations"
    found = client.get("/v1/exercises/planar-2r", params={"seed": "42"}).json()
    pose = client.post(
        "/v1/fk", json={"robot": found["robot"], "q": found["q"]}, params={"angle": "deg"}
    ).json()["poses"]["tool"]["matrix"]
    answers = {"T": pose, "determinant": "L1*L2*C2", "position": [1, 2]}
    sent = {"seed": "42", "answers": answers}
    marks = client.post("/v1/exercises/planar-2r/check", json=sent).json()
    parts = {one["name"]: one for one in marks["parts"]}
    assert (marks["marks"], marks["out_of"]) == (2, 10)
    assert parts["T"]["correct"]
    assert parts["determinant"]["diagnosis"][0]["code"] == "sin_and_cos_exchanged"
    assert parts["position"]["diagnosis"][0]["code"] == "unreadable"
    assert parts["A1"]["note"] == "no answer"
    assert "expected" not in parts["determinant"]
    page = client.get("/v1/exercises/planar-2r", params={"seed": "42", "format": "text"}).text
    assert re.search(r"curl .*/v1/exercises/planar-2r/check", page)


@pytest.mark.parametrize(
    ("method", "path", "body", "status", "pointer"),
    [
        ("GET", "/v1/exercises/nothing?seed=1", None, 404, ""),
        ("GET", "/v1/exercises/planar-2r", None, 422, "/seed"),
        ("GET", "/v1/exercises/planar-2r?seed=%20", None, 422, "/seed"),
        ("GET", f"/v1/exercises/planar-2r?seed={'9' * 200}", None, 422, "/seed"),
        ("GET", "/v1/exercises/planar-2r?seed=1&lang=de", None, 422, "/lang"),
        ("GET", "/v1/exercises/planar-2r?seed=1&angle=deg", None, 422, "/angle"),
        ("POST", "/v1/exercises/nothing/check", {"seed": "1"}, 404, ""),
        ("POST", "/v1/exercises/planar-2r/check", {"answers": {}}, 422, "/seed"),
        ("POST", "/v1/exercises/planar-2r/check", {"seed": 1}, 422, "/seed"),
        ("POST", "/v1/exercises/planar-2r/check", {"seed": "1", "answers": {"X": 1}}, 422,
         "/answers/X"),
        ("POST", "/v1/exercises/planar-2r/check", {"seed": "1", "answer": 1}, 422, "/answers"),
    ],
)  # fmt: skip
def test_refusals_name_their_place(client, method, path, body, status, pointer):
    answer = client.request(method, path, json=body)
    assert answer.status_code == status, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer


def denavit(*arguments):
    run = subprocess.run([*DENAVIT, *arguments], capture_output=True, text=True, check=False)
    return run.returncode, run.stdout, run.stderr


def test_a_class_list_becomes_sheets_and_a_table_of_marks(tmp_path):
    students = tmp_path / "class.csv"
    students.write_text("id;name\n101;Ada\n102;=Eve\n103;Zoé\n104;Max\n", encoding="utf-8-sig")
    status, out, err = denavit(
        "sheets", "planar-2r", str(students), "--out", str(tmp_path / "sheets"), "--lang", "fr"
    )
    assert status == 0, err
    pages = {path.name: path.read_text() for path in (tmp_path / "sheets").iterdir()}
    assert set(pages) == {"101.txt", "102.txt", "103.txt", "104.txt"}
    assert len(set(pages.values())) == 4
    folder = tmp_path / "answers"
    folder.mkdir()
    right = right_answers(drawn("planar-2r", "101"))
    (folder / "101.json").write_text(json.dumps({"seed": "101", "answers": right}))
    (folder / "102.json").write_text(json.dumps({"determinant": "-L1*L2*S2"}))
    (folder / "103.json").write_text("{")
    status, out, err = denavit("marks", "planar-2r", str(students), "--answers", str(folder))
    assert status == 0, err
    rows = list(csv.DictReader(io.StringIO(out), delimiter=";"))
    assert [row["total"] for row in rows] == ["10", "0", "0", "0"]
    assert rows[1]["name"] == "'=Eve"
    assert "sign is opposite" in rows[1]["remarks"]
    assert "103.json cannot be read" in rows[2]["remarks"]
    assert rows[3]["remarks"] == "no answer"


def test_answers_may_stand_in_the_list(tmp_path):
    students, marks = tmp_path / "class.csv", tmp_path / "marks.csv"
    answers = '"[""L1*C1 + L2*C12"", ""L1*S1 + L2*S12""]"'
    students.write_text(f"id,position,determinant\n7,{answers},L1*L2*S2\n8,,0.5*foo\n")
    status, _, err = denavit("marks", "planar-2r", str(students), "--out", str(marks))
    assert status == 0, err
    first, second = csv.DictReader(marks.read_text().splitlines())
    assert (first["position"], first["determinant"], first["total"]) == ("2", "2", "4")
    assert second["total"] == "0"
    assert "foo" in second["remarks"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("name\nAda\n", "no column is called id"),
        ("id\n1\n1\n", "stands in line 2 already"),
        ("id,name\n,Ada\n", "has no id"),
        ("id,name\n1,a,b\n", "more cells"),
        ("id\n1\n", "no column of answers"),
        ("id,T\na/b,1\na b,2\n", "same name"),
    ],
)
def test_class_lists_that_cannot_be_used_are_refused(tmp_path, text, words):
    students = tmp_path / "class.csv"
    students.write_text(text)
    status, _, err = denavit("marks", "planar-2r", str(students))
    assert status != 0
    assert words in err
    assert "Traceback" not in err
