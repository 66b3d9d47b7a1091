"""check over HTTP: every form of the request, what is told and what is not, and refusals."""

import httpx
import numpy as np
import pytest

Q = [0.5, 0.7]


def checked(client, robot, body, **query):
    answer = client.post(f"/v1/robots/{robot}/check", json=body, params=query)
    assert answer.status_code == 200, answer.text
    return answer.json()


def test_the_three_forms_give_the_same_answer(client):
    body = {"quantity": "det_jacobian", "answer": "a1*a2*C2", "task": "xy"}
    query = {"quantity": "det_jacobian", "answer": "a1*a2*C2", "task": "xy"}
    posted = checked(client, "planar_2r", body)
    assert client.get("/v1/robots/planar_2r/check", params=query).json() == posted
    assert client.post("/v1/check", json={"robot": "planar_2r", **body}).json() == posted
    assert posted["correct"] is False
    assert posted["diagnosis"][0]["code"] == "sin_and_cos_exchanged"
    assert posted["errors"] == [{"pointer": "/answer", "given": "a1*a2*C2", "off_by": 1.4}]
    assert posted["warnings"] == []


def test_what_is_right_is_told_only_where_it_is_asked(client):
    pose = client.post("/v1/robots/puma560/fk", json={"q": [0.1] * 6}).json()["poses"]["tool"]
    wrong = np.array(pose["matrix"])
    wrong[0, 3] += 0.1
    body = {"quantity": "T", "q": [0.1] * 6, "answer": wrong.tolist()}
    found = checked(client, "puma560", body)
    assert "expected" not in found
    (error,) = found["errors"]
    assert error == {"pointer": "/answer/0/3", "given": wrong[0, 3], "off_by": 0.1}
    assert found["largest_error"] == 0.1
    assert found["note"] == "the rotation is right, the position is not"
    shown = checked(client, "puma560", body | {"reveal": True})
    assert np.allclose(shown["expected"], pose["matrix"], atol=1e-12)


def test_a_deployment_may_show_nothing(tmp_path, start_server, monkeypatch):
    monkeypatch.setenv("DENAVIT_CHECK_REVEAL", "false")
    with start_server(tmp_path) as (address, _):
        body = {"quantity": "det_jacobian", "q": Q, "answer": 0, "task": "xy"}
        url = f"{address}/v1/robots/planar_2r/check"
        assert "expected" not in httpx.post(url, json=body).json()
        for place, sent in (
            (url, body | {"reveal": True}),
            (f"{address}/v1/exercises/planar-2r/check", {"seed": "1", "reveal": True}),
        ):
            answer = httpx.post(place, json=sent)
            assert answer.status_code == 403
            assert answer.json()["type"] == "/problems/not-revealed"
            assert answer.json()["errors"][0]["pointer"] == "/reveal"


def test_degrees_are_degrees_in_the_answer(client):
    body = {"quantity": "ik", "target": {"position": [1.2, 0.8]}}
    both = [[1.460472, 74.037986], [65.919663 + 360, -74.037986]]
    assert checked(client, "planar_2r", body | {"answer": both}, angle="deg")["correct"]
    one = checked(client, "planar_2r", body | {"answer": both[:1]}, angle="deg")
    assert [part["code"] for part in one["diagnosis"]] == ["missing_solution"]
    radians = np.deg2rad(both).tolist()
    found = checked(client, "planar_2r", body | {"answer": radians}, angle="deg")
    assert found["diagnosis"][0]["code"] == "radians_for_degrees"
    step = {"quantity": "delta_q", "q": [30, -45, 60], "delta_x": [0.01, 0], "answer": [0, 0, 0]}
    shown = checked(client, "planar_3r", step | {"reveal": True}, angle="deg")["expected"]
    given = {"q": [30, -45, 60], "delta_x": [0.01, 0], "task": "xy"}
    right = client.post("/v1/robots/planar_3r/step", json=given, params={"angle": "deg"}).json()
    assert shown == pytest.approx(right["delta_q"], abs=1e-9)


