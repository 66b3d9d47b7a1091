"""Paths over HTTP: nine reference scenarios, loops, streams, tables, refusals."""

import csv
import io
import json

import httpx
import numpy as np
import pytest

from tests.conftest import FIXTURES, PATIENCE

SCENARIOS = json.loads((FIXTURES / "scenarios.json").read_text())["scenarios"]
REFERENCES = {"sqp": "slsqp_hard", "qp": "qp_daqp", "whole_path": "ipopt_whole_path"}
CONSTRAINED = tuple(REFERENCES)
FREE = ("3R_free", "8R_free")
LIMITED = ("3R_limits", "8R_limits")
OBSTRUCTED = ("3R_obstacle", "8R_obstacles", "8R_pose")
DEGREE = np.pi / 180


def body_of(scenario):
    lengths, limits = scenario["L"], scenario["limits_deg"]
    joints = [
        {"type": "R", "alpha": 0, "a": lengths[k - 1] if k else 0, "d": 0,
         "limits": {"lower": limits[k][0], "upper": limits[k][1]}}
        for k in range(len(lengths))
    ]  # fmt: skip
    robot = {"convention": "modified", "units": {"angle": "deg", "length": "m"},
             "tool": {"xyz": [lengths[-1], 0, 0], "rpy": [0, 0, 0]}, "joints": joints}  # fmt: skip
    target = {"position": scenario["Pf"]}
    if "phi_f_deg" in scenario:
        target["phi"] = scenario["phi_f_deg"]
    return {
        "robot": robot,
        "q": scenario["q0_deg"],
        "target": target,
        "task": {"xy": "xy", "xyphi": "xy_phi"}[scenario["task"]],
        "tf": scenario["tf"],
        "samples": scenario["N"],
        "obstacles": [
            {"type": "circle", "center": [x, y], "radius": r} for x, y, r in scenario["obstacles"]
        ],
        "link_radius": scenario["link_radius"],
        "d_safe": scenario["d_safe"],
    }


@pytest.fixture(scope="module")
def follow(client):
    kept = {}

    def run(name, method, **options):
        key = name, method, json.dumps(options)
        if key not in kept:
            body = {**body_of(SCENARIOS[name]), "method": method, **options}
            answer = client.post("/v1/path?angle=deg", json=body)
            assert answer.status_code == 200, answer.text
            kept[key] = answer.json()
        return kept[key]

    return run


def figures(answer):
    return answer["summary"]


@pytest.mark.parametrize("method", CONSTRAINED)
@pytest.mark.parametrize("name", [*FREE, *LIMITED, *OBSTRUCTED])
def test_constrained_methods_do_as_well_as_the_reference(follow, name, method):
    answer = follow(name, method)
    found, expected = figures(answer), SCENARIOS[name]["reference"][REFERENCES[method]]
    assert answer["success"], answer["message"]
    assert answer["tracked"] == 1
    limit = 1e-8 if method == "sqp" else 1e-6
    assert found["max_position_error"] < limit
    assert found["max_position_error"] <= max(1.1 * expected["max_err_m"], 1e-9)
    assert found["limit_margin"] >= 0
    assert found["sum_dq"] * DEGREE <= 1.01 * expected["sum_dq_norm"]
    if name in OBSTRUCTED:
        assert found["min_clearance"] >= SCENARIOS[name]["d_safe"]
        assert found["min_clearance_swept"] >= SCENARIOS[name]["d_safe"]
    else:
        assert found["min_clearance"] is None


