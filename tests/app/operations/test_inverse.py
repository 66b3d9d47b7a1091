"""Inverse kinematics over HTTP beyond the single numeric solve."""

import io
import json
import re

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


def test_redundant_arms_have_curves_and_are_not_called_complete(client, poses):
    body = {"target": {"matrix": poses[0].tolist()}}
    answer = client.post("/v1/robots/panda/ik/solutions", json=body).json()
    assert answer["method"] == "algebraic"
    assert not answer["complete"]
    assert answer["self_motion"]["dimension"] == 1
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


@pytest.mark.parametrize("form", ["text", "csv", "latex"])
@pytest.mark.parametrize(("language", "word"), [("en", "self_motion"), ("fr", "mouvement interne")])
def test_self_motions_are_told_in_every_form_and_language(client, form, language, word):
    q = [0.3, 0.6, -0.4, 1.2, 0.5, -0.7, 0.2]
    matrix = client.post("/v1/robots/iiwa14/fk", json={"q": q}).json()["poses"]["tool"]["matrix"]
    answer = client.post(
        f"/v1/robots/iiwa14/ik/solutions?format={form}",
        json={"target": {"matrix": matrix}},
        headers={"Accept-Language": language},
    )
    assert answer.status_code == 200
    if form == "text":
        curves = answer.text[answer.text.index(word) :]
        matrices = re.findall(r"^ +q\s?:\n((?: +(?:-?[0-9.]+ *){7}\n)+)", curves, re.MULTILINE)
        assert matrices
        assert all(len(one.splitlines()) > 1 for one in matrices)


def test_self_motions_are_told_in_the_units_of_the_request(client):
    q = [0.3, 0.6, -0.4, 1.2, 0.5, -0.7, 0.2]
    matrix = client.post("/v1/robots/iiwa14/fk", json={"q": q}).json()["poses"]["tool"]["matrix"]
    body = {"target": {"matrix": matrix}}
    rad = client.post("/v1/robots/iiwa14/ik/solutions", json=body).json()
    deg = client.post("/v1/robots/iiwa14/ik/solutions?angle=deg", json=body).json()
    motion = rad["self_motion"]
    assert (motion["dimension"], motion["parameter"], motion["complete"]) == (1, "swivel", True)
    for one, other in zip(motion["curves"], deg["self_motion"]["curves"], strict=True):
        assert one["topology"] in ("arc", "closed")
        for name in ("interval", "lower", "upper", "q", "parameter"):
            np.testing.assert_allclose(np.rad2deg(one[name]), other[name], atol=1e-6)
        assert all(end[0]["reason"] == "limit" for end in one["ends"])
    wished = {**body, "swivel": 30}
    near = client.post("/v1/robots/iiwa14/ik/solutions?angle=deg", json=wished).json()
    assert {round(one["swivel"], 6) for one in near["solutions"]} >= {30.0}
    query = {
        "matrix": ",".join(map(repr, np.ravel(matrix).tolist())),
        "swivel": "30",
        "angle": "deg",
    }
    again = client.get("/v1/robots/iiwa14/ik/solutions", params=query).json()
    assert len(again["solutions"]) == len(near["solutions"])
    refused = client.post("/v1/robots/puma560/ik/solutions", json=wished)
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["pointer"] == "/swivel"


def test_all_windings_on_request(client):
    body = {"target": {"position": [0.4, 0.2, 0.5], "rpy": [0.1, 0.2, 0.3]}}
    nearest = client.post("/v1/robots/ur5/ik/solutions", json=body).json()["solutions"]
    every = client.post("/v1/robots/ur5/ik/solutions", json={**body, "windings": "all"}).json()
    within = sum(one["within_limits"] for one in nearest)
    assert sum(one["within_limits"] for one in every["solutions"]) == 32 * within
    assert every["solutions"][0] == nearest[0]
    refused = client.post("/v1/robots/ur5/ik/solutions", json={**body, "windings": "some"})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["pointer"] == "/windings"