@pytest.mark.parametrize("robot", ["planar_3r", "puma560", "pa10", "scara", "panda", "fanuc_m10ia"])
@pytest.mark.parametrize("parameters", ["symbolic", "numeric"])
def test_closed_forms_of_the_service_are_right(client, robot, parameters):
    asked = {"quantities": ["T", "position", "jacobian"], "parameters": parameters}
    forms = client.post(f"/v1/robots/{robot}/symbolic", json=asked).json()
    for quantity, answer in (
        ("T", forms["T"]),
        ("T", list(forms["position"].values())),
        ("jacobian", forms["jacobian"]["matrix"]),
    ):
        assert checked(client, robot, {"quantity": quantity, "answer": answer})["correct"]


@pytest.mark.parametrize(
    ("body", "slug", "pointer"),
    [
        ({"quantity": "pose", "answer": 1}, "invalid-request", "/quantity"),
        ({"quantity": "T"}, "invalid-request", "/answer"),
        ({"quantity": "T", "answer": [[1, 2], [3]], "q": Q}, "invalid-answer", "/answer/1"),
        ({"quantity": "T", "answer": [1, 2, "x y"], "q": Q}, "invalid-answer", "/answer/2"),
        ({"quantity": "T", "answer": [1, 2, None], "q": Q}, "invalid-answer", "/answer/2"),
        ({"quantity": "T", "answer": [1, 2, 3, 4], "q": Q}, "invalid-answer", "/answer"),
        ({"quantity": "T", "answer": [1, 2, 3]}, "invalid-answer", "/q"),
        ({"quantity": "T", "answer": [1, 2, 3], "q": [1]}, "invalid-q", "/q"),
        ({"quantity": "A", "answer": [[0] * 4] * 4, "q": Q}, "invalid-option", "/index"),
        ({"quantity": "A", "answer": [[0] * 4] * 4, "q": Q, "index": 3}, "invalid-option",
         "/index"),
        ({"quantity": "det_jacobian", "answer": "a3*S2"}, "invalid-answer", "/answer"),
        ({"quantity": "det_jacobian", "answer": 1, "q": Q, "task": "pose"}, "invalid-option",
         "/task"),
        ({"quantity": "jacobian", "answer": [[0, 0]] * 4, "q": Q}, "unknown-task", "/task"),
        ({"quantity": "euler", "answer": [1, 2, 3], "q": Q, "euler": "ZZX"},
         "unknown-euler-sequence", "/euler"),
        ({"quantity": "ik", "answer": [0, 0]}, "invalid-option", "/target"),
        ({"quantity": "delta_q", "answer": [0, 0], "q": Q}, "invalid-option", "/delta_x"),
        ({"quantity": "T", "answer": [0, 0, 0], "q": Q, "tolerance": 1}, "invalid-option",
         "/tolerance"),
        ({"quantity": "table", "answer": [{"type": "R", "alpha": "x", "a": 0, "d": 0, "theta": 0}]},
         "invalid-table", "/answer/0/alpha"),
        ({"quantity": "table", "answer": {"joints": [{"type": "R", "alpha": 0, "a": 0}]}},
         "invalid-table", "/answer/joints/0/d"),
        ({"quantity": "table", "answer": 3}, "invalid-answer", "/answer"),
    ],
)  # fmt: skip
def test_what_cannot_be_checked_is_refused_with_its_place(client, body, slug, pointer):
    answer = client.post("/v1/robots/planar_2r/check", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["type"] == f"/problems/{slug}"
    assert answer.json()["errors"][0]["pointer"] == pointer


def test_robots_without_a_table_are_checked_too(client):
    frame = "panda_link5"
    q = [0.3, -0.4, 0.5, -1.2, 0.4, 0.9, 0.1, 0.02]
    asked = {"q": q, "frames": [frame]}
    pose = client.post("/v1/robots/panda_urdf/fk", json=asked).json()["poses"][frame]["matrix"]
    body = {"quantity": "T", "q": q, "frame": frame, "answer": pose}
    assert checked(client, "panda_urdf", body)["correct"]
    turned = {"q": [0.3, -0.4, -0.5, -1.2, 0.4, 0.9, 0.1, 0.02], "frames": [frame]}
    other = client.post("/v1/robots/panda_urdf/fk", json=turned).json()["poses"][frame]["matrix"]
    found = checked(client, "panda_urdf", body | {"answer": other})
    assert [one["code"] for one in found["diagnosis"]] == ["joint_sign"]
    refused = client.post("/v1/robots/panda_urdf/check", json={"quantity": "table", "answer": []})
    assert refused.status_code == 422