@pytest.mark.parametrize("name", [*FREE, *LIMITED, *OBSTRUCTED])
def test_pseudo_inverses_do_as_the_reference_does(follow, name):
    references = SCENARIOS[name]["reference"]
    for closed, key in ((False, "pinv_open_loop"), (True, "pinv_closed_loop")):
        answer = follow(name, "pseudo_inverse", closed_loop=closed)
        found, expected = figures(answer), references[key]
        assert found["max_position_error"] == pytest.approx(expected["max_err_m"], abs=2e-9)
        assert found["sum_dq"] * DEGREE == pytest.approx(expected["sum_dq_norm"], abs=2e-9)
        assert found["largest_step"] * DEGREE == pytest.approx(expected["max_step_rad"], abs=2e-9)
        np.testing.assert_allclose(answer["q"][-1], expected["q_final_deg"], atol=1e-4)
        if name in OBSTRUCTED:
            assert found["min_clearance"] == pytest.approx(expected["min_clearance_m"], abs=2e-9)
            lowest = expected["min_clearance_swept_m"]
            assert found["min_clearance_swept"] <= lowest + 1e-9
            assert found["min_clearance_swept"] > lowest - 1e-4
            assert answer["reason"] == "collision"
        if name in LIMITED:
            assert answer["reason"] == "limits"
            violation = expected["max_limit_violation_rad"]
            assert -found["limit_margin"] * DEGREE == pytest.approx(violation, abs=2e-9)
    assert follow(name, "damped")["summary"]["max_position_error"] < 1e-8


@pytest.mark.parametrize("name", [*FREE, *LIMITED, "3R_obstacle", "8R_obstacles"])
def test_the_null_space_keeps_off_limits_and_obstacles(follow, name):
    answer = follow(name, "null_space")
    assert answer["success"], answer["message"]
    assert figures(answer)["limit_margin"] >= 0
    if name in OBSTRUCTED:
        assert figures(answer)["min_clearance_swept"] > 0.02


def test_the_open_loop_drifts_and_the_closed_one_does_not(follow):
    open_loop = follow("3R_free", "pseudo_inverse", closed_loop=False)
    assert figures(open_loop)["end_position_error"] == pytest.approx(1.34e-3, abs=5e-6)
    assert open_loop["reason"] == "tracking"
    closed = follow("3R_free", "pseudo_inverse")
    assert closed["success"]
    assert figures(closed)["max_position_error"] < 5e-5
    assert figures(closed)["end_position_error"] < 1e-6
    assert figures(follow("8R_free", "pseudo_inverse"))["max_position_error"] < 1e-4
    least = figures(follow("8R_free", "sqp"))["sum_dq"]
    assert least == pytest.approx(figures(follow("8R_free", "pseudo_inverse"))["sum_dq"], rel=0.01)
    whole = figures(follow("3R_obstacle", "whole_path"))["sum_dq"]
    assert whole < figures(follow("3R_obstacle", "sqp"))["sum_dq"]


def test_a_singular_start_is_named_and_left_when_perturbed(follow):
    for method in ("pseudo_inverse", "null_space"):
        answer = follow("3R_singular_start", method)
        assert (answer["success"], answer["reason"]) == (False, "singular_start")
        assert "refused: rank(J) = 1 < 2" in answer["message"]
        assert (answer["samples_done"], answer["tracked"]) == (1, 0)
    for method in ("damped", *CONSTRAINED):
        answer = follow("3R_singular_start", method)
        assert (answer["success"], answer["reason"]) == (False, "singular_start")
        assert figures(answer)["end_position_error"] == pytest.approx(0.3)
        assert figures(answer)["sum_dq"] == 0
        assert follow("3R_singular_start", method, perturb=0.05)["success"]


def test_an_unreachable_end_is_named_with_how_far_it_got(follow):
    diverged = follow("3R_unreachable", "pseudo_inverse")
    assert diverged["reason"] == "diverged"
    assert figures(diverged)["largest_step"] * DEGREE > 3
    for method in ("damped", *CONSTRAINED):
        answer = follow("3R_unreachable", method)
        assert (answer["success"], answer["reason"]) == (False, "unreachable")
        assert 0.115 <= figures(answer)["end_position_error"] <= 0.117
        assert figures(answer)["limit_margin"] >= 0
        # the arm is 1.2 m long: so much of the line lies within
        assert 0.5 < answer["tracked"] < 1
        q = answer["q"][answer["first_lost"] - 1]
        assert answer["position_error"][answer["first_lost"] - 1] <= 1e-4
        assert len(q) == 3


def test_velocities_come_from_the_time_law(follow):
    answer = follow("3R_free", "qp")
    q, v = np.array(answer["q"]), np.array(answer["velocity"])
    np.testing.assert_allclose(v[50], (q[51] - q[49]) / 0.04, atol=1e-9)
    assert np.abs(v[[0, -1]]).max() < 0.1
    assert answer["velocity_limits_respected"]
    assert answer["units"] == {"angle": "deg", "length": "m", "time": "s"}


