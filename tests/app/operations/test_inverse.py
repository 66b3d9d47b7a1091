"""Inverse kinematics over HTTP beyond the single numeric solve."""

import io
import json

import numpy as np
import pytest

NPY = {"Content-Type": "application/x-npy", "Accept": "application/x-npy"}


@pytest.fixture(scope="module")
def poses(client):
    middle = np.array([0, 0, 0, -1.5, 0, 1.5, 0])
    q = middle + np.random.default_rng(4).uniform(-1, 1, (2000, 7))
    body = {"q": q.tolist()}
    answer = client.post("/v1/robots/panda/fk", json=body).json()
    return np.array(answer["poses"]["tool"]["matrix"])


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def reached(client, q):
    answer = client.post("/v1/robots/panda/fk", json={"q": np.asarray(q).tolist()}).json()
    return np.array(answer["poses"]["tool"]["matrix"])


def test_npy_in_and_out(client, poses):
    answer = client.post("/v1/robots/panda/ik", content=npy(poses), headers=NPY)
    assert answer.status_code == 200, answer.text
    assert answer.headers["x-converged"] == "2000"
    assert answer.headers["x-not-converged"] == ""
    q = np.load(io.BytesIO(answer.content))
    np.testing.assert_allclose(reached(client, q)[:, :3, 3], poses[:, :3, 3], atol=1.1e-6)


def test_npy_says_which_targets_were_not_reached(client, poses):
    some = poses[:5].copy()
    some[3, :3, 3] = 9.0
    answer = client.post("/v1/robots/panda/ik", content=npy(some), headers=NPY)
    assert answer.headers["x-converged"] == "4"
    assert answer.headers["x-not-converged"] == "3"
    bad = poses[:5].copy()
    bad[2] *= 2
    answer = client.post("/v1/robots/panda/ik", content=npy(bad), headers=NPY)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/targets/matrix/2"


@pytest.mark.scene
def test_ndjson_comes_line_by_line(client, poses):
    body = {"targets": {"matrix": poses.tolist()}}
    headers = {"Accept": "application/x-ndjson"}
    with client.stream("POST", "/v1/robots/panda/ik", json=body, headers=headers) as answer:
        assert answer.headers["content-type"] == "application/x-ndjson"
        lines = [json.loads(line) for line in answer.iter_lines()]
    assert [line["index"] for line in lines] == list(range(2000))
    assert {line["status"] for line in lines} == {"converged"}
    q = [line["q"] for line in lines]
    np.testing.assert_allclose(reached(client, q)[:, :3, 3], poses[:, :3, 3], atol=1.1e-6)
    one = client.post("/v1/robots/panda/ik?format=ndjson", json={"target": {"position": [0, 0, 1]}})
    assert one.status_code == 422


def named(solutions):
    return {tuple(one["posture"]): np.array(one["q"]) for one in solutions}


@pytest.mark.scene
def test_all_eight_solutions_of_a_puma_have_their_names(client, exercises):
    table = client.get("/v1/robots/puma560/dh").json()
    table["joints"][0]["d"] = 0
    for joint in table["joints"]:
        joint.pop("limits")
    matrix = np.array(next(e["value"] for k, e in exercises.items() if k.startswith("E13_")))
    fk = client.post("/v1/fk?angle=deg", json={"robot": table, "q": [0, 45, 180, 0, 45, 0]}).json()
    pose = fk["poses"]["tool"]["matrix"]
    np.testing.assert_allclose(pose, matrix, atol=1e-9)
    body = {"robot": table, "target": {"matrix": pose}}
    answer = client.post("/v1/ik/solutions?angle=deg", json=body).json()
    assert answer["method"] == "closed_form"
    assert answer["complete"]
    expected = next(e["value"] for k, e in exercises.items() if k.startswith("E14_"))
    found = named(answer["solutions"])
    assert len(found) == len(answer["solutions"]) == 8
    for one in expected:
        difference = (found[tuple(one["posture"])] - one["q_deg"] + 180) % 360 - 180
        np.testing.assert_allclose(difference, 0, atol=1e-4)


def test_all_eight_solutions_of_a_ur5_have_their_names(client, exercises):
    expected = next(e["value"] for k, e in exercises.items() if k.startswith("E17_"))
    table = client.get("/v1/robots/ur5/dh").json()
    table.pop("base")
    body = {"robot": table, "q": [30, -60, 80, -40, 50, 20]}
    pose = client.post("/v1/fk?angle=deg", json=body).json()["poses"]["tool"]["matrix"]
    body = {"robot": table, "target": {"matrix": pose}}
    answer = client.post("/v1/ik/solutions?angle=deg", json=body).json()
    found = named(answer["solutions"])
    assert len(found) == expected["n"] == 8
    for one in expected["sols"]:
        np.testing.assert_allclose(found[tuple(one["posture"])], one["q_deg"], atol=1e-4)


def test_both_solutions_of_a_planar_arm(client, exercises):
    query = {"position": "1.2,0.8", "task": "xy", "angle": "deg"}
    answer = client.get("/v1/robots/planar_2r/ik/solutions", params=query).json()
    expected = next(e["value"] for k, e in exercises.items() if k.startswith("E5_"))
    found = sorted(one["q"] for one in answer["solutions"])
    np.testing.assert_allclose(found, sorted(expected), atol=1e-6)


def test_arms_without_a_closed_form_are_searched_and_not_called_complete(client, poses):
    body = {"target": {"matrix": poses[0].tolist()}}
    answer = client.post("/v1/robots/panda/ik/solutions", json=body).json()
    assert answer["method"] == "search"
    assert not answer["complete"]
    q = [one["q"] for one in answer["solutions"]]
    assert len(q) > 3
    np.testing.assert_allclose(reached(client, q), np.repeat(poses[:1], len(q), 0), atol=1e-8)


@pytest.mark.parametrize("choice", ["closest", "most_manipulable", "farthest_from_limits"])
def test_a_choice_is_a_solution(client, poses, choice):
    body = {"target": {"matrix": poses[1].tolist()}, "choose": choice}
    answer = client.post("/v1/robots/panda/ik", json=body).json()
    assert answer["status"] == "converged"
    np.testing.assert_allclose(reached(client, answer["q"]), poses[1], atol=1e-6)
    body["choose"] = "best"
    assert client.post("/v1/robots/panda/ik", json=body).status_code == 422
