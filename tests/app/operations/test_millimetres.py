"""Lengths in millimetres, in and out: the answer is that in metres, its lengths times 1000."""

from __future__ import annotations

import copy
import io
import re

import numpy as np
import pytest

ARM = {
    "name": "stanford",
    "convention": "standard",
    "tool": {"xyz": [0, 0, 0.26]},
    "joints": [
        {"name": "j1", "type": "R", "a": 0, "alpha": -1.5707963267948966, "d": 0.4},
        {"name": "j2", "type": "R", "a": 0, "alpha": 1.5707963267948966, "d": 0.15},
        {"name": "j3", "type": "P", "a": 0, "alpha": 0, "theta": 0, "d": 0},
        {"name": "j4", "type": "R", "a": 0, "alpha": -1.5707963267948966, "d": 0},
        {"name": "j5", "type": "R", "a": 0, "alpha": 1.5707963267948966, "d": 0},
        {"name": "j6", "type": "R", "a": 0, "alpha": 0, "d": 0},
    ],
}
for joint in ARM["joints"]:
    slides = joint["type"] == "P"
    joint["limits"] = {"lower": 0.1 if slides else -3, "upper": 0.9 if slides else 3}
SLIDE = 2
Q = [0.3, 0.5, 0.5, 0.4, 0.8, -0.5]
IN_MM = [*Q[:2], 500.0, *Q[3:]]

JOINTS = {"q", "seed", "delta_q", "task_motion", "null_motion", "lower", "upper", "qd", "start"}
JOINTS |= {"velocity", "acceleration"}
LENGTHS = {"position", "position_error", "position_miss", "points", "low", "high", "clearance"}
LENGTHS |= {"clearance_swept", "max_position_error", "end_position_error", "min_clearance"}
LENGTHS |= {"min_clearance_swept"}
ROWS = {"twist", "achieved"}
"""Three lengths and three angles, or their rates."""
MATRICES = {"matrix", "A", "T0", "T", "base", "tool"}
MIXED = {"norm", "distance", "sum_dq", "largest_step", "limit_margin", "null_motions", "drift"}
"""Norms of joint values and directions, in whatever units these have."""
TIMES = {"elapsed_ms", "ms_per_point"}


def in_mm(answer, key=""):
    """Return what an answer in m is in mm."""
    if isinstance(answer, dict):
        return {name: in_mm(value, name) for name, value in answer.items()}
    if key in MATRICES and isinstance(answer, list):
        T = np.array(answer)
        T[..., :3, 3] *= 1000
        return T.tolist()
    if key in LENGTHS and answer is not None:
        return (np.array(answer) * 1000).tolist()
    if key in JOINTS and isinstance(answer, list):
        q = np.array(answer)
        q[..., SLIDE] *= 1000
        return q.tolist()
    if key in ROWS:
        return (np.array(answer) * [1000, 1000, 1000, 1, 1, 1]).tolist()
    if key == "residuals":
        return [in_mm(one, "achieved") for one in answer]
    if isinstance(answer, list):
        return [in_mm(one) for one in answer]
    return answer


def close(given, expected, path=""):
    if isinstance(expected, dict):
        assert set(given) == set(expected), path
        for key, value in expected.items():
            if key not in TIMES | MIXED | {"units"}:
                close(given[key], value, f"{path}/{key}")
    elif isinstance(expected, list):
        assert len(given) == len(expected), path
        for k, value in enumerate(expected):
            close(given[k], value, f"{path}/{k}")
    elif isinstance(expected, float) and not isinstance(given, bool):
        assert given == pytest.approx(expected, abs=1e-6, rel=1e-7), path
    else:
        assert given == expected, path


