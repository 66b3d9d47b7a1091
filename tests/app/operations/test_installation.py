"""Base, tool and limits of one request: as if the robot's own document had them."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dh_to_urdf.poses import from_xyz_rpy

BASE = {"position": [0.3, -0.2, 0.5], "rpy": [0.1, -0.4, 2.0]}
TOOL = {"xyz": [0.02, 0.05, 0.12], "quaternion_xyzw": [0.5, -0.5, 0.5, 0.5]}
LIMITS = {"j1": {"lower": -0.5, "upper": 0.9}, "j3": {"velocity": 0.7}}
PUMA = {
    "name": "arm",
    "convention": "standard",
    "base": {"xyz": [0, 0, 0.1]},
    "tool": {"xyz": [0, 0.01, 0.02], "rpy": [0, 0.3, 0]},
    "joints": [
        {"name": "j1", "type": "R", "a": 0, "alpha": 1.5707963267948966, "d": 0.6718},
        {"name": "j2", "type": "R", "a": 0.4318, "alpha": 0, "d": 0},
        {"name": "j3", "type": "R", "a": 0.0203, "alpha": -1.5707963267948966, "d": 0.15005},
        {"name": "j4", "type": "R", "a": 0, "alpha": 1.5707963267948966, "d": 0.4318},
        {"name": "j5", "type": "R", "a": 0, "alpha": -1.5707963267948966, "d": 0},
        {"name": "j6", "type": "R", "a": 0, "alpha": 0, "d": 0},
    ],
}
for joint in PUMA["joints"]:
    joint["limits"] = {"lower": -2.5, "upper": 2.5, "velocity": 2.0}


def installed_document() -> dict:
    """The document of the same robot on that base, with that tool and those limits."""
    document = copy.deepcopy(PUMA)
    table_base = from_xyz_rpy([0, 0, 0.1], [0, 0, 0])
    table_tool = from_xyz_rpy([0, 0.01, 0.02], [0, 0.3, 0])
    base = from_xyz_rpy(BASE["position"], BASE["rpy"])
    document["base"] = {"matrix": (base @ table_base).tolist()}
    document["tool"] = {"matrix": (table_tool @ _tool()).tolist()}
    document["joints"][0]["limits"] |= {"lower": -0.5, "upper": 0.9}
    document["joints"][2]["limits"]["velocity"] = 0.7
    return document


Q = [0.3, -0.7, 0.9, 0.4, 0.8, -0.5]
SKIPPED = {"timing_ms", "time_ms", "elapsed_ms", "ms_per_point", "compute_ms"}


def close(given, expected, path=""):
    """Compare answers to rounding, but for times."""
    if isinstance(expected, dict):
        assert set(given) == set(expected), path
        for key, value in expected.items():
            if key not in SKIPPED and not key.endswith("_ms"):
                close(given[key], value, f"{path}/{key}")
    elif isinstance(expected, list):
        assert len(given) == len(expected), path
        for k, value in enumerate(expected):
            close(given[k], value, f"{path}/{k}")
    elif isinstance(expected, float) and not isinstance(given, str):
        assert given == pytest.approx(expected, abs=1e-9, rel=1e-9), path
    else:
        assert given == expected, path


RATES = [0.1, -0.2, 0.3, 0.4, -0.5, 0.6]
BODIES = {
    "fk": {"q": Q, "frames": ["tool"], "euler": "ZYX"},
    "jacobian": {"q": Q, "reference_frame": "local"},
    "singularity": {"q": Q},
    "singularity/nearest": {"q": Q},
    "joint-velocities": {"q": Q, "twist": [0.1, 0, 0.2, 0, 0.3, 0]},
    "twist": {"q": Q, "qd": RATES},
    "joint-torques": {"q": Q, "wrench": [1, 2, 3, 0.1, 0.2, 0.3]},
    "wrench": {"q": Q, "tau": RATES},
    "dh-matrices": {"q": Q},
    "hessian": {"q": Q},
    "jacobian-derivative": {"q": Q, "qd": RATES},
    "manipulability-gradient": {"q": Q},
    "step": {"q": Q, "delta_x": [0.01, 0, -0.02, 0, 0, 0.01]},
    "check": {"quantity": "T", "q": Q, "answer": np.eye(4).tolist(), "reveal": True},
}


def inline(client, name: str, robot: dict, body: dict, **more: str) -> dict:
    answer = client.post(f"/v1/{name}", json={"robot": robot, **body}, params=more)
    assert answer.status_code == 200, answer.text
    return answer.json()


@pytest.mark.parametrize("name", BODIES)
def test_an_answer_is_that_of_a_robot_whose_document_says_it(client, name):
    asked = {"base": BASE, "tool": TOOL, "limits": LIMITS, **BODIES[name]}
    given = inline(client, name, PUMA, asked)
    close(given, inline(client, name, installed_document(), BODIES[name]))


def reached(client, q=Q) -> list:
    """A pose of the tool in the world."""
    body = {"q": q}
    return inline(client, "fk", installed_document(), body)["poses"]["tool"]["matrix"]


@pytest.mark.parametrize("name", ["ik", "ik/solutions"])
def test_targets_are_of_the_tool_in_the_world_and_answers_within_the_limits(client, name):
    body = {"target": {"matrix": reached(client)}}
    asked = {"base": BASE, "tool": TOOL, "limits": LIMITS, **body}
    given = inline(client, name, PUMA, asked)
    close(given, inline(client, name, installed_document(), body))
    found = [given["q"]] if name == "ik" else [one["q"] for one in given["solutions"]]
    assert found
    for q in found:
        T = inline(client, "fk", installed_document(), {"q": q})["poses"]["tool"]["matrix"]
        assert np.allclose(T, body["target"]["matrix"], atol=1e-8)


def test_a_path_runs_in_the_world_around_obstacles_of_the_world(client):
    end = reached(client, [0.5, -0.6, 0.8, 0.3, 0.9, -0.4])
    body = {
        "q": Q,
        "target": {"matrix": end},
        "samples": 12,
        "obstacles": [{"type": "sphere", "center": [0.9, 0.2, 1.4], "radius": 0.1}],
    }
    asked = {"base": BASE, "tool": TOOL, "limits": LIMITS, **body}
    close(inline(client, "path", PUMA, asked), inline(client, "path", installed_document(), body))


@pytest.mark.parametrize("frame", ["panda_hand", "panda_link4", "panda_leftfinger"])
def test_the_tool_is_on_the_frame_that_is_asked_for(client, frame):
    """A robot of a URDF, on frames in the middle of its chain too."""
    q = [0.1, -0.3, 0.2, -1.5, 0.3, 1.2, 0.4]
    record = client.get("/v1/robots/panda_urdf").json()
    q = [*q, *[0.01] * (record["dof"] - 7)]
    address = "/v1/robots/panda_urdf"
    bare = client.post(f"{address}/fk", json={"q": q, "frames": [frame]}).json()["poses"][frame]
    asked = {"q": q, "frames": [frame], "base": BASE, "tool": TOOL}
    given = client.post(f"{address}/fk", json=asked).json()["poses"][frame]
    B = from_xyz_rpy(BASE["position"], BASE["rpy"])
    expected = B @ np.array(bare["matrix"]) @ _tool()
    assert np.abs(np.array(given["matrix"]) - expected).max() < 1e-12
    batch = client.post(f"{address}/fk", json=asked | {"q": [q, q]}).json()["poses"][frame]
    assert np.abs(np.array(batch["matrix"][1]) - expected).max() < 1e-12
    # Differences of the pose are the columns of its Jacobian.
    J = client.post(
        f"{address}/jacobian",
        json={"q": q, "frame": frame, "base": BASE, "tool": TOOL},
    ).json()["jacobian"]
    step = 1e-6
    for k in range(len(q)):
        ends = []
        for sign in (1, -1):
            moved = list(q)
            moved[k] += sign * step
            body = asked | {"q": moved}
            poses = client.post(f"{address}/fk", json=body).json()["poses"]
            ends.append(np.array(poses[frame]["position"]))
        assert np.abs((ends[0] - ends[1]) / (2 * step) - np.array(J)[:3, k]).max() < 1e-8


def _tool() -> np.ndarray:
    x, y, z, w = TOOL["quaternion_xyzw"]
    T = np.eye(4)
    T[:3, :3] = Rotation.from_quat([x, y, z, w]).as_matrix()
    T[:3, 3] = TOOL["xyz"]
    return T


def test_a_base_that_moves_is_a_base_too(client):
    """A robot whose base frame is a link of its own in the middle of the chain."""
    urdf = client.get("/v1/robots/planar_3r/urdf").text
    robot = {"urdf": urdf, "base": "frame_1"}
    q = [0.3, 0.4, 0.5]
    bare = inline(client, "fk", robot, {"q": q, "frames": ["tool", "frame_1", "base_link"]})
    given = inline(
        client, "fk", robot, {"q": q, "base": BASE, "frames": ["tool", "frame_1", "base_link"]}
    )
    B = from_xyz_rpy(BASE["position"], BASE["rpy"])
    for frame, pose in bare["poses"].items():
        error = np.array(given["poses"][frame]["matrix"]) - B @ np.array(pose["matrix"])
        assert np.abs(error).max() < 1e-12


def test_followers_may_have_limits_and_a_tool(client):
    """Limits of a follower narrow those of its leader."""
    row = {"type": "R", "a": 1, "alpha": 0, "d": 0}
    document = {
        "convention": "modified",
        "joints": [
            {**row, "name": "a", "a": 0, "limits": {"lower": -3, "upper": 3}},
            {**row, "name": "b", "mimic": {"joint": "a", "multiplier": -2}},
            {**row, "name": "c"},
        ],
    }
    body = {"q": [0.4, 0.2], "limits": {"b": {"lower": -1, "upper": 1}}, "tool": TOOL}
    given = inline(client, "fk", document, body)
    assert any("0.5" in one for one in given["warnings"]) is False
    beyond = inline(client, "fk", document, body | {"q": [0.6, 0.2]})
    assert any("0.5" in one and "limits" in one for one in beyond["warnings"])


def test_a_query_gives_them_too(client):
    address = "/v1/robots/puma560/fk"
    q = "0.1,0.2,0.3,0.4,0.5,0.6"
    asked = {
        "q": q,
        "tool_xyz": "0,0,0.1",
        "tool_rpy": "0,90deg,0",
        "base_xyz": "1,0,0",
        "limits": "j1:-0.05:0.05,j2::3",
    }
    given = client.get(address, params=asked)
    assert given.status_code == 200, given.text
    body = {
        "q": [float(one) for one in q.split(",")],
        "tool": {"xyz": [0, 0, 0.1], "rpy": [0, np.pi / 2, 0]},
        "base": {"xyz": [1, 0, 0]},
        "limits": {"j1": {"lower": -0.05, "upper": 0.05}, "j2": {"upper": 3}},
    }
    assert given.json() == client.post(address, json=body).json()
    assert any("j1" in one and "outside" in one for one in given.json()["warnings"])


def test_degrees_are_degrees_in_all_of_them(client):
    address = "/v1/robots/puma560/fk"
    q = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]
    body = {
        "tool": {"xyz": [0, 0, 0.1], "kuka_abc": [10, 20, 30]},
        "base": {"rpy": [0, 0, 90]},
        "limits": {"j1": {"lower": -20, "upper": 20, "velocity": 100}},
    }
    given = client.post(address, json={"q": q, **body}, params={"angle": "deg"}).json()
    turned = copy.deepcopy(body)
    turned["tool"]["kuka_abc"] = np.deg2rad([10, 20, 30]).tolist()
    turned["base"]["rpy"][2] = np.pi / 2
    turned["limits"]["j1"] = {"lower": -np.pi / 9, "upper": np.pi / 9, "velocity": 1.0}
    expected = client.post(address, json={"q": np.deg2rad(q).tolist(), **turned}).json()
    close(given["poses"]["tool"]["matrix"], expected["poses"]["tool"]["matrix"])


@pytest.mark.parametrize(
    ("body", "pointer", "part"),
    [
        ({"tool": {"rpy": [0, 0]}}, "/tool/rpy", "give 3"),
        ({"tool": {"xyz": [0, 0, 0], "position": [0, 0, 0]}}, "/tool", "give one of them"),
        ({"tool": {"rpy": [0, 0, 0], "kuka_abc": [0, 0, 0]}}, "/tool", "give one orientation"),
        ({"tool": {"matrix": np.eye(3).tolist()}}, "/tool/matrix", "4x4"),
        ({"base": [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}, "/base/matrix", "rot"),
        ({"base": {"quaternion_wxyz": [1, 1, 0, 0]}}, "/base/quaternion_wxyz", "unit"),
        ({"base": {"position": [1e7, 0, 0]}}, "/base/position", "1e6"),
        ({"base": {"euler": {"sequence": "ZZX", "angles": [0, 0, 0]}}}, "/base/euler/seq", "ZZX"),
        ({"limits": {"j9": {"lower": 0}}}, "/limits/j9", "known are j1"),
        ({"limits": {"j1": {"lower": 9}}}, "/limits/j1/lower", "not above"),
        ({"limits": {"j1": {"velocity": 0}}}, "/limits/j1/velocity", "above 0"),
        ({"limits": {"j1": {"speed": 0}}}, "/limits/j1/speed", "unknown field"),
        ({"limits": {"j1": {"upper": "1"}}}, "/limits/j1/upper", "give a number"),
        ({"limits": {"j1": 3}}, "/limits/j1", "give an object"),
        ({"limits": [3]}, "/limits", "object"),
    ],
)
def test_what_is_no_installation_is_refused_where_it_stands(client, body, pointer, part):
    answer = client.post("/v1/robots/puma560/fk", json={"q": [0] * 6, **body})
    assert answer.status_code == 422, answer.text
    error = answer.json()["errors"][0]
    assert error["pointer"].startswith(pointer), error
    assert part in error["message"], error


def test_limits_beyond_the_robots_own_are_told(client):
    body = {"q": [3.0, 0, 0, 0, 0, 0], "limits": {"j1": {"lower": -4, "upper": 4}}}
    given = client.post("/v1/robots/puma560/fk", json=body).json()
    assert any("j1" in one and "further" in one for one in given["warnings"])
    assert not any("outside" in one for one in given["warnings"])


def test_a_joint_may_be_held_by_its_limits(client):
    """Lower and upper the same: every solution has this value."""
    body = {
        "target": {"position": [0.4, 0.2, 0.6]},
        "task": "position",
        "limits": {"j1": {"lower": 0.35, "upper": 0.35}},
    }
    given = client.post("/v1/robots/pa10/ik", json=body).json()
    assert given["status"] == "converged", given
    assert given["q"][0] == pytest.approx(0.35, abs=1e-9)


def test_null_is_no_limits(client):
    body = {"q": [9.0, 0, 0, 0, 0, 0], "limits": {"j1": None}}
    given = client.post("/v1/robots/puma560/fk", json=body).json()
    assert not any("outside" in one for one in given["warnings"])


def test_a_slide_beyond_its_limits_is_told_so_and_not_taken_for_mm(client):
    body = {
        "q": [0, 0, 0, -1, 0, 1, 0, 0.03],
        "limits": {"panda_finger_joint1": {"upper": 0.01}},
    }
    given = client.post("/v1/robots/panda_urdf/fk", json=body).json()
    assert any("0.03 m, outside its limits 0 to 0.01" in one for one in given["warnings"])


def test_limits_of_jerk_are_told_to_be_unused(client):
    body = {"q": [0] * 6, "limits": {"j1": {"jerk": 5}}}
    given = client.post("/v1/robots/puma560/fk", json=body).json()
    assert any("jerk" in one for one in given["warnings"])


@pytest.mark.parametrize(
    ("limits", "part"), [("j1:-1:1,j1:0:1", "twice"), ("j1:-1:1:2", "write it as"), ("j1", "write")]
)
def test_limits_of_a_query_are_read_strictly(client, limits, part):
    params = {"q": "0,0,0,0,0,0", "limits": limits}
    answer = client.get("/v1/robots/puma560/fk", params=params)
    assert answer.status_code == 422
    assert part in answer.json()["errors"][0]["message"]


def test_nothing_is_stored(client):
    before = client.get("/v1/robots/puma560").json()
    body = {"q": [0] * 6, "tool": {"xyz": [0, 0, 1]}, "limits": {"j1": {"upper": 0.1}}}
    client.post("/v1/robots/puma560/fk", json=body)
    assert client.get("/v1/robots/puma560").json() == before