def test_targets_on_one_branch(client):
    start = np.array([0.2, -0.5, 0.4, 0.3, 0.7, 0.1])
    rows = start + np.linspace(0, 1, 7)[:, None] * np.array([0.4, 0.2, -0.1, 0.3, 0.2, 0.5])
    fk = client.post("/v1/robots/puma560/fk", json={"q": rows.tolist()}).json()
    matrix = fk["poses"]["tool"]["matrix"]
    body = {"targets": {"matrix": matrix}, "follow": True, "seed": start.tolist()}
    answer = client.post("/v1/robots/puma560/ik", json=body).json()
    assert set(answer["status"]) == {"converged"}
    np.testing.assert_allclose(answer["q"], rows, atol=1e-5)
    assert answer["branches"][-1]["index"] is None
    matrix[4][0][3] += 5
    answer = client.post("/v1/robots/puma560/ik", json=body).json()
    assert answer["status"] == ["converged"] * 4 + ["not_converged"] * 3
    assert max(one["index"] for one in answer["branches"]) == 4
    assert answer["branches"][0]["index"] == 4
    assert answer["branches"][0]["reason"] == "unreachable"
    one = {"target": {"matrix": matrix[0]}, "follow": True}
    refused = client.post("/v1/robots/puma560/ik", json=one)
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["pointer"] == "/follow"


def test_why_not_for_programs(client):
    far = {"target": {"position": [3, 0, 0], "rpy": [0, 0, 0]}}
    answer = client.post("/v1/robots/puma560/ik", json=far).json()
    assert answer["forbidden"]["by"] == "position"
    assert answer["forbidden"]["proven"]
    assert answer["forbidden"]["position_miss"] > 1
    q = [200, -30, 40, 20, 30, 10]
    matrix = client.post("/v1/robots/puma560/fk?angle=deg", json={"q": q}).json()
    limits = client.get("/v1/robots/puma560/dh").json()
    limits["joints"][0]["limits"] = {"lower": -0.1, "upper": 0.1}
    body = {"robot": limits, "target": {"matrix": matrix["poses"]["tool"]["matrix"]}}
    answer = client.post("/v1/ik?angle=deg", json=body).json()
    assert answer["forbidden"]["by"] == "limits"
    for branch in answer["forbidden"]["branches"]:
        for joint in branch["joints"]:
            assert joint["excess"] == pytest.approx(abs(joint["value"] - joint["limit"]))


@pytest.mark.parametrize(("decimals", "taken"), [(6, True), (4, True), (2, False)])
def test_matrices_as_printed(client, decimals, taken):
    q = [0.3, 0.6, -0.4, 1.2, 0.5, -0.7, 0.2]
    matrix = client.post("/v1/robots/iiwa14/fk", json={"q": q}).json()["poses"]["tool"]["matrix"]
    printed = np.round(matrix, decimals)
    answer = client.post("/v1/robots/iiwa14/ik", json={"target": {"matrix": printed.tolist()}})
    if not taken:
        assert answer.status_code == 422
        return
    body = answer.json()
    assert body["status"] == "converged"
    assert "nearest rotation" in body["warnings"][0]
    many = client.post("/v1/robots/iiwa14/ik", json={"targets": {"matrix": [printed.tolist()]}})
    assert "nearest rotation" in many.json()["warnings"][0]
    printed[:3, 0] *= -1
    answer = client.post("/v1/robots/iiwa14/ik", json={"target": {"matrix": printed.tolist()}})
    assert answer.status_code == 422
    assert "reflection" in answer.json()["detail"]


HALF = np.pi / 2
SPHERICAL = {
    "name": "rrp",
    "convention": "standard",
    "joints": [
        {"name": "j1", "type": "R", "alpha": -HALF, "a": 0, "d": 0.3},
        {"name": "j2", "type": "R", "alpha": HALF, "a": 0, "d": 0.2},
        {"name": "j3", "type": "P", "alpha": 0, "a": 0, "theta": 0},
    ],
}


