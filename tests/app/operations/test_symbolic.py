"""Closed forms over HTTP: every form of the answer, refusals, and the service meanwhile."""

import math
import os
import re
import shutil
import signal
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress

import httpx
import numpy as np
import pytest
from fastapi import Request

from app.http.handlers import domain_problem
from app.http.rendering import RENDERINGS
from kinematics.errors import WorkersBusy
from kinematics.symbolic import SymbolicUnavailable
from tests.conftest import PATIENCE, until
from tests.processes import symbolic_processes

PA10 = "/v1/robots/pa10/symbolic"


@pytest.mark.scene
def test_position_as_a_student_asks_for_it(client):
    query = {
        "quantities": "position",
        "parameters": "symbolic",
        "base": "frame_0",
        "frame": "frame_7",
    }
    answer = client.get(PA10, params={**query, "format": "text"})
    assert answer.headers["content-type"].startswith("text/plain")
    lines = answer.text.splitlines()
    assert "X = R5*(C1*C2*C3*S4 - S1*S3*S4 + C1*S2*C4) + R3*C1*S2" in lines
    assert "R5 = 0.48" in lines
    assert "C1 = cos(q1)" in lines
    same = client.get(PA10, params=query, headers={"Accept": "text/plain"})
    assert same.text == answer.text
    posted = client.post(PA10, json={**query, "quantities": ["position"]}).json()
    assert posted["position"]["X"] in answer.text
    assert posted["values"] == {"R3": 0.45, "R5": 0.48}
    assert posted["units"] == {"angle": "rad", "length": "m"}


def test_text_is_python(client):
    scope = {"cos": math.cos, "sin": math.sin, "sqrt": math.sqrt, "atan2": math.atan2}
    scope |= {f"q{k}": 0.1 * k for k in range(1, 7)}
    path = "/v1/robots/puma560/symbolic?quantities=all&format=text&parameters=symbolic"
    exec(client.get(path).text, scope)
    found = [scope[f"q{k}"] for k in range(1, 7)]
    q = [0.1 * k for k in range(1, 7)]
    T = client.post("/v1/robots/puma560/fk", json={"q": q}).json()["poses"]["tool"]["matrix"]
    assert scope["X"] == pytest.approx(T[0][3], abs=1e-12)
    assert scope["T_31"] == pytest.approx(T[2][0], abs=1e-12)
    J = client.post("/v1/robots/puma560/jacobian", json={"q": q}).json()["jacobian"]
    assert scope["J_12"] == pytest.approx(J[0][1], abs=1e-12)
    assert scope["det_J"] == pytest.approx(np.linalg.det(J), abs=1e-12)
    # Its own position and rotation are the target of the inverse model at the end.
    reached = client.post("/v1/robots/puma560/fk", json={"q": found}).json()
    np.testing.assert_allclose(reached["poses"]["tool"]["matrix"], T, atol=1e-12)


def test_python_and_c_as_files(client, tmp_path):
    code = client.get("/v1/robots/scara/symbolic?format=python")
    assert code.headers["content-type"].startswith("text/x-python")
    scope = {}
    exec(code.text, scope)
    T = client.get("/v1/robots/scara/fk?q=0.1,0.2,0.1,0.4").json()["poses"]["tool"]["matrix"]
    np.testing.assert_allclose(scope["fk"]([0.1, 0.2, 0.1, 0.4]), T, atol=1e-12)
    source = client.get("/v1/robots/scara/symbolic?format=c")
    assert source.headers["content-type"].startswith("text/x-c")
    if compiler := shutil.which("cc"):
        (tmp_path / "fk.c").write_text(source.text)
        subprocess.run([compiler, "-c", "fk.c"], cwd=tmp_path, check=True)
    body = client.post("/v1/robots/scara/symbolic", json={"format": "python"}).json()
    assert body["code"] == code.text
    assert "T" not in body


def test_latex(client):
    text = client.get("/v1/robots/planar_2r/symbolic?quantities=position,T&format=latex").text
    assert r"X &= C_{1} + 0.8 \, C_{12}" in text
    assert text.count(r"\begin{bmatrix}") == text.count(r"\end{bmatrix}") == 1
    body = {"format": "latex", "quantities": "position", "parameters": "symbolic"}
    answer = client.post("/v1/robots/planar_2r/symbolic", json=body).json()
    assert answer["position"]["X"] == r"a_{1} \, C_{1} + a_{2} \, C_{12}"


