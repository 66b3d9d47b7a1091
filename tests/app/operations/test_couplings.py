"""Robots whose joints depend on each other, through every operation."""

import json
import math

import numpy as np
import pytest

PLANE = """<robot name="m"><link name="base"/><link name="one"/><link name="two"/><link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="one"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="9" velocity="9"/></joint>
<joint name="j2" type="revolute"><parent link="one"/><child link="two"/><origin xyz="1 0 0"/>
<axis xyz="0 0 1"/><limit lower="-3" upper="1" effort="9" velocity="4"/>
<mimic joint="j1" multiplier="-2"/></joint>
<joint name="end" type="fixed"><parent link="two"/><child link="tip"/><origin xyz="1 0 0"/></joint>
</robot>"""
M10IA = "/v1/robots/fanuc_m10ia"
TABLE = {
    "convention": "modified",
    "units": {"angle": "deg", "length": "mm"},
    "tool": {"xyz": [200, 0, 0]},
    "joints": [
        {
            "name": "a",
            "type": "R",
            "alpha": 0,
            "a": 0,
            "d": 300,
            "limits": {"lower": -90, "upper": 90},
        },
        {
            "name": "b",
            "type": "R",
            "alpha": 90,
            "a": 100,
            "d": 0,
            "limits": {"lower": -80, "upper": 80},
        },
        {"name": "c", "type": "R", "alpha": 0, "a": 400, "d": 0, "theta": "q3 + q2"},
        {
            "name": "d",
            "type": "R",
            "alpha": 0,
            "a": 300,
            "d": 0,
            "theta": "-q3 + 90",
            "limits": {"lower": -100, "upper": 100},
        },
        {
            "name": "s",
            "type": "P",
            "alpha": 90,
            "a": 0,
            "theta": 0,
            "mimic": {"joint": "a", "multiplier": 2, "offset": 10},
        },
    ],
}


def inline(client, operation, body, robot=None, query=""):
    return client.post(f"/v1/{operation}{query}", json={"robot": robot or {"urdf": PLANE}, **body})


def test_a_mimic_leaves_one_degree_of_freedom(client):
    answer = inline(client, "fk", {"q": [0.3]})
    assert answer.status_code == 200, answer.text
    assert answer.json()["joint_values"] == {"j1": 0.3, "j2": -0.6}
    refused = inline(client, "fk", {"q": [0.3, 0.5]})
    assert refused.status_code == 422
    assert "has 1 joint" in refused.text
    target = {"target": {"position": [1.5, 0.2, 0]}, "task": "xy"}
    found = inline(client, "ik", target).json()
    assert found["status"] in ("not_converged", "unreachable")
    assert found["joint_values"]["j2"] == pytest.approx(-2 * found["q"][0], abs=1e-12)
    J = np.array(inline(client, "jacobian", {"q": [0.3]}).json()["jacobian"])
    assert J.shape == (6, 1)
    assert J[5, 0] == pytest.approx(-1.0)


def test_q_by_name_may_hold_followers_if_they_are_consistent(client):
    same = inline(client, "fk", {"q": {"j1": 0.3, "j2": -0.6}}).json()
    assert same["poses"] == inline(client, "fk", {"q": [0.3]}).json()["poses"]
    degrees = inline(client, "fk", {"q": {"j2": -60, "j1": 30}}, query="?angle=deg")
    assert degrees.json()["joint_values"] == pytest.approx({"j1": 30, "j2": -60})
    refused = inline(client, "fk", {"q": {"j1": 0.3, "j2": 0.5}})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["pointer"] == "/q/j2"
    assert "follows j1" in refused.text


def test_the_record_names_followers_and_couplings(client):
    answer = client.put("/v1/robots/palletiser", json=TABLE)
    assert answer.status_code == 201, answer.text
    record = client.get("/v1/robots/palletiser?angle=deg").json()
    assert (record["dof"], [joint["name"] for joint in record["joints"]]) == (3, ["a", "b", "c"])
    # d = -c, and within ±100, so that c is as well.
    assert (record["joints"][2]["lower"], record["joints"][2]["upper"]) == (
        pytest.approx(-100),
        pytest.approx(100),
    )
    d, s = record["followers"]
    assert (d["name"], d["joint"], d["multiplier"], d["offset"]) == ("d", "c", -1, 0)
    assert (s["name"], s["joint"], s["type"], s["offset"]) == ("s", "a", "prismatic", 0.01)
    assert s["multiplier"] == pytest.approx(0.002)
    assert record["couplings"] == [{"name": "c", "joints": {"b": 1}}]
    assert record["warnings"] == []
    q = [20, 30, -40]
    found = client.post("/v1/robots/palletiser/fk?angle=deg", json={"q": q}).json()
    assert found["joint_values"] == pytest.approx({"a": 20, "b": 30, "c": -10, "d": 40, "s": 0.05})
    # b + (c + b) + (-c) + 90
    batch = client.post("/v1/robots/palletiser/fk?angle=deg", json={"q": [q, q]}).json()
    assert batch["joint_values"]["c"] == pytest.approx([-10, -10])
    text = client.get("/v1/robots/palletiser/fk?q=0.1,0.2,0.3&format=text")
    assert "joint_values" in text.text
    for form, angle in (("json", "deg"), ("yaml", "rad"), ("csv", "deg"), ("markdown", "rad")):
        written = client.get(f"/v1/robots/palletiser/dh?format={form}&angle={angle}")
        assert written.status_code == 200, written.text
    assert client.get("/v1/robots/palletiser/dh?format=matlab").status_code == 422
    urdf = client.get("/v1/robots/palletiser/urdf").text
    read = inline(client, "fk", {"q": np.deg2rad(q).tolist()}, {"urdf": urdf, "tip": "tool"}).json()
    T = found["poses"]["tool"]["matrix"]
    np.testing.assert_allclose(read["poses"]["tool"]["matrix"], T, atol=1e-12)
    for to in ("standard", "khalil"):
        document = client.get(f"/v1/robots/palletiser/dh?convention={to}").json()
        again = inline(client, "fk", {"q": np.deg2rad(q).tolist()}, document).json()
        np.testing.assert_allclose(again["poses"]["tool"]["matrix"], T, atol=1e-12)
    same = client.post("/v1/robots/palletiser/diff", json={"other": {"urdf": urdf, "tip": "tool"}})
    assert same.json()["verdict"] in ("identical", "equivalent"), same.text
    other = json.loads(json.dumps(TABLE))
    other["joints"][2]["theta"] = "q3"
    different = client.post("/v1/robots/palletiser/diff", json={"other": other}).json()
    assert different["verdict"] == "different"
    assert different["first_difference"]["name"] == "c"
    assert different["first_difference"]["parameter"] == "coupling"
    assert client.delete("/v1/robots/palletiser").status_code == 204