def test_a_position_is_the_task_of_a_short_arm(client):
    body = {"robot": SPHERICAL, "target": {"position": [0.4, 0.3, 0.5]}}
    answer = client.post("/v1/ik/solutions", json=body).json()
    assert (answer["task"], answer["method"], answer["complete"]) == (
        "position",
        "closed_form",
        True,
    )
    names = {tuple(one["posture"]) for one in answer["solutions"]}
    assert names == {(a, b) for a in ("front", "back") for b in ("extended", "retracted")}
    assert client.post("/v1/ik", json=body).json()["task"] == "position"
    body["targets"] = [body.pop("target")] * 2
    assert client.post("/v1/ik", json=body).json()["status"] == ["converged"] * 2


def test_coordinates_of_a_plane_are_the_task_of_a_plane_arm(client):
    found = client.get("/v1/robots/planar_2r/ik/solutions?position=1.2,0.8").json()
    assert (found["task"], len(found["solutions"])) == ("xy", 2)
    found = client.get("/v1/robots/planar_3r/ik/solutions?position=1.04,0.52&phi=0.3").json()
    assert (found["task"], len(found["solutions"])) == ("xy_phi", 2)


def test_a_position_alone_is_no_pose_of_a_long_arm(client):
    answer = client.get("/v1/robots/puma560/ik/solutions?position=0.4,0.2,0.5")
    assert answer.status_code == 422
    assert "orientation" in answer.json()["detail"]


@pytest.mark.parametrize("operation", ["ik", "ik/solutions"])
def test_what_of_a_pose_is_within_reach(client, operation):
    """Five joints: the position is exact, the orientation the nearest."""
    asked = f"/v1/robots/so101/{operation}?position=0.2,0.1,0.2&rpy=0.1,0.2,0.3&angle=deg"
    answer = client.get(asked).json()
    assert answer.get("status", "not_converged") == "not_converged"
    parts = answer["reachable"]
    errors = [one["orientation_error"] for one in parts]
    assert errors == sorted(errors)
    for one in parts:
        assert one["position_error"] < 1e-8
        assert one["given_up"]
        assert set(one["given_up"]) <= {"direction_of_tool_axis", "rotation_about_tool_axis"}
        q = ",".join(map(str, one["q"]))
        pose = client.get(f"/v1/robots/so101/fk?q={q}&angle=deg").json()["poses"]
        position = pose["gripper_frame_link"]["position"]
        np.testing.assert_allclose(position, [0.2, 0.1, 0.2], atol=1e-7)


def test_arms_of_one_and_two_joints_beyond_their_reach_and_with_an_angle(client):
    slide = {"type": "P", "alpha": 0, "a": 0, "theta": 0, "limits": {"lower": 0, "upper": 1}}
    robot = {"convention": "standard", "joints": [slide]}
    body = {"robot": robot, "target": {"position": [0, 0, 2.5]}, "task": "z"}
    answer = client.post("/v1/ik", json=body)
    assert answer.status_code == 200, answer.text
    assert answer.json()["status"] == "unreachable"
    pose = client.get("/v1/robots/planar_2r/fk?q=0.5,0.3").json()["poses"]["tool"]["position"]
    url = "/v1/robots/planar_2r/ik/solutions"
    one = {"target": {"position": [1, 0, 0]}, "task": "x", "frame": "frame_1"}
    assert client.post(url, json=one).status_code == 200
    both = {"target": {"position": pose, "phi": 0.8}, "task": "xy_phi"}
    answer = client.post(url, json=both).json()
    assert answer["complete"]
    assert [each["q"] for each in answer["solutions"]] == [pytest.approx([0.5, 0.3], abs=1e-9)]