def test_a_loop_drifts_as_the_course_says(client):
    body = {"q": [110, -88, -96], "task": "xy", "method": "pseudo_inverse", "samples": 4001,
            "circle": {"center": [0.18, 0.58], "turns": 1}, "time_law": "linear"}  # fmt: skip
    tip = client.get("/v1/robots/planar_3r/fk?q=110,-88,-96&angle=deg").json()
    x, y, _ = tip["poses"]["tool"]["position"]
    body["circle"]["center"] = [x - 0.1, y]
    answer = client.post("/v1/robots/planar_3r/path?angle=deg", json=body).json()
    assert answer["closed"]
    np.testing.assert_allclose(answer["drift"], (3.2018, -2.9971, 5.1422), atol=3e-3)
    assert answer["summary"]["drift"] == pytest.approx(np.linalg.norm(answer["drift"]))


def test_the_step_of_the_course_and_its_refusal(client):
    body = {"q": [30, -45, 60], "delta_x": [0.01, 0], "task": "xy"}
    answer = client.post("/v1/robots/planar_3r/step?angle=deg", json=body).json()
    expected = np.rad2deg([-0.007463391, 0.030663928, -0.050222650])
    np.testing.assert_allclose(answer["delta_q"], expected, atol=1e-7)
    got = client.get(
        "/v1/robots/planar_3r/step?q=30,-45,60&delta_x=0.01,0&task=xy&z=1,0,0&angle=deg"
    ).json()
    N = np.array(got["null_projector"])
    np.testing.assert_allclose(got["null_motion"], N[:, 0], atol=1e-12)
    body["q"] = [0, 0, 0]
    refused = client.post("/v1/robots/planar_3r/step?angle=deg", json=body)
    assert refused.status_code == 422
    assert refused.json()["type"].endswith("rank-deficient")
    assert "rank(J) = 1 < 2" in refused.json()["detail"]
    assert "damping" in refused.json()["detail"]
    body["damping"] = 0.01
    assert client.post("/v1/robots/planar_3r/step", json=body).status_code == 200
    turn = {"q": [30, -45, 60], "delta_x": [0, 0, 1], "task": "xy_phi"}
    answer = client.post("/v1/robots/planar_3r/step?angle=deg", json=turn).json()
    assert sum(answer["delta_q"]) == pytest.approx(1)


def test_compare_as_json_text_and_csv(client):
    methods = ["pseudo_inverse", {"method": "pseudo_inverse", "closed_loop": False}, "qp",
               {"method": "qp", "label": "wide", "margin": 0.01}]  # fmt: skip
    body = {**body_of(SCENARIOS["8R_obstacles"]), "methods": methods}
    url = "/v1/path/compare?angle=deg"
    table = client.post(url, json=body).json()
    rows = {row["method"]: row for row in table["rows"]}
    assert list(rows) == ["pseudo_inverse", "pseudo_inverse (2)", "qp", "wide"]
    assert rows["pseudo_inverse"]["reason"] == "collision"
    assert rows["pseudo_inverse (2)"]["end_position_error"] > 4e-3
    assert rows["qp"]["success"]
    assert rows["wide"]["min_clearance"] > rows["qp"]["min_clearance"] + 0.008
    assert "obstacle" in table["messages"]["pseudo_inverse"]
    text = client.post(url, json=body, headers={"Accept": "text/plain"}).text
    assert "ms_per_point" in text
    answer = client.post(url, json=body, headers={"Accept": "text/csv"})
    assert answer.headers["content-type"].startswith("text/csv")
    lines = list(csv.DictReader(io.StringIO(answer.text)))
    assert [line["method"] for line in lines] == list(rows)
    assert lines[2]["success"] == "true"
    assert lines[2]["reason"] == lines[2]["drift"] == ""
    assert (float(lines[2]["tracked"]), float(lines[2]["max_orientation_error"])) == (1, 0)
    assert float(lines[2]["sum_dq"]) == pytest.approx(rows["qp"]["sum_dq"])