def test_every_operation_takes_a_coupled_arm(client):
    q = [0.2, 0.3, -0.5, 0.4, 0.6, -0.1]
    pose = client.post(f"{M10IA}/fk", json={"q": q}).json()
    assert pose["joint_values"]["J3"] == pytest.approx(-0.2)
    target = {"matrix": pose["poses"]["tool"]["matrix"]}
    solutions = client.post(f"{M10IA}/ik/solutions", json={"target": target, "seed": q}).json()
    assert solutions["method"] == "closed_form"
    np.testing.assert_allclose(solutions["solutions"][0]["q"], q, atol=1e-9)
    bodies = {
        "dh-matrices": {"q": q},
        "jacobian": {"q": q},
        "singularity": {"q": q},
        "singularity/nearest": {"q": q},
        "joint-torques": {"q": q, "wrench": [1, 2, 3, 0.1, 0.2, 0.3]},
        "joint-velocities": {"q": q, "twist": [0.1, 0, 0, 0, 0, 0.1]},
        "twist": {"q": q, "qd": q},
        "step": {"q": q, "delta_x": [0.01, 0, 0, 0, 0, 0]},
        "jacobian-derivative": {"q": q, "qd": q},
        "hessian": {"q": q},
        "manipulability-gradient": {"q": q},
        "workspace": {"samples": 20},
        "manipulability-map": {"q": q, "joints": ["J2", "J3"], "samples": 5},
        "ik": {"target": target, "choose": "closest"},
    }
    for operation, body in bodies.items():
        answer = client.post(f"{M10IA}/{operation}", json=body)
        assert answer.status_code == 200, (operation, answer.text)
    picture = client.get(f"{M10IA}/picture.svg?q=0,0,0,0,0,0")
    assert (picture.status_code, picture.headers["content-type"][:13]) == (200, "image/svg+xml")
    body = {"quantities": ["position"], "time_budget_ms": 3000}
    written = client.post(f"{M10IA}/symbolic", json=body)
    if written.status_code != 501:  # without SymPy
        assert written.status_code == 200, written.text
        assert written.json()["columns"] == ["J1", "J2", "J3", "J4", "J5", "J6"]
        half = json.loads(json.dumps(TABLE))
        half["joints"][2]["theta"] = "q3 + 0.5*q2"
        refused = inline(client, "symbolic", {"quantities": ["T"]}, half)
        assert refused.status_code == 422
        assert "joint c turns by a fraction" in refused.text


@pytest.mark.parametrize(
    "method", ["pseudo_inverse", "damped", "null_space", "qp", "sqp", "task_priority"]
)
def test_paths_of_a_coupled_arm_reach_their_end(client, method):
    start = [0.2, 0.1, 0.2, 0.4, 0.6, -0.1]
    pose = client.post(f"{M10IA}/fk", json={"q": start}).json()["poses"]["tool"]
    x, y, z = pose["position"]
    body = {
        "q": start,
        "target": {"position": [x - 0.05, y + 0.05, z - 0.05]},
        "task": "position",
        "method": method,
        "samples": 20,
        "obstacles": [{"type": "sphere", "center": [x, y, z + 0.6], "radius": 0.1}],
        "gains": {"limits": 1, "manipulability": 1, "obstacles": 1},
    }
    if method == "task_priority":
        body["secondary"] = [
            {"frame": "frame_4", "task": "position", "target": {"position": [0, 0, 1]}}
        ]
        del body["gains"]
    elif method != "null_space":
        del body["gains"]
    answer = client.post(f"{M10IA}/path", json=body)
    assert answer.status_code == 200, answer.text
    found = answer.json()
    assert found["success"], found["message"]
    assert len(found["joint_values"]["J3"]) == len(found["q"])
    for row, value in zip(found["q"], found["joint_values"]["J3"], strict=True):
        assert value == pytest.approx(row[1] + row[2], abs=1e-12)
    last = client.post(f"{M10IA}/fk", json={"q": found["q"][-1]}).json()["poses"]["tool"]
    np.testing.assert_allclose(last["position"], [x - 0.05, y + 0.05, z - 0.05], atol=1e-4)


def test_the_forearm_of_a_pendant_keeps_its_angle_to_the_floor(client):
    def forearm(q):
        body = {"q": q, "frames": ["frame_3"]}
        return np.array(client.post(f"{M10IA}/fk", json=body).json()["poses"]["frame_3"]["matrix"])

    before, after = forearm([0, 0, 0.3, 0, 0, 0]), forearm([0, 0.5, 0.3, 0, 0, 0])
    np.testing.assert_allclose(before[:3, :3], after[:3, :3], atol=1e-15)
    assert math.dist(before[:3, 3], after[:3, 3]) > 0.1
