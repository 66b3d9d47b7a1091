"""Paths over HTTP: nine reference scenarios, loops, streams."""

import json

import httpx
import numpy as np
import pytest

from tests.app.operations.scenarios import DEGREE, SCENARIOS, body_of
from tests.conftest import PATIENCE

REFERENCES = {"sqp": "slsqp_hard", "qp": "qp_daqp", "whole_path": "ipopt_whole_path"}
CONSTRAINED = tuple(REFERENCES)
FREE = ("3R_free", "8R_free")
LIMITED = ("3R_limits", "8R_limits")
OBSTRUCTED = ("3R_obstacle", "8R_obstacles", "8R_pose")


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
    assert "rad to sample" in diverged["message"]
    assert "out of its branch" in diverged["message"]
    assert figures(diverged)["largest_step"] * DEGREE <= 1
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


@pytest.mark.scene
def test_a_loop_drifts_as_the_course_says(client):
    body = {
        "q": [110, -88, -96],
        "task": "xy",
        "method": "pseudo_inverse",
        "samples": 4001,
        "circle": {"center": [0.18, 0.58], "turns": 1},
        "time_law": "linear",
    }
    tip = client.get("/v1/robots/planar_3r/fk?q=110,-88,-96&angle=deg").json()
    x, y, _ = tip["poses"]["tool"]["position"]
    body["circle"]["center"] = [x - 0.1, y]
    answer = client.post("/v1/robots/planar_3r/path?angle=deg", json=body).json()
    assert answer["closed"]
    np.testing.assert_allclose(answer["drift"], (3.2018, -2.9971, 5.1422), atol=3e-3)
    assert answer["summary"]["drift"] == pytest.approx(np.linalg.norm(answer["drift"]))


@pytest.mark.scene
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
    rad = {
        **body,
        "waypoints": [{**w, "rpy": np.deg2rad(w["rpy"]).tolist()} for w in body["waypoints"]],
    }
    rad["obstacles"][1]["rpy"] = [0, 0, np.pi / 4]
    answer = client.post("/v1/robots/panda/path", json=rad).json()
    assert answer["success"], answer["message"]
    end = client.post("/v1/robots/panda/fk", json={"q": answer["q"][-1]}).json()["poses"]["tool"]
    np.testing.assert_allclose(end["position"], [0.4, 0.2, 0.5], atol=1e-7)
    assert max(answer["orientation_error"]) < 1e-8