def test_inline_tables_and_names(client):
    table = client.get("/v1/robots/planar_2r/dh").json()
    body = {"robot": table, "quantities": ["det_jacobian"], "symbols": {"a1": "L1", "a2": "L2"}}
    answer = client.post("/v1/symbolic", json=body).json()
    assert answer["det_jacobian"]["expression"] == "L1*L2*S2"
    query = "quantities=det_jacobian&symbols=a1:L1,a2:L2"
    assert client.get(f"/v1/robots/planar_2r/symbolic?{query}").json()["values"] == {
        "L1": 1.0,
        "L2": 0.8,
    }


def test_a_robot_from_a_urdf_is_written_by_its_extracted_table(client):
    q = [0.3, -0.7, 1.1, 0.4, -0.9, 0.2]
    body = {"quantities": ["T"], "format": "python"}
    answer = client.post("/v1/robots/ur5_urdf/symbolic", json=body)
    assert answer.json()["convention"] == "modified"
    scope: dict = {}
    exec(answer.json()["code"], scope)
    tip = client.get("/v1/robots/ur5_urdf").json()["tip_frame"]
    T = client.post("/v1/robots/ur5_urdf/fk", json={"q": q}).json()["poses"][tip]["matrix"]
    np.testing.assert_allclose(scope["fk"](q), T, atol=1e-12)


FORMS = {
    "json": "application/json",
    "text": "text/plain",
    "latex": "application/x-latex",
    "python": "text/x-python",
    "c": "text/x-c",
    "matlab": "text/x-matlab",
}


@pytest.mark.parametrize("robot", ["puma560", "ur5", "stanford", "scara", "rx90", "kr6_r900"])
def test_the_inverse_model_in_every_form(client, robot):
    query = {"quantities": "inverse", "parameters": "symbolic"}
    for form, kind in FORMS.items():
        answer = client.get(f"/v1/robots/{robot}/symbolic", params={**query, "format": form})
        assert answer.status_code == 200, answer.text
        assert answer.headers["content-type"].startswith(kind)
        assert "atan2" in answer.text


def test_a_function_finds_what_ik_solutions_finds(client):
    q = [0.1, -0.4, 0.7, 0.3, -0.8, 0.2]
    T = client.post("/v1/robots/kr6_r900/fk", json={"q": q}).json()["poses"]["tool"]["matrix"]
    scope: dict = {}
    body = {"quantities": ["inverse"], "format": "python"}
    exec(client.post("/v1/robots/kr6_r900/symbolic", json=body).json()["code"], scope)
    found = {tuple(one["posture"]): one["q"] for one in scope["inverse_model"](T)}
    asked = {"target": {"matrix": T}, "seed": [0] * 6}
    known = client.post("/v1/robots/kr6_r900/ik/solutions", json=asked).json()["solutions"]
    assert {tuple(one["posture"]) for one in known} == set(found)
    for one in known:
        difference = np.array(one["q"]) - found[tuple(one["posture"])]
        assert np.abs(np.exp(1j * difference) - 1).max() < 1e-10


def test_the_inverse_model_is_derived_in_french(client):
    path = "/v1/robots/ur5/symbolic?quantities=inverse&parameters=symbolic&lang=fr"
    model = client.get(path).json()["inverse"]
    assert model["steps"][0]["title"] == "Le point où les axes 5 et 6 se coupent"
    assert model["postures"] == [["left", "right"], ["up", "down"], ["in", "out"]]
    for form in ("text", "latex", "python", "c", "matlab"):
        text = client.get(f"{path}&format={form}").text
        assert "On multiplie à gauche par l'inverse de A1" in text


def test_the_inverse_model_of_a_urdf_by_its_extracted_table(client):
    q = [0.3, -0.7, 1.1, 0.4, -0.9, 0.2]
    body = {"quantities": ["inverse"], "format": "python"}
    answer = client.post("/v1/robots/ur5_urdf/symbolic", json=body).json()
    scope: dict = {}
    exec(answer["code"], scope)
    tip = client.get("/v1/robots/ur5_urdf").json()["tip_frame"]
    T = client.post("/v1/robots/ur5_urdf/fk", json={"q": q}).json()["poses"][tip]["matrix"]
    found = [one["q"] for one in scope["inverse_model"](T)]
    assert min(np.abs(np.array(one) - q).max() for one in found) < 1e-7