def test_samples_are_streamed_and_the_verdict_comes_last(client):
    body = {**body_of(SCENARIOS["8R_obstacles"]), "method": "qp", "samples": 400}
    plain = client.post("/v1/path?angle=deg", json=body).json()
    headers = {"Accept": "application/x-ndjson"}
    with client.stream("POST", "/v1/path?angle=deg", json=body, headers=headers) as answer:
        lines = [json.loads(line) for line in answer.iter_lines()]
    assert [line["sample"] for line in lines[:-1]] == list(range(400))
    np.testing.assert_allclose([line["q"] for line in lines[:-1]], plain["q"])
    assert lines[-1]["success"]
    refused = {**body, "method": "task_priority"}
    assert client.post("/v1/path?angle=deg", json=refused, headers=headers).status_code == 422


def test_a_stream_that_nobody_reads_stops(serve_long_work):
    """The path is followed again and again, until nobody reads on."""
    body = {**body_of(SCENARIOS["8R_obstacles"]), "method": "sqp", "samples": 1000}
    headers = {"Accept": "application/x-ndjson"}
    with (
        serve_long_work(compute_threads=1, max_request_seconds=1e6) as server,
        httpx.Client(base_url=server.address, timeout=PATIENCE) as client,
    ):
        url = "/v1/again/path?angle=deg"
        with client.stream("POST", url, json=body, headers=headers) as answer:
            first = next(answer.iter_lines())
        assert json.loads(first)["sample"] == 0
        server.comes_to_rest()
        short = client.post("/v1/path?angle=deg", json={**body, "samples": 10})
        assert short.status_code == 200