TARGET = {"position": [0.2, 0.6, 0.9], "kuka_abc": [0.1, 0.5, -0.3]}
OBSTACLES = [
    {"type": "sphere", "center": [0.9, 0.9, 0.1], "radius": 0.1},
    {"type": "box", "center": [-0.9, 0.9, 0.1], "size": [0.1, 0.2, 0.3], "rpy": [0.1, 0, 0]},
    {"type": "capsule", "start": [0, -0.9, 0], "end": [0, -0.9, 1], "radius": 0.05},
    {"type": "half_space", "normal": [0, 0, 1], "offset": -0.5},
]
TOOL = {"tool": {"xyz": [0.01, 0.02, 0.03]}, "base": np.eye(4).tolist()}
TOOL["base"][0][3] = 0.25
BODIES = {
    "fk": {"q": Q, **TOOL, "euler": "ZXZ"},
    "ik": {"target": TARGET, "seed": Q, "tolerance": {"position": 1e-7}},
    "ik/solutions": {"target": TARGET, "seed": Q},
    "jacobian": {"q": Q},
    "singularity/nearest": {"q": Q},
    "step": {"q": Q, "delta_x": [0.01, 0, 0.02, 0, 0.1, 0]},
    "twist": {"q": Q, "qd": [0.1, 0.2, 0.03, 0.4, 0.5, 0.6]},
    "joint-velocities": {"q": Q, "twist": [0.1, 0, 0.2, 0, 0.3, 0]},
    "dh-matrices": {"q": Q},
    "workspace": {"samples": 1000},
    "path": {
        "q": Q,
        "target": {"position": [0.3, 0.5, 0.8]},
        "task": "position",
        "samples": 12,
        "obstacles": OBSTACLES,
        "link_radius": {"j1": 0.01, "j2": 0.01, "j3": 0.02, "j4": 0.01, "j5": 0.01, "j6": 0.01},
        "d_safe": 0.01,
        "tolerance": {"position": 1e-5},
        "method": "sqp",
    },
}


def body_in_mm(value, key=""):
    """Return a body in m in mm."""
    if isinstance(value, dict):
        if key == "link_radius":
            return {name: 1000 * one for name, one in value.items()}
        return {name: body_in_mm(one, name) for name, one in value.items()}
    if key in ("q", "seed", "qd"):
        return [1000 * one if k == SLIDE else one for k, one in enumerate(value)]
    if key in ("delta_x", "twist"):
        return [1000 * one if k < 3 else one for k, one in enumerate(value)]
    if key in ("position", "xyz", "center", "size", "start", "end"):
        return (np.array(value) * 1000).tolist()
    if key in ("radius", "offset", "d_safe"):
        return 1000 * value
    if key == "base":
        T = np.array(value)
        T[:3, 3] *= 1000
        return T.tolist()
    if isinstance(value, list):
        return [body_in_mm(one) for one in value]
    return value


@pytest.mark.parametrize("name", BODIES)
def test_an_answer_is_that_in_metres_with_its_lengths_in_mm(client, name):
    body = BODIES[name]
    answer = client.post(f"/v1/{name}", json={"robot": ARM, **body})
    assert answer.status_code == 200, answer.text
    given = client.post(
        f"/v1/{name}", json={"robot": ARM, **body_in_mm(body)}, params={"length": "mm"}
    )
    assert given.status_code == 200, given.text
    if name != "jacobian":
        assert given.json()["units"]["length"] == "mm"
    close(given.json(), in_mm(answer.json()))


def test_a_robot_a_thousand_times_as_large_is_the_same(client):
    """What has no tolerance scales: an oracle that knows nothing of units."""
    large = copy.deepcopy(ARM)
    large["tool"]["xyz"][2] *= 1000
    for joint in large["joints"]:
        joint["d"] *= 1000
        if joint["type"] == "P":
            joint["limits"] = {"lower": 100, "upper": 900}
    given = client.post("/v1/fk", json={"robot": ARM, "q": IN_MM}, params={"length": "mm"}).json()
    expected = client.post("/v1/fk", json={"robot": large, "q": IN_MM}).json()
    close(given["poses"], expected["poses"])


def test_a_stored_robot_a_query_and_npy(client):
    stored = client.put("/v1/robots/arm-in-mm", json=ARM | {"name": "arm-in-mm"})
    assert stored.status_code == 201, stored.text
    address = "/v1/robots/arm-in-mm"
    expected = client.post(f"{address}/fk", json={"q": Q}).json()["poses"]["tool"]
    query = {"q": ",".join(map(str, IN_MM)), "length": "mm"}
    given = client.get(f"{address}/fk", params=query).json()["poses"]["tool"]
    close(given, in_mm(expected))
    spelled = client.get(f"{address}/fk", params=query | {"q": "0.3,0.5,0.5m,0.4,0.8,-0.5"})
    close(spelled.json()["poses"]["tool"], given)
    array = io.BytesIO()
    np.save(array, np.array([IN_MM, IN_MM]))
    npy = {"Content-Type": "application/x-npy", "Accept": "application/x-npy"}
    answer = client.post(
        f"{address}/fk", content=array.getvalue(), headers=npy, params={"length": "mm"}
    )
    T = np.load(io.BytesIO(answer.content))
    assert np.abs(T[1] - np.array(given["matrix"])).max() < 1e-9
    targets = io.BytesIO()
    np.save(targets, T)
    answer = client.post(
        f"{address}/ik",
        content=targets.getvalue(),
        headers=npy,
        params={"length": "mm", "seed": ",".join(map(str, IN_MM))},
    )
    assert answer.status_code == 200, answer.text
    q = np.load(io.BytesIO(answer.content))
    back = client.post(f"{address}/fk", json={"q": q[0].tolist()}, params={"length": "mm"}).json()
    assert np.abs(np.array(back["poses"]["tool"]["matrix"]) - T[0]).max() < 1e-2
    target = {
        "position": ",".join(map(str, given["position"])),
        "quaternion_xyzw": ",".join(map(str, given["quaternion_xyzw"])),
        "length": "mm",
        "tool_xyz": "0,0,10mm",
    }
    found = client.get(f"{address}/ik", params=target).json()
    assert found["status"] == "converged", found
    assert found["tolerance"]["position"] == pytest.approx(1e-3)
    client.delete(address)