def test_an_arm_without_a_closed_form_is_told_why(client):
    query = {"quantities": "T,inverse"}
    problem = client.get("/v1/robots/panda/symbolic", params=query)
    assert problem.status_code == 422
    (error,) = problem.json()["errors"]
    assert error["pointer"] == "/quantities/1"
    assert "7 joints" in error["message"]
    assert "ik/solutions" in error["message"]
    answer = client.get("/v1/robots/panda/symbolic", params={"quantities": "all"}).json()
    assert answer["inverse"] is None
    assert any(note.startswith("inverse is left out") for note in answer["notes"])


def test_matlab_of_the_other_closed_forms(client):
    path = "/v1/robots/planar_2r/symbolic?quantities=A,position,det_jacobian&format=matlab"
    text = client.get(path).text
    assert text.count("function out = ") == 3
    assert "    out = [C1 + 0.8*C12; S1 + 0.8*S12; 0];" in text
    assert "    out(:, :, 2) = [C2, -S2, 0, 0.8*C2" in text


@pytest.mark.parametrize(
    ("robot", "body", "status", "message"),
    [
        ("pa10", {"quantities": ["det_jacob"]}, 422, "did you mean"),
        ("pa10", {"quantities": []}, 422, "quantities is empty"),
        ("pa10", {"quantities": 3}, 422, "quantities"),
        ("pa10", {"parameters": "maybe"}, 422, "numeric or symbolic"),
        ("pa10", {"symbols": {"R3": "os.system('x')"}}, 422, "cannot name R3"),
        ("pa10", {"symbols": {"R4": "L"}}, 422, "no length 'R4'"),
        ("pa10", {"frame": "frame_8"}, 422, "frame 'frame_8' is unknown"),
        ("pa10", {"format": "word"}, 422, "format is 'word'"),
        ("pa10", {"time_budget_ms": -1}, 422, "time_budget_ms"),
        ("pa10", {"task": "everything"}, 422, "task"),
        ("pa10", {"q": [0] * 7}, 422, "unknown field 'q'"),
    ],
)
def test_refusals(client, robot, body, status, message):
    answer = client.post(f"/v1/robots/{robot}/symbolic", json=body)
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert message in answer.json()["detail"]


@pytest.mark.parametrize("query", ["format=npy", "q=0", "symbols=a1", "time_budget_ms=x"])
def test_refused_queries(client, query):
    assert client.get(f"{PA10}?{query}").status_code == 422


def test_problems_of_the_work_itself():
    assert RENDERINGS[SymbolicUnavailable].type.status == 501
    scope = {"type": "http", "method": "GET", "path": "/", "headers": [], "query_string": b""}
    answer = domain_problem(Request(scope), WorkersBusy("busy", 2.5))
    assert answer.status_code == 503
    assert answer.headers["retry-after"] == "3"


def wild_body(seconds):
    """A request for a determinant that takes longer than that."""
    values = np.random.default_rng(0).uniform(0.1, 1, (6, 3)).tolist()
    joints = [{"type": "R", "alpha": alpha, "a": a, "d": d} for alpha, a, d in values]
    table = {"name": "wild", "convention": "modified", "joints": joints}
    budget = int(1000 * seconds)
    return {"robot": table, "quantities": ["T", "det_jacobian"], "time_budget_ms": budget}


def test_the_service_answers_meanwhile_and_survives_its_workers(start_server, tmp_path):
    with start_server(tmp_path) as (address, process), ThreadPoolExecutor(1) as pool:
        url = f"{address}/v1/symbolic"

        def ask(seconds):
            return httpx.post(url, json=wild_body(seconds), timeout=PATIENCE)

        short = ask(0.3)
        assert short.status_code == 200
        assert short.json()["simplified"]["det_jacobian"] is False

        asked = pool.submit(ask, 60)
        until(lambda: symbolic_processes(process.pid))
        with httpx.Client(base_url=address, timeout=PATIENCE) as others:
            for _ in range(50):
                assert others.get("/health/live").status_code == 200
                assert others.get("/v1/robots/pa10/fk?q=0,0,0,0,0,0,0").status_code == 200
        assert not asked.done()
        while not asked.done():
            for pid in symbolic_processes(process.pid):
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            time.sleep(0.2)
        answer = asked.result()
        assert answer.status_code in (200, 503)
        if answer.status_code == 503:
            assert int(answer.headers["retry-after"]) > 0
            assert re.search("stopped|worker", answer.json()["detail"])
        again = httpx.get(f"{address}/v1/robots/scara/symbolic", timeout=PATIENCE)
        assert again.status_code == 200
        assert again.json()["simplified"] == {"T": True}