def test_spatial_paths_with_every_obstacle(client):
    body = {
        "q": [0, -0.5, 0, -2.0, 0, 1.6, 0.8],
        "waypoints": [
            {"position": [0.4, 0.1, 0.6], "rpy": [180, 0, 0]},
            {"position": [0.4, 0.2, 0.5], "rpy": [180, 0, 30]},
        ],
        "task": "pose",
        "tf": 8,
        "obstacles": [
            {"type": "sphere", "center": [0.7, 0.5, 0.5], "radius": 0.1},
            {"type": "box", "center": [0.6, -0.5, 0.2], "size": [0.2, 0.2, 0.4], "rpy": [0, 0, 45]},
            {"type": "capsule", "start": [0, 0.6, 0], "end": [0, 0.6, 1], "radius": 0.05},
            {"type": "half_space", "normal": [0, 0, 1], "offset": 0},
        ],
        "link_radius": 0.05,
    }
    rad = {**body, "waypoints": [
        {**w, "rpy": np.deg2rad(w["rpy"]).tolist()} for w in body["waypoints"]]}  # fmt: skip
    rad["obstacles"][1]["rpy"] = [0, 0, np.pi / 4]
    answer = client.post("/v1/robots/panda/path", json=rad).json()
    assert answer["success"], answer["message"]
    end = client.post("/v1/robots/panda/fk", json={"q": answer["q"][-1]}).json()["poses"]["tool"]
    np.testing.assert_allclose(end["position"], [0.4, 0.2, 0.5], atol=1e-7)
    assert max(answer["orientation_error"]) < 1e-8


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"method": "magic"}, "/method"),
        ({"target": None}, "/target"),
        ({"circle": {"center": [0, 0]}}, "/circle"),
        ({"samples": 1}, "/samples"),
        ({"samples": 10**6}, "/samples"),
        ({"tf": 0}, "/tf"),
        ({"time_law": "jerk"}, "/time_law"),
        ({"d_safe": -1}, "/d_safe"),
        ({"link_radius": -1}, "/link_radius"),
        ({"obstacles": [{"type": "cone"}]}, "/obstacles/0/type"),
        ({"obstacles": [{"type": "circle", "center": [1, 2], "radius": -1}]},
         "/obstacles/0/radius"),
        ({"obstacles": [{"type": "sphere", "center": [1, 2], "radius": 1}]}, "/obstacles/0/center"),
        ({"obstacles": [{"type": "circle", "center": [9, 9], "radius": 1}] * 101}, "/obstacles"),
        ({"q": [200, 0, 0]}, "/q/0"),
        ({"task": "magic"}, "/task"),
        ({"task": "xy_phi"}, "/target"),
        ({"frame": "hand"}, "/frame"),
        ({"frame": "base_link"}, "/frame"),
        ({"secondary": [{"frame": "frame_0"}]}, "/secondary/0/frame"),
        ({"damping": 0}, "/damping"),
        ({"tolerance": {"position": -1}}, "/tolerance/position"),
        ({"secondary": [{"frame": "no"}]}, "/secondary/0/frame"),
        ({"secondary": [{}, {"task": "magic"}]}, "/secondary/1/task"),
        ({"method": "task_priority"}, "/secondary"),
        ({"posture": [0, 0]}, "/posture"),
        ({"gains": {"limits": -1}}, "/gains/limits"),
        ({"method": "whole_path", "samples": 10_000, "obstacles":
          [{"type": "circle", "center": [9, 9], "radius": 1}] * 5}, "/samples"),
    ],
)  # fmt: skip
def test_bad_paths_name_their_field(client, change, pointer):
    body = {**body_of(SCENARIOS["3R_free"]), **change}
    answer = client.post("/v1/path?angle=deg", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer


LINE = {
    "q": [0, -0.5, 0, -2.0, 0, 1.6, 0.8],
    "target": {"position": [0.4, 0.2, 0.5]},
    "task": "position",
    "samples": 101,
    "obstacles": [{"type": "sphere", "center": [0.7, 0.5, 0.5], "radius": 0.1}],
    "link_radius": 0.05,
}


def test_a_path_in_the_shortest_time(client):
    body = {**LINE, "retime": {"acceleration": 5, "samples": 301}}
    url = "/v1/robots/panda/path"
    answer = client.post(url, json=body).json()
    assert answer["success"]
    motion = answer["retimed"]
    assert motion["status"] == "retimed"
    assert motion["success"], motion["message"]
    assert motion["violations"] == motion["warnings"] == []
    assert 0.1 < motion["duration"] < 2
    assert len(motion["t"]) == len(motion["q"]) == len(motion["velocity"]) == 301
    assert motion["t"][-1] == pytest.approx(motion["duration"])
    robot = client.get("/v1/robots/panda").json()
    speeds = np.array([joint["velocity"] for joint in robot["joints"]])
    assert motion["velocity_limits"] == speeds.tolist()
    assert motion["acceleration_limits"] == [5.0] * 7
    assert np.abs(np.array(motion["velocity"]) / speeds).max() <= 1 + 1e-9
    assert np.abs(motion["acceleration"]).max() <= 5 * (1 + 1e-9)
    np.testing.assert_allclose(motion["q"][-1], answer["q"][-1], atol=1e-12)
    assert motion["max_position_deviation"] < 1e-4
    assert motion["min_clearance"] <= answer["summary"]["min_clearance"]

    # the same in degrees, and joint by joint
    names = [joint["name"] for joint in robot["joints"]]
    wide = dict.fromkeys(names, float(np.rad2deg(5)))
    degrees = {
        **body,
        "q": np.rad2deg(LINE["q"]).tolist(),
        "retime": {"acceleration": wide, "velocity": np.rad2deg(speeds).tolist(), "samples": 301},
    }
    turned = client.post(f"{url}?angle=deg", json=degrees).json()["retimed"]
    assert turned["duration"] == pytest.approx(motion["duration"], rel=1e-6)
    np.testing.assert_allclose(turned["velocity"], np.rad2deg(motion["velocity"]), atol=1e-3)
    np.testing.assert_allclose(turned["acceleration_limits"], np.rad2deg(5))

    assert client.post(url, json=LINE).json()["retimed"] is None


def test_a_retimed_path_as_text_picture_npy_and_stream(client):
    body = {**LINE, "retime": {"acceleration": 5, "samples": 50}}
    url = "/v1/robots/panda/path"
    plain = client.post(url, json=body).json()
    text = client.post(f"{url}?format=text", json=body).text
    assert "retimed:" in text
    assert "  duration: " in text
    picture = client.post(f"{url}?format=svg", json=body).text
    assert "in the shortest time: speeds / limit" in picture
    assert "nan" not in picture
    array = np.load(io.BytesIO(client.post(f"{url}?format=npy", json=body).content))
    assert array.shape == (101, 7)
    lines = [
        json.loads(line)
        for line in client.post(f"{url}?format=ndjson", json=body).text.splitlines()
    ]
    assert len(lines) == 101 + 50 + 1
    assert [line["retimed_sample"] for line in lines[101:-1]] == list(range(50))
    np.testing.assert_allclose([line["q"] for line in lines[101:-1]], plain["retimed"]["q"])
    last = lines[-1]["retimed"]
    assert last["success"]
    assert "q" not in last
    assert last["duration"] == pytest.approx(plain["retimed"]["duration"])
    untimed = client.post(f"{url}?format=ndjson", json=LINE).text.splitlines()
    assert json.loads(untimed[-1])["retimed"] is None


def test_methods_compared_by_their_shortest_time(client):
    body = {**LINE, "methods": ["qp", "pseudo_inverse"], "retime": {"acceleration": 5}}
    url = "/v1/robots/panda/path/compare"
    table = client.post(url, json=body).json()
    assert all(row["retimed_success"] and row["retimed_duration"] > 0 for row in table["rows"])
    assert "the path takes" in table["messages"]["qp"]
    csv_text = client.post(f"{url}?format=csv", json=body).text
    rows = list(csv.DictReader(io.StringIO(csv_text)))
    assert float(rows[0]["retimed_duration"]) == pytest.approx(table["rows"][0]["retimed_duration"])
    del body["retime"]
    assert client.post(url, json=body).json()["rows"][0]["retimed_duration"] is None


def test_a_stuck_path_has_no_motion_to_time(client):
    body = {"q": [0, 0, 0], "target": {"position": [0.9, 0]}, "task": "xy",
            "method": "pseudo_inverse", "retime": {"acceleration": 1}}  # fmt: skip
    url = "/v1/robots/planar_3r/path"
    motion = client.post(url, json=body).json()["retimed"]
    assert (motion["status"], motion["success"], motion["duration"]) == ("no_motion", False, 0)
    assert motion["velocity_limits"] == [None] * 3
    lines = client.post(f"{url}?format=ndjson", json=body).text.splitlines()
    assert json.loads(lines[-1])["retimed"]["status"] == "no_motion"
    assert "<svg" in client.post(f"{url}?format=svg", json=body).text


SHAPED = """<robot name="shaped">
<link name="base"><collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
<link name="upper"><collision><origin xyz="0.25 0 0" rpy="0 1.5707963 0"/>
  <geometry><cylinder radius="0.05" length="0.5"/></geometry></collision></link>
<link name="lower"><collision><origin xyz="0.2 0 0" rpy="0 1.5707963 0"/>
  <geometry><capsule radius="0.03" length="0.4"/></geometry></collision></link>
<link name="wrist"><collision><geometry><mesh filename="wrist.stl"/></geometry></collision></link>
<link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
<joint name="j2" type="revolute"><parent link="upper"/><child link="lower"/>
  <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
<joint name="j3" type="revolute"><parent link="lower"/><child link="wrist"/>
  <origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
  <limit lower="-3" upper="3" velocity="2" effort="1"/></joint>
<joint name="end" type="fixed"><parent link="wrist"/><child link="tip"/>
  <origin xyz="0.2 0 0"/></joint>
</robot>"""


def test_the_shapes_of_a_urdf(client):
    body = {
        "robot": {"urdf": SHAPED},
        "q": [0.4, 0.5, 0.6],
        "target": {"position": [0.3, 0.8]},
        "task": "xy",
        "obstacles": [
            {"type": "sphere", "center": [0.6, -0.2, 0], "radius": 0.05},
            {"type": "sphere", "center": [0, 0.2, 0], "radius": 0.1},
        ],
        "link_radius": {"j1": 0.01, "j2": 0.02, "j3": 0.04},
        "link_geometry": "urdf",
    }
    answer = client.post("/v1/path", json=body).json()
    parts = {part["link"]: part for part in answer["links"]}
    assert set(parts) == {"upper", "lower", "segment 3"}
    assert parts["upper"]["shape"] == "cylinder"
    assert 0 < parts["upper"]["excess"] <= 0.06
    lower = {"link": "lower", "joint": "j2", "shape": "capsule", "radius": 0.03, "excess": 0.0}
    assert parts["lower"] == {**lower, "length": pytest.approx(0.4)}
    segment = {"link": "segment 3", "joint": "j3", "shape": "segment", "radius": 0.04}
    assert parts["segment 3"] == {**segment, "length": None, "excess": 0.0}
    assert "meshes are not read, those of wrist" in answer["warnings"][0]
    assert "link base, which no joint of the arm moves" in answer["warnings"][1]
    assert "from obstacle 1" in answer["warnings"][1]
    picture = client.post("/v1/path?format=svg", json=body).text
    assert picture.count("#56b4e9") >= 27
    assert "nan" not in picture
    lines = client.post("/v1/path?format=ndjson", json=body).text.splitlines()
    assert json.loads(lines[-1])["links"] == answer["links"]

    bones = {**body, "link_geometry": "skeleton"}
    plain = client.post("/v1/path", json=bones).json()
    assert plain["links"] is None
    assert plain["warnings"] == []
    assert plain["clearance"][0] > answer["clearance"][0]
    table = client.post("/v1/path/compare", json={**body, "methods": ["qp"]}).json()
    assert table["links"] == answer["links"]
    assert table["rows"][0]["min_clearance"] == answer["summary"]["min_clearance"]


def test_radii_of_the_links_by_joint(client):
    body = body_of(SCENARIOS["3R_obstacle"])
    one = client.post("/v1/path?angle=deg", json={**body, "link_radius": 0.03}).json()
    for radii in ([0.03] * 3, {"j1": 0.03, "j2": 0.03, "j3": 0.03}):
        same = client.post("/v1/path?angle=deg", json={**body, "link_radius": radii}).json()
        assert same["clearance"] == one["clearance"]
    thin = client.post("/v1/path?angle=deg", json={**body, "link_radius": [0, 0, 0.03]}).json()
    assert thin["clearance"][0] >= one["clearance"][0]
    picture = client.post(
        "/v1/path?angle=deg&format=svg", json={**body, "link_radius": [0, 0, 0.03]}
    )
    assert "<svg" in picture.text


@pytest.mark.parametrize(
    ("change", "pointer", "words"),
    [
        ({"retime": {}}, "/retime/acceleration", "give a number for all joints"),
        ({"retime": {"acceleration": 0}}, "/retime/acceleration", "joint j1"),
        ({"retime": {"acceleration": [1, -1, 1]}}, "/retime/acceleration/1", "joint j2"),
        ({"retime": {"acceleration": [1, 1]}}, "/retime/acceleration", "2 values; give 3"),
        ({"retime": {"acceleration": {"j1": 1}}}, "/retime/acceleration", "lacks joint j2"),
        ({"retime": {"acceleration": {"j1": 1, "jx": 1}}}, "/retime/acceleration/jx", "unknown"),
        ({"retime": {"acceleration": "fast"}}, "/retime/acceleration", ""),
        ({"retime": {"acceleration": 1, "velocity": 1e12}}, "/retime/velocity", "give 1e-06"),
        ({"retime": {"acceleration": 1, "samples": 1}}, "/retime/samples", "give 2"),
        ({"retime": {"acceleration": 1, "samples": 10**6}}, "/retime/samples", "give 2"),
        ({"retime": {"acceleration": 1, "jerk": 1}}, "/retime/jerk", "unknown"),
        ({"link_radius": [0.1]}, "/link_radius", "1 values; give 3"),
        ({"link_radius": {"j1": 0.1, "j2": -1, "j3": 0}}, "/link_radius/j2", "joint j2"),
        ({"link_geometry": "mesh"}, "/link_geometry", "skeleton or urdf"),
    ],
)
def test_bad_limits_and_links_name_their_field(client, change, pointer, words):
    body = {**body_of(SCENARIOS["3R_free"]), **change}
    for headers in ({}, {"Accept": "application/x-ndjson"}):
        answer = client.post("/v1/path?angle=deg", json=body, headers=headers)
        assert answer.status_code == 422, answer.text
        assert answer.json()["errors"][0]["pointer"] == pointer
        assert words in answer.json()["detail"]
    compare = {key: value for key, value in body.items() if key != "method"}
    assert client.post("/v1/path/compare?angle=deg", json=compare).status_code == 422


@pytest.mark.parametrize(
    ("change", "pointer", "words"),
    [
        ({"target": {"position": [1]}}, "/target/position", "target.position has 1 values; give 2"),
        ({"target": None, "waypoints": [{"position": [0.5, 0.2]}, {"position": []}]},
         "/waypoints/1/position", "waypoints.1.position has 0 values"),
        ({"obstacles": [{"type": "box", "center": [9, 9, 0], "size": [1, 1, 1], "rpy": [0, 0]}]},
         "/obstacles/0/rpy", "obstacles.0.rpy has 2 values; give 3"),
        ({"target": None, "circle": {"center": [0.1]}}, "/circle/center", "give two"),
        ({"target": None, "circle": {"center": [0.1, 0], "plane": "xz"}}, "/circle/plane",
         "leaves the plane of the task xy"),
        ({"methods": ["qp", {"method": "qp", "margin": -1}]}, "/methods/1/margin", "margin is -1"),
        ({"methods": [{"method": "null_space", "gains": {"limits": -1}}]},
         "/methods/0/gains/limits", "give 0"),
        ({"d_safe": 0.02, "methods": ["qp", {"method": "null_space", "influence": 0.01}]},
         "/methods/1/influence", "give more than d_safe, 0.02"),
        ({"obstacles": [{"type": "box", "center": [9, 9, 0], "size": [1, 0, 1]}]},
         "/obstacles/0/size", "the size has a value that is not positive"),
        ({"obstacles": [{"type": "circle", "center": [9], "radius": 1}]},
         "/obstacles/0/center", "center has 1 values; give 2 or 3"),
    ],
)  # fmt: skip
def test_refusals_name_the_field_as_it_was_given(client, change, pointer, words):
    body = {**body_of(SCENARIOS["3R_free"]), **change}
    body = {key: value for key, value in body.items() if value is not None}
    url = "/v1/path/compare" if "methods" in change else "/v1/path"
    answer = client.post(f"{url}?angle=deg", json=body)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer
    assert words in answer.json()["detail"]


def test_a_step_of_a_frame_that_no_joint_moves(client):
    body = {"q": [0.5, -0.7, 1], "delta_x": [0.01, 0], "task": "xy", "frame": "frame_0"}
    answer = client.post("/v1/robots/planar_3r/step", json=body)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/frame"
    assert "no joint moves frame 'frame_0'" in answer.json()["detail"]
    lower = {key: value for key, value in body.items() if key != "q"}
    second = {**body, "frame": "tool", "secondary": [lower]}
    answer = client.post("/v1/robots/planar_3r/step", json=second)
    assert answer.json()["errors"][0]["pointer"] == "/secondary/0/frame"
    second["secondary"] = [{**lower, "frame": "tool", "task": "magic"}]
    answer = client.post("/v1/robots/planar_3r/step", json=second)
    assert answer.json()["errors"][0]["pointer"] == "/secondary/0/task"
    whole = {"q": [0.5, -0.7, 1], "delta_x": [0] * 6, "task": "pose"}
    words = client.post("/v1/robots/planar_3r/step", json=whole).json()["detail"]
    assert "choose another (xy, x, y, xy_phi)" in words


def test_a_spatial_arm_is_drawn_in_space(client):
    """Seen from aside, on a floor with coordinates; a planar arm in its plane."""
    body = {
        **LINE,
        "obstacles": [
            {"type": "sphere", "center": [0.7, 0.5, 0.5], "radius": 0.1},
            {"type": "circle", "center": [0.7, -0.5], "radius": 0.1},
            {"type": "box", "center": [0.6, -0.5, 0.2], "size": [0.2, 0.2, 0.4], "rpy": [0, 0, 1]},
            {"type": "capsule", "start": [0, 0.6, 0], "end": [0, 0.6, 1], "radius": 0.05},
            {"type": "half_space", "normal": [0, 0, 1], "offset": -0.01},
        ],
        "methods": ["pseudo_inverse", "qp"],
    }
    picture = client.post("/v1/robots/panda/path/compare?format=svg", json=body).text
    assert picture.count(">z [m]<") == 2
    assert picture.count(">y [m]<") == 2
    assert "nan" not in picture
    flat = {**body_of(SCENARIOS["8R_obstacles"]), "methods": ["qp"]}
    assert ">z [m]<" not in client.post("/v1/path/compare?angle=deg&format=svg", json=flat).text