def test_a_default_in_metres_stays_the_same_length(client):
    """Only what the request gives is in its unit."""
    path = {"q": IN_MM, "target": {"position": [300, 500, 800]}, "task": "position", "samples": 5}
    given = client.post("/v1/path", json={"robot": ARM, **path}, params={"length": "mm"}).json()
    assert given["success"], given["message"]


@pytest.mark.parametrize("q", [Q, [Q, Q]])
def test_every_form_of_link_matrices_is_in_mm(client, q):
    """Text, LaTeX and npy say what JSON says."""
    body = {"robot": ARM, "q": in_mm({"q": q})["q"]}

    def asked(form: str):
        params = {"length": "mm", "format": form}
        answer = client.post("/v1/dh-matrices", json=body, params=params)
        assert answer.status_code == 200, answer.text
        return answer

    answer = asked("json").json()
    assert np.abs(np.array(answer["A"])[..., 0, 2, 3]).max() == pytest.approx(400)
    T = np.load(io.BytesIO(asked("npy").content))
    assert np.abs(T - np.array(answer["T"])).max() < 1e-9
    for form in ("text", "latex"):
        assert re.search(r"\b400\b", asked(form).text)


def test_warnings_are_in_mm(client):
    body = {"robot": ARM, "q": [*IN_MM[:2], 2000.0, *IN_MM[3:]]}
    warnings = client.post("/v1/fk", json=body, params={"length": "mm"}).json()["warnings"]
    assert "q of joint j3 is 2000 mm, outside its limits 100 to 900" in " ".join(warnings)
    body = {"robot": ARM, "target": {"position": [90_000, 200, 500]}, "task": "position"}
    warnings = client.post("/v1/ik", json=body, params={"length": "mm"}).json()["warnings"]
    assert not any("length=mm" in one for one in warnings)
    body = {"robot": ARM, "target": {"position": [0.4, 0.2, 0.5]}, "task": "position"}
    warnings = client.post("/v1/ik", json=body, params={"length": "mm"}).json()["warnings"]
    assert any("metres? then leave length=mm out" in one for one in warnings), warnings


def test_a_characteristic_length_is_one(client):
    body = {"robot": ARM, "q": IN_MM, "characteristic_length": 500}
    given = client.post("/v1/singularity", json=body, params={"length": "mm"}).json()
    body = {"robot": ARM, "q": Q, "characteristic_length": 0.5}
    close(given["dexterity"], client.post("/v1/singularity", json=body).json()["dexterity"])


def test_csv_has_headings_in_mm(client):
    params = {"length": "mm", "format": "csv"}
    text = client.post("/v1/fk", json={"robot": ARM, "q": IN_MM}, params=params).text
    heading, row = text.splitlines()
    cells = dict(zip(heading.split(","), row.split(","), strict=True))
    assert float(cells["q_j3 [mm]"]) == 500.0
    assert abs(float(cells["x [mm]"])) > 10


@pytest.mark.parametrize(
    ("name", "length", "status"), [("fk", "cm", 422), ("symbolic", "mm", 422), ("fk", "m", 200)]
)
def test_other_units_are_refused(client, name, length, status):
    body = {"robot": ARM} if name == "symbolic" else {"robot": ARM, "q": Q}
    answer = client.post(f"/v1/{name}", json=body, params={"length": length})
    assert answer.status_code == status
    if status == 422:
        assert answer.json()["errors"][0]["pointer"] == "/length"
